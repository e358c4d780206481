-- A restoring force surface in a model: identified on one record, run on another excitation, beside the truth; bilinear in
-- its cells and as a spline, on which runs converge faster; and the same damping as a function in Lua, which works, and says
-- what it costs.
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time

local function damping(y, v) return 20*v / (1 + (y/2e-3)^2) end
local truth = lunid.model { mass = 1, restoring = 2e4*y + damping(y, v) }

local noise = lunid.excitation.white_noise { rms = 60, seed = 1, dt = 1e-3, duration = 30 }
local record = lunid.simulate { model = truth, excitation = noise }:record()
local surface = lunid.rfs { record = record, mass = 1, interpolate = lunid.grid { cells = { 12, 12 } } }
print(surface)

local identified = lunid.model { mass = 1, restoring = surface(y, v) }
local spline = lunid.rfs { record = record, mass = 1, name = "spline",
  interpolate = lunid.grid { cells = { 12, 12 }, between = "cubic" } }
local smooth = lunid.model { mass = 1, restoring = spline(y, v) }
local in_lua = lunid.lua_function { "damping", damping }
local called = lunid.model { mass = 1, restoring = 2e4*y + in_lua(y, v) }

for _, model in ipairs { truth, identified, smooth, called } do
  local run = lunid.simulate { model = model, excitation = 30*lunid.sin(110*t), duration = 1, dt = 1e-3 }
  print(("rms of y %.5g m: %s"):format(run:column("y"):rms(), model:equation()))
end
identified:save "identified.lua"  -- with all values of the surface

-- What most shakers have: a force cell and an accelerometer. Free runs are held against the acceleration itself; what an
-- integration would lose or add judges nothing. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local nature = lunid.model { mass = 2.1, restoring = 3.3e4*y + 16*v + 4.2e9*y^3 }

local function measure(seed)
  local force = lunid.excitation.multisine { from = 8, to = 45, rms = 9, dt = 1/800, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = force }:record():with_noise { a = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "a", run:column "a" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2.1, restoring = k*y + c*v },
  train = measure(1), test = measure(2) }
print(found)
print("held against channel " .. found.output)

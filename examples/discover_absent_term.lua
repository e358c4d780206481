-- A baseline that says too much: it believes in dry friction, and there is none, but a cubic spring that it lacks. The spring
-- is named; the friction is offered for removal and left where it is, since a baseline is the user's. "Nature" stands for the
-- rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 2, restoring = 3e4*y + 25*v + 1.5e10*y^3 }

local function measure(seed)
  local shaker = lunid.excitation.multisine { from = 8, to = 45, rms = 14, dt = 1/600, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = shaker }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local Fc = lunid.parameter { "Fc", min = 0, unit = "N" }
local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v + Fc*lunid.sign(v) },
  train = measure(1), test = measure(2) }
print(found)

local absent = found.data.removable[1]  -- the line `absent?`
assert(found.verdict == "explained" and #found.effects == 1 and found.effects[1].name == "cubic_stiffness")
assert(#found.data.removable == 1 and absent.parameter == "Fc" and found.model.parameters.Fc)

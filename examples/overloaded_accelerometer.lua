-- An accelerometer that is overloaded. Faults of sensors and of the input compete with physics for the same misfit: here
-- nothing is missing in the model, and what is named is the channel that clips, with the level at which it does.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local nature = lunid.model { mass = 2.1, restoring = 3.3e4*y + 16*v }
local limit = 25  -- m/s^2

local function measure(seed)
  local force = lunid.excitation.multisine { from = 8, to = 45, rms = 9, dt = 1/800, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = force }:record():with_noise { a = 0.01, seed = seed }
  local shown = {}
  for i = 1, run.rows do shown[i] = math.max(-limit, math.min(limit, run:column "a"[i])) end
  return lunid.record { channels = { { "F", run:column "F" }, { "a", shown } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2.1, restoring = k*y + c*v },
  train = measure(1), test = measure(2) }
print(found)
print(found.model:equation())

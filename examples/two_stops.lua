-- Stops on either side with gaps of their own: an entry that stands twice. The parameters of the second end in _b.
-- "Nature" is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local above = lunid.effects.one_sided_stop { prefix = "above", k = 9e4, g = 1.2e-3 }
local below = lunid.effects.one_sided_stop { prefix = "below", k = 6e4, g = 2.0e-3, variant = 2 }
local nature = lunid.model { mass = 2, restoring = 3e4*y + 10*v + above + below }

local function measure(rms, seed)
  local shaker = lunid.excitation.multisine { from = 5, to = 60, rms = rms, dt = 1/800, duration = 4, seed = seed }
  local run = lunid.simulate { model = nature, excitation = shaker }
    :record():with_noise { y = lunid.noise.gaussian { relative = 0.01 }, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v },
  train = measure(18, 1), test = measure(14, 2) }
print(found)
for _, each in ipairs(found.effects) do
  print(("%s  %s: k %.3g N/m, g %.3g mm"):format(each.name, each.formula, each.parameters.k.value, 1e3*each.parameters.g.value))
end

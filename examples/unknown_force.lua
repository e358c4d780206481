-- A rig holds a force that no entry of the catalogue has: a spring that is stiffer the faster it moves. No name is forced on
-- it; what is said is its shape, and a model of forces without a name that can be simulated. "Nature" stands for the rig: it
-- is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 0.4, restoring = 1.1*v + 900*y + 700*y*lunid.abs(v) }

local function measure(excitation, seed)
  local run = lunid.simulate { model = nature, excitation = excitation }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local shaken = lunid.excitation.multisine { from = 2, to = 16, rms = 6, dt = 1/150, duration = 16, seed = 1 }
local swept = lunid.excitation.swept_sine { from = 3, to = 14, amplitude = 5, dt = 1/150, duration = 16 }
local k, c = lunid.parameter { "k", unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }

local found = lunid.discover { model = lunid.model { mass = 0.4, restoring = k*y + c*v },
  train = measure(shaken, 1), test = measure(swept, 2) }
print(found)
for _, each in ipairs(found.data.unknown_force.harmonics) do
  print(("harmonic %d: %.2g N (noise alone below %.2g N)"):format(each.order, each.amplitude, each.level))
end

-- The model without a name under a force that it has not seen, beside the rig.
local other = lunid.excitation.harmonic { amplitude = 4, frequency = 7.2, dt = 1/150, duration = 8 }
local function steady(model)
  local run = lunid.simulate { model = model, excitation = other }
  return 1e3 * run:column("y"):max()
end
print(("largest displacement under 4 N at 7.2 Hz: rig %.2f mm, baseline %.2f mm, closure %.2f mm"):format(steady(nature),
  steady(found.baseline), steady(found.closure)))

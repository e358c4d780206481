-- Two springs that fit a record alike, the experiment that tells them apart, and the record that it makes.
-- What "nature" is here would be a test rig: its law is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", min = 0, unit = "N/m" }
local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local baseline = lunid.model { mass = 1, restoring = k*y + c*v }
local nature = lunid.model { mass = 1, restoring = y + 0.08*v + 0.06*y^3 }
local rivals = { "cubic_stiffness", "odd_quadratic_stiffness" }

local function measure(force, seed)
  local run = lunid.simulate { model = nature, excitation = force, from = { 0, 0 } }
  return run:record():with_noise { y = 0.12, seed = seed }
end
local function weak_push(seed)
  return lunid.excitation.multisine { from = 0.12, to = 0.2, rms = 0.1, dt = 0.21, duration = 250, seed = seed }
end

-- A weak push in a narrow band: the spring hardens, but how? Either law would do.
local first = lunid.discover { model = baseline, train = measure(weak_push(4), 4), test = measure(weak_push(9), 9),
  catalogue = rivals }
print(first.verdict, first.sentence)

-- What would decide, within what this machine can do? Rate, time and noise are those of the first record.
local design = lunid.design_experiment { from = first, limits = { force = 0.6, displacement = 3, frequency = { 0.04, 0.4 } } }
print(design)
design.excitation:save "next_experiment.csv"

-- That experiment, made; the first record is the test.
local second = lunid.discover { model = baseline, train = measure(design.excitation, 5), test = measure(weak_push(4), 4),
  catalogue = rivals }
print(second.verdict, second.sentence)

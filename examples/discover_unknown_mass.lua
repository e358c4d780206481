-- A mass that nobody has weighed is a parameter like any other, and several records of different excitations are one body of
-- evidence: a multisine and a sweep to train on, filtered noise and steps to test. On the command line: --mass m, and several
-- files. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 3.7, restoring = 9e3*y + 14*v + 6*v*lunid.abs(v) }

local function measure(excitation, seed)
  local run = lunid.simulate { model = nature, excitation = excitation }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local make = lunid.excitation
local train = { measure(make.multisine { from = 3, to = 20, rms = 60, dt = 1/250, duration = 8, seed = 1 }, 1),
  measure(make.swept_sine { from = 4, to = 14, amplitude = 50, dt = 1/250, duration = 8 }, 2) }
local test = { measure(make.band_limited_noise { from = 1, to = 15, rms = 70, dt = 1/250, duration = 8, seed = 3 }, 3),
  measure(make.harmonic { amplitude = 70, frequency = 7, dt = 1/250, duration = 6 }, 4) }

local m = lunid.parameter { "m", min = 0, unit = "kg" }
local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = m, restoring = k*y + c*v }, train = train, test = test }
print(found)

assert(found.verdict == "explained" and #found.effects == 1 and found.effects[1].name == "quadratic_drag")
assert(math.abs(found.model.parameters.m.value/3.7 - 1) < 0.01)

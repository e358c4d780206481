-- A shaft: y is an angle, F a torque, the "mass" a moment of inertia. The units of the record's channels are those of the
-- answer, N m/rad and N m; nothing else changes. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 0.031, restoring = 60*y + 0.12*v + 0.4*lunid.sign(v) }

local function measure(torque, seed)
  local motor = lunid.excitation.multisine { from = 2, to = 12, rms = torque, dt = 1/250, duration = 6, seed = seed }
  local run = lunid.simulate { model = nature, excitation = motor }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { dt = run.dt, channels = { { "F", run:column "F", unit = "N m" }, { "y", run:column "y", unit = "rad" } } }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N m/rad" }, lunid.parameter { "c", min = 0, unit = "N m s/rad" }
local found = lunid.discover { model = lunid.model { mass = 0.031, restoring = k*y + c*v },
  train = measure(2, 1), test = measure(1.5, 2) }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "coulomb_friction")
assert(math.abs(named.parameters.Fc.value/0.4 - 1) < 0.02 and named.parameters.Fc.unit == "N m")

-- A coil in series with a resistor, driven by a voltage, and the current alone: L*di/dt + R*i = u. The displacement is the
-- charge, which nobody measured, the mass an inductance. What else is in the circuit? "Nature" stands for the bench: it is
-- used for nothing but the records.
local lunid = require "lunid"
local v = lunid.velocity  -- the current
local inductance = 0.02   -- H, that is V s^2/C

local nature = lunid.model { mass = inductance, restoring = 4*v + 30*v^3 }  -- a lamp, whose filament grows hot at once

local function bench(seed, from, to)
  local voltage = lunid.excitation.multisine { from = from, to = to, rms = 1.2, period = 0.5, dt = 1e-4, duration = 0.5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = voltage }
  return lunid.record { dt = run.dt, channels = { { "F", run:column "F", unit = "V" }, { "v", run:column "v", unit = "A" } } }
    :with_noise { v = 0.01, seed = seed }
end

local c = lunid.parameter { "c", min = 0, unit = "V/A" }  -- the resistance
local found = lunid.discover { model = lunid.model { mass = inductance, restoring = c*v },
  train = bench(1, 2, 60), test = bench(2, 2, 90) }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "cubic_damping")
assert(math.abs(named.parameters.c3.value/30 - 1) < 0.02 and named.parameters.c3.unit == "V/A^3")

-- A displacement sensor whose zero wanders as it warms up, in each record in its own way. What drifts is not the rig: the
-- entry says `separate = true`, so that a test record has its own drift, found on it while all that was found of the rig is
-- held; an entry of one's own may say so as well (an amplifier that was set anew before each run).
-- "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 12, restoring = 4800*y + 9*v + 1.5e7*y^3 }

--- Micrometres at the start and per second.
local function measure(offset, drift, seed)
  local push = lunid.excitation.multisine { from = 0.5, to = 8, rms = 8, dt = 1/100, duration = 12, seed = seed }
  local run = lunid.simulate { model = nature, excitation = push }:record():with_noise { y = 0.01, seed = seed }
  local shown = {}
  for i, moved in ipairs(run:column "y") do shown[i] = moved + 1e-6*(offset + drift*(i - 1)*run.dt) end
  return lunid.record { name = "warm " .. seed, channels = { { "F", run:column "F" }, { "y", shown } }, dt = run.dt }
end
local train, test = measure(800, 300, 1), measure(-1500, -120, 2)

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 12, restoring = k*y + c*v }, train = train, test = test,
  catalogue = { "cubic_stiffness", "quadratic_stiffness", "coulomb_friction", "quadratic_drag", "stiffness_drift",
    "constant_force", "displacement_offset", "sensor_drift" } }  -- of all entries these, to be quick
print(found)

assert(found.verdict == "explained" and #found.effects == 2)
local named = {}
for _, effect in ipairs(found.effects) do named[effect.name] = effect end
assert(math.abs(named.cubic_stiffness.parameters.k3.value/1.5e7 - 1) < 0.05)
assert(math.abs(named.sensor_drift.parameters.d.value/300e-6 - 1) < 0.05)
local own = false
for _, warning in ipairs(found.warnings) do own = own or warning:find("has its own sensor_drift_b", 1, true) ~= nil end
assert(own, "the drift of the test record is told")

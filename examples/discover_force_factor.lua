-- A loudspeaker whose coil leaves its magnet: the recorded force is the current times a constant, the force that acts falls
-- with y^2 (Klippel 2006, J. Audio Eng. Soc. 54, 907). No force of y and v alone is missing: discovery says that the drive
-- depends on y, and an entry of one's own, which says what acts of the recorded force, gives it a name.
-- "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v, F = lunid.displacement, lunid.velocity, lunid.force

local nature = lunid.model { mass = 0.018, restoring = 2e3*y + 1.5*v, acts = { F = F*(1 - 4e4*y^2) } }

local function measure(seed)
  local music = lunid.excitation.multisine { from = 15, to = 140, rms = 2.5, dt = 1/2000, duration = 1, seed = seed }
  local run = lunid.simulate { model = nature, excitation = music }:record():with_noise { y = 0.005, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end
local train, test = measure(1), measure(2)

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local baseline = lunid.model { mass = 0.018, restoring = k*y + c*v }

local unknown = lunid.discover { model = baseline, train = train, test = test }
print(unknown.sentence)
assert(unknown.verdict == "unknown-effect" and unknown.sentence:find "a drive whose force depends on y")

local force_factor = lunid.effect {
  name = "force_factor", family = "input",
  acts = { F = "F*(1 - b*y^2)" },
  formula = "m*a + f = F*(1 - b*y^2)",
  parameters = { { "b", min = 0, unit = "1/m^2" } },
  sentence = "the force per ampere falls where the coil leaves its field",
}
local found = lunid.discover { model = baseline, train = train, test = test, effects = { force_factor } }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "force_factor")
assert(math.abs(named.parameters.b.value/4e4 - 1) < 0.05)

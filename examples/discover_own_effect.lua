-- An effect that the catalogue lacks, in ten lines: an eddy-current brake, whose force falls again beyond a critical velocity
-- (Wouterse 1991, IEE Proceedings B 138, 153). It competes with the catalogue's entries and is named before their dampers
-- and frictions. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local brake = lunid.effect {
  name = "eddy_current_brake", family = "damping", passive = true,
  contribution = "2*Fb*(v/vc)/(1 + (v/vc)^2)",
  parameters = { { "Fb", min = 0, unit = "N" }, { "vc", min = 0, unit = "m/s" } },
  guess = function(scale) return { { vc = 0.2*scale.v_max }, { vc = 0.6*scale.v_max } } end,  -- Fb is linear: solved for
  range = function(scale) return { vc = { 0.01*scale.v_max, 2*scale.v_max } } end,            -- beyond: a viscous damper
  sentence = "a magnet brakes a conductor that passes by, most at the critical velocity vc",
  confusers = { "coulomb_friction", "viscous_damping" },
}

local nature = lunid.model { mass = 2, restoring = 3e3*y + 4*v + brake { Fb = 6, vc = 0.15 } }

local function measure(seed)
  local shaker = lunid.excitation.multisine { from = 2, to = 14, rms = 14, dt = 1/200, duration = 8, seed = seed }
  local run = lunid.simulate { model = nature, excitation = shaker }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v },
  train = measure(1), test = measure(2), effects = { brake } }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "eddy_current_brake")
assert(math.abs(named.parameters.vc.value/0.15 - 1) < 0.1 and math.abs(named.parameters.Fb.value/6 - 1) < 0.1)

-- An accelerometer on a mass with known friction: the force along its integrals shows little, the free run shows what is
-- missing, and that is what the entries are tried on in the end. The records are made here, by Runge and Kutta's method at
-- four times the rate.
local lunid = require "lunid"
local spec = require "spec"

local mass, omega, length = 2.4e-6, 5e4, 2.5e-6
local rows, finer, spacing = 2700, 4, 2 * math.pi / 30

--- Ninety lines from 0.2 to 2.2 times the natural frequency; phases by a rule, another one for each seed.
local function force_at(tau, seed)
  local sum = 0
  for i = 1, 90 do sum = sum + math.cos((0.2 + i / 45) * tau + (1e4 * math.sin(77 * i + seed)) % 6.28) end
  return 0.034 * sum
end

--- Acceleration of x'' + 0.12 x' + 0.08 sign(x') + 0.2 x^2 x' + x = u, without dimensions.
local function record(seed)
  local h, state, as, fs = spacing / finer, { 0, 0 }, {}, {}
  local function slopes(tau, at)
    local x, s = at[1], at[2]
    local friction = (1 - 2 / (math.exp(math.max(-60, math.min(60, 1600 * s))) + 1)) * 0.08
    return { s, force_at(tau, seed) - 0.12 * s - friction - 0.2 * x * x * s - x }
  end
  for i = 0, rows * finer - 1 do
    local tau = i * h
    if i % finer == 0 then
      as[#as + 1] = slopes(tau, state)[2] * length * omega ^ 2
      fs[#fs + 1] = force_at(tau, seed) * mass * length * omega ^ 2
    end
    state = spec.runge_kutta(slopes, tau, state, h)
  end
  return lunid.record({ channels = { { "F", fs }, { "a", as } }, dt = spacing / omega })
    :with_noise { a = lunid.noise.gaussian { relative = 0.01 }, F = lunid.noise.gaussian { relative = 0.0056 }, seed = seed }
end

spec.case("what the free run alone shows is named", function()
  local y, v = lunid.displacement, lunid.velocity
  local k, c, Fc = lunid.parameter "k", lunid.parameter "c", lunid.parameter "Fc"
  local found = lunid.discover { train = record(1), test = record(2), out = "found",
    model = lunid.model { mass = mass, restoring = k*y + c*v + Fc*lunid.sign(v) } }
  spec.equal(found.verdict, "explained")
  spec.equal(#found.effects, 1)
  local effect = found.effects[1]
  spec.equal(effect.name, "van_der_pol_damping")
  spec.equal(effect.formula, "beta*y^2*v")  -- mu is one number with c
  spec.equal(effect.parameters.mu, nil)
  local beta, truth = effect.parameters.beta, 0.2 * mass * omega / length ^ 2
  spec.near(beta.value, truth, math.max(4 * beta.std, 0.1 * truth))
  assert(effect.gap_test < 0.3 * found.data.baseline.gap_test, found.sentence)
  -- The integrals drift at the ends of the record: the maps leave these out.
  local times, duration = found.maps.before.time.x, rows * spacing / omega
  assert(times[1] > 0.02 * duration and times[#times] < 0.98 * duration, "the maps hold the ends")
end)

spec.finish()

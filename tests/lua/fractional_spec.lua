-- A viscoelastic part beside a spring and a damper. The truth is made here: the fractional derivative as relaxations whose
-- rates are a factor of 2 apart from 2e-3 to 16 natural frequencies, with what is below as a spring and what is above as a
-- damper, by Runge and Kutta's rule.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity

--- y, v, a of m a + k y + c v + cf D^p y = F(t), from rest.
local function respond(o, rows, dt, finer, force)
  local omega, factor = math.sqrt((o.k + o.cf)/o.mass), 2
  local rates, weights, scale = {}, {}, math.sin(math.pi*o.p)/math.pi
  for i = 0, 13 do
    rates[i + 1] = 2e-3*omega*factor^i
    weights[i + 1] = scale*rates[i + 1]^o.p*math.log(factor)
  end
  local below, above = rates[1]/math.sqrt(factor), rates[#rates]*math.sqrt(factor)
  local spring, damper = scale*below^o.p/o.p, scale*above^(o.p - 1)/(1 - o.p)
  local function slopes(t, s)
    local sum, out = spring*s[1] + damper*s[2], {}
    for i = 1, #rates do
      sum = sum + weights[i]*s[i + 2]
      out[i + 2] = s[2] - rates[i]*s[i + 2]
    end
    out[1], out[2] = s[2], (force(t) - o.c*s[2] - o.k*s[1] - o.cf*sum)/o.mass
    return out
  end
  local s, ys, vs, as, h = {}, {}, {}, {}, dt/finer
  for i = 1, #rates + 2 do s[i] = 0 end
  for row = 1, rows do
    local t = (row - 1)*dt
    ys[row], vs[row], as[row] = s[1], s[2], slopes(t, s)[2]
    for part = 0, finer - 1 do s = spec.runge_kutta(slopes, t + part*h, s, h) end
  end
  return ys, vs, as
end

--- Straight between the rows.
local function straight(force, dt)
  return function(t)
    local row = math.floor(t/dt + 1e-9)
    local from, to = force(row*dt), force((row + 1)*dt)
    return from + (to - from)*(t/dt - row)
  end
end

local function values(force, rows, dt)
  local out = {}
  for i = 1, rows do out[i] = force((i - 1)*dt) end
  return out
end

local function baseline(mass)
  return lunid.model { mass = mass,
    restoring = lunid.parameter { "k", min = 0 }*y + lunid.parameter { "c", min = 0 }*v }
end

local function is_near(got, truth)
  spec.equal(got.effects[1].name, "fractional_damping")
  for name, value in pairs { c = truth.cf, p = truth.p } do
    local row = got.effects[1].parameters[name]
    spec.near(row.value, value, 3*row.std)
  end
end

spec.case("beside noise: one relaxation that follows as well is no more than a rival", function()
  local o = { mass = 5e-3, k = 2.95, c = 0.016, cf = 0.28, p = 0.27 }
  local omega = math.sqrt(o.k/o.mass)
  local dt = 2*math.pi/omega/16
  local function record(seed)
    local force = spec.tones(omega, 4e-3, seed)
    local ys, vs = respond(o, 1300, dt, 6, force)
    return lunid.record({ channels = { { "y", ys, unit = "m" }, { "v", vs, unit = "m/s" },
      { "F", values(force, 1300, dt), unit = "N" } }, dt = dt })
      :with_noise { y = lunid.noise.gaussian { relative = 0.03 }, v = lunid.noise.gaussian { relative = 0.03 }, seed = math.floor(100*seed) }
  end
  local found = lunid.discover { model = baseline(o.mass), train = record(0.7), test = record(1.9), max_effects = 1,
    catalogue = { "maxwell_relaxation", "fractional_damping", "hidden_mode", "added_mass" } }
  assert(found.verdict == "explained" or found.verdict == "ambiguous", found.verdict)
  is_near(found, o)
end)

spec.case("a force that is straight between its samples: the exponent is not that of another reading", function()
  local o = { mass = 0.9, k = 357, c = 0.13, cf = 32, p = 0.214 }
  local omega = math.sqrt(o.k/o.mass)
  local dt = 2*math.pi/omega/50
  local function record(seed)
    local force = straight(spec.tones(omega, 0.05, seed), dt)
    local _, _, as = respond(o, 2500, dt, 2, force)
    return lunid.record({ channels = { { "a", as, unit = "m/s^2" }, { "F", values(force, 2500, dt), unit = "N" } }, dt = dt })
      :with_noise { a = lunid.noise.gaussian { relative = 1e-3 }, seed = math.floor(100*seed) }
  end
  local found = lunid.discover { model = baseline(o.mass), train = record(0.7), test = record(1.9), max_effects = 1,
    catalogue = { "fractional_damping" } }
  is_near(found, o)
end)

spec.finish()

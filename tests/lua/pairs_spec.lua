-- Two effects at once, of which other pairs, or one effect that stands for both, follow the motion nearly as well. The
-- truth is made here, by Runge and Kutta's rule.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity

--- Rows of y, v, a and F of m a + force(y, v) = F(t) from rest.
local function respond(o, excitation)
  local function slopes(t, s) return { s[2], (excitation(t) - o.force(s[1], s[2]))/o.mass } end
  local s, h = { 0, 0 }, o.dt/o.finer
  local rows = { y = {}, v = {}, a = {}, F = {} }
  for i = 1, o.rows do
    local t = (i - 1)*o.dt
    rows.y[i], rows.v[i], rows.a[i], rows.F[i] = s[1], s[2], slopes(t, s)[2], excitation(t)
    for part = 0, o.finer - 1 do s = spec.runge_kutta(slopes, t + part*h, s, h) end
  end
  return rows
end

local function record(rows, dt)
  return lunid.record({ channels = { { "y", rows.y, unit = "m" }, { "v", rows.v, unit = "m/s" },
    { "a", rows.a, unit = "m/s^2" }, { "F", rows.F, unit = "N" } }, dt = dt })
end

local function white(rows, o, relative, seed)
  local noise = lunid.noise.gaussian { relative = relative }
  return record(rows, o.dt):with_noise { y = noise, v = noise, a = noise, seed = seed }
end

--- Tones one after another, of frequencies from `low` to `high` times the natural one.
local function stepped(o, size, low, high, steps)
  local part = o.rows*o.dt/steps
  return function(t)
    local step, phase = math.min(steps - 1, t // part), 0
    local function frequency(i) return o.omega*(low + (high - low)*i/(steps - 1)) end
    for i = 0, step - 1 do phase = phase + frequency(i)*part end
    return size*math.sin(phase + frequency(step)*(t - step*part))
  end
end

local function chirp(o, size, low, high)
  return function(t) return size*math.sin(o.omega*(low*t + (high - low)*t*t/(2*o.rows*o.dt))) end
end

local function model(o)
  return lunid.model { mass = o.mass, restoring = lunid.parameter { "k", min = 0 }*y + lunid.parameter { "c", min = 0 }*v }
end

local function expect(found, names)
  spec.equal(found.verdict, "explained")
  spec.equal(spec.names_of(found), names)
end

spec.case("of two curves of a spring neither is the best alone, and others stand for both", function()
  local o = { mass = 88.7, k = 459, c = 3.74, rows = 2095, dt = 1/25.3, finer = 4 }
  o.omega = math.sqrt(o.k/o.mass)
  function o.force(x, w) return o.k*x + o.c*w + 2920*x*x + 59.4*x/(1 + math.abs(x)/0.0097) end
  for _, seed in ipairs { 1, 3 } do
    expect(lunid.discover { catalogue = { "hyperbolic_soil", "quadratic_stiffness", "bilinear_stiffness",
        "sinusoidal_stiffness", "parametric_stiffness", "friction_lift_off", "missing_harmonic",
        "displacement_dependent_mass", "soil_plug", "hidden_mode", "added_mass" }, max_effects = 2, model = model(o),
      train = white(respond(o, stepped(o, 0.64, 1.7, 0.45, 6)), o, 0.0316, seed),
      test = white(respond(o, chirp(o, 0.64, 0.4, 1.85)), o, 0.0316, seed + 1) },
      "hyperbolic_soil quadratic_stiffness")
  end
end)

--- The same with noise of which each row holds 0.9 of the one before.
local function slow_noise(rows, o, relative, seed)
  math.randomseed(seed)
  for _, name in ipairs { "y", "v", "a" } do
    local values, noise, sum, squares = rows[name], 0, 0, 0
    for _, value in ipairs(values) do sum, squares = sum + value, squares + value*value end
    local deviation = math.sqrt(squares/#values - (sum/#values)^2)
    for i = 1, #values do
      local normal = math.sqrt(-2*math.log(1 - math.random()))*math.cos(2*math.pi*math.random())
      noise = 0.9*noise + math.sqrt(1 - 0.81)*normal
      values[i] = values[i] + relative*deviation*noise
    end
  end
  return record(rows, o.dt)
end

spec.case("names are not taken back for noise that has a colour", function()
  local o = { mass = 26, k = 2.9e5, c = 30, rows = 830, dt = 1/638, finer = 8 }
  o.omega = math.sqrt(o.k/o.mass)
  function o.force(x, w) return o.k*x + o.c*w + 875*math.max(0, w) + 1.8*(w > 0 and 1 or w < 0 and -1 or 0) end
  local found = lunid.discover { catalogue = { "asymmetric_damping", "coulomb_friction", "quadratic_drag",
      "cubic_stiffness", "constant_force" }, model = model(o),
    train = slow_noise(respond(o, stepped(o, 7, 0.5, 1.6, 8)), o, 0.1, 1),
    test = slow_noise(respond(o, spec.tones(o.omega, 1.6, 3)), o, 0.1, 2) }
  expect(found, "asymmetric_damping coulomb_friction")
  spec.contains(table.concat(found.warnings, "\n"), "taken for noise of a colour")
end)

spec.finish()

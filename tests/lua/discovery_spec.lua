-- What lunid.discover names with the whole catalogue, in records of a hand-written integrator.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity

--- The motion of x'' + rest(x, v, z) = F(t), z' = rate(x, v, z), by Runge and Kutta's fourth order in `fine` parts of a
--- sample: lists of the force, the displacement and the acceleration. `of.held`: the force is, over each
--- sample; `of.straight`: it goes in a straight line to the next. `of.delay`: rest is told x, or what `of.late` says, of so
--- long before, too.
local function motion(of, force, rows, dt, fine)
  local h, x, forces, ys, accelerations = dt / fine, { 0, 0 }, {}, {}, {}
  local between, past = force, {}
  for i = 1, of.states or 0 do x[2 + i] = 0 end
  local function before(t)
    local at = math.max(0, (t - of.delay) / h)
    local first = at // 1 + 1
    return past[first] + (at % 1)*((past[first + 1] or past[first]) - past[first])
  end
  local function slope(t, s)
    local d = { s[2], between(t) - of.rest(s[1], s[2], s[3], s[4], of.delay and before(t)) }
    if of.rate then d[3], d[4] = of.rate(s[1], s[2], s[3], s[4]) end
    return d
  end
  for i = 1, rows do
    forces[i], ys[i], past[#past + 1] = force((i - 1) * dt), x[of.shows or 1], x[of.late or 1]
    accelerations[i] = slope((i - 1) * dt, x)[2]
    if of.held then between = function() return forces[i] end end
    if of.straight then
      local rise = (force(i * dt) - forces[i]) / dt
      between = function(t) return forces[i] + rise*(t - (i - 1) * dt) end
    end
    for j = 1, fine do
      x = spec.runge_kutta(slope, ((i - 1) + (j - 1) / fine) * dt, x, h)
      if j < fine then past[#past + 1] = x[of.late or 1] end
    end
  end
  return forces, ys, accelerations
end

local function chirp(amplitude, first, last, duration)
  return function(t) return amplitude * math.sin(first*t + (last - first) * t^2 / (2*duration)) end
end

local function tone(frequency, amplitude)
  return function(t) return amplitude * math.sin(frequency*t) end
end

local function tones(amplitude, seed)
  return function(t)
    local sum = 0
    for i = 1, 12 do sum = sum + math.sin((0.2 + 0.17*i)*t + (seed*i*i) % 6.28) end
    return amplitude * sum
  end
end

--- A band of 120 tones.
local function band(amplitude, seed)
  local phases, r = {}, seed * 7919
  for i = 1, 120 do
    r = (r * 16807) % 2147483647
    phases[i] = r / 2147483647 * 6.28318
  end
  return function(t)
    local sum = 0
    for i = 1, 120 do sum = sum + math.sin((0.25 + 0.0179*i)*t + phases[i]) end
    return amplitude * sum / 3.16
  end
end

--- Of mass 1 and k 1, without the first `of.skip` rows; noise as a share of the displacement, which the sensor shows
--- off by `of.offset` and, on a part that gives way, by `of.gives` of the force.
local function record_of(of, force, rows, dt, noise, seed)
  local skip = of.skip or 0
  local forces, ys = motion(of, force, skip + rows, dt, of.fine or 8)
  forces, ys = table.move(forces, skip + 1, skip + rows, 1, {}), table.move(ys, skip + 1, skip + rows, 1, {})
  for i = 1, #ys do ys[i] = ys[i] + (of.offset or 0) + (of.gives or 0)*forces[i] end
  return lunid.record({ channels = { { "F", forces }, { "y", ys } }, dt = dt })
    :with_noise { y = lunid.noise.gaussian { relative = noise }, seed = seed }
end

--- What the whole catalogue finds; train and test are { force, rows, dt, seed }, train may be several of them.
local function found_in(of, noise, train, test, interpolation)
  local function record(made) return record_of(of, made[1], made[2], made[3], noise, made[4]) end
  local k, c = lunid.parameter { "k", min = 0 }, lunid.parameter { "c", min = of.least_damping or 0 }
  local records = {}
  for i, made in ipairs(type(train[1]) == "table" and train or { train }) do records[i] = record(made) end
  return lunid.discover {
    model = lunid.model { mass = 1, restoring = k*y + c*v, interpolation = interpolation },
    train = records, test = record(test), out = of.name,
    catalogue = of.catalogue,
  }
end

local function named(...) return spec.names_of(found_in(...)) end

-- A lightly damped absorber between the frequencies of coarser guesses: beside its resonance the force along the motion
-- has the wrong phase, and nothing points to it.
spec.case("a hidden mode of little damping beside a cubic spring", function()
  local mh, wh, ch = 0.08, 1, 0.004
  local of = {
    name = "absorber", states = 2,
    rest = function(x, u, z, w) return x + 0.018*u + 0.02*x^3 + mh*wh^2*(x - z) + ch*(u - w) end,
    rate = function(x, u, z, w) return w, wh^2*(x - z) + ch/mh*(u - w) end,
  }
  local names = named(of, 0.002, { chirp(0.1, 0.3, 1.6, 450), 3000, 0.15, 1 }, { tones(0.05, 2), 2500, 0.15, 2 })
  spec.equal(names, "cubic_stiffness hidden_mode")
end)

-- Neither alone comes near the motion, and beside what either makes of k and c the other has minima of its own: short
-- runs lead out of them.
spec.case("a strong cubic spring whose sensor is off its zero", function()
  local of = { name = "off", offset = 0.47, rest = function(x, u) return x + 0.04*u + 0.41*x^3 end,
    catalogue = { "cubic_stiffness", "displacement_offset" } }
  local found = found_in(of, 0.01, { band(0.18, 4), 2000, 0.157, 4 }, { band(0.07, 14), 2000, 0.157, 24 })
  spec.equal(spec.names_of(found), "cubic_stiffness displacement_offset")
  spec.near(found.model.parameters.cubic_stiffness_k3.value, 0.41, 0.005)
  spec.near(found.model.parameters.displacement_offset_b.value, 0.47, 0.003)
end)

-- Seven waves over the motion: guesses that double from one to the next stand a whole wave beside it.
spec.case("cogging of many waves over the motion", function()
  local of = { name = "cogging", rest = function(x, u) return x + 0.2*u + 0.3*math.sin(9*x) end,
    catalogue = { "sinusoidal_stiffness", "cubic_stiffness", "clearance", "saturating_stiffness" } }
  local found = found_in(of, 0.01, { tones(0.4, 3), 2500, 0.15, 3 }, { tones(0.3, 5), 2000, 0.15, 4 })
  spec.equal(spec.names_of(found), "sinusoidal_stiffness")
  spec.near(found.effects[1].parameters.p.value, 9, 0.02)
end)

-- Neither a sine nor a cosine of y comes near, and two of them have each a wave of their own.
spec.case("cogging whose rest lies between two of its places", function()
  local of = { name = "cogging_phase", rest = function(x, u) return x + 0.2*u + 0.3*math.sin(5*x + 0.7) end,
    catalogue = { "sinusoidal_stiffness", "cubic_stiffness", "clearance", "saturating_stiffness", "constant_force" } }
  local found = found_in(of, 0.01, { tones(0.4, 3), 2500, 0.15, 3 }, { tones(0.3, 5), 2000, 0.15, 4 })
  spec.equal(spec.names_of(found), "sinusoidal_stiffness")
  local own = found.effects[1].parameters
  spec.near(own.p.value, 5, 0.02)
  spec.near(math.atan(own.kc.value, own.k.value), 0.7, 0.05)
end)

-- More parameters than are needed follow the same motion: Bouc and Wen's hysteresis without loss.
spec.case("a curved spring beside drag is no hysteresis", function()
  local of = {
    name = "curved", rest = function(x, u) return x + 0.1*u + 0.5*x/(1 + math.abs(x)/0.8) + 0.1*math.abs(u)*u end,
  }
  local names = named(of, 0.01, { chirp(1, 0.3, 2.4, 380), 2500, 0.152, 3 }, { tones(0.25, 4), 1900, 0.2, 4 })
  spec.equal(names, "hyperbolic_soil quadratic_drag")
end)

-- Friction that grows with |y| has a parameter more.
spec.case("friction beside a lag", function()
  local of = {
    name = "lag", states = 2, shows = 3, fine = 24,
    rest = function(x, u) return x + 0.2*u + 0.15*math.tanh(u/2e-3) end,
    rate = function(x, _, z) return (x - z)/0.4, 0 end,
  }
  local names = named(of, 0.01, { tones(0.2, 5), 2200, 0.16, 5 }, { chirp(0.6, 0.3, 2.4, 350), 2200, 0.16, 6 })
  spec.equal(names, "coulomb_friction sensor_lag")
end)

-- The force acts three samples late: along the motion damping is negative, and the baseline's run grows without bound.
-- What came before the record is predicted from it: an accelerometer shows it at once.
spec.case("a late force beside a baseline that cannot be run", function()
  local late, dt = 0.42, 0.14
  local of = { name = "late", rest = function(x, u) return x + 0.06*u end }
  local function record(force, duration, seed)
    local rows = math.floor(duration/dt)
    local forces, _, accelerations = motion(of, force, rows + 3, dt, 8)
    table.move(forces, 4, rows + 3, 1)
    local made = { {}, {} }
    for i = 1, rows do made[1][i], made[2][i] = forces[i], accelerations[i] end
    return lunid.record({ channels = { { "F", made[1] }, { "a", made[2] } }, dt = dt })
      :with_noise { a = lunid.noise.gaussian { relative = 0.01 }, seed = seed }
  end
  local function two(t) return 0.6*math.sin(0.7*t + 0.4) + math.sin(1.9*t) end
  local k, c = lunid.parameter { "k" }, lunid.parameter { "c" }
  for _, catalogue in ipairs { { "force_delay" }, { "missing_harmonic", "sensor_lag", "force_delay", "cubic_stiffness" } } do
    local found = lunid.discover {
      model = lunid.model { mass = 1, restoring = k*y + c*v }, catalogue = catalogue, out = of.name .. #catalogue,
      train = record(two, 240, 7), test = record(chirp(1, 0.4, 2.2, 240), 240, 8),
    }
    spec.equal(spec.names_of(found), "force_delay")
    spec.near(found.data.effects[1].parameters.tau.value, late, 0.01)
    assert(found.data.final.gap_test < 0.02, found.data.final.gap_test)
  end
end)

-- At ten rows a period: what relaxes within one row still stiffens a tone more than what the force does between rows.
spec.case("a relaxation shorter than the sampling interval", function()
  local of = { name = "relaxation", states = 1, rest = function(x, u, z) return x + 0.04*u + z end,
    rate = function(_, u, z) return 0.8*u - z/0.42 end, fine = 24 }
  local names = named(of, 0.004, { chirp(1, 0.3, 2.2, 360), 560, 0.63, 9 }, { tones(0.4, 10), 560, 0.63, 10 })
  spec.equal(names, "maxwell_relaxation")
end)

-- At twenty rows a period a held force is late by a twentieth of a radian and more: read as smooth, a channel that lags
-- and a gain followed it nearly to the noise, and the one law did not.
spec.case("a relaxation under a force that is held", function()
  local of = { name = "held", held = true, states = 1, rest = function(x, u, z) return x + 0.04*u + z end,
    rate = function(_, u, z) return 0.6*u - z/0.5 end }
  local found = found_in(of, 0.0126, { band(0.3, 3), 1200, 0.314, 9 }, { tones(0.3, 10), 1200, 0.314, 10 })
  spec.equal(spec.names_of(found), "maxwell_relaxation")
  spec.equal(found.data.method.force_between_samples, "hold")
  local tau = found.effects[1].parameters.tau
  spec.near(tau.value, 0.5, 3*tau.std)
  spec.equal(found.data.where:find("a channel that lags", 1, true), nil)
end)

-- What straight lines take from the force shows at few rows a period alone.
spec.case("a reading of the force that the test record alone shows to be wrong is said", function()
  local of = { name = "reading", straight = true, rest = function(x, u) return x + 0.1*u end, catalogue = { "cubic_stiffness" } }
  local found = found_in(of, 0.03, { band(0.3, 5), 1200, 0.1, 9 }, { band(0.3, 3), 1200, 0.65, 10 })
  spec.equal(found.verdict, "nothing-missing")
  spec.contains(table.concat(found.warnings, "\n"), "the test records are followed better with the force read as linear")
end)

-- What the user says of the force stands, though the training records are followed better otherwise.
spec.case("a reading of the force that the baseline says is kept, and told where it is wrong", function()
  local of = { name = "said", rest = function(x, u) return x + 0.1*u end, catalogue = { "cubic_stiffness", "force_delay" } }
  local function read_as(interpolation)
    local found = found_in(of, 0.005, { band(0.3, 5), 1200, 0.3, 9 }, { band(0.3, 3), 1200, 0.3, 10 }, interpolation)
    return found.data.method.force_between_samples, table.concat(found.warnings, "\n")
  end
  local read, notes = read_as()
  spec.equal(read == "hold", false)
  spec.equal(notes:find("followed better", 1, true), nil)
  read, notes = read_as "hold"
  spec.equal(read, "hold")
  spec.contains(notes, "with the force read as ")
  spec.contains(notes, "than as it is said (")
end)

-- The baseline alone is damped; beside what it lacks its c is negative.
spec.case("a system that swings by itself", function()
  local of = { name = "swings", rest = function(x, u) return x - 0.1*u + 0.4*x^2*u end,
    catalogue = { "van_der_pol_damping", "cubic_damping", "coulomb_friction", "quadratic_drag" } }
  local found = found_in(of, 0.01, { band(0.06, 3), 2000, 0.3, 9 }, { band(0.1, 5), 1500, 0.3, 10 })
  spec.equal(spec.names_of(found), "van_der_pol_damping")
  spec.near(found.model.parameters.c.value, -0.1, 0.01)
  spec.near(found.model.parameters.van_der_pol_damping_beta.value, 0.4, 0.02)
  spec.contains(table.concat(found.warnings, "\n"), "c holds mu of van_der_pol_damping as well")
end)

-- What it adds beside the band of the motion went for noise, and the verdict was that nothing is missing.
spec.case("a displacement that holds a part of the force has no name", function()
  local of = { name = "compliance", rest = function(x, u) return x + 0.06*u end, gives = 1.2,
    catalogue = { "hidden_mode", "added_mass", "missing_harmonic", "parametric_stiffness" } }
  local found = found_in(of, 0.016, { chirp(0.3, 0.3, 3, 314), 1200, 0.262, 9 }, { band(0.3, 1), 1200, 0.262, 10 })
  spec.equal(found.verdict, "unknown-effect")
  spec.contains(found.sentence, "follows the force linearly")
  spec.near(found.data.noise_floor.gap_test, 0.016, 0.002)
end)

-- A cutter meets the surface that it left two periods before: a hidden mode follows that down to eleven times the noise,
-- and what it leaves, in which forces of y and v see nothing, still follows the force.
spec.case("a spring that answers the displacement of two periods before has no name", function()
  local of = { name = "regenerative", delay = 13.2, rest = function(x, u, _, _, late) return x + 0.04*u + 0.06*(x - late) end,
    catalogue = { "hidden_mode", "added_mass", "maxwell_relaxation", "cubic_stiffness" } }
  local found = found_in(of, 0.005, { band(0.3, 9), 2000, 0.25, 9 }, { band(0.3, 1), 2000, 0.25, 10 })
  spec.equal(found.verdict, "unknown-effect")
  spec.equal(#found.effects, 0)
end)

-- A reflex answers the velocity of a quarter of a period before. Relaxation and a hidden mode follow it down to the
-- noise, on the test record too, beside a damper that drives the motion.
spec.case("linear forces beside a damper that drives are no explanation", function()
  local of = { name = "reflex", delay = 1.4, late = 2, rest = function(x, u, _, _, late) return x + 0.67*u + 0.38*late end,
    least_damping = -10, catalogue = { "maxwell_relaxation", "hidden_mode" } }
  local found = found_in(of, 0.008, { band(0.3, 9), 2000, 0.1, 9 }, { chirp(0.4, 0.25, 2.5, 200), 2000, 0.1, 10 })
  spec.equal(found.verdict, "unknown-effect")
  spec.equal(#found.effects, 0)
end)

-- An entry as an element of the baseline is guessed as the entry is: without guesses a power of zero has no slope.
spec.case("an element of the baseline that is given no values", function()
  local of = { states = 1, rest = function(x, u, z) return 379*x + u + 379*z end,
    rate = function(_, u, z) return u - math.abs(z/0.0072)*(0.6*math.abs(u)*(z > 0 and 1 or -1) + 0.4*u) end }
  local function slower(force) return function(t) return force(25*t) end end
  local k, c = lunid.parameter { "k", min = 0 }, lunid.parameter { "c", min = 0 }
  local found = lunid.discover { model = lunid.model { mass = 1, restoring = k*y + c*v + lunid.effects.bouc_wen {} },
    train = record_of(of, slower(band(1.5, 3)), 1400, 0.00833, 0.008, 9),
    test = record_of(of, slower(tones(1.5, 10)), 1400, 0.00833, 0.008, 10),
    catalogue = { "bouc_wen", "cubic_stiffness", "coulomb_friction" }, out = "element" }
  spec.equal(found.verdict, "nothing-missing")
  local yield = found.model.parameters.bouc_wen_zy
  spec.near(yield.value, 0.0072, 3*yield.std)
end)

-- Under a sweep through a jump the test hangs on the damping, which the training record shows to a few percent: what its
-- deviations make of the test is no patchwork.
spec.case("friction beside a cubic spring, tested through a jump", function()
  local of = { name = "jump", fine = 24,
    rest = function(x, u) return x + 0.027*u + 0.1*x^3 + 0.05*math.tanh(u/2e-3) end }
  local names = named(of, 0.005, { tones(0.12, 13), 2000, 0.11, 13 }, { chirp(0.35, 0.4, 2.2, 220), 2000, 0.11, 14 })
  spec.equal(names, "coulomb_friction cubic_stiffness")
end)

-- At ten rows a period the force along the motion says nothing of what happens at creeping speed: beside the spring the
-- fit ended at a peak of no width.
spec.case("friction that falls with speed beside a cubic spring", function()
  for i, case in ipairs { { chirp(1, 0.3, 2, 480), 0.07 }, { tones(0.4, 5), 0.12 } } do
    local of = { name = "stribeck" .. i, fine = 48, catalogue = { "stribeck_friction", "cubic_stiffness" },
      rest = function(x, u)
        return x + 0.234*u + 0.1*x^3 + case[2]*(1 + 1.5*math.exp(-(u/0.3)^2))*math.tanh(u/2e-3)
      end }
    local names = named(of, 0.007, { case[1], 785, 0.61, 11 }, { tones(0.3, 12), 785, 0.61, 12 })
    spec.equal(names, "cubic_stiffness stribeck_friction")
  end
end)

-- Two tones below resonance at 20 dB are followed down to their noise by a common entry, which the test record refuses.
spec.case("rare springs are heard beside a common entry that follows two tones", function()
  local of = { name = "rare", rest = function(x, u) return x + 0.101*u + 0.301*x*math.abs(x) end }
  local function pair(frequency, size)
    return { { tone(frequency, 2*size*(1 - frequency^2)), 2059, 0.161, 11 },
      { tone(1.3*frequency, 2*size*(1 - (1.3*frequency)^2)), 2059, 0.161, 13 } }
  end
  local test = { tones(0.25, 6), 2059, 0.161, 12 }
  spec.equal(named(of, 0.1, pair(0.45, 0.6), test), "odd_quadratic_stiffness")
  spec.equal(named(of, 0.1, pair(0.6, 0.7), test), "odd_quadratic_stiffness")
end)

spec.case("the test record leaves the right one of what two tones cannot tell apart", function()
  local of = { name = "tied", skip = 300, rest = function(x, u) return x + 0.101*u + 0.301*x*math.abs(x) end }
  local train = { { tone(1.341, 0.584), 2059, 0.1593, 11 }, { tone(1.609, 1.13), 2059, 0.1593, 13 } }
  local found = found_in(of, 0.1, train, { tones(0.3, 6), 2059, 0.1593, 12 })
  spec.equal(found.verdict, "explained")
  spec.equal(spec.names_of(found), "odd_quadratic_stiffness")
  spec.contains(table.concat(found.warnings, "\n"),
    "the training records could not tell cubic_stiffness from odd_quadratic_stiffness: the former left much of the gap on the test record open")
  spec.equal(found.data.test_chose, true)
  spec.equal(found.effects[1].gap_test < 0.105, true)
  spec.equal(found.rivals[1].name, "cubic_stiffness")
  spec.equal(found.rivals[1].remark, "not confirmed by the test record")
end)

spec.clean()
spec.finish()

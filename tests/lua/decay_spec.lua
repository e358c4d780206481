-- What lunid.discover names in free decays, in records of a hand-written integrator: pulled, released, mass 1 and k 1.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local k, c = lunid.parameter { "k", min = 0 }, lunid.parameter { "c", min = 0 }

local function tanh(x)
  return 1 - 2/(math.exp(math.min(2*x, 700)) + 1)
end

--- The motion of x'' + rest(x, v, z) + dry(v, x)*sign(v) = 0, z' = rate(x, v, z), by steps of Euler and Cromer, in each of
--- which dry friction takes no more than the velocity that is there.
local function decay(of)
  local fine = math.ceil(of.dt / 2e-4)
  local h, x, w, z, ys = of.dt / fine, of.from[1], of.from[2], 0, {}
  for i = 1, of.rows do
    ys[i] = x + (of.zero or 0)
    for _ = 1, fine do
      local free, held = w - h * of.rest(x, w, z), h * (of.dry and of.dry(w, x) or 0)
      if of.rate then z = z + h * of.rate(x, w, z) end
      w = free > held and free - held or free < -held and free + held or 0
      x = x + h * w
    end
  end
  return ys
end

local function record_of(of, noise, seed)
  local nothing = {}
  local ys = decay(of)
  for i = 1, #ys do nothing[i] = 0 end
  return lunid.record({ channels = { { "F", nothing }, { "y", ys } }, dt = of.dt })
    :with_noise { y = lunid.noise.gaussian { relative = noise }, seed = seed }
end

--- The train record begins at `from`, the test record at `again`.
local function found_in(of, restoring, noise)
  local other = setmetatable({ from = of.again }, { __index = of })
  return lunid.discover { model = lunid.model { mass = 1, restoring = restoring },
    train = record_of(of, noise, of.draw or 1), test = record_of(other, noise, (of.draw or 1) + 1) }
end

spec.case("friction stops a decay", function()
  local found = found_in({ dt = 0.3355, rows = 308, from = { 2.5, 1.45 }, again = { -2.4, 1 },
    rest = function(x, w) return x + 0.063*w end, dry = function() return 0.179 end }, k*y + c*v, 0.013)
  spec.equal(spec.names_of(found), "coulomb_friction")
  spec.near(found.effects[1].parameters.Fc.value, 0.179, 0.004)
end)

spec.case("friction and drag leave the ridge where damping stands in for friction", function()
  for _, draw in ipairs { 1, 21 } do
    local found = found_in({ dt = 0.537, rows = 380, from = { -2.5, 1.9 }, again = { 2.1, 1.2 }, draw = draw,
      rest = function(x, w) return x + 0.063*w + 0.12*math.abs(w)*w end, dry = function() return 0.12 end }, k*y + c*v, 0.003)
    spec.equal(spec.names_of(found), "coulomb_friction quadratic_drag")
  end
end)

spec.case("hysteretic damping is friction of the displacement without a constant part", function()
  for _, draw in ipairs { 1, 11, 21 } do  -- by chance a constant part ends above zero, where it may stay
    local found = found_in({ dt = 0.2, rows = 900, from = { 1, 0 }, again = { 0.7, 0 }, draw = draw,
      rest = function(x, w) return x + 0.01*w end, dry = function(_, x) return 0.05*math.abs(x) end }, k*y + c*v, 0.0005)
    spec.equal(spec.names_of(found), "position_dependent_friction")
    spec.near(found.effects[1].parameters.alpha.value, 0.05, 0.002)
  end
end)

spec.case("a fit finds friction and drag from far on either side", function()
  local of = { dt = 0.537, rows = 70, from = { -2.5, 1.9 },
    rest = function(x, w) return x + 0.063*w + 0.12*math.abs(w)*w end, dry = function() return 0.12 end }
  local record = record_of(of, 0.003, 1)
  for _, start in ipairs { { 0.36, 0, 0 }, { 0.3, 0.1, 0 }, { 0, 0.2, 0.2 }, { 0, 0.05, 0.2 } } do
    local c = lunid.parameter { "c", min = 0, value = start[1] }
    local Fc = lunid.parameter { "Fc", min = 0, value = start[2] }
    local c2 = lunid.parameter { "c2", min = 0, value = start[3] }
    local fit = lunid.fit_trajectory { record = record, model = lunid.model { mass = 1,
      restoring = lunid.parameter { "k", value = 1 }*y + c*v + Fc*lunid.sign(v) + c2*lunid.abs(v)*v } }
    spec.near(fit.model.parameters.Fc.value, 0.12, 0.002)
    spec.near(fit.model.parameters.c2.value, 0.12, 0.004)
  end
end)

spec.case("slip is named by its simplest entry", function()
  local Fs, stiffness = 0.35, 0.6
  local found = found_in({ dt = 0.094, rows = 1200, from = { 2.5, -1 }, again = { -2.1, 0.5 },
    rest = function(x, w, z) return x + 0.05*w + stiffness*z end,
    rate = function(_, w, z) return (stiffness*z >= Fs and w > 0 or stiffness*z <= -Fs and w < 0) and 0 or w end },
    k*y + c*v, 0.07)
  spec.equal(spec.names_of(found), "elastic_slip")
end)

spec.case("an offset of the sensor beside a cubic spring is no weight and quadratic spring", function()
  local k3 = lunid.parameter { "k3" }
  local found = found_in({ dt = 0.52, rows = 300, from = { 2.5, 0.5 }, again = { -1.8, 1 }, zero = 0.4,
    rest = function(x, w) return x + 0.066*w + 0.25*x^3 end }, k*y + c*v + k3*y^3, 0.007)
  spec.equal(spec.names_of(found), "displacement_offset")
end)

spec.case("a lag of the sensor and relaxation do the same", function()
  local found = found_in({ dt = 0.19, rows = 640, from = { 2.5, 1 }, again = { -2, 0 },
    rest = function(x, w, z) return x + 0.05*w + z end,
    rate = function(_, w, z) return 0.5*w - z/1.2 end }, k*y + c*v, 0.006)
  spec.equal(found.verdict, "ambiguous")
  spec.contains(tostring(found), "maxwell_relaxation")
end)

spec.case("a force that no entry has is not two springs", function()
  local found = found_in({ dt = 0.28, rows = 510, from = { 2.5, -1 }, again = { -2.2, 1.5 },
    rest = function(x, w) return x + 0.087*w + 0.15*x*math.abs(w) end }, k*y + c*v, 0.003)
  spec.equal(found.verdict, "unknown-effect")
  assert(found.closure, "no model of what is missing")
  assert(found.data.closure.gap_test < 1.1*found.data.noise_floor.gap_test, found.sentence)
  spec.equal(#found.closure.parameters, 3)  -- k, c, and the force alone
  local rest = lunid.excitation.formula { force = 0, dt = 0.28, duration = 20 }
  local run = lunid.simulate { model = found.closure, excitation = rest, from = { 2.5, -1 } }
  assert(run:column("y"):max() > 0.1)
end)

spec.case("friction that creeps on where it should hold", function()
  local found = found_in({ dt = 0.14, rows = 1147, from = { 3, 0.4 }, again = { -2.4, 0.2 },
    rest = function(x, w) return x + 0.023*w + 0.26*tanh(w/1e-3) end }, k*y + c*v, 0.03)
  spec.equal(spec.names_of(found), "coulomb_friction")
  spec.near(found.effects[1].parameters.Fc.value, 0.26, 0.01)
end)

spec.case("a spring that is fast while the motion is large", function()
  local found = found_in({ dt = 0.2, rows = 783, from = { 3, 0.5 }, again = { -3.4, 0.2 },
    rest = function(x, w) return x + 0.062*w + 0.051*x^5 end }, k*y + c*v, 0.018)
  spec.equal(spec.names_of(found), "quintic_stiffness")
  spec.near(found.effects[1].parameters.k5.value, 0.051, 0.001)
end)

-- Two modes are four numbers: of k, c and the hidden mass, spring and damper one is free.
spec.case("a hidden mode in a decay has no intervals, and a note says why", function()
  local function hidden(from, seed, drive)  -- an oscillator of a tenth of the mass on the first, steps of Euler and Cromer
    local h, x, w, p, q, ys, forces = 5e-4, from, 0, 0, 0, {}, {}
    for i = 1, 900 do
      ys[i], forces[i] = x, drive and drive((i - 1) * 0.2) or 0
      for j = 0, 399 do
        local pull = 0.12*(x - p) + 0.01*(w - q)
        local force = drive and drive((i - 1) * 0.2 + j * h) or 0
        w, q = w + h * (force - x - 0.03*w - pull), q + h * pull / 0.1
        x, p = x + h * w, p + h * q
      end
    end
    return lunid.record({ channels = { { "F", forces }, { "y", ys } }, dt = 0.2 })
      :with_noise { y = lunid.noise.gaussian { relative = 0.01 }, seed = seed }
  end
  local function found_on(test)
    return lunid.discover { model = lunid.model { mass = 1, restoring = k*y + c*v }, train = hidden(1, 1), test = test,
      catalogue = { "hidden_mode", "maxwell_relaxation", "cubic_stiffness", "coulomb_friction" } }
  end
  local found = found_on(hidden(-0.8, 2))
  spec.equal(spec.names_of(found), "hidden_mode")
  spec.contains(table.concat(found.warnings, "\n"), "k, c, hidden_mode_mh, hidden_mode_kh, hidden_mode_ch are not identifiable")
  local own = found.data.final.parameters
  assert(not own.k.std and not own.k.interval, own.k.std)
  -- Under a force that number counts, and the test says it.
  local driven = found_on(hidden(0, 3, function(t)
    local force = 0
    for i = 1, 20 do force = force + 0.05*math.cos((0.5 + 0.06*i)*t + i*i) end
    return force
  end))
  spec.equal(driven.verdict, "explained")
  spec.equal(spec.names_of(driven), "hidden_mode")
  spec.contains(table.concat(driven.warnings, "\n"), "the training records leave k, c, hidden_mode_mh, hidden_mode_kh, "
    .. "hidden_mode_ch of hidden_mode open: the values are those of one fit to all records")
  local data = driven.data
  assert(data.test_chose)
  spec.contains(driven.sentence, "on data that the fit knows")
  assert(data.final.gap_test < 1.1*data.noise_floor.gap_test, data.final.gap_test)
  spec.near(data.final.parameters.hidden_mode_mh.value, 0.1, 0.005)
  spec.near(data.final.parameters.k.value, 1, 0.01)
end)

spec.finish()

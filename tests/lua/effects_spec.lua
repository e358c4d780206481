-- Entries of the catalogue in models: two solvers, the exact relations between entries, energy, fits and sweeps, help and
-- docs, discovery by name.
local lunid = require "lunid"
local samples = require "effect_samples"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local effects = lunid.effects

local names = {}
for name in pairs(effects) do names[#names + 1] = name end

local function refused(text, body) spec.equal(spec.message_of(body), text) end

-- ---- simulation ----

--- A free run of the oscillator with an element, or several.
local function run_of(force, options)
  options = options or {}
  local drive = { F = 9*lunid.cos(15*t) + 4*lunid.sin(31*t + 1), ab = options.ab }
  for channel, signal in pairs(options.shaft or {}) do drive[channel] = signal end
  local faulty = type(force) == "table" and (force.y or force.F or force.delay) and force or {}  -- a sensor: no force
  local model = lunid.model { mass = 1, restoring = 400*y + v + (faulty == force and 0 or force),
    measures = faulty.y and faulty, acts = faulty.F and faulty, delay = faulty.delay and faulty }
  return lunid.simulate { model = model, excitation = drive,
    from = options.from or { 0.005, 0 }, duration = options.duration or 1.5, dt = 0.005, solver = options.solver or "fixed",
    rtol = 1e-9 }
end

local function furthest(a, b)
  local most = 0
  for i = 1, #a do most = math.max(most, math.abs(a[i] - b[i])) end
  return most
end

spec.case("the fixed path and SUNDIALS give every entry the same motion", function()
  -- c |v|^p and J |v|^n with p, n < 1 have an infinite slope at v = 0, where both paths lose digits
  local tolerance = { power_law_damping = 2e-5, rate_power_law = 2e-5 }
  for _, name in ipairs(names) do
    local force, ab = effects[name](samples[name]), name == "base_motion" and lunid.sin(10*t) or nil
    local shaft = name == "rotating_unbalance" and { shaft_angle = 20*t + t^2, shaft_speed = 20 + 2*t, shaft_rate = 2 + 0*t }
    local fixed = run_of(force, { ab = ab, shaft = shaft })
    local other = run_of(force, { ab = ab, shaft = shaft, solver = "rk45" })
    assert(fixed.summary.completed and other.summary.completed, name)
    local error = furthest(fixed:column "y", other:column "y") / other:column("y"):std()
    assert(error < (tolerance[name] or 1e-6), ("%s: %.1e of the motion apart"):format(name, error))
  end
end)

-- ---- exact relations ----

local fine = 1e-6  -- of the motion: two integrations
local same = {
  { "dahl_friction", { s = 300, Fc = 2.5 }, "bouc_wen", { k = 300, zy = 2.5/300, rho = 1, n = 1 } },
  { "dahl_friction", { s = 300, Fc = 2.5 }, "lugre_friction", { s0 = 300, s1 = 0, Fc = 2.5, Fs = 2.5, vs = 0.1 } },
  { "masing_soil", { k = 300, yr = 0.015 }, "iwan", { k = 300, Fs = 4.5, n = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "iwan", { k = 300, Fs = 3, n = 50 }, 3e-3 },  -- n -> infinity
  { "elastic_slip", { k = 300, Fs = 3 }, "smith_shaft", { Ru = 3, q = 0.01, J = 0 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "rate_power_law", { Ru = 3, q = 0.01, J = 0, n = 0.2 } },
  { "smith_shaft", { Ru = 3, q = 0.01, J = 0.4 }, "rate_power_law", { Ru = 3, q = 0.01, J = 0.4, n = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "friction_lift_off", { k = 300, fN = 3, kf = 0 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "backlash_play", { k = 300, g = 0.01 } },
  { "backlash_play", { k = 300, g = 0.01 }, "elastic_slip", { k = 300, Fs = 3 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "depth_resistance", { k = 300, Ru0 = 3, b = 0, tau = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "degrading_resistance", { Ru = 3, q = 0.01, rinf = 1, Nc = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "setup_recovery", { k = 300, R0 = 3, Ri = 3, tau = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "shaft_softening", { Ru = 3, Rr = 3, q = 0.01, sr = 1 } },
  { "elastic_slip", { k = 300, Fs = 3 }, "vibro_liquefaction", { k = 300, Rs = 3, Rl = 3, tau = 1 } },
  { "coulomb_friction", { Fc = 1.5 }, "stribeck_friction", { Fc = 1.5, Fs = 1.5, vs = 0.1 } },
  { "coulomb_friction", { Fc = 1.5 }, "power_law_damping", { c = 1.5, p = 1e-4 }, 1e-3 },  -- p -> 0
  { "coulomb_friction", { Fc = 1.5 }, "position_dependent_friction", { Fc = 1.5, alpha = 0 } },
  { "coulomb_friction", { Fc = 1.5 }, "elastic_slip", { k = 1e8, Fs = 1.5 }, 1e-3 },  -- k -> infinity
  { "viscous_damping", { c = 2 }, "power_law_damping", { c = 2, p = 1 } },
  { "viscous_damping", { c = 2 }, "radiation_damping", { c = 2 } },
  { "quadratic_drag", { c2 = 3 }, "power_law_damping", { c = 3, p = 2 } },
  { "cubic_damping", { c3 = 4 }, "power_law_damping", { c = 4, p = 3 } },
  { "one_sided_stop", { k = 1500, g = 0.02 }, "bilinear_stiffness", { dk = 1500, y0 = 0.02 } },
  { "one_sided_stop", { k = 1500, g = 0.02 }, "impact_hunt_crossley", { k = 1500, c = 0, n = 1, g = 0.02 } },
  { "one_sided_stop", { k = 1500, g = 0.02 }, "crane_lowering", { kc = 1500, yc0 = 0.02, Vc = 0 } },
  { "linear_stiffness", { k = 800 }, "clearance", { k = 800, g = 0 } },
}

spec.case("special cases are the general entries at those values", function()
  local tested = {}
  for _, row in ipairs(same) do
    local one, p, other, q, tolerance = table.unpack(row)
    local rest = { from = { 0, 0 } }  -- where every element begins unstressed
    local a, b = run_of(effects[one](p), rest):column "y", run_of(effects[other](q), rest):column "y"
    local error = furthest(a, b) / a:std()
    assert(error < (tolerance or fine), ("%s and %s: %.1e of the motion apart"):format(one, other, error))
    tested[one .. " " .. other] = true
  end
  local offset, drift = effects.displacement_offset { b = 0.004 }, effects.sensor_drift { b = 0.004, d = 0, q = 0 }
  spec.equal(offset.y:at { y = 0.3 }, drift.y:at { y = 0.3, t = 7 })  -- what a sensor shows of any motion
  tested["displacement_offset sensor_drift"] = true
  for _, name in ipairs(names) do
    for _, other in ipairs(effects[name].special_case_of) do
      assert(tested[name .. " " .. other], ("%s in %s is not tested"):format(name, other))
    end
  end
end)

spec.case("parallel elastic_slip elements are masing_soil and iwan", function()
  local sum, share = 0, {}
  for i = 0, 20 do share[i] = i < 20 and math.cos(i * math.pi / 40) ^ 2 or 0 end
  for i = 1, 20 do
    local k = 300 * (share[i - 1] ^ 2 - share[i] ^ 2)
    sum = sum + effects.elastic_slip { k = k, Fs = k * 0.015 * (2 / (share[i - 1] + share[i]) - 1), prefix = "e" .. i }
  end
  local parallel = run_of(sum):column "y"
  assert(furthest(parallel, run_of(effects.masing_soil { k = 300, yr = 0.015 }):column "y") < fine * parallel:std())
end)

spec.case("inertia moves to the mass", function()
  local more = lunid.model { mass = 1.3, restoring = 400*y + v }
  local added = lunid.model { mass = 1, restoring = 400*y + v + effects.added_mass { 0.3 } }
  local function motion(model)
    return lunid.simulate { model = model, excitation = 9*lunid.cos(15*t), duration = 1, dt = 0.005 }:column "y"
  end
  assert(furthest(motion(more), motion(added)) < 1e-12)
  -- a body free of force keeps (m + m1 y^2) v^2/2 + k y^2/2, and m v^2/2 + m1 v^3/3 + k y^2/2
  for _, row in ipairs { { "displacement_dependent_mass", 80, function(y, v) return (1 + 80*y^2)*v^2/2 end },
    { "velocity_dependent_mass", 0.2, function(_, v) return v^2/2 + 0.2*v^3/3 end } } do
    local model = lunid.model { mass = 1, restoring = 400*y + effects[row[1]] { row[2] } }
    local run = lunid.simulate { model = model, excitation = 0, from = { 0.08, 0 }, duration = 3, dt = 0.005, rtol = 1e-10 }
    for i = 1, run.rows do
      local at, speed = run:column "y"[i], run:column "v"[i]
      spec.near(row[3](at, speed) + 200*at^2, 200*0.08^2, 1e-6)
    end
  end
end)

-- ---- energy ----

--- A motion from rest at y = 0 back to it, over one second, as a record.
local function closed_motion(seed)
  local motion, acceleration = 0, 0
  for i = 1, 4 do
    local w, A = 2 * math.pi * ((i * seed) % 5 + i), 0.03 * math.sin(7 * i + seed)
    motion = motion + A*(lunid.cos(w*t) - 1)
    acceleration = acceleration - A*w^2*lunid.cos(w*t)
  end
  return lunid.simulate { model = lunid.model { mass = 1, restoring = 0 }, excitation = acceleration, from = { 0, 0 },
    duration = 1, dt = 5e-4, solver = "fixed" }:record()
end
local motions = {}
for seed = 1, 4 do motions[seed] = closed_motion(seed) end

--- The work that the motion does on the element, and the sum of its parts without sign.
local function work(force, record)
  local along = lunid.model { mass = 0, restoring = force, motion = "imposed" }:force(record)
  local v, sum, size = record:column "v", 0, 0
  for i = 1, #v - 1 do
    local part = (along[i]*v[i] + along[i + 1]*v[i + 1])/2 * record.dt
    sum, size = sum + part, size + math.abs(part)
  end
  return sum, size
end

spec.case("passive entries take up energy over a closed motion", function()
  for _, name in ipairs(names) do
    local sensor = effects[name].maps[1].field
    if effects[name].passive == true and not sensor or name == "bouc_wen" or name == "pinching_degrading_hysteresis" then
      for _, record in ipairs(motions) do
        local done, size = work(effects[name](samples[name]), record)
        assert(done >= -1e-4 * size, ("%s gives %.2e of %.2e J"):format(name, -done, size))
      end
    end
  end
end)

spec.case("entries that are not passive can create energy where they say so", function()
  local active = { van_der_pol_damping = { mu = 2, beta = 1 }, asymmetric_damping = { dc = -2 },
    position_dependent_friction = { Fc = 0.1, alpha = -40 }, crane_lowering = { kc = 300, yc0 = -0.05, Vc = 0.1 },
    lugre_friction = { s0 = 1e4, s1 = 200, Fc = 0.5, Fs = 5, vs = 0.2 } }
  -- bristles bent by creeping motion, then torn along: creep at 0.1 m/s, a jump to 2 m/s within 20 microseconds
  local torn = lunid.simulate { model = lunid.model { mass = 1, restoring = 0 }, from = { 0, 0.1 }, duration = 0.0102,
    excitation = 1.9/2e-5 * (1 - lunid.tanh((t - 0.01)/1e-5)^2), dt = 2e-6, solver = "fixed" }:record()
  for _, name in ipairs(names) do
    local passive = effects[name].passive
    local given = active[name] or passive == false and #effects[name].channels == 0 and samples[name]
    if given then
      local least = math.huge
      for _, record in ipairs(name == "lugre_friction" and { torn } or motions) do
        least = math.min(least, (work(effects[name](given), record)))
      end
      assert(least < 0, ("%s: %g J"):format(name, least))
    end
  end
end)

-- ---- in models ----

spec.case("an element brings its parameters and states along", function()
  local model = lunid.model { mass = 49, restoring = 2e4*y
    + effects.bouc_wen { k = 1e4, zy = 1e-3, rho = 0.7, n = 1.5 } + effects.coulomb_friction { prefix = "guide" } }
  spec.equal(tostring(model):match "^[^\n]*", "49*a + 20000*y + bouc_wen_k*bouc_wen_z + guide_Fc*sign(v) = F")
  spec.equal(model.parameters.bouc_wen_zy.unit, "m")
  spec.equal(model.parameters.bouc_wen_n.max, 4.0)
  spec.equal(model.parameters.guide_Fc.value, nil)
  spec.equal(model.states[1].name, "bouc_wen_z")
  spec.equal(tostring(effects.bouc_wen), "bouc_wen  k*z, dz/dt = v - (abs(z)/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v); or "
    .. "k*z, dz/dt = v - (abs(z)/zy)^n*(rho*abs(v)*sign(z) - (1 + rho)*v)")
  spec.equal(effects.one_sided_stop.formula, "k*max(y - g, 0); or k*min(y + g, 0)")
  spec.equal(effects.one_sided_stop.formulas[2], "k*min(y + g, 0)")
  local path = model:with { guide_Fc = 3 }:save(spec.folder .. "/elements.lua")
  spec.equal(lunid.load(path):equation(), model:equation())
end)

spec.case("positions, expressions in place of numbers, two of a kind, variants", function()
  local k = lunid.parameter { "k", 2e4, unit = "N/m" }
  spec.equal(tostring(effects.clearance { 800, 0.02 }), "clearance_k*sign(y)*max(abs(y) - clearance_g, 0)")
  spec.equal(tostring(effects.linear_stiffness { k = k/2 }), "k/2*y")
  spec.equal(tostring(effects.one_sided_stop { k = 3, g = 1, variant = 2 }),
    "one_sided_stop_k*min(y + one_sided_stop_g, 0)")
  local two = lunid.model { mass = 1, restoring = effects.elastic_slip { 300, 3, prefix = "left" }
    + effects.elastic_slip { 100, 5, prefix = "right" } }
  spec.equal(#two.states, 2)
  spec.equal(two.parameters.right_Fs.value, 5.0)
end)

spec.case("an element between two masses", function()
  local y1, y2 = lunid.displacements(2)
  local v1, v2 = lunid.velocities(2)
  local d = y2 - y1
  local force = effects.bouc_wen { k = 100, zy = 0.01, rho = 1, n = 1, displacement = d }
  local model = lunid.model { mass = { 1, 2 }, restoring = { 300*y1 - force, force } }
  local z = lunid.state { "z", rate = function(z) return (v2 - v1) - lunid.abs(z/0.01)*lunid.abs(v2 - v1)*lunid.sign(z) end }
  local same_model = lunid.model { mass = { 1, 2 }, restoring = { 300*y1 - 100*z, 100*z } }
  local function motion(model)
    return lunid.simulate { model = model, excitation = { F1 = 3*lunid.cos(12*t), F2 = 0 }, from = { 0, 0, 0, 0 },
      duration = 1, dt = 0.005 }:column "y2"
  end
  assert(furthest(motion(model), motion(same_model)) < 1e-9)
  -- a hidden mode is that second mass, not measured
  local hidden = run_of(effects.hidden_mode { mh = 0.2, kh = 50, ch = 0.3 }):column "y"
  local pair = lunid.model { mass = { 1, 0.2 }, forces = { 1 },
    restoring = { 400*y1 + v1 - 50*d - 0.3*(v2 - v1), 50*d + 0.3*(v2 - v1) } }
  local seen = lunid.simulate { model = pair, excitation = { F1 = 9*lunid.cos(15*t) + 4*lunid.sin(31*t + 1) },
    from = { 0.005, 0, 0, 0 }, duration = 1.5, dt = 0.005 }:column "y1"
  assert(furthest(hidden, seen) < 1e-7)
end)

spec.case("elements are fitted: parameters come back from a run, through slips, gaps and yields", function()
  for name, start in pairs { elastic_slip = { k = 380, Fs = 2.4 }, smith_toe = { Ru = 3.3, q = 0.008, J = 0.3 },
    depth_resistance = { k = 250, Ru0 = 1.7, b = 70, tau = 0.6 }, maxwell_relaxation = { k = 150, tau = 0.08 },
    rate_power_law = { Ru = 2.7, q = 0.011, J = 0.3, n = 0.25 } } do  -- its slope at v = 0 is infinite
    local record = run_of(effects[name](samples[name]), { duration = 3 }):record()
    local fit = lunid.fit_trajectory { model = lunid.model { mass = 1, restoring = 400*y + v + effects[name](start) },
      record = record, interpolation = "cubic" }
    for key, value in pairs(samples[name]) do
      local row = fit.model.parameters[name .. "_" .. key]
      assert(math.abs(row.value / value - 1) < (name == "rate_power_law" and 0.02 or 2e-3), ("%s: %s = %g"):format(name, key, row.value))
    end
  end
end)

spec.case("elements are swept", function()
  local k = lunid.parameter { "k", 300, unit = "N/m" }
  local model = lunid.model { mass = 1, restoring = 400*y + v + effects.masing_soil { k = k, yr = 0.015 } }
  local sweep = lunid.ensemble { model = model, vary = { k = { 100, 300 } }, duration = 1, dt = 0.005, from = { 0.005, 0 },
    excitation = 9*lunid.cos(15*t) }
  spec.contains(tostring(sweep), "2 members")
end)

spec.case("a user's own effect is an element too", function()
  local magnet = lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(p*y)",
    parameters = { { "k", unit = "N" }, { "p", min = 0, unit = "1/m" } } }
  spec.equal(tostring(magnet { k = 3, p = 40 }), "magnet_k*sin(magnet_p*y)")
  refused("effect: magnet: unknown name 'q' in 'k*sin(q*y)'; declare it in parameters or states", function()
    lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(q*y)", parameters = { { "k" } } }
  end)
end)

spec.case("messages", function()
  refused("lunid.effects has no 'bouc_wenn', did you mean 'bouc_wen'?", function() return effects.bouc_wenn end)
  refused("effects.bouc_wen: unknown field 'zz', did you mean 'zy'?", function() effects.bouc_wen { zz = 1 } end)
  refused("effects.bouc_wen: n: expected 1 to 4, got 7", function() effects.bouc_wen { n = 7 } end)
  refused("effects.bouc_wen: k: expected a number >= 0 or an expression, got the string 'big'",
    function() effects.bouc_wen { k = "big" } end)
  refused("effects.stribeck_friction: expected Fs >= Fc", function() effects.stribeck_friction { Fc = 2, Fs = 1, vs = 1 } end)
  refused("effects.one_sided_stop: variant: expected 1 to 2, got 3", function() effects.one_sided_stop { variant = 3 } end)
  refused("effects.bouc_wen: name: expected letters, digits and _, got 'a b'", function() effects.bouc_wen { prefix = "a b" } end)
  refused("effects.bouc_wen: displacement: expected an expression in displacements, such as y2 - y1, got 't' in it",
    function() effects.bouc_wen { displacement = y + t } end)
  refused("lunid.effects.bouc_wen cannot be assigned", function() effects.bouc_wen = 1 end)
  refused("force: expected a record, got nothing", function() lunid.model({ mass = 1, restoring = y }):force() end)
end)

-- ---- help, lists, docs ----

spec.case("help explains an effect", function()
  local said, code = spec.lunid "help effect smith_toe"
  spec.equal(code, 0)
  spec.equal(spec.lunid "help smith_toe", said)
  for _, part in ipairs { "smith_toe (soil)\n  R + J*R*v", "lunid.effects.smith_toe { Ru, q, J, displacement =, prefix = }",
    "Ru             N, at least 0\n", "passive: yes", "easily taken for: one_sided_stop", "source: Smith 1960" } do
    spec.contains(said, part)
  end
  spec.contains(spec.lunid "help stribeck_friction", "  with: Fs >= Fc\n")
  spec.contains(spec.lunid "help hidden_mode", "may stand up to three times at one place")
  assert(not said:find("three times", 1, true))
  spec.equal(spec.lunid "help effect smith_to", "no help on 'smith_to', did you mean 'smith_toe'?\n")
end)

spec.case("help shows from where discovery starts: of one rig, with the scales that the guesses are read off", function()
  spec.contains(spec.lunid "help bouc_wen", [[
  first guesses, read off the records' y_max and y_min (here: 1 kg on 1 N/m swings by 1 m at 1 rad/s):
    zy 0.06, 0.2, 0.6 m; rho 0.5, 0.9; n 1, 2
    a record can show zy from 0.0002 to 2 m; rho from 0.1 to 100
    form 2: zy 0.6, 2 m; rho 1, 3; n 1
    form 2: a record can show zy from 0.2 to 20 m; rho from 0.1 to 100
    solved for: k
]])
  spec.contains(spec.lunid "help sinusoidal_stiffness", "\n    p 0.7, 1.5, 3 ... 96 1/m\n")  -- 65 of them
  spec.contains(spec.lunid "help one_sided_stop", "\n    g 0, 0.3, 0.6, 0.84 m\n")
  spec.contains(spec.lunid "help force_gain", "  g              no unit\n  first guesses, whatever the records:\n    g -1, 1\n\n")
  spec.contains(spec.lunid "help coulomb_friction", "    form 2: vr 0.01, 0.05, 0.2 m/s\n")
  spec.contains(spec.lunid "help linear_stiffness", "  first guesses: it needs none, its parameters are solved for\n")
  for _, name in ipairs(names) do
    local said, code = spec.lunid("help effect " .. name)
    assert(code == 0 and said:find "\n  first guesses", name .. ": no first guesses")
    spec.equal(said:match "[^\n]*first guesses.-\n\n":find(" \n", 1, true), nil)
  end
end)

--- The rows of the plot in `lunid help NAME`, without labels; none where there is no plot.
local function plot_of(name)
  local said, rows = spec.lunid("help effect " .. name), {}
  for line in (said:match "where y = sin.-\n(.-)\n +%-1 m +1 m\n" or ""):gmatch "[^\n]+" do
    if #rows > 0 or line:match "N  [ *o|-]*$" then rows[#rows + 1] = (line:sub(15) .. (" "):rep(41)):sub(1, 41) end
  end
  return rows, said
end

spec.case("help shows the loop of an effect: friction is a box, a spring a line, a faulty sensor has none", function()
  local box, said = plot_of "coulomb_friction"
  spec.contains(said, "force over displacement where y = sin(t), in steady state,\n  with Fc = 1 N\n")
  spec.equal(#box, 11)
  for i, row in ipairs(box) do
    local inside = row:sub(2, -2):gsub("[|-]", " ")
    spec.equal(row:sub(1, 1) .. row:sub(-1), "**")
    spec.equal(inside, ((i == 1 or i == 11) and "*" or " "):rep(39))
  end
  local before = 0
  for i, row in ipairs(plot_of "linear_stiffness") do  -- from the lower left to the upper right, a single stroke
    local first, last = row:reverse():gsub("[|-]", " "):match "^ *()%*+() *$"
    assert(first and first <= before + 1 and last > before, ("row %d: %s"):format(i, row))
    before = last - 1
  end
  spec.equal(before, 41)
  local stop = plot_of "one_sided_stop"
  assert(stop[11]:match "^%*+%-+$" and not table.concat(stop, "", 1, 10):sub(1, 410):find "^%*", table.concat(stop, "\n"))
  local drift = table.concat(plot_of "stiffness_drift")
  assert(drift:find "o" and drift:find "%*", "the first cycle and the last are two")
  for _, name in ipairs { "sensor_gain", "clipping", "missing_harmonic", "base_motion", "force_delay", "force_gain" } do
    spec.equal(#plot_of(name), 0)
  end
  for _, name in ipairs(names) do  -- every force of the motion has one
    local entry = effects[name]
    if entry.family ~= "input" and entry.family ~= "sensor" and name ~= "force_delay" then
      assert(#plot_of(name) == 11, name .. " has no plot")
    end
  end
end)

spec.case("the list has all, in order", function()
  local said = spec.lunid "list effects"
  local count, tried = 0, {}
  for mark, name in ("\n" .. said):gmatch "\n([* ]) ([%l_%d]+) +%l" do
    count = count + 1
    spec.equal(name, names[count])
    if mark == "*" then tried[name] = true end
  end
  spec.equal(count, 62)
  assert(tried.cubic_stiffness and tried.coulomb_friction and not tried.iwan, said)
  spec.equal(spec.lunid "help effects", said)
end)

spec.case("check knows elements", function()
  spec.write("bad.lua", "local lunid = require 'lunid'\nprint(lunid.effects.bouc_wen { kk = 1 })\nprint(lunid.effects.boucwen)\n")
  spec.equal(spec.lunid "check bad.lua", "bad.lua:2: effects.bouc_wen: unknown field 'kk', did you mean 'k'?\n"
    .. "bad.lua:3: lunid.effects has no 'boucwen', did you mean 'bouc_wen'?\n")
end)

spec.case("docs/effects.md has the table of the entries", function()
  local file = assert(io.open "docs/effects.md")
  local text = file:read "a"
  file:close()
  local table_text, code = spec.lunid "help effects_table"
  spec.equal(code, 0)
  assert(text:find(table_text, 1, true), "docs/effects.md is not what `lunid help effects_table` prints")
end)

spec.case("discovery takes any entry by name", function()
  -- k and Fs stand in the rate and in the bounds of its state: no parameter of it is linear
  local record = run_of(effects.elastic_slip { k = 300, Fs = 3 }, { duration = 5 }):record():with_noise { y = 1e-5, seed = 3 }
  local k, c = lunid.parameter { "k", 400, min = 0 }, lunid.parameter { "c", 1, min = 0 }
  local found = lunid.discover { model = lunid.model { mass = 1, restoring = k*y + c*v }, train = record,
    catalogue = { "elastic_slip", "coulomb_friction" }, out = "found" }
  spec.equal(found.effects[1].name, "elastic_slip")
  spec.near(found.effects[1].parameters.Fs.value, 3, 0.02)
  refused("discover: catalogue: unknown effect 'cubic_dampin', did you mean 'cubic_damping'?", function()
    lunid.discover { model = lunid.model { mass = 1, restoring = k*y }, train = record, catalogue = { "cubic_dampin" } }
  end)
end)

spec.case("an entry of the user's own is named before those of the catalogue, and stays out where it is not there", function()
  local brake = lunid.effect { name = "eddy_current_brake", family = "damping",  -- Wouterse 1991, IEE Proceedings B 138, 153
    contribution = "2*Fb*(v/vc)/(1 + (v/vc)^2)", parameters = { { "Fb", min = 0, unit = "N" }, { "vc", min = 0, unit = "m/s" } },
    guess = function(scale) return { { vc = 0.2*scale.v_max }, { vc = 0.6*scale.v_max } } end,
    range = function(scale) return { vc = { 0.01*scale.v_max, 2*scale.v_max } } end }
  local k, c = lunid.parameter { "k", 400, min = 0 }, lunid.parameter { "c", 1, min = 0 }
  local rivals = { "coulomb_friction", "quadratic_drag", "cubic_damping", "power_law_damping" }
  local function found_in(force)
    local record = run_of(force, { duration = 5 }):record():with_noise { y = 2e-5, seed = 4 }
    return lunid.discover { model = lunid.model { mass = 1, restoring = k*y + c*v }, train = record, catalogue = rivals,
      effects = { brake }, out = "own" }
  end
  local found = found_in(brake { Fb = 1.5, vc = 0.1 })
  spec.equal(spec.names_of(found), "eddy_current_brake")
  spec.near(found.effects[1].parameters.Fb.value, 1.5, 0.03)
  spec.near(found.effects[1].parameters.vc.value, 0.1, 0.005)
  spec.equal(spec.names_of(found_in(effects.quadratic_drag { c2 = 3 })), "quadratic_drag")
end)

spec.clean()
spec.finish()

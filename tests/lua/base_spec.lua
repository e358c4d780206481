-- Rigs on a base that moves: a shaker's table, the ground. The fourth-order Runge-Kutta method at 12 steps a sample.
local lunid = require "lunid"
local spec = require "spec"

local y, v, yb, vb = lunid.displacement, lunid.velocity, lunid.base_displacement, lunid.base_velocity
local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local mass, frequency, size = 20, 6, 2e-3  -- kg, Hz, m
local omega = 2 * math.pi * frequency
local stiffness, damping = mass * omega^2, 0.06 * mass * omega
local rows, dt, finer = 1500, 1 / (40 * frequency), 12
local hidden = { mass = 3, stiffness = 3 * (1.15*omega)^2, damping = 0.1 * 3 * omega }

--- What the base does: displacement, velocity, acceleration at a time. Sixteen tones.
local function base(t, seed)
  local at, speed, acceleration = 0, 0, 0
  for i = 1, 16 do
    local w, phase = (0.5 + 0.08*i) * omega, (seed * i * i) % 6.28
    at = at - math.cos(w*t + phase) / w^2
    speed = speed + math.sin(w*t + phase) / w
    acceleration = acceleration + math.cos(w*t + phase)
  end
  local rms = 0.09 * omega^2 * size
  return rms * at, rms * speed, rms * acceleration
end

--- The table of what was measured of a rig with `law`, a force beside k and c over relative motions in sizes (in units
--- of k times the size), or with the hidden mass on top.
local function measure(law, seed, on_top)
  local function slopes(t, state)
    local x, w, xh, wh = table.unpack(state)
    local _, _, ab = base(t, seed)
    local between = on_top and hidden.stiffness*(x - xh) + hidden.damping*(w - wh) or 0
    local force = stiffness * (x + size * law(x/size, w/(omega*size))) + damping * w + between
    return { w, -force/mass - ab, wh, between/hidden.mass - ab }
  end
  local state, h, out = { 0, 0, 0, 0 }, dt / finer, { y = {}, a = {}, yb = {}, vb = {}, ab = {}, relative = {} }
  for row = 1, rows do
    local t = (row - 1)*dt
    local at, speed, acceleration = base(t, seed)
    out.relative[row], out.y[row], out.a[row] = state[1], state[1] + at, slopes(t, state)[2] + acceleration
    out.yb[row], out.vb[row], out.ab[row] = at, speed, acceleration
    for step = 0, finer - 1 do state = spec.runge_kutta(slopes, t + step*h, state, h) end
  end
  return out
end

--- A record of these channels, "relative" as y, each with 1 % of noise, or as much as said.
local function record(table_of, channels, seed, level)
  local list = {}
  for i, name in ipairs(channels) do
    local clean = table_of[name]
    local sum = 0
    for _, x in ipairs(clean) do sum = sum + x*x end
    local noise = lunid.excitation.white_noise { rms = (level or 0.01)*math.sqrt(sum/rows), dt = dt, duration = rows*dt, seed = 10*seed + i }
    local values, drawn = {}, noise:column "F"
    for row = 1, rows do values[row] = clean[row] + drawn[row] end
    local shown = name == "relative" and "y" or name
    list[i] = { shown, values, unit = shown:match "^y" and "m" or shown:match "^v" and "m/s" or "m/s^2" }
  end
  return lunid.record { channels = list, dt = dt }
end

local function none() return 0 end
local function cubic(x) return 0.05*x^3 end

local absolute = lunid.model { mass = mass, restoring = k*(y - yb) + c*(v - vb) }
local relative = lunid.model { mass = mass, restoring = k*y + c*v + mass*lunid.base_acceleration }
local few = { "cubic_stiffness", "coulomb_friction", "hidden_mode", "added_mass", "maxwell_relaxation", "base_motion",
  "force_gain" }

local function discover(model, law, channels, on_top)
  return lunid.discover { model = model, catalogue = few, train = record(measure(law, 1, on_top), channels, 1),
    test = record(measure(law, 2, on_top), channels, 2) }
end

spec.case("a spring between a mass and its base is named from displacements of both", function()
  local found = discover(absolute, cubic, { "y", "yb" })
  spec.equal(found.verdict, "explained")
  spec.equal(found.effects[1].name, "cubic_stiffness")
  spec.near(found.effects[1].parameters.k3.value, 0.05*stiffness/size^2, 0.03 * 0.05*stiffness/size^2)
  spec.contains(tostring(found), "the base moves: y, v and a are those relative to it (y - yb), and F is what its acceleration "
    .. "does to the mass, -m*ab, everywhere but in the equation; base_motion")
  spec.contains(found.model:equation(), "k*(y - yb) + c*(v - vb) + cubic_stiffness_k3*(y - yb)^3")
  -- as the baseline was given: it runs on the motion of the base
  local clean = measure(cubic, 2)
  local run = lunid.simulate { model = found.model, excitation = record(clean, { "yb", "vb" }, 2, 1e-9),
    from = { clean.y[1], clean.vb[1] }, interpolation = "cubic" }
  local worst = 0
  for row = 1, rows do worst = math.max(worst, math.abs(run:column "y"[row] - clean.y[row])) end
  if not (worst < 0.1*size) then error(("off by %g of %g"):format(worst, size)) end
end)

spec.case("the same from accelerations of both, and from what moves against the base", function()
  for _, way in ipairs { { absolute, { "a", "ab" } }, { relative, { "relative", "ab" } } } do
    local found = discover(way[1], cubic, way[2])
    spec.equal(found.verdict, "explained")
    spec.equal(found.effects[1].name, "cubic_stiffness")
    spec.near(found.effects[1].parameters.k3.value, 0.05*stiffness/size^2, 0.03 * 0.05*stiffness/size^2)
  end
  spec.contains(discover(relative, cubic, { "relative", "ab" }).model:equation(), "20*ab = F")
end)

spec.case("nothing missing is nothing missing", function()
  for _, channels in ipairs { { "y", "yb" }, { "a", "ab" } } do
    spec.equal(discover(absolute, none, channels).verdict, "nothing-missing")
  end
end)

spec.case("the base acts on a mass that was not measured as well", function()
  local found = discover(absolute, none, { "y", "yb" }, true)
  spec.equal(found.verdict, "explained")
  spec.equal(found.effects[1].name, "hidden_mode")
  local own = found.effects[1].parameters
  spec.near(own.mh.value, hidden.mass, 0.03 * hidden.mass)
  spec.near(own.kh.value, hidden.stiffness, 0.03 * hidden.stiffness)
  spec.contains(found.model:equation(), "- ab")
end)

spec.case("the stages look from the base too", function()
  local seen = record(measure(cubic, 1), { "y", "yb" }, 1)
  local where = lunid.locate { model = absolute, record = seen }
  spec.contains(tostring(where), "the base moves")
  spec.contains(where.sentence, "odd")
  local ranked = lunid.rank { model = absolute, record = seen, sets = { { "cubic_stiffness" }, { "coulomb_friction" } } }
  spec.equal(ranked[1].name, "cubic_stiffness")
  spec.contains(ranked[1].model:equation(), "(y - yb)^3")
end)

spec.case("what cannot be looked at says why, and what to do", function()
  local seen, against = record(measure(none, 1), { "y", "yb" }, 1), record(measure(none, 1), { "relative", "ab" }, 1)
  local function fails(restoring, rec, text, heavy)
    spec.contains(spec.message_of(function()
      lunid.discover { model = lunid.model { mass = heavy or mass, restoring = restoring }, train = rec, catalogue = few }
    end), text)
  end
  fails(k*(y - yb) + c*v*yb, seen, "expected it in differences y - yb, v - vb alone, got ")
  fails(k*(y - yb), seen, "expected a mass that is a number, got m: no force shows it", lunid.parameter { "m", 20, min = 1 })
  fails(k*y + lunid.parameter { "g" }*lunid.base_acceleration, against, "expected ab with a number, as m*ab, got g*ab")
  fails(k*(y - yb), against, "expected one quantity of the rig and of its base (y and yb, v and vb, or a and ab), got y, ab")
  fails(k*y, seen, "where the base drives, the baseline holds differences to it, as k*(y - yb) + c*(v - vb), or m*ab")
  fails(k*(y - yb), record(measure(none, 1), { "y" }, 1), "the record holds no motion of it; name its column")
end)

--- Writes a shaken rig: its motion, and that of its base under the name `base`; what --check says of it.
local function checked(base, options)
  local lines = { "t [s],y [m]," .. base }
  for i = 0, 399 do
    local t = i/100
    lines[#lines + 1] = ("%g,%.8g,%.8g"):format(t, 0.02*math.sin(7*t) + 0.01*math.sin(23*t), 0.5*math.sin(7*t))
  end
  spec.write("shaken.csv", table.concat(lines, "\n") .. "\n")
  spec.shell "sed 's/,base .*/,nothing [V]/; 1!s/,[^,]*$/,0/' shaken.csv > bare.csv"
  return spec.lunid("discover shaken.csv --mass 3 --check " .. options)
end

spec.case("--check says = 0 where the base alone drives, and what F is from there on", function()
  local said = checked("base [m/s^2]", '--restoring "k*y + c*v + 3*ab" --columns "ab=base"')
  spec.contains(said, "3*a + k*y + c*v + 3*ab = 0\n")
  spec.contains(said, "the base moves: F is what its acceleration does to the mass, -m*ab, everywhere but in the equation, "
    .. "where it stands on the left")
  spec.contains(checked("base [m/s^2]", '--restoring "k*y + c*v + 3*ab" --columns "ab=base,F=0"'), "3*a + k*y + c*v + 3*ab = F\n")
  spec.write("storeys.lua", 'local lunid = require "lunid"\nlocal k = lunid.parameter "k"\n'
    .. 'return lunid.chain { masses = { 2, 1 }, ends = "base", element = function(d) return k*d end }')
  spec.write("storeys.csv", spec.shell "awk -F, 'NR==1{print \"t,y1,y2,yb\"} NR>1{print $1\",\"$2\",\"2*$2\",\"0.1*$2}' shaken.csv")
  local chain = spec.lunid "discover storeys.csv --baseline storeys.lua --check"
  spec.contains(chain, "2*a1 + k*(y1 - yb) - k*(y2 - y1) = 0\na2 + k*(y2 - y1) = 0\n")
  spec.contains(chain, "-m*ab (so of y1, v1, a1 and F1, and of the others), everywhere")
end)

spec.case("--check says that a base was measured and nothing drives", function()
  local unused = "nothing drives the baseline: F is 0 in shaken.csv, and ab stands nowhere in it"
  local usual = '--restoring "k*y + c*v" --columns '
  spec.contains(checked("base [m/s^2]", usual .. '"ab=base,F=0"'), unused)
  local function silent(options)
    local said = checked("base [m/s^2]", options)
    spec.contains(said, "to fit")
    spec.equal(said:find("nothing drives", 1, true), nil)
  end
  silent(usual .. '"F=base [N]"')  -- a force, no base
  silent(usual .. '"ab=base,F=1 [N]"')  -- both: base_motion is tried
  silent(usual .. '"ab=base [um/s^2],F=0"')  -- a base at rest
  silent '--restoring "k*y + c*v + 3*ab" --columns "ab=base,F=0"'
  local turns = checked("phase [rad]", usual .. '"shaft_angle=phase,F=0"')
  spec.contains(turns, "nothing drives the baseline: F is 0 in shaken.csv, and the shaft stands nowhere in it; rotating_unbalance is among")
  local driven = checked("phase [rad]", usual .. '"shaft_angle=phase,F=1 [N]"')
  spec.equal(driven:find("nothing drives", 1, true), nil)
end)

spec.case("a base that no record holds is missed in the training record first", function()
  checked("base [m/s^2]", "--restoring 0")
  spec.contains(spec.lunid 'discover shaken.csv --test bare.csv --mass 3 --restoring "k*(y - yb)" --check',
    "shaken.csv: discover: a base that moves: the record holds no motion of it")
end)

spec.case("a chain stands on a base", function()
  local y1, y2 = lunid.displacements(2)
  local chain = lunid.chain { masses = { 2, 1 }, ends = "base", element = function(d) return k*d end }
  spec.equal(chain:equation(), lunid.model { mass = { 2, 1 }, restoring = { k*(y1 - yb) - k*(y2 - y1), k*(y2 - y1) } }:equation())
end)

spec.finish()

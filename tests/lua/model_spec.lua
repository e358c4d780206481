-- model:save writes Lua that loads again to the same model.
local lunid = require "lunid"
local spec = require "spec"

local y, v, a, t = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time

--- Everything that can be seen of a model, as text.
local function seen(model)
  local lines = { tostring(model), tostring(model.imposed_motion), tostring(model.interpolation), table.concat(model.forces, " ") }
  for _, part in ipairs { model.mass, model.restoring } do
    for _, row in ipairs(model.degrees > 1 and part or { part }) do lines[#lines + 1] = tostring(row) end
  end
  for _, row in ipairs(model.parameters) do
    lines[#lines + 1] = ("%s %a %a %a %a %s %s"):format(row.name, row.value or 0, row.min or -1, row.max or -1,
      row.std or -1, row.unit, row.fixed)
  end
  for _, state in ipairs(model.states) do
    lines[#lines + 1] = ("%s %a %s %s %s"):format(state.name, state.initial, state.rate, state.min, state.max)
  end
  return table.concat(lines, "\n")
end

local function round_trip(model, name)
  local path = spec.folder .. "/" .. name .. ".lua"
  spec.equal(model:save(path), path)
  spec.equal(seen(lunid.load(path)), seen(model))
end

spec.case("a linear model", function()
  local k = lunid.parameter { "k", 20931.123456789, min = 0, max = 1e9, unit = "N/m", std = 0.1 }
  local m = lunid.parameter { "m", 49, min = 1, fixed = true, unit = "kg" }
  round_trip(lunid.model { mass = m, restoring = k*y + 10*v }, "linear")
end)

-- At seven rows a period of the force straight lines are far off; the formula of an excitation knows better than all.
spec.case("a model says how recorded forces go on between their rows", function()
  local curved = lunid.model { mass = 1, restoring = 400*y + 2*v, interpolation = "cubic" }
  round_trip(curved, "curved")
  spec.equal(curved:with({}).interpolation, "cubic")
  local plain = lunid.model { mass = 1, restoring = 400*y + 2*v }
  spec.equal(plain.interpolation, nil)
  local made = lunid.excitation.harmonic { amplitude = 1, frequency = 20/6.283185307, dt = 0.045, duration = 4 }
  local shown = lunid.record { channels = { { "F", made:column "F" } }, dt = made.dt }
  local function last(model, force, how)
    local column = lunid.simulate { model = model, excitation = force, interpolation = how }:column "y"
    return column[#column]
  end
  local cubic, linear = last(plain, shown, "cubic"), last(plain, shown)
  assert(math.abs(cubic - linear) > 0.01*math.abs(cubic))
  spec.equal(last(curved, shown), cubic)
  spec.equal(last(curved, shown, "linear"), linear)
  spec.equal(last(curved, made), last(plain, made))
  local sweep = lunid.ensemble { model = curved, excitation = shown, outputs = { "last_y" } }
  spec.near(sweep:column("last_y")[1], cubic, 1e-6*math.abs(cubic))
end)

spec.case("every function of the language", function()
  local p = lunid.parameter { "p", 0.1 + 0.2 }
  local sum = lunid.where(lunid.greater(y, v), y, -v) + lunid.where(lunid.less_equal(y, 0.5), t, 1)
  for _, name in ipairs { "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    "abs", "sign" } do
    sum = sum + lunid[name](p*y)
  end
  round_trip(lunid.model { mass = 2, restoring = sum + lunid.min(y, v) - lunid.max(y, 1e-300)/3 + 2^-y }, "functions")
end)

spec.case("internal states with bounds that follow the motion", function()
  local k = lunid.parameter { "k", 3 }
  local z = lunid.state { "z", rate = function(z) return v - k*lunid.abs(v)*z end, initial = 0.25,
    min = -1 - lunid.abs(y), max = 2 }
  round_trip(lunid.model { mass = 1, restoring = k*z }, "states")
end)

spec.case("imposed motion, no first guess", function()
  local c = lunid.parameter { "c" }
  round_trip(lunid.model { mass = 0, restoring = c*v, motion = "imposed" }, "imposed")
end)

spec.case("terms in a", function() round_trip(lunid.model { mass = 3, restoring = 2*a + 5*y }, "inertia") end)

spec.case("several coordinates, a full mass matrix, a moving base", function()
  local y1, y2 = lunid.displacements(2)
  local k = lunid.parameter { "k", 3 }
  round_trip(lunid.model { mass = { { 2, 0.5 }, { 0.5, 1 } }, forces = { 2 },
    restoring = { k*(y1 - lunid.base_displacement), k*(y2 - y1)^3 } }, "coordinates")
  round_trip(lunid.model { mass = 1, restoring = k*(y - lunid.base_displacement) + 2*(v - lunid.base_velocity) }, "base")
end)

spec.case("a delayed force", function()
  local k, tau = lunid.parameter { "k", 3 }, lunid.parameter { "tau", 0.01, min = 0, unit = "s" }
  local model = lunid.model { mass = 1, restoring = k*y, delay = tau }
  spec.equal(model:equation(), "a + k*y = F(t - tau)")
  round_trip(model, "delay")
  -- the same as a force that is written later, before the start as well
  local late = lunid.simulate { model = model, excitation = lunid.sin(5*t)^2, duration = 3, dt = 0.01 }
  local same = lunid.simulate { model = lunid.model { mass = 1, restoring = k*y },
    excitation = lunid.sin(5*(t - 0.01))^2, duration = 3, dt = 0.01 }
  for i = 1, 301, 50 do spec.near(late:column "y"[i], same:column "y"[i], 1e-7) end
end)

spec.case("a chain and what it stands for", function()
  local k, c = lunid.parameter { "k", 3 }, lunid.parameter { "c", 1 }
  local function element(d, w, index) return index*k*d + c*w end
  local chain = lunid.chain { masses = { 1, 2 }, element = element, ends = "left" }
  local y1, y2 = lunid.displacements(2)
  local v1, v2 = lunid.velocities(2)
  local same = lunid.model { mass = { 1, 2 },
    restoring = { k*y1 + c*v1 - (2*k*(y2 - y1) + c*(v2 - v1)), 2*k*(y2 - y1) + c*(v2 - v1) } }
  spec.equal(chain:equation(), same:equation())
  round_trip(lunid.chain { masses = { 1, 2, 1 }, element = element, forces = { 1 } }, "chain")
  spec.equal(lunid.chain { masses = { 4 }, element = function(d) return k*d end, ends = "right" }:equation(),
    "4*a + k*y = F")
end)

spec.case("a run has a column for each coordinate", function()
  local k = lunid.parameter { "k", 100 }
  local model = lunid.chain { masses = { 1, 1 }, element = function(d) return k*d end }
  -- symmetric start: both masses swing as one on k, w^2 = 100
  local run = lunid.simulate { model = model, excitation = { F1 = 0 }, from = { 0.1, 0, 0.1, 0 }, duration = 1, dt = 0.01 }
  for _, name in ipairs { "y1", "y2" } do
    assert(math.abs(run:column(name)[101] - 0.1*math.cos(10)) < 1e-6, run:column(name)[101])
  end
  assert(math.abs(run:column "a2"[1] + 10) < 1e-9)
  local names = {}
  for i, channel in ipairs(run:record().channels) do names[i] = channel.name end
  spec.equal(table.concat(names, " "), "F1 F2 y1 v1 y2 v2 a1 a2")
end)

spec.case("a base that moves slowly carries the mass along", function()
  local yb, t = lunid.base_displacement, lunid.time
  local model = lunid.model { mass = 1, restoring = 1e4*(y - yb) + 200*(v - lunid.base_velocity) }
  spec.equal(table.concat(model.inputs, " "), "F yb vb")
  local run = lunid.simulate { model = model, excitation = { yb = 0.01*lunid.sin(2*t) }, duration = 3, dt = 0.01 }
  assert(math.abs(run:column "y"[301] - 0.01*math.sin(6)) < 1e-5)
end)

spec.case("stop_when ends a run where its condition is met", function()
  -- y = 0.1 cos(10 t) falls below -0.05 at t = 2 pi/30
  local model = lunid.model { mass = 2, restoring = 200*y }
  for _, solver in ipairs { "auto", "fixed", "bdf", "rk78" } do
    local run = lunid.simulate { model = model, excitation = 0, from = { 0.1, 0 }, duration = 1, dt = 0.01,
      stop_when = -y - 0.05, solver = solver, rtol = 1e-10 }
    spec.near(run.summary.ended_at, 2*math.pi/30, 1e-7)
    spec.near(run.summary.ended_in[2], -math.sin(2*math.pi/3), 1e-5)
    spec.equal(run:record().rows, 21)
    spec.contains(tostring(run), "ended by stop_when at t = 0.20943")
  end
  local whole = lunid.simulate { model = model, excitation = 0, from = { 0.1, 0 }, duration = 1, dt = 0.01, stop_when = y - 1 }
  assert(whole.summary.completed and not whole.summary.ended_at)
end)

spec.case("a run tells what is between its rows, and may have more rows than its record", function()
  local model = lunid.model { mass = 1, restoring = 400*y }
  local push = lunid.excitation.harmonic { amplitude = 3, frequency = 2, phase = -math.pi/2, dt = 0.05, duration = 1 }
  local run = lunid.simulate { model = model, excitation = push, from = { 0, 0 } }
  local w = 4*math.pi
  local function exact(t) return 3/(400 - w^2)*(math.sin(w*t) - w/20*math.sin(20*t)) end
  for _, t in ipairs { 0.05, 0.2345, 0.999 } do
    local there = run:at(t)
    spec.equal(there.t, t)
    spec.near(there.y, exact(t), 1e-6)
    spec.near(there.a, 3*math.sin(w*t) - 400*there.y, 1e-9)
  end
  local fine = lunid.simulate { model = model, excitation = push, from = { 0, 0 }, dt = 0.01 }
  spec.equal(fine.rows, 101)
  for i = 1, 101, 7 do spec.near(fine:column "y"[i], exact((i - 1)*0.01), 1e-6) end
  local coarse = lunid.simulate { model = model, excitation = push, from = { 0, 0 }, solver = "bdf", rtol = 1e-3, atol = 1e-3 }
  local close = lunid.simulate { model = model, excitation = push, from = { 0, 0 }, solver = "bdf", rtol = 1e-9, atol = 1e-12 }
  assert(coarse.summary.steps < close.summary.steps/3)
end)

spec.case("a model as C computes the same rates", function()
  local k, c = lunid.parameter { "k", 20000.25, unit = "N/m" }, lunid.parameter { "c", 3 }
  local y1, y2 = lunid.displacements(2)
  local v1, v2 = lunid.velocities(2)
  local z = lunid.state { "z", rate = v1 - 2*lunid.abs(v2) }
  local model = lunid.model { mass = { { 2, 0.5 }, { 0.5, 1 } },
    restoring = { k*y1^3 + c*lunid.sign(v1) + z, k*(y2 - y1) + c*lunid.max(v2, 0) } }
  spec.equal(model:export(spec.folder .. "/model.c"), spec.folder .. "/model.c")
  spec.write("main.c", [=[
#include <stdio.h>
#include "model.c"
int main(void) {
  const double u[] = {7, -3}, x[] = {0.1, -2, 0.3, 4, 5};
  double dx[states];
  rate(0, u, x, parameter_values, dx);
  for (int i = 0; i < states; ++i) printf("%.17g\n", dx[i]);
  return 0;
}
]=])
  local said = spec.shell("cc -std=c99 -Wall -Werror main.c -lm -o rates && ./rates")
  local got = {}
  for number in said:gmatch "%S+" do got[#got + 1] = tonumber(number) end
  -- 2 a1 + a2/2 = 7 - f1, a1/2 + a2 = -3 - f2
  local r1 = 7 - (20000.25*0.1^3 - 3 + 5)
  local r2 = -3 - (20000.25*(0.3 - 0.1) + 3*4)
  local expected = { -2, (r1 - r2/2)/1.75, 4, (2*r2 - r1/2)/1.75, -2 - 8 }
  spec.equal(#got, 5)
  for i, value in ipairs(expected) do spec.near(got[i], value, 1e-9*math.abs(value)) end
end)

spec.case("a model as LaTeX, and what cannot be exported", function()
  local k = lunid.parameter { "k", 3, unit = "N/m" }
  local model = lunid.model { mass = 1, restoring = k*y }
  local path = spec.folder .. "/model.tex"
  spec.equal(model:export(path), path)
  local file = assert(io.open(path))
  local text = file:read "a"
  file:close()
  spec.contains(text, "\\begin{gather*}\na + k \\, y = F\n\\end{gather*}")
  spec.contains(text, "$k = 3$\\,N/m")
  local good, said = pcall(model.export, model, "model.f90")
  spec.contains(tostring(said), "export: expected a path that ends in .c or .tex, got 'model.f90'")
  local r = lunid.state { "r", rate = 9*v, min = -1, max = 1 }
  good, said = pcall(model.export, lunid.model { mass = 1, restoring = r }, "model.c")
  spec.contains(tostring(said), "export: the state 'r' has a bound, which a right-hand side in C cannot hold")
end)

spec.clean()
spec.case("branches are smoothed where asked for, and the run says so", function()
  local friction = lunid.model { mass = 1, restoring = 400*y + 2*lunid.sign(v) }
  local given = { model = friction, excitation = 0, from = { 0.05, 0 }, duration = 0.5, dt = 1e-3 }
  local sharp = lunid.simulate(given)
  spec.equal(#sharp.summary.notes, 0)
  given.regularise = 1e-3
  local smooth = lunid.simulate(given)
  spec.equal(smooth.summary.notes[1], "regularised over 0.001, as asked: sign(v)")
  spec.contains(tostring(smooth), "\n  note: regularised over 0.001, as asked: sign(v)")
  spec.equal(smooth.summary.events, 0)
  spec.near(smooth:column("y")[300], sharp:column("y")[300], 2e-4)
  given.model = lunid.model { mass = 1, restoring = 400*y }
  spec.equal(lunid.simulate(given).summary.notes[1], "regularised over 0.001, as asked: there was no branch")
  given.regularise = 0
  spec.equal(spec.message_of(function() lunid.simulate(given) end), "simulate: regularise: expected > 0, got 0")
end)

spec.finish()

-- lunid.ensemble: members are single runs, tables read back, bad input, several ranks, interruption and restart.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local k, c = lunid.parameter { "k", 2e4 }, lunid.parameter { "c", 10 }
local model = lunid.model { mass = 1, restoring = k*y + c*v + 1e6*y^3 }
local f, A = lunid.parameter { "f", 20 }, lunid.parameter { "A", 10 }

spec.case("every member is the single run with its values", function()
  local sweep = lunid.ensemble { model = model, vary = { c = { 5, 20 }, k = { 1e4, 3e4, 2e4 } },
    excitation = 10*lunid.sin(80*t), duration = 0.5, dt = 1e-3, outputs = { "max_y", "last_v" }, substeps = 2 }
  spec.equal(sweep.members, 6)
  spec.equal(sweep.rows, 501)
  spec.equal(table.concat(sweep.names, " "), "k c max_y last_v stopped_at")
  spec.equal(table.concat(sweep:column("k"):list(), " "), "10000.0 10000.0 30000.0 30000.0 20000.0 20000.0")
  for m = 1, 6 do
    local run = lunid.simulate { model = model:with { k = sweep:column("k")[m], c = sweep:column("c")[m] },
      excitation = 10*lunid.sin(80*t), duration = 0.5, dt = 1e-3, solver = "fixed", substeps = 2 }
    spec.equal(sweep:column("max_y")[m], run:column("y"):max())
    spec.equal(sweep:column("last_v")[m], run:column("v")[501])
  end
end)

spec.case("first states, gains and records of each member", function()
  local record = lunid.excitation.harmonic { amplitude = 3, frequency = 12, dt = 1e-3, duration = 0.3 }
  local held = lunid.ensemble { model = model, vary = { y = { 0.001, 0.002 } }, excitation = record, from = { 0, 0.1 },
    substeps = 1, keep = "trajectories", outputs = { "rms_y" } }
  local run = lunid.simulate { model = model, excitation = record, from = { 0.002, 0.1 }, solver = "fixed", substeps = 1 }
  for i = 1, 301 do spec.equal(held:trajectory(2, "y")[i], run:column("y")[i]) end
  local gained = lunid.ensemble { model = model, vary = { gain = { 1, 2 } }, excitation = record, interpolation = "linear",
    substeps = 1, outputs = { "max_y" } }
  assert(gained:column("max_y")[2] > 1.9*gained:column("max_y")[1])
  -- the formula of a record is scaled with it: coarse samples run as the formula does, not as straight lines
  local coarse = { amplitude = 3, frequency = 12, dt = 0.01, duration = 0.5 }
  local scaled = lunid.ensemble { model = model, vary = { gain = { 1, 2 } }, excitation = lunid.excitation.harmonic(coarse),
    substeps = 16, outputs = { "last_y" } }
  coarse.amplitude = 6
  local twice = lunid.simulate { model = model, excitation = lunid.excitation.harmonic(coarse), solver = "fixed", substeps = 16 }
  spec.near(scaled:column("last_y")[2], twice:column("y")[51], 1e-13)
  local made = lunid.ensemble { model = model, vary = { seed = { 1, 2, 1 } }, substeps = 1, outputs = { "max_y" },
    excitation = function(case)
      return lunid.excitation.white_noise { rms = 5, seed = case.seed, dt = 1e-3, duration = 0.3 }
    end }
  local found = made:column("max_y"):list()
  spec.equal(found[1], found[3])
  assert(found[1] ~= found[2])
end)

spec.case("a draw repeats with its seed, and follows its distributions", function()
  local function drawn(method, seed)
    return lunid.ensemble { model = model, draw = { k = lunid.uniform(1e4, 3e4), c = lunid.normal(10, 1),
      y = lunid.log_uniform(1e-4, 1e-2) }, samples = 400, method = method, seed = seed, excitation = 0*t, duration = 0.01,
      dt = 1e-3, substeps = 1 }
  end
  for _, method in ipairs { "latin_hypercube", "sobol", "random" } do
    local a, b, other = drawn(method, 3), drawn(method, 3), drawn(method, 4)
    spec.equal(table.concat(a:column("c"):list(), " "), table.concat(b:column("c"):list(), " "))
    assert(a:column("c")[1] ~= other:column("c")[1])
    spec.near(a:column("k"):mean(), 2e4, 1e3)
    assert(a:column("k"):min() > 1e4 and a:column("k"):max() < 3e4)
    spec.near(a:column("c"):mean(), 10, 0.2)
    spec.near(a:column("c"):std(), 1, 0.12)
    assert(a:column("y"):min() > 1e-4 and a:column("y"):max() < 1e-2)
    spec.near(drawn(method, 3):column("rms_y")[7], a:column("rms_y")[7], 0)
  end
end)

spec.case("a member that explodes is a result; a sweep reads back to the same numbers", function()
  local k3 = lunid.parameter { "k3", 1 }
  local soft = lunid.model { mass = 1, restoring = 100*y - k3*y^3 }
  local sweep = lunid.ensemble { model = soft, vary = { k3 = { 1, 1e9, 2 } }, excitation = 20*lunid.sin(9*t),
    duration = 5, dt = 0.01 }
  spec.equal(sweep.stopped, 1)
  spec.contains(sweep:cause(2), "the restoring force grows without bound")
  spec.equal(sweep:cause(1), nil)
  spec.contains(tostring(sweep), "sweep of 3 members, 501 rows each, by fixed DP5, ")
  spec.contains(tostring(sweep), "; 1 stopped early\n  k3           1 to 1e+09\n  rms_y ")
  local path = spec.folder .. "/sweep.csv"
  sweep:save(path)
  local read = lunid.table(path)
  spec.equal(tostring(read), "table of 3 rows: k3, rms_y, max_y, stopped_at")
  for _, name in ipairs(read.names) do
    for m = 1, 3 do
      local a, b = read:column(name)[m], sweep:column(name)[m]
      assert(a == b or a ~= a and b ~= b, name)
    end
  end
end)

local head = [[
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local k, c, f = lunid.parameter { "k", 2e4 }, lunid.parameter { "c", 10 }, lunid.parameter { "f" }
local model = lunid.model { mass = 1, restoring = k*y + c*v }
]]

--- A study whose line 5 is an ensemble with these fields; its only output must be `expected`.
local function refused(fields, expected)
  local said, code = spec.study(head .. "lunid.ensemble { model = model, " .. fields .. " }\n")
  spec.equal(said, "study.lua:5: " .. expected .. "\n  nothing was written\n")
  spec.equal(code, 1)
end

spec.case("bad input", function()
  local push = "excitation = lunid.sin(t), duration = 1, dt = 0.01"
  refused("vary = { kk = { 1 } }, " .. push, "ensemble: nothing is called 'kk', did you mean 'k'?")
  refused("vary = { stiffness = { 1 } }, " .. push, "ensemble: nothing is called 'stiffness' (to vary: k, c, y, v)")
  refused("vary = { k = {} }, " .. push, "ensemble: vary: k: expected 1 value or more, got none")
  refused("vary = {}, " .. push, "ensemble: vary: expected 1 quantity or more")
  refused("vary = { k = { 1, 1/0 } }, " .. push, "ensemble: vary: k: entry 2: expected a finite number, got inf")
  refused("vary = { k = 'high' }, " .. push,
    "ensemble: vary: k: expected a list of numbers or lunid.range, got the string 'high'")
  refused("vary = { k = lunid.range(1, 2, 5000), c = lunid.range(1, 2, 5000) }, " .. push,
    "ensemble: vary: the full grid has 2.5e+07 members, more than 1e+07; take fewer values, or draw")
  refused("vary = { k = { 1 } }, draw = { c = lunid.normal(1, 1) }, " .. push, "ensemble: give vary or draw, not both")
  refused("draw = { k = { 1, 2 } }, samples = 3, " .. push,
    "ensemble: draw: k: expected lunid.uniform, lunid.normal or lunid.log_uniform, got a table")
  refused("draw = { k = lunid.uniform(1, 2) }, " .. push, "ensemble: samples: how many members to draw")
  refused("draw = { k = lunid.uniform(1, 2) }, samples = 0, " .. push,
    "ensemble: samples: expected 1 to 1e+07, got 0")
  refused("draw = { k = lunid.uniform(1, 2) }, samples = 9, method = 'sobel', " .. push,
    "ensemble: method: expected 'latin_hypercube', 'sobol' or 'random', got the string 'sobel', did you mean 'sobol'?")
  refused("vary = { k = { 1 } }, outputs = { 'rms_x' }, " .. push, "ensemble: outputs: expected max, min, mean, std, rms, "
    .. "amplitude or last, '_' and a signal (y, v, a), got 'rms_x', did you mean 'rms_y'?")
  refused("excitation = lunid.sin(t)", "ensemble: duration and dt are needed where the excitation is an expression")
  refused("excitation = lunid.sin(f*t), duration = 1, dt = 0.01",
    "ensemble: excitation: parameter 'f' has no value; give it one, or vary it")
  refused("excitation = lunid.sin(y), duration = 1, dt = 0.01",
    "ensemble: excitation: cannot hold 'y', only parameters and the time")
  refused("vary = { f = { 1, 2 } }, excitation = lunid.sin(f*t), duration = 1, dt = 0.01/f", "ensemble: duration: all "
    .. "members need the same number of rows, duration / dt + 1: member 1 has 101, member 2 has 201")
  refused("vary = { f = { 1, -2 } }, excitation = lunid.sin(f*t), duration = 1/f, dt = 0.01/f",
    "ensemble: dt: member 2: expected > 0, got -0.005")
  refused("vary = { k = lunid.range(1, 2, 1000) }, keep = 'trajectories', outputs = { 'rms_y' }, excitation = t, "
    .. "duration = 1000, dt = 0.001, substeps = 1", "ensemble: the trajectories of 1000 members, 1000001 rows and 1 "
    .. "signals need 8.00001 GB, more than the 2 GB allowed; keep summaries, or run fewer members at a time")
  refused("vary = { k = { 1 } }, excitation = function() return 3 end",
    "ensemble: excitation: the function gave 3 for member 1, expected a record")
  refused("vary = { k = { 1e12 } }, " .. push, "ensemble: member 1 needs more than 64 substeps per sample; take a smaller "
    .. "dt, or lunid.simulate with solver = 'bdf' for each")
end)

spec.case("bad tables and distributions", function()
  spec.equal(spec.message_of(function() lunid.uniform(2, 1) end), "uniform: to: expected > from, which is 2, got 1")
  spec.equal(spec.message_of(function() lunid.log_uniform(0, 1) end), "log_uniform: from: expected > 0, got 0")
  spec.equal(spec.message_of(function() lunid.normal(0, 0) end), "normal: std: expected > 0, got 0")
  spec.equal(spec.message_of(function() lunid.range(0, 1, 3, "log") end),
    "range: spacing 'log': expected two values of one sign, got 0 and 1")
  spec.write("bad.csv", "a,b\n1,2\n3,x\n")
  spec.contains(spec.message_of(function() lunid.table(spec.folder .. "/bad.csv") end),
    "bad.csv:3: column 'b': expected a number, got 'x'")
  spec.write("short.csv", "a,b\n1\n")
  spec.contains(spec.message_of(function() lunid.table(spec.folder .. "/short.csv") end),
    "short.csv:2: expected 2 cells, got 1")
  spec.write("good.csv", "a,b\n1,2\n")
  spec.equal(spec.message_of(function() lunid.table(spec.folder .. "/good.csv"):column "c" end),
    "the table has no column 'c'; it has a, b")
end)

-- ---- processes ----

local long = head .. [[
local members = lunid.option { "members", 3000 }
local sweep = lunid.ensemble { model = model, draw = { k = lunid.uniform(1e4, 3e4), c = lunid.normal(10, 1) },
  samples = members, excitation = 10*lunid.sin(80*t), dt = 1e-3, duration = lunid.option { "duration", 1.5 }, substeps = 1 }
print(sweep)
print("continued", sweep.continued > 0)
sweep:save "sweep.csv"
]]

assert(spec.shell "command -v mpirun" ~= "", "mpirun is missing; scripts/setup installs it")
local mpirun = "mpirun --oversubscribe --allow-run-as-root "

spec.case("threads and ranks give the same file", function()
  spec.write("long.lua", long)
  local said, code = spec.lunid "run long.lua members=500 --threads 1 --out one"
  spec.equal(code, 0)
  spec.contains(said, "sweep of 500 members, 1501 rows each, by fixed DP5, 1 substep\n")
  spec.lunid "run long.lua members=500 --threads 3 --out three"
  spec.equal(spec.shell "cmp one/sweep.csv three/sweep.csv && echo same", "same\n")
  local alone = said:gsub("one/", "ranks/")
  said, code = spec.lunid("run long.lua members=500 --out ranks", mpirun .. "-n 2")
  spec.equal(code, 0)
  said = said:gsub("%[hwloc[^\n]*\n", "")  -- what MPI itself says of the machine
  spec.equal(said, alone)  -- one rank speaks
  spec.equal(spec.shell "cmp one/sweep.csv ranks/sweep.csv && ls ranks; ls | grep ranks.", "run.json\nsweep.csv\n")
end)

spec.case("a study that fails on all ranks says so once", function()
  spec.write("wrong.lua", head .. "lunid.ensemble { model = model, vary = { kk = { 1 } }, excitation = t, dt = 1, duration = 9 }\n")
  local said, code = spec.lunid("run wrong.lua --out wrong", mpirun .. "-n 2")
  spec.equal(code, 1)
  spec.equal(select(2, said:gsub("did you mean 'k'%?", "")), 1)
end)

--- Starts a command, sends `signal` to the process `pid` names once members are kept; its exit code and words.
local function stopped(command, find, signal, out)
  return spec.shell(([[(%s > said 2>&1 & p=$!
    for i in $(seq 200); do ls | grep -q '%s.ensemble-' && break; sleep 0.05; done
    kill -%s $(%s); wait $p; echo "[exit $?]"); cat said]]):format(command, out or "out", signal, find))
end

spec.case("Ctrl-C keeps what is done, and the same study continues from it", function()
  local said = stopped(("'%s' run long.lua members=48000 --threads 1 --out out"):format(spec.executable), "echo $p", "INT")
  spec.contains(said, "[exit 130]")
  assert(said:match "ensemble: %d+ of 48000 members are done and kept; the same study continues from them\n", said)
  spec.contains(spec.shell "ls", "out.ensemble-")
  local code
  said, code = spec.lunid "run long.lua members=48000 --threads 2 --out out"
  spec.equal(code, 0)
  spec.contains(said, "continued\ttrue")
  spec.lunid "run long.lua members=48000 --out whole"
  spec.equal(spec.shell "cmp out/sweep.csv whole/sweep.csv && echo same; ls | grep ensemble-", "same\n")
end)

spec.case("an ensemble that calls functions of the study continues, too, unless the study has changed", function()
  local slow = long:gsub("local model = [^\n]*", [[
local spring = lunid.lua_function { "spring", function(y) return 1e6*y^3 end }
local model = lunid.model { mass = 1, restoring = k*y + c*v + spring(y) }]])
  assert(slow ~= long)
  spec.write("called.lua", slow)
  local run = "run called.lua members=1200 duration=0.5"
  local said = stopped(("'%s' %s --out called"):format(spec.executable, run), "echo $p", "INT", "called")
  spec.contains(said, "[exit 130]")
  spec.contains(said, "are done and kept; the same study continues from them\n")
  local code
  said, code = spec.lunid(run .. " --out called")
  spec.equal(code, 0)
  spec.contains(said, "continued\ttrue")
  spec.lunid(run .. " --out fresh")
  spec.equal(spec.shell "cmp called/sweep.csv fresh/sweep.csv && echo same; ls | grep ensemble-", "same\n")
  -- what another text of the study left is not taken
  said = stopped(("'%s' %s --out called"):format(spec.executable, run), "echo $p", "INT", "called")
  spec.contains(said, "[exit 130]")
  spec.write("called.lua", (slow:gsub("1e6%*y", "2e6*y")))
  said, code = spec.lunid(run .. " --out called")
  spec.equal(code, 0)
  spec.contains(said, "continued\tfalse")
  spec.shell "rm -f called.ensemble-*"
end)

spec.case("a rank that dies ends the run; what is done is kept for any number of ranks", function()
  local said = stopped(mpirun .. ("-n 2 '%s' run long.lua members=48000 --out out"):format(spec.executable),
    "pgrep -P $p | tail -1", "KILL")
  assert(not said:find("[exit 0]", 1, true), said)
  spec.contains(said, "exited on signal 9")
  spec.contains(spec.shell "ls", "out.ensemble-")
  local code
  said, code = spec.lunid "run long.lua members=48000 --out out"
  spec.equal(code, 0)
  spec.contains(said, "continued\ttrue")
  spec.equal(spec.shell "cmp out/sweep.csv whole/sweep.csv && echo same; ls | grep ensemble-", "same\n")
end)

spec.clean()
spec.finish()

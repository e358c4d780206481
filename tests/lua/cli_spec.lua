-- Bad input through the real executable: each with its message, its exit code, and no earlier result lost.
local spec = require "spec"

--- A free decay under a small force, sampled; changed row by row by `change(i, cells)` (returning nil drops the row).
local function record(name, rows, change, header)
  local lines, y, v = { header or "t,F,y" }, 0.01, 0
  local h = 0.01
  for i = 0, rows - 1 do
    local force = 20 * math.sin(0.7 * i * h * 10)
    local cells = { ("%.3f"):format(i * h), ("%.17g"):format(force), ("%.17g"):format(y) }
    if change then cells = change(i, cells) end
    if cells then lines[#lines + 1] = table.concat(cells, ",") end
    for _ = 1, 10 do  -- semi-implicit Euler at a tenth of the sample: good enough for bad input
      v = v + h / 10 * (force - 100 * y - 1000 * y ^ 3 - 0.8 * v)
      y = y + h / 10 * v
    end
  end
  spec.write(name, table.concat(lines, "\n") .. "\n")
end

--- Runs lunid; what it says must hold `expected`, and the exit code must be `code`.
local function says(arguments, expected, code)
  local said, got = spec.lunid(arguments)
  spec.contains(said, expected)
  spec.equal(got, code)
end

local usual = '--mass 1 --restoring "k*y + c*v" --out out'

--- Runs discover on a file; the whole output must be `expected`, and the exit code `code`.
local function refused(file, options, expected, code)
  local said, got = spec.lunid(("discover %s %s"):format(file, options))
  spec.equal(said, expected)
  spec.equal(got, code)
  spec.equal(spec.shell "cat out/run.json", "the earlier run\n")
end

spec.shell "mkdir out"
spec.write("out/run.json", "the earlier run\n")
local kept = "\n  nothing was written; 'out' is as it was\n"

record("good.csv", 600)

spec.case("missing file", function()
  refused("nowhere.csv", usual, "nowhere.csv: no such file" .. kept, 3)
end)

spec.case("empty CSV", function()
  spec.write("empty.csv", "")
  refused("empty.csv", usual, "empty.csv: the file is empty" .. kept, 3)
end)

spec.case("text in a number column", function()
  record("text.csv", 100, function(i, cells)
    if i == 40 then cells[2] = "n/a" end
    return cells
  end)
  refused("text.csv", usual, "text.csv:42: column 'F': expected a number, got 'n/a'; mend it, or set resample = true "
    .. "(--resample), which interpolates such rows as missing ones" .. kept, 3)
  local said, code = spec.lunid 'discover text.csv --mass 1 --restoring "k*y + c*v" --catalogue cubic_stiffness --resample --out mended'
  spec.contains(said, "interpolated")
  spec.equal(code, 0)
end)

spec.case("two columns of one name", function()
  record("twice.csv", 100, nil, "t,y,y")
  refused("twice.csv", usual, "twice.csv:1: two columns of one name: columns 2 and 3 are both 'y'" .. kept, 3)
end)

spec.case("other names for motion and force: all that are missing, what there is, and what to do", function()
  record("pendulum.csv", 100, nil, "t,M,theta")
  refused("pendulum.csv", usual, "pendulum.csv: discover: the record has no channels 'y', 'F' (it has M, theta); name "
    .. 'its column, e.g. --columns "y=header [unit], F=header [unit]" (in a study columns = "...")' .. kept, 3)
end)

spec.case("a column whose unit speaks for one channel is named where that is missing", function()
  local function offers(header, expected)
    record("other.csv", 100, function(_, cells) return { cells[1], cells[2], cells[3], cells[2] } end, header)
    spec.contains(spec.lunid("discover other.csv " .. usual), ('name its column, e.g. --columns "%s"'):format(expected))
  end
  offers("t,clamp [kN],head [g],oil [K]", "a=head, F=clamp")
  offers("t,tau_cmd [N m],y,oil", "F=tau_cmd")
  offers("t,tau_cmd [N m],y,tau [N m]", "F=header [unit]")  -- either
  offers("t,F,head [g],ldv [m/s]", "y=header [unit]")
  offers("t,F,drop [V],oil", "y=header [unit]")  -- a volt may be anything
  offers("t,F_kN,y mm,oil", "y=y mm [mm], F=F_kN [kN]")
  says('discover good.csv --columns "Y=y [mm]" ' .. usual, 'e.g. --columns "y=y"', 3)
  says('discover good.csv --columns "x=y" ' .. usual, 'e.g. --columns "y=y"', 3)
end)

spec.case("with several coordinates too, of the quantity that is measured", function()
  spec.write("two.lua", 'local lunid = require "lunid"\nlocal k = lunid.parameter { "k", min = 0 }\n'
    .. "return lunid.chain { masses = { 1.2, 0.8 }, ends = 'left', forces = { 1 }, element = function(d, w) return k*d + w end }\n")
  record("two.csv", 100, function(_, cells) return { cells[1], cells[2], cells[3], cells[3] } end, "t,F1,shield [g],cold stage [g]")
  local both = "discover two.csv --baseline two.lua --out out"
  says(both, "has no channels 'a1', 'a2' (it has F1, shield, cold stage); the motion of every coordinate of the model has to be "
    .. 'measured: name its column, e.g. --columns "a1=shield, a2=cold stage" (in a study', 3)
  says(both .. ' --columns "a1=shield"', [[no channel 'a2' (it has F1, a1, cold stage]], 3)
  says(both .. ' --columns "a1=shield,v2=cold stage [m/s]"', "discover: expected one quantity of the motion at all coordinates, got a1 and v2", 3)
end)

spec.case("on a terminal: the stage, the part that is done and the time left", function()
  local command = ("'%s' discover good.csv --mass 1 --restoring 'k*y + c*v' --out watched"):format(spec.executable)
  local said = spec.shell(('script -qec "%s" /dev/null'):format(command))
  spec.contains(said, "%  propose and fit, 1 effect, about ")
  spec.contains(said, " s left")
end)

spec.case("an uneven time base: refused, and resampled when asked", function()
  record("uneven.csv", 600, function(i, cells)
    cells[1] = ("%.6f"):format(i * 0.01 + 0.002 * math.sin(i))
    return cells
  end)
  refused("uneven.csv", usual, "uneven.csv:524: time is uneven: steps from 0.008082 to 0.011918 s, median 0.01 s; "
    .. "the largest ends here; set resample = true (--resample) to interpolate to the median step" .. kept, 3)
  local said, code = spec.lunid 'discover uneven.csv --mass 1 --restoring "k*y + c*v" --resample --out resampled'
  spec.equal(code, 0)
  spec.contains(said, "verdict")
end)

spec.case("a record with a gap is cut there, and no run goes through what was not measured", function()
  record("gap.csv", 900, function(i, cells) return (i < 400 or i >= 423) and cells or nil end)
  local said, code = spec.lunid 'discover gap.csv --mass 1 --restoring "k*y + c*v" --catalogue cubic_stiffness --resample --out cut'
  spec.equal(code, 0)
  spec.contains(said, "gap.csv, part 1 of 2, from t = 0 s: train, 280 rows")  -- the last 30 % of each piece are held out
  spec.contains(said, "gap.csv, part 2 of 2, from t = 4.23 s: train, 333 rows")
  spec.contains(said, "gap.csv, part 2 of 2, from t = 7.56 s: test, 144 rows")
  spec.contains(said, "named      cubic_stiffness")
  local _, notes = said:gsub("23 rows are missing before t = 4.23 s: interpolated; free runs begin anew at t = 4.23 s,", "")
  spec.equal(notes, 1)
  local checked = 'discover gap.csv --mass 1 --restoring "k*y + c*v" --resample --check'
  says(checked, "record gap.csv, part 1 of 2, from t = 0 s: 400 rows", 0)
  says(checked, "record gap.csv, part 2 of 2, from t = 4.23 s: 477 rows, 4.76 s at 100 Hz; channels", 0)
  says(checked .. " --window 0:4", "record gap.csv: 400 rows", 0)  -- one part alone is a record as others are
end)

spec.case("a time column that runs backwards", function()
  record("back.csv", 100, function(i, cells)
    if i == 50 then cells[1] = "0.1" end
    return cells
  end)
  refused("back.csv", usual, "back.csv:52: time runs backwards: t = 0.1 s after t = 0.49 s; delete the rows that are out of "
    .. "order, or where all are evenly spaced give their rate in place of the time: rate = HZ (--rate HZ)" .. kept, 3)
  local said, code = spec.lunid 'discover back.csv --mass 1 --restoring "k*y + c*v" --catalogue cubic_stiffness --rate 100 --out rated'
  spec.contains(said, "back.csv: train, 70 rows, 0.69 s at 100 Hz")
  spec.contains(said, "left out: the time 't', because a rate or interval is given")
  spec.equal(code, 0)
  spec.equal(spec.shell 'grep -o \'"rate": "100"\' rated/run.json', '"rate": "100"\n')
  says('discover good.csv --mass 1 --restoring "k*y + c*v" --rate 200 --check',
    "warning: the time 't' has 100 rows per second, the rate that is given 200", 0)
end)

spec.case("no time column: --rate says how far the rows are apart", function()
  record("bare.csv", 100, function(_, cells) return { cells[2], cells[3] } end, "F,y")
  refused("bare.csv", usual, "bare.csv:1: no time column: expected a column named 't' or 'time', the file has 'F', 'y'; give "
    .. "the rows per second: rate = HZ (--rate HZ)" .. kept, 3)
  says('discover bare.csv --mass 1 --restoring "k*y + c*v" --catalogue cubic_stiffness --rate 100 --out bare',
    "bare.csv: train, 70 rows, 0.69 s at 100 Hz", 0)
  local _, code = spec.lunid "simulate bare/model.lua --excitation bare.csv --rate 100 --from 0,0 --out bare-run"
  spec.equal(code, 0)
  says("simulate bare/model.lua --excitation bare.csv --rate fs --out bare-run",
    "bare.csv: rate and interval: expected a number for a CSV file, got the name 'fs'", 3)
  says("discover bare.csv --rate 0 " .. usual, "--rate: expected > 0, got '0'\n", 2)
  says([[discover bare.csv --rate "0.2 kHz" --check --mass 1 --restoring "k*y + c*v"]], "100 rows, 0.495 s at 200 Hz", 0)
  says([[discover bare.csv --rate "4 ms" --check --mass 1 --restoring "k*y + c*v"]], "got the name '4 ms'", 3)
end)

spec.case("a logger's file is read as it is, and what was skipped is said", function()
  record("logger.csv", 100, function(i, cells)
    cells[1], cells[2] = ("%.2f"):format(i*0.01), ("%.9f"):format(cells[2])
    cells[3] = ("%.9f"):format(1000*cells[3])
    return cells
  end, "Logger;X200\nKanal;1;2\nt;F;Disp.\ns;N;mm")
  spec.shell "tail -n +5 logger.csv | tr ',.' ';,' > rows; head -4 logger.csv | cat - rows > german.csv"
  local said, code = spec.lunid 'discover german.csv --mass 1 --restoring "k*y + c*v" --catalogue cubic_stiffness --out german'
  spec.contains(said, "2 lines before the header in line 3 are no part of the table and skipped, the first: 'Logger;X200'")
  spec.equal(code, 0)
end)

spec.case("columns: what is said holds, and a number that is none of a header is refused", function()
  local function with(columns) return ('discover good.csv --mass 1 --restoring "k*y + c*v" --check --columns %s'):format(columns) end
  says(with '"F=0"', "  F  0 to 0 N, deviation 0", 0)
  says(with '"F=0"', "warning: left out: the column 'F', because F=0 is given", 0)
  says(with '"F=2"', "no column '2' for channel 'F': a column is named by its header", 3)
  says(with '"y=y [mm]" --columns "F=F [kN]"', "; from 'F' [kN]", 0)
  says(with '"y=y [mm];F=F"', "commas separate one column from the next", 3)
  says(with '"y=F [N],F=y"', "'N' is no unit of channel 'y'", 3)
  spec.contains(spec.study 'local lunid = require "lunid"\nprint(lunid.read("good.csv", { force = "0" }))\n', "  F  0 to 0 N")
end)

spec.case("fewer rows than are needed where some are held out", function()
  record("r40.csv", 40)
  refused("r40.csv", usual, "r40.csv: discover: expected at least 30 rows in a record without what is held out of it, got 28 "
    .. "of 40: give a longer one, or a test record (--test)" .. kept, 3)
  says('discover r40.csv --test good.csv --mass 1 --restoring "k*y + c*v" --check', "record r40.csv: 40 rows", 0)
end)

spec.case("5 rows", function()
  record("short.csv", 5)
  refused("short.csv", usual, "short.csv: expected at least 6 rows, got 5" .. kept, 3)
end)

spec.case("a constant displacement", function()
  record("still.csv", 600, function(_, cells)
    cells[3] = "0.25"
    return cells
  end)
  refused("still.csv", usual, "still.csv: discover: the displacement is constant (0.25 m in every row); "
    .. "nothing can be learned from a record without motion" .. kept, 3)
end)

spec.case("mass <= 0 without imposed motion", function()
  refused("good.csv", '--mass 0 --restoring "k*y" --out out',
    "model: mass: expected > 0, got 0 (a mass of 0 needs imposed motion)" .. kept, 2)
  refused("good.csv", '--mass=-3 --restoring "k*y" --out out',
    "model: mass: expected > 0, got -3 (a mass of 0 needs imposed motion)" .. kept, 2)
end)

spec.case("a mass with its unit", function()
  says('discover good.csv --mass "0.002 t" --restoring "k*y + c*v" --check', "2*a + k*y + c*v = F", 0)
  says('discover good.csv --mass 5e-1kg --restoring "k*y + c*v" --check', "0.5*a + k*y + c*v = F", 0)
  says('discover good.csv --mass "500 g" --restoring "k*y + c*v" --check', "0.5*a + k*y + c*v = F", 0)
  says('discover good.csv --mass 2e6mg --restoring "k*y + c*v" --check', "2*a + k*y + c*v = F", 0)
  says('discover good.csv --mass "2e7 g cm^2" --restoring "k*y + c*v" --check', "2*a + k*y + c*v = F", 0)
  says('discover good.csv --mass 12lb --restoring "k*y + c*v" --check', "5.44310844*a + k*y + c*v = F", 0)
  says('discover good.csv --mass "0.5 slug ft^2" --restoring "k*y + c*v" --check', "0.677908974", 0)
  local expected = "--mass: expected a number with or without a unit of mass (kg g mg ug t lb slug, or a product such as kg m^2, "
    .. "of a circuit H), got "
  refused("good.csv", '--mass "5 m/s^2" --restoring "k*y" --out out', expected .. "'5 m/s^2' ('m/s^2' is a unit of m/s^2)" .. kept, 2)
  refused("good.csv", '--mass "12 stone" --restoring "k*y" --out out', expected .. "'12 stone' (unknown unit 'stone')" .. kept, 2)
  refused("good.csv", '--mass "8.5 Tonnes" --restoring "k*y" --out out', expected .. "'8.5 Tonnes' (unknown unit 'Tonnes', did you mean 't'?)" .. kept, 2)
  for unit in expected:match "%((.-),":gmatch "%a+" do  -- what it lists is known
    says(('discover good.csv --mass "1 %s" --restoring "k*y + c*v" --check'):format(unit), "k*y + c*v = F", 0)
  end
end)

spec.case("a mass of another kind than its motion", function()
  local function beside(unit, mass) return ('discover good.csv --mass "%s" --restoring "k*y + c*v" --columns "y=y [%s]" --check'):format(mass, unit) end
  says(beside("mrad", "0.36 kg"), "--mass: expected a unit of the kind of kg m^2, since y is in rad, got '0.36 kg'\n", 2)
  says(beside("mm", "12 mH"), "--mass: expected a unit of the kind of kg, since y is in m, got '12 mH'\n", 2)
  says(beside("mrad", "0.36 kg m^2"), "0.36*a + k*y", 0)
  says(beside("mm", "0.36 kg m^2"), "since y is in m, got '0.36 kg m^2'", 2)
  local function circuit(mass)
    return ('discover good.csv --mass "%s" --restoring "k*y + c*v" --columns "y=y [nC],F=F [V]" --check'):format(mass)
  end
  says(circuit "12 kg", "--mass: expected a unit of the kind of H, since y is in C, got '12 kg'\n", 2)
  says(circuit "12 mH", "0.012*a + k*y", 0)
  says(beside("mrad", "0.36"), "0.36*a + k*y", 0)
  says(beside("V", "0.36 kg"), "0.36*a + k*y", 0)  -- a motion that is not calibrated
  says(beside("nC", "12 mH"), "0.012*a + k*y", 0)
end)

spec.case("a parameter that the data do not excite", function()
  local said, code = spec.lunid 'discover good.csv --mass 1 --restoring "k*y + k2*y + c*v" --out out'
  spec.contains(said, "k2")
  spec.equal(code, 3)
  says('discover good.csv --mass 1 --restoring "k*y + k2*y + c*v" --check', "do not excite parameters 'k' and 'k2' separately", 3)
  record("free.csv", 600, function(i, cells) return { cells[1], ("%.17g"):format(0.01*math.exp(-4e-3*i)*math.cos(0.1*i)) } end, "t,y")
  says('discover free.csv --mass m --restoring "k*y + c*v" --check', "only ratios to the mass can be seen; give --mass as a number", 3)
end)

spec.case("an unknown function in --restoring", function()
  refused("good.csv", '--mass 1 --restoring "k*y + sine(v)" --out out',
    "--restoring:1:7: unknown function 'sine', did you mean 'sin'?" .. kept, 2)
end)

spec.case("unbalanced parentheses", function()
  refused("good.csv", '--mass 1 --restoring "k*(y + c*v" --out out',
    "--restoring:1:11: expected ')' to close the '(' in column 3, got the end" .. kept, 2)
end)

spec.case("an effect of the catalogue stands in a file", function()
  refused("good.csv", '--mass 1 --restoring "k*y + lunid.effects.bouc_wen {}" --out out',
    "--restoring: expected a formula such as k*y + c*v, got Lua, 'lunid.effects.bouc_wen': that stands in the file of a "
      .. "baseline, --baseline model.lua" .. kept, 2)
  says('discover good.csv --mass 1 --restoring "k*y + bouc_wen" --check', "note       --restoring: 'bouc_wen' is taken for a parameter "
    .. "to fit; the effect stands in the file of a baseline (--baseline), as lunid.effects.bouc_wen {}\n", 0)
end)

spec.case("constant forces that were meant as products", function()
  local function constants(restoring)
    return spec.lunid(('discover good.csv --mass 1 --restoring "%s" --check'):format(restoring)):match "constant forces to fit: [^\n]*"
  end
  spec.equal(constants "ky + cv", "constant forces to fit: ky, cv; a product is written with *, as k*y")
  spec.equal(constants "k*y + cv", "constant forces to fit: cv; a product is written with *, as k*y")
  spec.equal(constants "k*y + ky + c*v", "constant forces to fit: ky; a product is written with *, as k*y")
  spec.equal(constants "k*y + c*v + ma", "constant forces to fit: ma; a product is written with *, as k*y")
  spec.equal(constants "spring + damper", "constant forces to fit: spring, damper; a product is written with *, as k*y")
  for _, right in ipairs { "k*y + c*v + F0", "c*v + W", "W", "k*(y - y0) + c*v", "k*y + Fy*sign(v)", "k*tanh(y/yv) + c*v",
    "k*y + c*abs(v)^p*sign(v)", "0" } do
    spec.equal(constants(right), nil)
  end
end)

spec.case("terms that were most likely meant otherwise", function()
  local function said(mass, restoring)
    return spec.lunid(('discover good.csv --mass %s --restoring "%s" --check'):format(mass, restoring))
  end
  local twice = "--restoring: 2*a stands beside the mass 2, and both act; the mass is given by --mass alone"
  spec.contains(said(2, "2*a + k*y + c*v"), twice)
  spec.equal(said(3, "2*a + k*y + c*v"):find("stands beside", 1, true), nil)
  spec.contains(said(2, "k*y + c*v^p"), "--restoring: v^p is no number where v < 0; write abs(v)^p*sign(v)")
  spec.contains(said(2, "k*y + c*v^1.5"), "v^1.5 is no number")
  spec.equal(said(2, "k*y + c*v^3 + d*abs(v)^p*sign(v) + e*(2 + v)^1.5"):find("is no number", 1, true), nil)
end)

spec.case("wrong usage", function()
  local said, code = spec.lunid "discover good.csv --mass 1 --out out"
  spec.equal(said, "--restoring (or --baseline model.lua) is needed" .. kept)
  spec.equal(code, 2)
  said, code = spec.lunid "discover good.csv --restoring y --out out"
  spec.equal(said, "--mass is needed where the motion is free; where a machine imposes it, say --imposed-motion" .. kept)
  spec.equal(code, 2)
  said, code = spec.lunid("discover good.csv --window 8 " .. usual)
  spec.equal(said, "--window: expected A:B in seconds, got '8'" .. kept)
  spec.equal(code, 2)
  says("discover good.csv --alpha 2 " .. usual, "--alpha: expected > 0 and < 0.5, got 2\n", 2)
  says("discover good.csv --minimum-gain 1 " .. usual, "--minimum-gain: expected >= 0 and < 1, got 1\n", 2)
  says("discover good.csv --catalogue cubic_stiffness,clearence " .. usual,
    "--catalogue: unknown effect 'clearence', did you mean 'clearance'?\n", 2)
  says([[discover good.csv --catalogue "cubic stiffness" ]] .. usual,
    "--catalogue: unknown effect 'cubic stiffness', did you mean 'cubic_stiffness'?\n", 2)
  says("discover good.csv --catalogue cubic " .. usual, "unknown effect 'cubic', did you mean 'cubic_stiffness' or 'cubic_damping'?", 2)
  says([[discover good.csv --catalogue "clearance cubic_stiffness" --check --mass 1 --restoring "k*y + c*v"]], "a + k*y", 0)
  says("discover good.csv --without clearence " .. usual,
    "--without: unknown effect 'clearence', did you mean 'clearance'?\n", 2)
end)

spec.case("wrong options: what was expected, what came", function()
  for arguments, expected in pairs {
    ["run s.lua --seed abc"] = "lunid: --seed: expected a whole number >= 0, got 'abc'\nlunid: see `lunid run --help`\n",
    ["run s.lua --seed -1"] = "lunid: --seed: expected a whole number >= 0, got '-1'\nlunid: see `lunid run --help`\n",
    ["run s.lua --seed 1.5"] = "lunid: --seed: expected a whole number >= 0, got '1.5'\nlunid: see `lunid run --help`\n",
    ["repl --threads 9999"] = "lunid: --threads: expected a whole number from 0 to 4096, got '9999'\nlunid: see `lunid repl --help`\n",
    ["run s.lua --out ''"] = "lunid: --out: expected a directory, got ''\nlunid: see `lunid run --help`\n",
    ["run s.lua --out --check"] = "lunid: --out: expected a value, got '--check'\nlunid: see `lunid run --help`\n",
    ["run s.lua --out --seed"] = "lunid: --out: expected a value, got '--seed'\nlunid: see `lunid run --help`\n",
    ["discover r.csv --mass --check"] = "lunid: --mass: expected a value, got '--check'\nlunid: see `lunid discover --help`\n",
    ["discover r.csv --test --check"] = "lunid: --test: expected a value, got '--check'\nlunid: see `lunid discover --help`\n",
    ["discover --mas 3"] = "lunid: discover has no option '--mas', did you mean '--mass'?\nlunid: see `lunid discover --help`\n",
    ["run s.lua --zzz=3"] = "lunid: run has no option '--zzz'\nlunid: see `lunid run --help`\n",
    ["check s.lua more"] = "lunid: check: one word too many: 'more'\nlunid: see `lunid check --help`\n",
    ["list effects solvers"] = "list: expected one topic, got 'effects solvers'\n",
  } do
    local said, code = spec.lunid(arguments)
    spec.equal(said, expected)
    spec.equal(code, 2)
  end
end)

spec.case("the solvers that simulate offers are those that there are", function()
  local help = spec.lunid "simulate --help"
  local offered = assert(help:gsub("%s+", " "):match "%-%-solver TEXT (.-) %(auto%)", help):gsub(" or ", ", ")
  local words = {}
  for name in spec.lunid "list solvers":match "of a simulation[^\n]*\n(.*)":gmatch "%s*(%S+)[^\n]*\n" do words[#words + 1] = name end
  spec.equal(offered, table.concat(words, ", "))
end)

spec.case("--catalogue and --minimum-gain say what may be named", function()
  local _, code = spec.lunid([[discover good.csv --mass 1 --restoring "k*y + c*v" --out few]]
    .. " --catalogue 'cubic_stiffness, quadratic_drag' --minimum-gain 0")
  spec.equal(code, 0)
  local tried = spec.shell [[grep -o '"name": "[a-z_ +]*"' few/discovery.json | sort -u]]
  spec.contains(tried, "cubic_stiffness")
  for name in tried:gmatch '"name": "([^"]*)"' do
    for word in name:gmatch "[%w_]+" do
      if word ~= "nothing" then spec.equal(word == "cubic_stiffness" or word == "quadratic_drag", true) end
    end
  end
  local _, left = spec.lunid([[discover good.csv --mass 1 --restoring "k*y + c*v" --out fewer]]
    .. " --catalogue 'quintic_stiffness, cubic_stiffness, quadratic_drag' --without 'cubic_stiffness, quadratic_drag'")
  spec.equal(left, 0)
  spec.equal(spec.shell [[grep -c 'cubic_stiffness\|quadratic_drag' fewer/discovery.json]], "0\n")
end)

spec.case("--interpolation says what the force does between its rows", function()
  says("discover good.csv --interpolation held " .. usual,
    "--interpolation: expected hold, linear, cubic or band_limited, got 'held'\n", 2)
  says("discover good.csv --baseline b.lua --interpolation hold",
    "--interpolation: the baseline's file says it: lunid.model { interpolation = ... }", 2)
  -- A free decay cannot tell, and keeps what is said.
  record("decay.csv", 600, function(i, cells) return { cells[1], "0", ("%.17g"):format(0.01*math.exp(-4e-3*i)*math.cos(0.1*i)) } end)
  for _, kind in ipairs { "hold", "cubic" } do
    local _, code = spec.lunid(("discover decay.csv --interpolation %s --catalogue cubic_stiffness --mass 1 "
      .. "--restoring 'k*y + c*v' --out said_%s"):format(kind, kind))
    spec.equal(code, 0)
    spec.contains(spec.shell(("cat said_%s/model.lua"):format(kind)), ('interpolation = "%s"'):format(kind))
  end
end)

spec.case("--check says how records and baseline are read, and writes nothing", function()
  record("micron.csv", 100, nil, "temps [s],effort [kN],course")
  local said, code = spec.lunid([[discover micron.csv --test micron.csv --columns "t=temps,y=course [um],F=effort" --mass 1 ]]
    .. [[--restoring "k*y + 0.8*v" --check --out unmade]])
  spec.equal(code, 0)
  spec.contains(said, "record micron.csv: 100 rows, 0.99 s at 100 Hz; channels F y v* a*\n")
  spec.contains(said, "; from 'effort [kN]'\n  y  ")
  spec.contains(said, "; from 'course' [um]\n")
  spec.contains(said, "\nrecord micron.csv: 100 rows")  -- the second, to test on
  spec.contains(said, "a + k*y + 0.8*v = F\n  k [N/m]: to fit, discover reads the first guess off the data\n")
  spec.equal(spec.shell "ls -d unmade 2>/dev/null | wc -l", "0\n")
  says([[discover micron.csv --mass 1 --restoring "k*y" --check]], "micron.csv", 3)
end)

spec.case("--check says from where a parameter is fitted, and whose force F is", function()
  spec.write("pair.lua", 'local lunid = require "lunid"\nlocal k = lunid.parameter { "k", 300, min = 0, unit = "N/m" }\n'
    .. 'local c = lunid.parameter { "c", 2, fixed = true }\n'
    .. 'return lunid.chain { masses = { 2, 1 }, ends = "left", forces = { 2 }, element = function(d, w) return k*d + c*w end }')
  record("pair.csv", 100, nil, "t,F [N],y1 [m]")
  spec.shell "awk -F, 'NR==1{print $0\",y2 [m]\"} NR>1{print $0\",\"2*$3}' pair.csv > pair2.csv"
  local said, code = spec.lunid "discover pair2.csv --baseline pair.lua --check"
  spec.equal(code, 0)
  spec.contains(said, "= F2\n  k = 300 N/m: to fit, from there\n  c = 2 (fixed)\n")
  spec.contains(said, "note       F of pair2.csv is taken for F2, the force that drives the baseline\n")
  spec.contains(said, "note       noise is what a channel does from row to row")
end)

spec.case("--check says what a discovery would say of the records before it fits anything", function()
  local checked = [[discover good.csv --mass 1 --restoring "k*y + c*v" --check]]
  says(checked, "note       no test record given: the last 30 % of each record is held out", 0)
  local twice = "holds rows of the training record good.csv: they count twice, and deviations come out too small. Give them once"
  spec.shell "awk 'NR%2==1' good.csv > half.csv; sed -n '1,200p' good.csv > begin.csv"
  for _, more in ipairs { "good.csv", "half.csv", "begin.csv" } do
    says(([[discover good.csv %s --mass 1 --restoring "k*y + c*v" --check]]):format(more), ("the training record %s %s"):format(more, twice), 0)
  end
  says(checked .. " --test half.csv", "the test record half.csv holds rows of the training record good.csv", 0)
  says(checked .. " --out good.csv", "--out: 'good.csv' is a file, not a directory", 2)
  says(checked .. " --test good.csv", "note       the test record good.csv holds rows of the training record good.csv: it confirms nothing", 0)
  local said = spec.lunid(checked .. " --window 1:3 --test-window 3.5:4")
  spec.contains(said, "record good.csv: 201 rows, 2 s at 100 Hz")
  spec.contains(said, "record good.csv: 51 rows, 0.5 s at 100 Hz")
  says(checked .. " --catalogue cubic_stifness", "did you mean 'cubic_stiffness'?", 2)
  record("free.csv", 600, function(i, cells) return { cells[1], ("%.17g"):format(0.01*math.exp(-4e-3*i)*math.cos(0.1*i)) } end, "t,y")
  says([[discover free.csv --mass 1 --restoring "k*y + c*v" --check]], "note       free.csv has no force and its motion dies away: taken for a free decay, F = 0", 0)
  record("other.csv", 100, nil, "t,piezo,disp")
  local other = [[discover other.csv --mass 1 --restoring "k*y + c*v" --check]]
  says(other, "record other.csv: 100 rows", 3)
  says(other, "the record has no channel 'F' (it has piezo, y", 3)
end)

--- What --check notes of a file, but that no test was given.
local function noted(arguments)
  local said, code = spec.lunid("discover " .. arguments .. " --check")
  spec.equal(code, 0)
  local notes = {}
  for note in said:gmatch "note       ([^\n]*)" do
    if not note:find "^no test record given" then notes[#notes + 1] = note end
  end
  return table.concat(notes, "\n")
end

local linear = '--mass 1 --restoring "k*y + c*v"'

spec.case("--check says of which channels no unit is given", function()
  local function units(arguments) return noted(arguments):match "no unit[^\n]*" end
  spec.equal(units("good.csv " .. linear), "no unit is given for t, F, y: SI is taken")
  spec.equal(units('good.csv --columns "y=y [mm]" --test good.csv ' .. linear), "no unit is given for t, F: SI is taken")
  spec.equal(units('good.csv --columns "t=t [s],y=y [mm],F=F [kN]" ' .. linear), nil)
  record("ms.csv", 600, function(i, cells) return { tostring(10*i), cells[2], cells[3] } end, "t,F [N],y [m]")
  spec.equal(units("ms.csv " .. linear),
    'no unit is given for t: SI is taken; the rows of ms.csv are 10 s apart: where that is ms, say --columns "t=header [ms]"')
  record("all_units.csv", 600, nil, "t [s],F [N],y [m]")
  spec.equal(units("all_units.csv " .. linear), nil)
  spec.equal(units('all_units.csv --columns "extra=F,F=0" ' .. linear), nil)
  record("extra.csv", 600, function(i, cells) return { cells[1], cells[2], cells[3], tostring(i % 7) } end, "t [s],F [N],y [m],hall")
  spec.equal(units("extra.csv " .. linear), nil)  -- nothing takes it for SI
end)

spec.case("--check says how the force is read between its rows", function()
  local function reading(arguments) return noted(arguments):match "between its rows[^\n]*" end
  local of_models = ": by its rows, as a first guess; a run asks its models how it is best read"
  record("bits.csv", 600, function(i, cells) return { cells[1], (i // 20)^2 % 7 > 3 and "20" or "-20", cells[3] } end)
  spec.equal(reading("good.csv " .. linear), "between its rows the force is read as cubic" .. of_models)
  spec.equal(reading("bits.csv " .. linear), "between its rows the force is read as hold" .. of_models)
  spec.equal(reading("bits.csv --test good.csv " .. linear),
    "between its rows the force is read as hold (bits.csv), cubic (good.csv)" .. of_models)
  spec.equal(reading("bits.csv --test good.csv --interpolation linear " .. linear),
    "between its rows the force is read as linear, as was said")
  spec.equal(reading("free.csv " .. linear), nil)  -- a decay has no force
  spec.equal(reading('good.csv --imposed-motion --restoring "k*y + c*v"'), nil)
  spec.contains(noted('good.csv --imposed-motion --restoring "k*y + c*v"'),
    "the motion is imposed: the force of the baseline along y, v and a is held against F, and gaps are of it")
  record("loop.csv", 600, function(_, cells) return { cells[1], cells[2], cells[3], cells[3] } end, "t,F,y,y_reference")
  spec.contains(noted("loop.csv " .. linear), "how it is best read; where a digital controller puts it out, --interpolation hold says so")
end)

spec.case("--check says that the angle of a shaft wants its name", function()
  local function angle(header, turns)
    record("turns.csv", 600, function(i, cells)
      return { cells[1], cells[2], cells[3], ("%.6f"):format(360 * (i/600*turns % 1)) }
    end, header)
    return noted("turns.csv " .. linear):match "nothing uses[^\n]*"
  end
  spec.equal(angle("t,F [N],y [mm],keyphasor [deg]", 20),
    "nothing uses the channel 'keyphasor', an angle that turns on; where it is that of a shaft in the rig, say shaft_angle=keyphasor")
  spec.equal(angle("t,F [N],y [mm],tilt [deg]", 0.9), nil)
  spec.equal(angle("t,F [N],y [mm],shaft_angle [deg]", 20), nil)
  spec.equal(angle("t,F [N m],y [mrad],motor [deg]", 20), nil)  -- the rig is what turns
end)

spec.case("--check says that a set point wants its name", function()
  local function four(header)
    record("loop.csv", 600, function(_, cells) return { cells[1], cells[2], cells[3], cells[3] } end, header)
  end
  four "t,F,y,Setpoint [m]"
  local hint = "nothing uses the channel 'Setpoint'; where it is what a controller was to follow, say y_reference=Setpoint"
  spec.contains(noted("loop.csv " .. linear), hint)
  spec.equal(noted('loop.csv --columns "y_reference=Setpoint" ' .. linear):find("y_reference=", 1, true), nil)
  four "t,F,v,target"
  spec.contains(noted("loop.csv " .. linear), "say v_reference=target")
end)

spec.case("--check warns of a clock that is far from 0", function()
  local function late(start) record("late.csv", 600, function(i, cells) return { ("%.2f"):format(start + 0.01*i), cells[2], cells[3] } end) end
  late(1732924800)
  spec.contains(noted("late.csv " .. linear), "the time of late.csv begins at 1.73292e+09 s, far from 0: effects of the time")
  late(60)  -- ten times the record: a window of a long one
  spec.equal(noted("late.csv " .. linear):find "the time of", nil)
end)

spec.case("a directory or nothing in place of a study", function()
  spec.shell "mkdir -p folder"
  for _, command in ipairs { "run", "check" } do
    local said, code = spec.lunid(command .. " folder")
    spec.equal(said, "'folder' is a directory; expected a study, such as study.lua\n")
    spec.equal(code, 2)
    said, code = spec.lunid(command .. " nowhere.lua")
    spec.equal(said, "no such study: 'nowhere.lua'\n")
    spec.equal(code, 2)
  end
end)

spec.case("a record in place of a study", function()
  local said, code = spec.lunid "run good.csv"
  spec.equal(said, "'good.csv' is a record, not a study: type `lunid discover good.csv --mass M --restoring \"k*y + c*v\"`, or "
    .. "write a study, such as study.lua, that has lunid.read \"good.csv\"\n")
  spec.equal(code, 2)
end)

spec.case("a command that there is not, or none", function()
  local said, code = spec.lunid "discver good.csv"
  spec.equal(said, "lunid: no command 'discver', did you mean 'discover'?\nlunid: see `lunid --help`\n")
  spec.equal(code, 2)
  said, code = spec.lunid ""
  spec.contains(said, "lunid: a command is needed, such as `lunid help`\n")
  spec.equal(code, 2)
end)

spec.case("a signal that is written otherwise is a parameter, and that is said", function()
  local said = spec.lunid 'discover good.csv --mass 1 --restoring "k*x + c*v" --out out-x'
  spec.contains(said, "note       --restoring: 'x' is taken for a parameter to fit; the displacement is written y\n")
  spec.shell "rm -rf out-x"
end)

spec.case("a directory that holds other things is refused", function()
  spec.shell "mkdir mine && echo hello > mine/notes.txt"
  local said, code = spec.lunid 'discover good.csv --mass 1 --restoring "k*y + c*v" --out mine'
  spec.equal(said, "--out: the directory 'mine' holds other things than an earlier run (it has no run.json); "
    .. "choose another or empty it\n")
  spec.equal(code, 2)
  spec.equal(spec.shell "ls mine", "notes.txt\n")
  said, code = spec.lunid 'discover good.csv --mass 1 --restoring "k*y + c*v" --out mine/notes.txt'
  spec.equal(said, "--out: 'mine/notes.txt' is a file, not a directory\n")
  spec.equal(code, 2)
end)

spec.case("an out directory is looked at no deeper than its first entry, and messages name it as it was asked for", function()
  for _, out in ipairs { "/", "/proc/1" } do
    local said, code = spec.lunid("run mine/notes.txt.lua --out " .. out, "echo 'local x = 1' > mine/notes.txt.lua;")
    spec.equal(said, ("--out: the directory '%s' holds other things than an earlier run (it has no run.json); "
      .. "choose another or empty it\n"):format(out))
    spec.equal(code, 2)
  end
  local said, code = spec.lunid "run mine/notes.txt.lua --out /proc/lunid-out"
  spec.equal(said, "--out: cannot make the directory '/proc/lunid-out': No such file or directory\n")
  spec.equal(code, 2)
end)

spec.case("a slip in the last line loses nothing: what finished calls wrote is kept beside the out directory", function()
  local study = [[
local lunid = require "lunid"
local name = lunid.option { "name", "a" }
lunid.model { mass = 1, restoring = 2*lunid.displacement }:save(name .. ".lua")
lunid.read("good.csv"):save "records/copy.csv"
]]
  spec.write("whole.lua", study)
  spec.write("slip.lua", study .. "print(lunid.verdict)\n")
  local _, code = spec.lunid "run whole.lua --out slip"
  spec.equal(code, 0)
  local earlier = spec.shell "ls -lR --time-style=full-iso slip"
  for _, name in ipairs { "a", "b" } do  -- which replaces the first
    local said
    said, code = spec.lunid(("run slip.lua name=%s --out slip/"):format(name))
    spec.equal(said, ("slip.lua:5: lunid has no 'verdict'\n  finished files are kept in 'slip.failed': %s.lua, records (1 file); "
      .. "'slip' is as it was\n"):format(name))
    spec.equal(code, 1)
    spec.equal(spec.shell "ls slip.failed", ("%s.lua\nerror.txt\nrecords\n"):format(name))
    spec.equal(spec.shell "cat slip.failed/error.txt", "slip.lua:5: lunid has no 'verdict'\n")
    spec.equal(spec.shell "ls -lR --time-style=full-iso slip", earlier)
  end
  spec.shell "rm slip.failed/error.txt"  -- now it may be anyone's
  local said = spec.lunid "run slip.lua name=c --out slip"
  spec.contains(said:gsub("partial%-%d+", "partial-N"), "are kept in 'slip.partial-N': c.lua, records (1 file); 'slip' is")
  spec.equal(spec.shell "ls slip.failed", "b.lua\nrecords\n")
  spec.shell "rm -r slip.partial-*"
end)

local heavy = [[
local lunid = require "lunid"
local y = lunid.displacement
lunid.model { mass = 1, restoring = 2*y }:save "model.lua"
io.stdout:write("saved\n")
io.stdout:flush()
local n = 0
while true do n = n + 1 end
]]

spec.case("Ctrl-C in Lua code: exit 130, finished files are kept, the earlier result is as it was", function()
  spec.write("loop.lua", heavy)
  local said = spec.shell(([[('%s' run loop.lua --out out > said 2>&1 & p=$!; while ! grep -qs saved said; do sleep 0.05; done
    kill -INT $p; wait $p; echo "[exit $?]") ; sed 's/partial-[0-9]*/partial-N/' said]]):format(spec.executable))
  spec.equal(said, "[exit 130]\nsaved\ninterrupted; finished files are kept in 'out.partial-N': model.lua; "
    .. "'out' is as it was\n")
  spec.equal(spec.shell "cat out/run.json", "the earlier run\n")
  spec.contains(spec.shell "cat out.partial-*/model.lua", "restoring = 2*y")
  spec.shell "rm -r out.partial-*"
end)

spec.case("Ctrl-C in a discovery", function()
  record("long.csv", 20000)
  local said = spec.shell(([[('%s' discover long.csv %s > said 2>&1 & p=$!; sleep 1; kill -INT $p; wait $p; echo "[exit $?]"); cat said]])
    :format(spec.executable, usual))
  spec.contains(said, "[exit 130]\ninterrupted; nothing was written; 'out' is as it was\n")
  spec.equal(spec.shell "cat out/run.json", "the earlier run\n")
  spec.equal(spec.shell "ls -d out.partial-* 2>/dev/null", "")
end)

spec.case("a disk that is full", function()
  -- A limit on the size of files stands for the full disk where no small file system can be mounted.
  spec.write("big.lua", [[
local lunid = require "lunid"
lunid.read("good.csv"):save "copy.csv"
]])
  local said, code = spec.lunid("run big.lua --out out", "trap '' XFSZ; ulimit -f 8;")
  spec.contains(said, "/copy.csv: cannot write: File too large\n  asked for at big.lua:2\n")
  spec.contains(said, "nothing was written; 'out' is as it was")
  spec.equal(code, 3)
  spec.equal(spec.shell "cat out/run.json", "the earlier run\n")
end)

spec.case("a full file system", function()
  local mounted = spec.shell "mkdir -p tiny && mount -t tmpfs -o size=16k tmpfs tiny 2>/dev/null && echo yes"
  if mounted == "" then
    print "skipped: a full file system (no right to mount one)"
    return
  end
  local said, code = spec.lunid("run big.lua --out tiny/out")
  local left = spec.shell "ls tiny; umount tiny"
  spec.contains(said, "No space left on device")
  spec.equal(code, 3)
  spec.equal(left, "")
end)

spec.case("run.json repeats a run bit for bit, and tells a changed input", function()
  local _, code = spec.lunid 'discover good.csv --mass 1 --restoring "k*y + c*v" --out first --seed 7'
  spec.equal(code, 0)
  _, code = spec.lunid "run first/run.json --out second"
  spec.equal(code, 0)
  spec.equal(spec.shell "diff -r -x run.json first second && echo same", "same\n")
  spec.shell "sed 's/\"out\": \"[a-z]*\"//' first/run.json > a; sed 's/\"out\": \"[a-z]*\"//' second/run.json > b"
  spec.equal(spec.shell "diff a b && echo same", "same\n")
  record("good.csv", 601)
  local said
  said, code = spec.lunid "run first/run.json --out second"
  spec.equal(said, "the run's input 'good.csv' has changed since (another SHA-256)\n")
  spec.equal(code, 3)
end)

spec.case("parameters of --restoring get the units that the equation gives them", function()
  local _, code = spec.lunid 'discover good.csv --mass 1 --restoring "k*y + c*v + c2*abs(v)*v + k1*cos(40*y)*v^2 + p*abs(y)^1.5" --out units'
  spec.equal(code, 0)
  local model = spec.shell "cat units/model.lua"
  for name, unit in pairs { k = "N/m", c = "N s/m", c2 = "N s^2/m^2", k1 = "N s^2/m^2" } do
    spec.equal(model:match('{ "' .. name .. '"[^}]-unit = "([^"]*)"'), unit)
  end
  spec.equal(model:match '{ "p"[^}]-unit', nil)
end)

spec.case("of a circuit whose current alone was measured they are those of its charge", function()
  record("good.csv", 601)
  spec.shell "sed '1s/.*/t,current [A],source [V]/' good.csv > current.csv"
  local said = spec.lunid 'discover current.csv --mass L --restoring "S*y + R*v" --columns "v=current,F=source" --check'
  for name, unit in pairs { L = "V s/A", S = "V/s/A", R = "V/A" } do
    assert(said:find(("  %s [%s]: "):format(name, unit), 1, true), said)
  end
end)

spec.case("those before differences to a base too", function()
  local header, lines = "t,y,yb,vb,F\n", {}
  for i = 0, 599 do
    local t = i/100
    lines[#lines + 1] = ("%g,%.8g,%.8g,%.8g,0\n"):format(t, 0.02*math.sin(7*t) + 0.01*math.sin(23*t), 0.01*math.sin(7*t), 0.07*math.cos(7*t))
  end
  spec.write("base.csv", header .. table.concat(lines))
  local said, code = spec.lunid 'discover base.csv --mass 2 --restoring "k*(y - yb) + c*(v - vb)" --catalogue cubic_stiffness --out base'
  spec.equal(code, 0)
  spec.contains(said, "the base moves")
  local against = [[discover base.csv --mass 1400 --restoring "k*y + c*v + %g*ab" --columns "y=y,F=0" --check]]
  local weight = "The equation has 1200*ab beside a mass of 1400: it is taken as it is, F = -1200*ab"
  says(against:format(1200), weight, 0)
  spec.equal(spec.lunid(against:format(1400)):find("The equation has", 1, true), nil)
  local model = spec.shell "cat base/model.lua"
  spec.contains(model, "restoring = k*(y - yb) + c*(v - vb)")
  for name, unit in pairs { k = "N/m", c = "N s/m" } do
    spec.equal(model:match('{ "' .. name .. '"[^}]-unit = "([^"]*)"'), unit)
  end
end)

spec.case("a second run replaces the files of the first and keeps the user's own", function()
  spec.write("s.lua", 'local lunid = require "lunid"\nlocal name = lunid.option { "name", "a" }\n'
    .. 'lunid.model { mass = 1, restoring = lunid.displacement }:save(name .. ".lua")\n')
  spec.lunid "run s.lua name=a --out third"
  spec.write("third/notes.txt", "mine")
  local _, code = spec.lunid "run s.lua name=b --out third"
  spec.equal(code, 0)
  spec.equal(spec.shell "ls third", "b.lua\nnotes.txt\nrun.json\n")
end)

spec.case("a reader that goes away does not cost the results", function()
  spec.write("long.lua", 'local lunid = require "lunid"\nfor i = 1, 20000 do print("a line of many", i) end\n'
    .. 'lunid.model { mass = 1, restoring = lunid.displacement }:save "m.lua"\n')
  spec.equal(spec.shell(("'%s' run long.lua --out read | head -1"):format(spec.executable)), "a line of many\t1\n")
  spec.equal(spec.shell "ls read", "m.lua\nrun.json\n")
end)

spec.case("simulate", function()
  spec.write("m.lua", 'local lunid = require "lunid"\nreturn lunid.model { mass = 1, restoring = 100*lunid.displacement }\n')
  local said, code = spec.lunid "simulate m.lua --excitation good.csv --from 0.01,0 --out sim"
  spec.equal(code, 0)
  spec.contains(said, "sim/run.csv")
  said, code = spec.lunid "simulate nowhere.lua --excitation good.csv --out sim"
  spec.contains(said, "no such file: 'nowhere.lua'")
  spec.equal(code, 3)
end)

spec.case("help finds methods, and says where it is on words that have none of their own", function()
  spec.contains(spec.lunid "help record save", "record:save { path, version = }\n")
  local function points(topic, expected)
    local said, code = spec.lunid("help " .. topic)
    spec.contains(said, expected)
    spec.equal(code, expected:match "^no help" and 2 or 0)
  end
  points("duffing", "no help on 'duffing' alone: see `lunid help systems duffing`\n")
  points("solvers", "no help on 'solvers' alone: see `lunid list solvers`\n")
  points("fit", "See `lunid help fit_trajectory`, `lunid help regress`, `lunid help fit_curve`.\n")
  points("gap", "The gap is the error of a free run over the size of the motion")
  points("verdict", "See `lunid help discover`.\n")
  spec.write("fit.lua", 'require "lunid".fit {}')
  spec.contains(spec.lunid "run fit.lua", "fit.lua:1: lunid has no 'fit', did you mean 'fit_trajectory', 'regress' or 'fit_curve'?\n")
end)

spec.case("help on what the command line is about", function()
  spec.contains(spec.lunid "help columns", "channel=header [unit]")
  spec.contains(spec.lunid "help units", "many of them with p n u")
  spec.contains(spec.lunid "help rate", "--rate 800")
end)

spec.case("columns of a list stand apart, however long a name is", function()
  local said = spec.lunid "list solvers"
  spec.contains(said, "\n  instrumental_variables  Two-stage least squares")
  spec.contains(said, "\n  lasso                   Least squares")
end)

spec.clean()
spec.finish()

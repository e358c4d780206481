-- Bad input of an identification: what each study is told, with the lines of the study.
local lunid = require "lunid"
local spec = require "spec"

local head = ([[
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local record = lunid.read "%s/tests/data/spring_multisine.csv"
]]):format(io.popen("pwd"):read "l")

--- What a study says whose lines from the fourth on are these.
local function said(lines) return (spec.study(head .. lines .. "\n")) end

--- A record in a file, by a row for each sample.
local function file(name, header, rows, row)
  local lines = { header }
  for i = 0, rows - 1 do lines[#lines + 1] = row(i) end
  spec.write(name, table.concat(lines, "\n") .. "\n")
end

spec.case("fewer rows than features", function()
  spec.contains(said "lunid.regress { record = record:window(0, 0.01), mass = 49, features = { lunid.polynomials({ y, v }, 4) } }",
    "study.lua:4: 14 features need at least as many rows, got 9: take fewer features or more of the record\n")
end)

spec.case("a constant channel has no motion, and is said", function()
  file("still.csv", "t,F,y", 2000, function(i) return ("%.3f,%g,0.1"):format(1e-3*i, i % 7) end)
  local text = said [[
local still = lunid.read "still.csv"
print(still)
print(lunid.regress { record = still, mass = 49, features = { y, v } })]]
  spec.contains(text, "v  0 to 0 m/s, deviation 0; of y, which is constant")
  spec.contains(text, "study.lua:6: feature 'v' is zero on all rows: the data do not excite it, leave it out or fix its coefficient\n")
  spec.contains(said "lunid.rfs { record = lunid.read 'still.csv', mass = 49 }", "study.lua:4: surface: y is constant")
end)

spec.case("what is not a number in the window", function()
  file("gap.csv", "t,F,y,v,a", 2000, function(i)
    return ("%.3f,%g,%g,%g,%g"):format(1e-3*i, i % 7, math.sin(0.1*i), math.cos(0.1*i), math.sin(0.3*i))
  end)
  local study = [[
local gap = lunid.read("gap.csv"):with_noise { y = lunid.noise.dropped { fraction = 0.001, fill = "gap" }, seed = 1 }
lunid.regress { record = gap, mass = 49, features = { y, v }, window = lunid.window(0, %g) }]]
  local text = said(study:format(1.9))
  local at, row = text:match "study.lua:5: feature 'y' is not a number at t = ([%d.]+) s %(row (%d+) of gap.csv%): leave such rows "
    .. "out of the window, or the feature out of the list\n"
  assert(at, text)
end)

spec.case("two identical features, and two that are one on the data", function()
  local text = said [[
local twice = lunid.features { y, y*v }
local fit = lunid.regress { record = record, mass = 49, features = { y, v, twice,
  lunid.features { 2*y } } }
for _, warning in ipairs(fit.warnings) do print(warning) end]]
  spec.contains(text, "the feature 'y' of study.lua:5 is given again at study.lua:4: it is taken once\n")
  spec.contains(text, "on these data (2*y) = 2*y (2*y at study.lua:6, y at study.lua:5): they cannot be told apart, '2*y' is "
    .. "left at 0\n")
end)

spec.case("constraints that contradict one another, each with its line", function()
  spec.contains(said [[
local low = lunid.at_least(y, 2)
local high = lunid.at_most(y, 1)
lunid.regress { record = record, mass = 49, features = { y, v }, constraints = { low, high } }]],
    "study.lua:5: constraint 'y <= 1' contradicts 'y >= 2' (study.lua:4)\n")
end)

spec.case("a window outside the record", function()
  spec.contains(said "lunid.regress { record = record, mass = 49, features = { y, v }, window = lunid.window(20, 30) }",
    "spring_multisine.csv: window 20 to 30 s: expected at least 6 rows, the record has t = 0 to 8 s in steps of 0.00125 s\n"
      .. "  asked for at study.lua:4\n")
end)

spec.case("a negative lambda", function()
  for _, solver in ipairs { "lasso", "elastic_net", "ridge" } do
    spec.contains(said(("lunid.%s { lambda = -1 }"):format(solver)), ("study.lua:4: %s: lambda: expected > 0, got -1\n"):format(solver))
  end
end)

spec.case("a network that does not converge is a result", function()
  local text = said [[
local surface = lunid.rfs { record = record, mass = 49, interpolate = lunid.mlp { evaluations = 3 } }
print(surface)
print(lunid.model { mass = 49, restoring = surface(y, v) })]]
  spec.contains(text, "\n  not converged: stopped after 3 evaluations, not at rest\n49*a + surface(y, v) = F")
end)

spec.case("a MAT file that cannot be read", function()
  spec.write("text.mat", "this is no MAT file, but a text that is as long as the header of one would be, and then some more: "
    .. ("."):rep(200))
  spec.contains(said 'lunid.read "text.mat"', "text.mat: ")
  spec.contains(said 'lunid.read "text.mat"', "\n  asked for at study.lua:4\n")
  spec.write("short.mat", "MATLAB 5.0 MAT-file")
  spec.contains(said 'lunid.read "short.mat"',
    "short.mat: cut short: it holds no more than a part of its header\n  asked for at study.lua:4\n")
  spec.contains(said 'lunid.read "none.mat"', "none.mat: no such file\n  asked for at study.lua:4\n")
end)

spec.case("records with other units in one study", function()
  local function row(i) return ("%.3f,%g,%g"):format(1e-3*i, i % 7, math.sin(0.1*i)) end
  file("angle.csv", "t,F,y [deg]", 2000, row)
  spec.contains(said 'lunid.regress { record = { record, lunid.read "angle.csv" }, mass = 49, features = { y, v } }',
    "study.lua:4: regress: 'y' is in m in ")
  spec.contains(said 'lunid.regress { record = { record, lunid.read "angle.csv" }, mass = 49, features = { y, v } }',
    " and in rad in angle.csv: regress them one by one, or mend the units where they are read\n")
  spec.contains(said 'lunid.read("angle.csv", { displacement = "y [kN]" })', "angle.csv:1: column 'y [deg]': 'kN' is no unit of "
    .. "channel 'y', expected one of the kind of m, rad, V, C\n  asked for at study.lua:4\n")
  -- Units of one kind are turned into SI.
  file("metres.csv", "t,F,y", 2000, row)
  file("others.csv", "t [ms],F [kN],y [mm]", 2000, function(i) return ("%d,%.12g,%.12g"):format(i, (i % 7)/1000, 1000*tonumber(("%g"):format(math.sin(0.1*i)))) end)
  local text = said [[
for _, name in ipairs { "metres.csv", "others.csv" } do
  print(("%.6g"):format(lunid.regress { record = lunid.read(name), mass = 49, features = { y, v } }.terms.y.value))
end]]
  local first, second = text:match "^(%S+)\n(%S+)\n"
  spec.equal(first, second)
end)

spec.clean()
spec.finish()

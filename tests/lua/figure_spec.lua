-- Every kind of figure: what it plans, what it writes, and what it says of bad input.
local lunid = require "lunid"
local spec = require "spec"

local figure = lunid.figure
local y, v = lunid.displacement, lunid.velocity
local series = figure.series

--- One second of a motion in closed form at 10 Hz, which grows; F is what moves 2 kg on a spring of 8000 N/m.
local rows = { "t,F,y,v,a" }
for i = 0, 1000 do
  local t, w = i*1e-3, 2*math.pi*10
  local s, co, e = math.sin(w*t), math.cos(w*t), 1e-3*math.exp(t)
  local yy, vv, aa = e*s, e*(s + w*co), e*((1 - w*w)*s + 2*w*co)
  rows[#rows + 1] = ("%.17g,%.17g,%.17g,%.17g,%.17g"):format(t, 2*aa + 8000*yy, yy, vv, aa)
end
spec.write("motion.csv", table.concat(rows, "\n") .. "\n")
local record = lunid.read(spec.folder .. "/motion.csv")

--- Rows of an exported figure: { panel, kind, label, name, x, y, z }.
local function exported(drawn)
  local path = spec.folder .. "/data.csv"
  drawn:export(path)
  local list = {}
  for line in io.lines(path) do
    local row = {}
    for cell in (line .. ","):gmatch "([^,]*)," do row[#row + 1] = tonumber(cell) or cell end
    if line:sub(1, 1) ~= "#" and row[1] ~= "panel" then list[#list + 1] = row end
  end
  return list
end

local function count(list, panel, kind)
  local n = 0
  for _, row in ipairs(list) do n = n + (row[1] == panel and row[2] == kind and 1 or 0) end
  return n
end

spec.case("a history enlarges parts of the time and shades them", function()
  local drawn = figure.history { record, channels = { "y", "F" }, zoom = { lunid.window(0.1, 0.2), lunid.window(0.5, 0.6) } }
  spec.equal(#drawn.panels, 6)
  spec.equal(drawn.panels[1].column_span, 2)
  spec.equal(#drawn.panels[1].bands, 2)
  spec.equal(drawn.panels[3].x.min, 0.5)
  spec.equal(drawn.panels[4].y.name, "force")
  spec.equal(count(exported(drawn), 1, "curve"), 1001)
end)

spec.case("a lone loop is coloured by its cycles, and the restoring force is that of the spring", function()
  local drawn = figure.loop { record, mass = 2 }
  local list = exported(drawn)
  spec.equal(count(list, 1, "curve"), 1001)
  for _, row in ipairs(list) do
    if row[1] == 1 then spec.near(row[6], 8000*row[5], 1e-9) end  -- F - m*a = k*y by construction; N, beside 22 N
  end
  -- Ten periods from t = 0: an upward crossing of the mean, each but the first after a low.
  spec.equal(list[1][7], 0)
  spec.equal(list[1001][7], 9)
  spec.equal(#figure.loop { { record, record } }.panels[1].series, 2)
  spec.equal(figure.loop { { record, record } }.panels[1].series[1].colour, nil)
end)

spec.case("phase portraits take records, runs, comparisons and plain columns", function()
  local model = lunid.model { mass = 2, restoring = 8000*y }
  local run = lunid.simulate { model = model, excitation = record, from = "record" }
  local drawn = figure.phase_portrait { { record, run, series { { 0, 1e-3 }, { 0, 0.05 }, label = "drawn by hand" } } }
  spec.equal(#drawn.panels[1].series, 3)
  spec.equal(drawn.panels[1].series[2].label, "free run")
  spec.equal(drawn.panels[1].y.unit, "m/s")
  local compared = lunid.compare { record = record, run = run }
  spec.equal(#figure.history(compared).panels[1].series, 2)
  spec.equal(#figure.qq(compared).panels[1].series, 2)
end)

spec.case("a histogram is a density, and its classes follow Freedman and Diaconis", function()
  local values = {}
  for i = 1, 1000 do values[i] = (i - 0.5)/1000 end
  local drawn = figure.histogram { values, normal = false }
  local columns = drawn.panels[1].series[1]
  -- Uniform: interquartile range 0.5, range 0.999; 0.999*10/(2*0.5) = 9.99 classes.
  spec.equal(#columns.x, 10)
  local width, area = columns.x[2] - columns.x[1], 0
  for i = 1, 10 do area = area + width*columns.y[i] end
  spec.near(area, 1, 1e-12)
  spec.near(columns.y[5], 1, 0.02)
  spec.equal(#figure.histogram { { 3, 3, 3 } }.panels[1].series[1].x, 1)
end)

spec.case("a residual map is the mean over cells, and empty cells have no data", function()
  local drawn = figure.residual_map { residual = { 1, 3, -5, 0/0 }, y = { 0, 0.1, 1, 1 }, v = { 0, 0.1, 1, 0 }, cells = 2 }
  local map = drawn.panels[1].map
  spec.equal(map.z[1][1], 2)
  spec.equal(map.z[2][2], -5)
  assert(map.z[1][2] ~= map.z[1][2], "a cell whose only residual is not a number must be empty")
  spec.equal(map.colour.max, 5)
  spec.equal(map.colour.min, -5)
  -- The model that made the record leaves nothing; half its stiffness leaves the other half.
  local half = figure.residual_map { record = record, model = lunid.model { mass = 2, restoring = 4000*y }, cells = 10 }
  local cells = half.panels[1].map
  for i = 1, 10 do
    if cells.z[5][i] == cells.z[5][i] then spec.near(cells.z[5][i], 4000*cells.x[i], 4000*1.1e-3*0.5) end
  end
end)

spec.case("a Pareto front holds what nothing beats in both", function()
  local drawn = figure.pareto { series { { 1, 2, 2, 3, 4, 5 }, { 5, 4, 3, 3, 1, 0/0 } } }
  local front = drawn.panels[1].series[2]
  spec.equal(table.concat(front.x:list(), " "), "1.0 2.0 4.0")
  spec.equal(table.concat(front.y:list(), " "), "5.0 3.0 1.0")
end)

spec.case("intervals stand beside the truth, and false terms by themselves", function()
  local fit = lunid.regress { record = record, mass = 2, features = { y, v } }
  local drawn = figure.intervals { { fit, fit }, truth = { y = 4000, v = 0 }, labels = { "one", "same" } }
  spec.equal(#drawn.panels, 2)
  spec.equal(drawn.panels[1].y.names[1], "y")
  spec.equal(drawn.panels[2].y.names[1], "v")
  local points = drawn.panels[1].series[2]
  spec.equal(points.label, "one")
  spec.near(points.x[1], 100, 1e-6)  -- 8000 is 100 % more than 4000
  local whisker, term = drawn.panels[1].series[1].x, fit.terms.y
  spec.near(whisker[1], 100*(term.lower/4000 - 1), 1e-9)
  spec.near(whisker[2], 100*(term.upper/4000 - 1), 1e-9)
  spec.equal(#figure.intervals(fit).panels, 1)
end)

spec.case("a coefficient path has every lambda, and ends at the coefficients of the least", function()
  local fit = lunid.regress { record = record, mass = 2, features = { y, v, y^3 }, solver = lunid.lasso { path = 40 } }
  spec.equal(#fit.path, 40)
  assert(fit.path[1].lambda > fit.path[40].lambda)
  spec.equal(#fit.path[1].coefficients, 3)
  local drawn = figure.coefficient_path(fit)
  spec.equal(#drawn.panels, 2)
  local first = drawn.panels[1].series[#drawn.panels[1].series]
  spec.equal(first.label, "y")
  spec.near(first.y:max(), 1, 0)
  spec.equal(spec.message_of(function() figure.coefficient_path(lunid.regress { record = record, features = { y } }) end),
    "figure.coefficient_path: the regression has no path: fit it with lunid.lasso or lunid.elastic_net "
    .. "{ lambda = \"cross-validate\" }")
end)

spec.case("time warping pairs equal rows of a curve and its slower copy", function()
  local fast, slow = {}, {}
  for i = 0, 50 do fast[i + 1] = math.sin(0.1*i) end
  for i = 0, 100 do slow[i + 1] = math.sin(0.05*i) end
  local pairing = lunid.statistics.dtw_pairing({ fast }, { slow })
  spec.near(pairing.distance, lunid.statistics.dtw({ fast }, { slow }), 1e-12)
  local sum = 0
  for k = 1, #pairing.a do sum = sum + math.abs(fast[pairing.a[k]//1 | 0] - slow[pairing.b[k]//1 | 0]) end
  spec.near(sum, pairing.distance, 1e-12)
  for i = 0, 50 do  -- the rows of the copy that are the curve's own are paired with them
    local paired = false
    for k = 1, #pairing.a do paired = paired or pairing.a[k] == i + 1 and pairing.b[k] == 2*i + 1 end
    assert(paired, ("row %d is not paired with row %d"):format(i + 1, 2*i + 1))
  end
  spec.equal(#figure.alignment(pairing).panels, 2)
  spec.equal(#pairing:figure().panels, 2)
  local long = {}
  for i = 1, 25000 do long[i] = i end
  spec.equal(spec.message_of(function() lunid.statistics.dtw_pairing({ long }, { long }) end), "dtw: the pairing of 25000 and "
    .. "25000 rows takes more than 4e8 pairs: give a narrower band, or every n-th row")
end)

spec.case("an information matrix is symmetric and knows nothing of a channel and itself", function()
  local a, b, c = {}, {}, {}
  for i = 1, 500 do a[i], b[i], c[i] = math.sin(i), math.sin(i)^3, math.cos(7.77*i*i) end
  local drawn = figure.information_matrix { { { "a", a }, { "b", b }, { "c", c } } }
  local z = drawn.panels[1].map.z
  spec.equal(z[1][2], z[2][3])  -- rows run upward: (c, b) and (b, c)
  assert(z[3][1] ~= z[3][1], "the first cell on top is a with itself")
  assert(z[3][2] > 2 and z[3][3] < 0.3, "b is a function of a, c is not")
  spec.equal(drawn.panels[1].map.missing, "itself")  -- not "no data"
end)

spec.case("surfaces take grids of one's own, and their parts fit", function()
  local grid = { x = { 0, 1, 2 }, y = { 0, 1 }, z = { { 0, 1, 4 }, { 1, 2, 5 } } }
  local drawn = figure.relief(grid)
  spec.equal(count(exported(drawn), 1, "surface"), 6)
  spec.equal(count(exported(figure.map(grid)), 1, "map"), 6)
  spec.equal(spec.message_of(function() figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 1, 2, 3 }, { 1, 2 } } } end),
    "figure.relief: z: row 1: expected 2 numbers as in x, got 3")
  spec.equal(spec.message_of(function() figure.map { x = { 0, 1 }, y = { 0 }, z = { { 1, 2 }, { 1, 2 } } } end),
    "figure.map: z: expected 1 rows as y has numbers, got 2")
  local all = figure.grid { { drawn, figure.map(grid), figure.history(record) }, columns = 3, title = "all" }
  spec.equal(#all.panels, 3)
  spec.equal(all.columns, 3)
end)

spec.case("the look goes to the file: size, resolution and theme", function()
  local drawn = figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 0, 1 }, { 1, 2 } }, width = 10, height = 8, dpi = 127,
    theme = "dark" }
  local path = spec.folder .. "/look.png"
  drawn:save(path)
  local file = assert(io.open(path, "rb"))
  local width, height = (">I4I4"):unpack(file:read "a", 17)
  file:close()
  spec.equal(width, 500)
  spec.equal(height, 400)
end)

spec.case("an animation writes its frames, and the surface turns", function()
  local relief = figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 0, 1 }, { 1, 3 } }, width = 6, dpi = 60 }
  figure.turn { relief, frames = 3 }:save(spec.folder .. "/turn")
  local seen = {}
  for i = 1, 3 do
    local file = assert(io.open(("%s/turn/frame_%04d.png"):format(spec.folder, i), "rb"))
    local bytes = file:read "a"
    file:close()
    assert(not seen[bytes], "two frames are alike")
    seen[bytes] = true
  end
  spec.equal(spec.message_of(function() figure.turn(figure.history(record)) end),
    "figure.turn: expected a figure with a surface, such as one of figure.surface")
end)

spec.case("a page holds its figures' numbers and nothing from elsewhere", function()
  local path = spec.folder .. "/page.html"
  figure.page { { figure.lines { series = { series { { 1, 2 }, { 3, 4 }, label = "</script>" } } },
    figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 0, 1 }, { 1, 2 } } } }, title = "a < b", captions = { "first & only" } }:save(path)
  local file = assert(io.open(path))
  local page = file:read "a"
  file:close()
  spec.contains(page, "<h1>a &lt; b</h1>")
  spec.contains(page, "<figcaption>first &amp; only</figcaption>")
  spec.contains(page, [["label":"<\/script>"]])
  spec.contains(page, '"x":[1.0,2.0],"y":[3.0,4.0]')
  assert(not page:find("https?://") and not page:find("src=\"[^d]"), "the page asks for something from elsewhere")
  local _, holders = page:gsub('<div class="lunid%-figure">', "")
  spec.equal(holders, 2)
end)

-- ---- bad input ----

spec.case("series of no, one or unusable numbers are drawn or refused, never broken", function()
  local function save(kind) kind:save(spec.folder .. "/bad.png") end
  save(figure.lines { series = { series { {}, {} } } })
  save(figure.lines { series = { series { { 1 }, { 2 } } } })
  save(figure.lines { series = { series { { 1, 2 }, { 0/0, 0/0 } } } })
  save(figure.lines { series = { series { { -1, 0 }, { -5, -7 } } }, x_scale = "log", y_scale = "log" })
  save(figure.lines { series = { series { { -1, 1, 10 }, { 5, -7, 3 } } }, x_scale = "log", y_scale = "log" })
  save(figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 0/0, 0/0 }, { 0/0, 0/0 } } })
  save(figure.map { x = { 0 }, y = { 0 }, z = { { 5 } } })
  spec.equal(spec.message_of(function() figure.qq { { 1, 0/0, 2 } } end),
    "figure.qq: expected at least 3 finite numbers, got 2 of 3")
  spec.equal(spec.message_of(function() figure.histogram { { 0/0, 1/0 } } end),
    "figure.histogram: expected at least 1 finite numbers, got 0 of 2")
  spec.equal(spec.message_of(function() series { { 1, 2 }, { 1 } } end), "figure.series: y: expected 2 numbers as in x, got 1")
  spec.equal(spec.message_of(function() figure.pareto { series { { 1 }, { 0/0 } } } end),
    "figure.pareto: no candidate has both costs: there is no front")
end)

spec.case("a channel that is not there is named with those that are", function()
  spec.equal(spec.message_of(function() figure.history { record, channels = { "z" } } end),
    ("figure.history: the record '%s' has no channel 'z' (it has t, F, y, v, a)"):format(record.name))
  spec.equal(spec.message_of(function() figure.history { record, chanels = { "z" } } end),
    "figure.history: unknown field 'chanels', did you mean 'channels'?")
end)

spec.case("more points than can be drawn are refused before they are copied", function()
  local said, code = spec.study [[
local lunid = require "lunid"
local force = lunid.excitation.harmonic { frequency = 1, amplitude = 1, dt = 1e-7, duration = 2.1 }
lunid.figure.history { force, channels = { "F" } }:save "much.png"
]]
  spec.equal(code, 1)
  spec.contains(said, "study.lua:3: figure: a curve of 21000001 points, at most 20000000 can be drawn: show a part of it "
    .. "(record:window), or every n-th point (column:every)")
end)

spec.case("a kind of file that there is not, and no path at all", function()
  local drawn = figure.lines { series = { series { { 1, 2 }, { 3, 4 } } } }
  spec.equal(spec.message_of(function() drawn:save "a.gif" end), "save: expected a path that ends in .png, .svg, .pdf, got the string 'a.gif'")
  spec.equal(spec.message_of(function() drawn:export "a.xls" end),
    "export: expected a path that ends in .csv, .vts, .vtp, .vtu, .vtm, got the string 'a.xls'")
  spec.equal(spec.message_of(function() drawn:save(3) end), "save: path: expected a string, got 3")
  spec.equal(spec.message_of(function() figure.lines { series = {} } end),
    "figure.lines: series: expected a list of series from lunid.figure.series (1 or more), got an empty list")
  spec.equal(spec.message_of(function() series { { 1, "a" }, { 1, 2 } } end), "figure.series: x: entry 2: expected a number, got the string 'a'")
end)

spec.case("a place that cannot be written is named", function()
  local drawn = figure.lines { series = { series { { 1, 2 }, { 3, 4 } } } }
  for _, save in ipairs { "save", "export" } do
    local path = "/proc/nowhere/a." .. (save == "save" and "png" or "csv")
    spec.contains(spec.message_of(function() drawn[save](drawn, path) end), path .. ": cannot write: No such file or directory")
  end
  spec.contains(spec.message_of(function() drawn:export(spec.folder .. "/a.vts") end),
    "the figure has no surface: only its numbers can be written, as .csv")
end)

spec.case("without Xvfb a study says what to install, and everything but pictures works", function()
  spec.write("study.lua", [[
local lunid = require "lunid"
local relief = lunid.figure.relief { x = { 0, 1 }, y = { 0, 1 }, z = { { 0, 1 }, { 1, 2 } } }
relief:export "relief.csv"
relief:export "relief.vtu"
lunid.figure.page { { relief } }:save "page.html"
print(select(2, pcall(relief.save, relief, "relief.png")))
]])
  local said, code = spec.lunid("run study.lua --out all-but", "env -u DISPLAY PATH=/nonexistent")
  spec.equal(code, 0)
  spec.contains(said, "relief.png: cannot draw: there is no display, and Xvfb is not installed (apt-get install xvfb)")
  spec.contains(said, "wrote      all-but/page.html, all-but/relief.csv, all-but/relief.vtu")
end)

spec.case("memory is returned: by many figures, by a large one, by a long line", function()
  local said, code = spec.study(spec.resident "VmRSS" .. [[
local lunid = require "lunid"
local function draw(width, dpi, rows)
  local column = lunid.excitation.white_noise { rms = 1, seed = 1, dt = 1e-3, duration = rows/1000 }
  lunid.figure.lines { series = { lunid.figure.series { column:column "t", column:column "F" } }, width = width, height = 6, dpi = dpi }:save "a.png"
end
local function small()
  lunid.figure.lines { series = { lunid.figure.series { { 1, 2, 3 }, { 1, 4, 2 } } }, height = 6, dpi = 60 }:save "a.png"
end
for i = 1, 10 do small() end
local before = resident()
for i = 1, 40 do small() end
print(("many %.1f"):format(resident() - before))
draw(60, 300, 1000)
draw(16, 60, 1000)
print(("large %.1f"):format(resident() - before))
draw(16, 60, 1e6)
draw(16, 60, 1000)
print(("long %.1f"):format(resident() - before))]])
  spec.equal(code, 0)
  -- A window of 60 x 6 cm at 300 dots per inch has 5 million pixels, over 100 MB with its samples; 1e6 points are 16 MB, twice copied.
  for name, most in pairs { many = 5, large = 200, long = 250 } do
    local more = tonumber(said:match(name .. " (%S+)"))
    assert(more < most, said)
  end
end)

spec.case("two runs at once draw the same", function()
  spec.write("study.lua", [[
local lunid = require "lunid"
lunid.figure.lines { series = { lunid.figure.series { { 1, 2, 3 }, { 1, 4, 9 } } } }:save "a.png"
]])
  spec.shell(("{ '%s' run study.lua --out one >/dev/null 2>&1 & '%s' run study.lua --out two >/dev/null 2>&1; wait; }"):format(
    spec.executable, spec.executable))
  spec.equal(spec.shell "cmp one/a.png two/a.png && echo same", "same\n")
end)

spec.clean()
spec.finish()

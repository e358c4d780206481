-- Every error of a user, on its full text with file and line.
local lunid = require "lunid"
local spec = require "spec"

local head = [[
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
]]

--- Runs a study whose line 3 is `line`; its only output must be `expected`.
local function line_3(line, expected)
  local said, code = spec.study(head .. line .. "\n")
  spec.equal(said, expected .. "\n  nothing was written\n")
  spec.equal(code, 1)
end

spec.case("unknown field, with the nearest one", function()
  line_3("lunid.regress { feature = { y } }",
    "study.lua:3: regress: unknown field 'feature', did you mean 'features'?")
  line_3("lunid.least_squares { weight = 1 }", "study.lua:3: least_squares: unknown field 'weight' (it has no fields)")
  line_3("lunid.window { begin = 1 }", "study.lua:3: window: unknown field 'begin' (fields: from, to)")
end)

spec.case("a study that does not begin with the module", function()
  local said = spec.study "print(lunid)\n"
  spec.equal(said, "study.lua:1: undeclared name 'lunid'; begin with local lunid = require \"lunid\"\n  nothing was written\n")
  spec.equal(spec.lunid "check study.lua", "study.lua:1: undeclared name 'lunid'; begin with local lunid = require \"lunid\"\n")
end)

spec.case("a value out of range", function()
  line_3("lunid.lasso { lambda = -1 }", "study.lua:3: lasso: lambda: expected > 0, got -1")
  line_3("lunid.stlsq { threshold = 2 }", "study.lua:3: stlsq: threshold: expected > 0 and < 1, got 2")
end)

spec.case("a name within a list, which would do nothing", function()
  line_3("lunid.model { mass = 1, restoring = { y, weight = 2 } }",
    "study.lua:3: model: restoring: expected a list of expressions or numbers (1 or more) and no named fields, "
      .. "got a table { weight = }")
end)

spec.case("a value of another type", function()
  line_3("lunid.lasso { lambda = {} }",
    "study.lua:3: lasso: lambda: expected a number > 0 or 'cross-validate', got an empty table")
  line_3("lunid.model { mass = 'heavy', restoring = y }",
    "study.lua:3: model: mass: expected an expression or a number, a list of them, or the rows of a matrix, "
      .. "got the string 'heavy'")
  line_3("lunid.model { mass = 1, restoring = y, motion = 'imposd' }",
    "study.lua:3: model: motion: expected 'free' or 'imposed', got the string 'imposd', did you mean 'imposed'?")
  line_3("lunid.model { mass = 1, restoring = y, states = { y, 'z' } }",
    "study.lua:3: model: states: entry 2: expected an expression or a number, got the string 'z'")
end)

spec.case("a required field that is missing", function()
  line_3("lunid.model { mass = 1 }", "study.lua:3: model: missing field 'restoring': an expression or a number, "
    .. "or a list of them")
end)

spec.case("a call without its table", function()
  line_3("lunid.model(3)", "study.lua:3: model: expected a table { ... }, got 3")
  line_3("lunid.fixed(v, 10, 11)", "study.lua:3: fixed: expected 2 arguments, got 3")
  line_3("lunid.model { y, mass = 1 }",
    "study.lua:3: model: unexpected entry 1: an expression; fields are written name = value (fields: mass, "
      .. "restoring, forces, delay, measures, acts, states, interpolation, motion)")
end)

spec.case("a unit is no label: values are SI", function()
  local function unit(text, expected)
    line_3(("lunid.parameter { 'k', 30, unit = '%s' }"):format(text), "study.lua:3: parameter: k: unit: expected an SI unit "
      .. "such as N/m, got '" .. text .. "'" .. expected)
  end
  unit("kN/m", " (1000 N/m): write the value in N/m")
  unit("%", " (0.01): write the value itself, without a unit")
  unit("kN/m^1.5", ": write the value in SI")
  unit("kNs/m", " (1000 N s/m): write the value in N s/m")
  for _, good in ipairs { "", "-", "1", "V", "rad", "N m", "N s/m", "N/m^3", "1/s^2", "N/(m s)", "N (s/m)^p", "s^degree",
    "N/m^1.5", "N.s/m", "N·s/m", "V/T", "ohm", "Ns/m", "Nm/rad", "counts" } do
    lunid.parameter { "k", 30, unit = good }
  end
end)

spec.case("model:with names the field that is wrong", function()
  local function with(rows, expected)
    line_3("local k = lunid.parameter { 'k', 3 } lunid.model { mass = 1, restoring = k*y }:with " .. rows,
      "study.lua:3: with: " .. expected)
  end
  local fields = "(value, min, max, unit, fixed, std)"
  with("{ k = { value = 2e4, fixd = true } }", "k: unknown field 'fixd', did you mean 'fixed'?")
  with("{ k = { 2e4, fixed = true } }", "k: unexpected entry 1: 20000; fields are written name = value, such as value = 3")
  with("{ k = { q = 1 } }", "k: unknown field 'q' (fields: value, min, max, unit, fixed, std)")
  with("{ k = {} }", "k: expected a number or fields " .. fields .. ", got an empty table")
  with("{ k = 0/0 }", "k: expected a number or a table, got nan")
  with("{ k = { min = 0/0 } }", "k: min: expected a number, got nan")
  with("{ k = { fixed = 1 } }", "k: fixed: expected true or false, got 1")
  with("{ k = { unit = 'kN/m' } }",
    "k: unit: expected an SI unit such as N/m, got 'kN/m' (1000 N/m): write the value in N/m")
  with("{ q = 1 }", "the model has no parameter 'q' (parameters: k)")
  with("{ 3 }", "the model has no parameter '1' (parameters: k)")
  with("(3)", "expected a table { k = 3, c = { min = 0 } }, got 3")
end)

spec.case("a row of a model's parameters holds for another one", function()
  local k = lunid.parameter { "k", 3, min = 1, unit = "N/m" }
  local model = lunid.model { mass = 1, restoring = k*lunid.displacement }
  local other = model:with { k = { value = 4, std = 0.1, fixed = true } }
  local row = model:with { k = other.parameters.k }.parameters.k
  spec.equal(("%g %g %g %s"):format(row.value, row.std, row.min, row.fixed), "4 0.1 1 true")
end)

spec.case("what is wrong within a list or a table", function()
  line_3("lunid.regress { record = { 3 }, mass = 1, features = { y } }", "study.lua:3: regress: record: entry 1: expected "
    .. "a record from lunid.read or a stream from lunid.stream, got 3")
  line_3("lunid.simulate { model = lunid.model { mass = 1, restoring = y }, excitation = 0, from = { 1 } }",
    "study.lua:3: simulate: from: expected 'record' or a list of numbers (2 or more), got a list of one: 1")
  line_3("lunid.simulate { model = { lunid.model { mass = 1, restoring = y } } }",
    "study.lua:3: simulate: model: expected a model from lunid.model, got a list of one: a model")
  line_3("lunid.model { mass = 1, restoring = y, measures = { y = 'y + b' } }",
    "study.lua:3: model: measures: y: expected an expression or a number, got the string 'y + b'")
  line_3("lunid.model { mass = { 1, 'a' }, restoring = { y, v } }",
    "study.lua:3: model: mass: entry 2: expected an expression or a number, got the string 'a'")
  line_3("lunid.model { mass = { { 1, 'a' }, { 0, 1 } }, restoring = { y, v } }",
    "study.lua:3: model: mass: entry 1: entry 2: expected an expression or a number, got the string 'a'")
  line_3("lunid.model { mass = 1, restoring = {} }",
    "study.lua:3: model: restoring: expected an expression or a number, or a list of them, got an empty list")
  line_3("lunid.polynomials { variables = { y, v }, order = 3 }", "study.lua:3: polynomials: expected "
    .. "lunid.polynomials(variables, order, options), got a table { order = , variables = }")
  line_3("lunid.record { channels = 3, dt = 1 }", "study.lua:3: record: channels: expected a list of tables (1 or more), got 3")
  local rows = "local rows = { 1, 2, 4, 3, 2, 1, 0 } "
  for channel, said in pairs { ['{ "y", rows, unit = "mm" }'] = "'y': unit: expected an SI unit such as N/m, got 'mm' (0.001 m): write the value in m",
    ['{ "y", rows, unit = 3 }'] = "'y': unit: expected a string, got 3",
    ['{ "y", rows, units = "m" }'] = "'y': unknown field 'units' (fields: unit)",
    ['{ rows, "y" }'] = "entry 1: expected { name, column }, got { a table, ... }" } do
    line_3(rows .. "lunid.record { dt = 1, channels = { " .. channel .. " } }", "study.lua:3: record: channels: " .. said)
  end
  line_3("lunid.scoreboard { models = { 3 } }", "study.lua:3: scoreboard: models: entry 1: expected a list (2 or more), got 3")
end)

spec.case("a plain list is the first field that takes one", function()
  local statistics, x, z = lunid.statistics, {}, {}
  for i = 1, 60 do x[i], z[i] = math.sin(i) + i % 7, math.cos(i*i) end
  spec.equal(statistics.ljung_box(x), statistics.ljung_box { x })
  spec.equal(statistics.ljung_box(x, { lags = 4 }), statistics.ljung_box { x, lags = 4 })
  spec.equal(statistics.kolmogorov_smirnov(x, z), statistics.kolmogorov_smirnov { x, z })
  spec.equal(tostring(statistics.cross_correlation(x, z)), tostring(statistics.cross_correlation { x, z }))
  spec.equal(#lunid.figure.histogram(x).panels, 1)
  line_3("lunid.statistics.ljung_box { 1, 2, 'a' }",
    "study.lua:3: statistics.ljung_box: x: entry 3: expected a number, got the string 'a'")
  line_3("local s = lunid.figure.series { { 1, 2 }, { 3, 4 } } lunid.figure.history { s, s }",
    "study.lua:3: figure.history: several go in one list: lunid.figure.history { { a series, a series } }")
  line_3("lunid.model({ mass = 1, restoring = y }, 3)", "study.lua:3: model: expected a table { ... }, got 2 arguments")
end)

spec.case("what Lua itself would say of an expression in a riddle", function()
  line_3("local f = math.sin(2*y)", "study.lua:3: math.sin: expected a number, got an expression: write lunid.sin(2*y)")
  line_3("local f = math.max(1, y)", "study.lua:3: math.max: expected a number, got an expression: write lunid.max(1, y)")
  line_3("local f = math.floor(y)",
    "study.lua:3: math.floor: expected a number, got an expression: the language has no such function")
  line_3("local f = math.sin 'a'", "study.lua:3: math.sin: expected a number, got the string 'a'")
  line_3("local given = {} local f = 3*y + given.k",
    "study.lua:3: '+': the right side is nothing: a name or a field that has no value (... + nil)")
  line_3("local given = {} local f = given.k/y",
    "study.lua:3: '/': the left side is nothing: a name or a field that has no value (nil / ...)")
  line_3("local f = y^{}", "study.lua:3: '^': the right side: expected a number or an expression, got a table")
  line_3("local f = y % 2", "study.lua:3: '%': an expression has no remainder; of a periodic one write lunid.sin or lunid.cos")
  line_3("local f = y // 2", "study.lua:3: '//': an expression has no whole division; write '/'")
  line_3("local f = y[1]", "study.lua:3: an expression is no list and has no [1]; several come as several values: local y1, y2 = lunid.displacements(2)")
  line_3("local f = y:tex()", "study.lua:3: an expression has no 'tex' (methods: at derivative symbols text)")
  line_3("local f = y(2)", "study.lua:3: an expression is no function: write '*' for a product, and k:at { y = 1 } for its value")
end)

spec.case("Lua's math of numbers is as it was", function()
  spec.near(math.sin(0.5), 0.479425538604203, 1e-15)  -- this spec is a study
  spec.near(math.atan(1, 2), 0.463647609000806, 1e-15)
  spec.equal(math.max(1, 3, 2), 3)
  spec.equal(math.log(8, 2), 3.0)
  spec.equal(math.floor(2.5), 2)
  spec.equal(math.sqrt "4", 2.0)
end)

spec.case("a parameter without a value", function()
  local function parameter(text, expected)
    line_3("local k = lunid.parameter { 'k' } local m = lunid.model { mass = 1, restoring = k*y } " .. text, "study.lua:3: " .. expected)
  end
  local todo = ": parameter 'k' has no value: model:with { k = ... }, or fit it first"
  parameter("print((k*y):at { y = 1 })", "at: parameter 'k' has no value: give it here too, at { k = ... }")
  parameter("lunid.simulate { model = m, excitation = 0, duration = 1, dt = 0.1 }", "simulate" .. todo)
  parameter("lunid.frequency_response { model = m, amplitude = 1, from = 1, to = 2 }", "frequency_response" .. todo)
  parameter("lunid.backbone { model = m, from = 1, to = 2 }", "backbone" .. todo)
  local record = "local r = lunid.record { dt = 0.1, channels = { { 'F', { 1, 2, 1, 2, 1, 2, 1, 2 } }, { 'y', { 1, 2, 3, 4, 3, 2, 1, 0 } } } } "
  parameter(record .. "lunid.compare { model = m, record = r }", "compare" .. todo)
  parameter(record .. "m:force(r)", "force" .. todo)
  parameter(record .. "lunid.fit_trajectory { model = m, record = r }",
    "fit_trajectory: parameter 'k' has no first guess: write model:with { k = ... }")
  parameter(record .. "lunid.locate { model = m, record = r, place = 'y2' }",
    "locate: place: the model has one coordinate: leave it out, got 'y2'")
  parameter(record .. "r:window('a')", "argument 1: expected a number, got the string 'a'")
  parameter(record .. "lunid.figure.motion(r):save 'x.gif'", "save: expected a folder, which gets the frames as PNG files, "
    .. "got 'x.gif'; another tool makes a film of them")
end)

spec.case("a shortened name is nearest to what it is short for", function()
  local text = spec.message_of(function()
    lunid.effect { name = "mm", family = "damping", contribution = "k*sgn(v)", parameters = { { "k" } } }
  end)
  spec.contains(text, "unknown function 'sgn', did you mean 'sign'?")
end)

spec.case("names that cannot be", function()
  line_3("lunid.parameter { 'k 2' }", "study.lua:3: parameter: name: expected letters, digits and _, got 'k 2'")
  line_3("lunid.parameter { 'end' }", "study.lua:3: parameter: name: 'end' is a word of Lua; choose another")
end)

spec.case("bounds", function()
  line_3("lunid.parameter { 'k', 5, min = 6 }",
    "study.lua:3: parameter: k: value: expected within 6 to inf, got 5")
  line_3("lunid.window { from = 3, to = 2 }", "study.lua:3: window: to: expected > from, which is 3, got 2")
end)

spec.case("an unknown word of the module", function()
  line_3("lunid.regres {}", "study.lua:3: lunid has no 'regres', did you mean 'regress'?")
  line_3("lunid.figure.line {}", "study.lua:3: lunid.figure has no 'line', did you mean 'lines'?")
  line_3("lunid.read = 3", "study.lua:3: lunid.read cannot be assigned")
end)

spec.case("undeclared globals, read and written", function()
  line_3("print(vv)", "study.lua:3: undeclared name 'vv', did you mean 'v'?")
  line_3("speed = 3", "study.lua:3: assignment to the undeclared name 'speed'; write `local speed = ...`")
end)

spec.case("an error inside a function is blamed on its line", function()
  local said = spec.study(head .. "local function f()\n  return lunid.sin('x')\nend\nf()\n")
  spec.equal(said, "study.lua:4: sin: argument 1: expected a number or an expression, got the string 'x'\n"
    .. "  nothing was written\n")
end)

spec.case("comparison of expressions", function()
  line_3("local low = y <= 3", "study.lua:3: an expression cannot be compared by < <= > >=, because Lua makes a boolean "
    .. "of it: write lunid.at_most(a, b), lunid.at_least(a, b) for a constraint, or lunid.less(a, b), "
    .. "lunid.greater(a, b) for the condition of lunid.where")
end)

spec.case("syntax", function()
  local said, code = spec.study(head .. "local k = = 3\n")
  spec.equal(said, "study.lua:3: unexpected symbol near '='\n  nothing was written\n")
  spec.equal(code, 1)
end)

spec.case("a model that cannot be", function()
  line_3("local y1, y2 = lunid.displacements(2); lunid.model { mass = { 1, 1 }, restoring = { y1, y2 }, motion = 'imposed' }",
    "study.lua:3: model: motion can be imposed on one coordinate, got 2")
  line_3("lunid.model { mass = -2, restoring = y }", "study.lua:3: model: mass: expected > 0, got -2 (a mass of 0 needs imposed "
    .. "motion)")
  line_3("lunid.model { mass = { 1, 2 }, restoring = y }",
    "study.lua:3: model: mass: expected 1 entry, as many as restoring forces, got 2")
  line_3("lunid.model { mass = { { 1, 2 }, { 1 } }, restoring = { y, v } }",
    "study.lua:3: model: mass: row 2: expected 2 entries, got 1")
  line_3("lunid.model { mass = { 1, 1 }, restoring = { lunid.displacements(2), y } }",
    "study.lua:3: model: restoring of y2: cannot hold the channel 'y' (it may hold y1 y2 v1 v2 a1 a2 t yb vb ab)")
  line_3("lunid.model { mass = { 1, 1 }, restoring = { 1, 2 }, forces = { 3 } }",
    "study.lua:3: model: forces: expected coordinates from 1 to 2, got 3")
  line_3("lunid.model { mass = 1, restoring = y, delay = -0.1 }", "study.lua:3: model: delay: expected >= 0, got -0.1")
  line_3("lunid.model { mass = 1, restoring = y, delay = y }",
    "study.lua:3: model: delay: cannot hold the channel 'y' (it may hold parameters alone)")
  line_3("lunid.chain { masses = { 1 }, element = function() end }",
    "study.lua:3: chain: element: expected the function to return an expression, got nothing")
end)

spec.case("an excitation that does not fit the model", function()
  local simulate = "lunid.simulate { model = lunid.model { mass = 1, restoring = y }, duration = 1, dt = 0.01, "
  line_3(simulate .. "excitation = { yb = 1 } }",
    "study.lua:3: excitation: yb: drives nothing in this model; its inputs are F")
  line_3(simulate .. "excitation = {} }", "study.lua:3: simulate: excitation: the table is empty")
  line_3(simulate .. "excitation = { F = 'big' } }",
    "study.lua:3: simulate: excitation: F: expected an expression or a number, got the string 'big'")
end)

spec.case("a run that cannot be", function()
  local model = "lunid.model { mass = 1, restoring = y }"
  line_3("lunid.simulate { model = " .. model .. ", excitation = lunid.time, duration = 1, dt = 0.1, rtol = 1e-15 }",
    "study.lua:3: simulate: rtol: 1e-15 is below what rounding leaves; the least is 2.22045e-14")
  line_3("lunid.simulate { model = " .. model .. ", excitation = lunid.time, duration = 1, dt = 1e-9 }",
    "study.lua:3: simulate: 1e+09 output points need 176 GB of memory, more than max_memory = 8 GB; take a longer dt or "
      .. "a shorter duration, or allow more")
  line_3("lunid.simulate { model = " .. model .. ", excitation = lunid.time, duration = 10, dt = 0.1, max_memory = 1e-5 }",
    "study.lua:3: simulate: 101 output points need 1.7776e-05 GB of memory, more than max_memory = 1e-05 GB; take a "
      .. "longer dt or a shorter duration, or allow more")
  line_3("lunid.model { mass = 1, restoring = y + lunid.state { 'z' } }",
    "study.lua:3: state: missing field 'rate': an expression or a number or a function")
  line_3("local r = lunid.simulate { model = lunid.model { mass = 1, restoring = y + 1/y }, excitation = 0, "
    .. "duration = 1, dt = 0.1 } error(tostring(r), 0)",
    "run of 11 rows at 10 Hz: stopped at t = 0 s: the term 1/y has no finite value at the start, t = 0 s, "
      .. "y = 0 m, v = 0 m/s\n  asked for at study.lua:3")
  line_3("lunid.simulate { model = lunid.model { mass = 1, restoring = y + 1/y }, excitation = 0, duration = 1, "
    .. "dt = 0.1 }:save 'run.csv'",
    "study.lua:3: run: there is no row to keep: the term 1/y has no finite value at the start, t = 0 s, y = 0 m, v = 0 "
      .. "m/s")
  line_3("lunid.simulate { model = lunid.model { mass = 0, restoring = 5*y, motion = 'imposed' }, excitation = 0, "
    .. "duration = 1, dt = 0.1 }", "study.lua:3: simulate: the motion of this model is imposed: there is no free run; "
    .. "model:force(record) is its force along a motion")
  line_3("lunid.ensemble { model = lunid.model { mass = 0, restoring = 5*y, motion = 'imposed' }, excitation = 0, "
    .. "duration = 1, dt = 0.1 }", "study.lua:3: ensemble: the motion of this model is imposed: there is no free run")
  line_3("lunid.simulate { model = " .. model .. ", excitation = 0, duration = 1, dt = 0.1, from = { 1, 2, 3 } }",
    "study.lua:3: simulate: from: expected 2 values (y v), got 3")
  line_3("local z = lunid.state { 'z', rate = v } lunid.simulate { model = lunid.model { mass = 1, restoring = z }, "
    .. "excitation = 0, duration = 1, dt = 0.1, from = { 1, 2, 3, 4 } }",
    "study.lua:3: simulate: from: expected 2 to 3 values (y v z), got 4")
  line_3("lunid.model { mass = 1, restoring = y, states = { lunid.parameter { 'z' } } }",
    "study.lua:3: model: states: expected states from lunid.state, got z")
  line_3("local r = lunid.simulate { model = lunid.model { mass = 1, restoring = y - 1000*(1 - y^2)*v }, excitation = 0, "
    .. "from = { 2, 0 }, duration = 1000, dt = 500, solver = 'rk45' } error(r.summary.cause:gsub('%d+%.%d+', '#'), 0)",
    "the model is stiff: its fastest decay, # s, holds the steps of ARKODE ERK Dormand-Prince 5(4) down to # s; take "
      .. "solver = \"bdf\" or \"esdirk\"")
  spec.write("short.csv", "t,F,y\n0,0,0\n0.1,1,0\n0.2,1,0\n0.3,1,0\n0.4,1,0\n0.5,1,0\n")
  line_3("lunid.simulate { model = " .. model .. ", excitation = lunid.read 'short.csv', duration = 2 }",
    "study.lua:3: simulate: duration: the excitation lasts 0.5 s, got 2 s")
  line_3("lunid.simulate { model = " .. model .. ", excitation = lunid.read 'short.csv', dt = 0.03 }",
    "study.lua:3: simulate: dt: expected the sample time of the record, 0.1 s, or a whole part of it, got 0.03 s")
  line_3("local r = lunid.simulate { model = " .. model .. ", excitation = lunid.read 'short.csv' } r:at(0.6)",
    "study.lua:3: at: t: expected within the run, 0 to 0.5 s, got 0.6")
  line_3("lunid.model { restoring = y }", "study.lua:3: model: missing field 'mass': an expression or a number, a list of them, or the rows of a matrix")
  line_3("lunid.model { mass = 1, restoring = y + lunid.tanh(lunid.acceleration) }",
    "study.lua:3: model: restoring: terms in a must be a times something without a, got tanh(a)")
end)

spec.case("a guess of the user's own effect that fails", function()
  spec.write("record.csv", (function()
    local rows = { "t,F,y" }
    for i = 0, 400 do rows[#rows + 1] = ("%.3f,%.17g,%.17g"):format(i * 0.01, math.sin(i * 0.1), math.sin(i * 0.1 + 1)) end
    return table.concat(rows, "\n") .. "\n"
  end)())
  local said, code = spec.study(head .. [[
local magnet = lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(p*y)",
  parameters = { { "k" }, { "p" } }, guess = function(scale) return { { p = scale.nothing / 2 } } end }
lunid.discover { model = lunid.model { mass = 1, restoring = 0 }, train = lunid.read "record.csv",
  catalogue = { "cubic_stiffness" }, effects = { magnet } }
]])
  spec.contains(said, "effect magnet: guess: study.lua:4: attempt to perform arithmetic on a nil value (field 'nothing')")
  spec.equal(code, 1)
end)

spec.case("guesses that are no values of the effect's parameters", function()
  local function guess(returned, expected)
    local said = spec.study(head .. ([[
local magnet = lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(p*y)",
  parameters = { { "k" }, { "p", min = 0 } }, guess = function() return %s end }
lunid.discover { model = lunid.model { mass = 1, restoring = 0 }, train = lunid.read "record.csv",
  catalogue = { "cubic_stiffness" }, effects = { magnet } }
]]):format(returned))
    spec.contains(said, "study.lua:5: effect magnet: guess: " .. expected .. "\n")
  end
  guess("{ { q = 1 } }", "unknown parameter 'q' (k, p)")
  guess("{ p = 1 }", "expected a list { { k = ... }, ... }, got a table that is no list")
  guess("3", "expected a list { { k = ... }, ... }, got 3")
  guess("{ 3 }", "entry 1: expected { k = ... }, got 3")
  guess("{ { p = -1 } }", "p: expected a number >= 0, got -1")
  guess("{ { p = 0/0 } }", "p: expected a number >= 0, got nan")
end)

spec.case("an effect whose definition cannot be meant", function()
  local function effect(fields, expected)
    line_3("lunid.effect { name = 'mm', family = 'stiffness', " .. fields .. " }", "study.lua:3: effect: mm: " .. expected)
  end
  local function states(fields, expected)
    effect("contribution = 'k*y', parameters = { { 'k' } }, states = " .. fields, "states: " .. expected)
  end
  states("{ z = 'k*v' }", "z: expected { rate = ... }, got the string 'k*v'")
  states("{ z = 3 }", "z: expected { rate = ... }, got 3")
  states("{ z = { 'k*v' } }", "z: unexpected entry 1: the string 'k*v'; write rate = ...")
  states("{ 'k*v' }", "expected z = { rate = ... }, got entry 1: the string 'k*v'")
  states("{ z = {} }", "z: missing field 'rate': a string or an expression or a number")
  states("{ z = { rat = 'v' } }", "z: unknown field 'rat', did you mean 'rate'?")
  states("{ z = { rate = 'v', initial = 'a' } }", "z: initial: expected a number, got the string 'a'")
  states("{ k = { rate = 'v' } }", "'k' is a parameter already")
  local function parameters(rows, expected)
    effect("contribution = 'k*y', parameters = " .. rows, "parameters: " .. expected)
  end
  parameters("{ { 'k', min = 'a' } }", "k: min: expected a number, got the string 'a'")
  parameters("{ { 'k', min = 3, max = 2 } }", "k: min: expected <= max, which is 2, got 3")
  parameters("{ { 'k', fixed = 'yes' } }", "k: fixed: expected true or false, got the string 'yes'")
  parameters("{ { 'k', unit = 'kN/m' } }",
    "k: unit: expected an SI unit such as N/m, got 'kN/m' (1000 N/m): write the value in N/m")
  parameters("{ { 'k' }, { 'k' } }", "'k' is there twice")
  parameters("{ { 'k' }, { 'q' } }", "nothing uses 'q'; name it in the contribution or in a state's rate, or leave it out")
  effect("contribution = 'k*y', parameters = { { 'k' } }, separate = { kk = 'F' }", "separate: no parameter 'kk', did you mean 'k'?")
  effect("contribution = 'k*y', parameters = { { 'k' } }, separate = { k = 1 }", "separate: k: expected a channel, got 1")
  local function maps(fields, expected) effect(fields .. ", parameters = { { 'k' } }", expected) end
  maps("measures = { 'y + k' }", "measures: expected { y = ... }, or a list of them, got the string 'y + k'")
  maps("measures = {}", "measures: expected { y = ... }, or a list of them, got an empty table")
  maps("acts = { 'k*F' }", "acts: expected { F = ... }, or a list of them, got the string 'k*F'")
end)

spec.case("what a report cannot show", function()
  local function report(call, expected)
    local said, code = spec.study(head .. "local r = lunid.report { title = 'T' } r" .. call .. "\n")
    spec.equal(said, "\nT\n=\nstudy.lua:3: report:" .. expected .. "\n  nothing was written\n")
    spec.equal(code, 1)
  end
  report(":table { head = { 'a' }, rows = { 3 } }", "table: row 1: expected a list of cells, got 3")
  report(":table { head = { {} }, rows = {} }", "table: head: entry 1: expected a string, got a table")
  report(":table { head = { 'a' }, rows = { { 1, 2 } } }",
    "table: row 1: expected at most 1 cells, as many as the head has, got a cell 2: 2")
  report(":table { head = { 'a' }, rows = { { {} } } }", "table: row 1: cell 1: expected a text or a number, got a table")
  report(":table { head = { 'a' }, rows = {}, captoin = 'x' }", "table: unknown field 'captoin' (fields: head, rows, caption)")
  report(":results(3)", "results: expected a table { name = value }, got 3")
  report(":results { 1 }", "results: expected name = value, got entry 1: 1")
  report(":progress('a', 'b', 'c')", "progress: done: expected a whole number, got the string 'b'")
  report(":save 'y.html'", "save: takes no path: it writes report.html to the directory of --out, got the string 'y.html'")
  report(":figure('x', 3)", "figure: expected report:figure(name, figure, caption), got 3 for the figure")
  report(".text 'x'", "text: expected report:text(...), with a colon")
end)

spec.case("an effect that does not exist", function()
  line_3("lunid.discover { model = lunid.model { mass = 1, restoring = y }, train = {}, catalogue = { 'x' } }",
    "study.lua:3: discover: train: expected a record from lunid.read or a list of records from lunid.read (1 or more), "
    .. "got an empty list")
end)

spec.case("check finds what would stop a study, and nothing else", function()
  spec.write("good.lua", head .. [[
local k = lunid.parameter { "k", min = 0 }
local function stiffness(factor, ...)
  local first <const> = ...
  for i, each in ipairs { factor, first } do print(i, each) end
  return factor*k
end
goto done
::done::
print(lunid.model { mass = 1, restoring = stiffness(2)*y + v }, "restorin = 3", [=[ undeclared ]=])
]])
  spec.equal(spec.lunid "check good.lua", "good.lua: nothing that would stop it\n")
  spec.write("bad.lua", head .. [[
lunid.model { mass = 1, restorin = y }
print(speed)
lunid.regres {}
if y == 3 then print(v) end
]])
  local said, code = spec.lunid "check bad.lua"
  spec.equal(said, "bad.lua:3: model: unknown field 'restorin', did you mean 'restoring'?\n"
    .. "bad.lua:4: undeclared name 'speed'\n"
    .. "bad.lua:5: lunid has no 'regres', did you mean 'regress'?\n"
    .. "bad.lua:6: warning: '==' with the expression 'y' compares identity at once and gives true or false; for a "
    .. "condition use lunid.greater, lunid.less and lunid.where\n")
  spec.equal(code, 1)
end)

spec.case("check finds wrong values that are written out, unknown effects and missing files", function()
  local function checked(body)
    spec.write("literal.lua", head .. body)
    return spec.lunid "check literal.lua"
  end
  spec.write("there.csv", "t,y\n0,1\n")
  local said, code = checked [[
local a, b = lunid.read "there.csv", lunid.read("there.csv", { displacment = "y [mm]", window = { 0, 2 } })
local c = lunid.read "nowhere.csv"
lunid.discover { model = c, train = a, catalogue = { "cubic_stifness" }, alpha = 3, without = { "clearance" } }
lunid.effect { name = "q", family = "spring", contribution = "k*y^2", parameters = { { "k" } } }
print(max(y, 0))
]]
  spec.equal(code, 1)
  local lines = {}
  for line in said:gmatch "[^\n]+" do lines[#lines + 1] = line end
  spec.equal(lines[1], "literal.lua:3: read: unknown field 'displacment', did you mean 'displacement'?")
  spec.equal(lines[2], "literal.lua:3: read: window: expected a window from lunid.window, got a list of 2")
  spec.equal(lines[3], "literal.lua:4: no such file: 'nowhere.csv'")
  spec.equal(lines[4], "literal.lua:5: discover: catalogue: unknown effect 'cubic_stifness', did you mean 'cubic_stiffness'?")
  spec.contains(lines[5], "literal.lua:5: discover: alpha: expected > 0 and < 0.5, got 3")
  spec.contains(lines[6], "literal.lua:6: effect: family: expected ")
  spec.equal(lines[7], "literal.lua:7: undeclared name 'max', did you mean lunid.max?")
  spec.equal(#lines, 7)
  -- A study may write what it reads, and values may be computed.
  said, code = checked [[
local path = "x" .. ".csv"
lunid.record { dt = 1, channels = { { "y", { 1, 2, 3, 4, 5, 6 } } } }:save "/tmp/part.csv"
print(lunid.read "part.csv", lunid.read("there" .. ".csv"), lunid.read(path, { rate = 2*50, columns = "y=" .. path }))
]]
  spec.equal(said, "literal.lua:5: warning: no such file: 'part.csv'\nliteral.lua: nothing that would stop it\n")
  spec.equal(code, 0)
  spec.contains(spec.study(head .. "print(max(y, 0))\n"), "study.lua:3: undeclared name 'max', did you mean lunid.max?")
  spec.contains(spec.study(head .. "lunid.report { 'soil' }\n"),
    "report: unexpected entry 1: the string 'soil'; fields are written name = value (fields: ")
end)

spec.case("an option of the command line that the study does not read", function()
  spec.write("study.lua", head .. "local n = lunid.option { 'count', 3 }\nprint(n + 1)\n")
  local said, code = spec.lunid "run study.lua count=4 --out study-out"
  spec.equal(said, "5\n")
  spec.equal(code, 0)
  said, code = spec.lunid "run study.lua cout=4 --out study-out"
  spec.contains(said, "the study has no option 'cout', did you mean 'count'?")
  spec.equal(code, 2)
  said, code = spec.lunid "run study.lua count=four --out study-out"
  spec.contains(said, "option: count: expected a number, got 'four'")
  spec.equal(code, 2)
end)

spec.clean()
spec.finish()

-- What the ground does to the pile, as far as gauges tell: a shaft whose friction slips part by part, grows with the embedded depth and
-- wears with the path that it has slipped; a toe that yields and lets go; a plug of soil that is torn loose. Fitted to tests 1 to 3,
-- which have two frequencies and two rates of lowering between them.
local lunid = require "lunid"
local y, v, abs = lunid.displacement, lunid.velocity, lunid.abs
local lines, series = lunid.figure.lines, lunid.figure.series

local ground = {}

--- A test as a record from one time to another, with the head's force, its difference to the tip's, or the tip's as F; the gauges are
--- `delay` samples late. y is the penetration since the test began.
function ground.part_of(test, force, from, to, delay)
  local gauges, shown = test.gauges, {}
  local n = #gauges.t
  for i = 1, n do
    local at = math.min(n, i + delay)
    shown[i] = force == "shaft" and gauges.head[at] - gauges.tip[at] or force == "tip" and gauges.tip[at] or gauges.head[at]
  end
  return lunid.record { name = test.name, dt = gauges.dt, channels = { { "F", shown }, { "y", gauges.y }, { "v", gauges.v },
    { "a", gauges.a } } }:window(from, to)
end

--- The path that the pile has gone by a time, up and down: the integral of |v|.
function ground.path(test, time)
  local sum, dt = 0, test.gauges.dt
  for i = 1, math.floor(time/dt + 0.5) do sum = sum + math.abs(test.gauges.v[i])*dt end
  return sum
end

-- ---- elements ----

local function free(name, guess, min, unit, max) return lunid.parameter { name, guess, min = min, max = max, unit = unit } end

--- Parallel slip elements of one stiffness whose limits are spread evenly from 0 to twice their mean (Iwan 1966), and Smith's J.
local function shaft_force(limit, stiffness, J)
  local count, sum = 3, 0
  for i = 1, count do
    local reach = limit/stiffness*(2*i - 1)/count
    sum = sum + lunid.state { "slip" .. i, rate = v, min = -reach, max = reach }
  end
  local force = stiffness/count*sum
  return force + J*abs(force)*v
end

--- Smith's toe, a damper, and the plug, which may be left out.
local function tip_force(p, with_plug)
  local force = lunid.effects.smith_toe { Ru = p.Rt, q = p.qt, J = p.Jt } + p.cp*v
  return with_plug and force + lunid.effects.soil_plug { mp = p.mp, k = p.kp, Fs = p.Fp } or force
end

local function imposed(mass, restoring) return lunid.model { motion = "imposed", mass = mass, restoring = restoring } end

-- ---- what is fitted ----

--- Smith's elements for both parts, with which the delay of the gauges is found.
function ground.smith(tests, delay)
  local shaft, tip = {}, {}
  for _, test in ipairs { tests[1], tests[3] } do
    for _, from in ipairs { 3, 9 } do
      shaft[#shaft + 1] = ground.part_of(test, "shaft", from, from + 0.5, delay)
      tip[#tip + 1] = ground.part_of(test, "tip", from, from + 0.5, delay)
    end
  end
  local friction = lunid.effects.smith_shaft { Ru = free("Rs", 800, 1, "N"), q = free("qs", 1e-3, 1e-4, "m", 2e-2), J = free("Js", 0.2, 0, "s/m") }
  local toe = tip_force { Rt = free("Rt", 3000, 1, "N"), qt = free("qt", 1.5e-3, 1e-4, "m", 2e-2), Jt = free("Jt", 0.2, 0, "s/m"),
    cp = free("cp", 100, 0, "N s/m") }
  return lunid.fit_trajectory { model = imposed(free("mb", 45, 10, "kg"), friction + free("offset_s", -400, nil, "N")), record = shaft },
    lunid.fit_trajectory { model = imposed(free("mt", 8, 0, "kg"), toe + free("offset_t", -80, nil, "N")), record = tip }
end

--- The times that lie a second within a test.
local function starts(test, times)
  local list = {}
  for _, from in ipairs(times) do
    if from + 1 <= test.duration then list[#list + 1] = from end
  end
  return list
end

--- mb*a + shaft + offset = Fh - Gt over short windows, each with a limit of friction of its own; and where and when that limit was found.
local function fit_shaft(tests, delay, embedded)
  local records, places = {}, { path = {}, depth = {}, limit = {} }
  for i = 1, 3 do
    for _, from in ipairs(starts(tests[i], { 2, 3, 4.5, 6.5, 9.5, 14, 20, 28, 39 })) do
      local k = #records + 1
      records[k] = ground.part_of(tests[i], "shaft", from, from + 0.3, delay)
      places.path[k] = ground.path(tests[i], from + 0.15)
      places.depth[k] = tests[i].gauges.y[math.floor((from + 0.15)/tests[i].gauges.dt)]
    end
  end
  local force = shaft_force(free("Rs", 500, 1, "N"), free("ks", 8e5, 1e3, "N/m^2", 1e8)*(embedded + y), free("Js", 0.3, 0, "s/m"))
  local fit = lunid.fit_trajectory { model = imposed(free("mb", 42, 10, "kg"), force + free("os", -400, nil, "N")), record = records,
    separate = { "Rs" } }
  for i, model in ipairs(fit.models) do places.limit[i] = model.parameters.Rs.value end
  return fit, places
end

--- How the limit follows the path and the depth: friction per depth falls from r0 to ri over a path s0; fresh soil adds g per depth.
local function limit_of(embedded, depth, path, p, exp) return (embedded + depth)*(p.ri + (p.r0 - p.ri)*exp(-path/p.s0)) + p.g*depth end

local function fit_limit(places, embedded)
  local p = { ri = free("ri", 300, 0, "N/m"), r0 = free("r0", 1000, 0, "N/m"), s0 = free("s0", 1, 0.05, "m", 50), g = free("g", 500, 0, "N/m") }
  return lunid.fit_curve { data = places, response = lunid.channel "limit",
    formula = limit_of(embedded, lunid.channel "depth", lunid.channel "path", p, lunid.exp) }
end

local function values_of(curve)
  local values = {}
  for _, name in ipairs { "ri", "r0", "s0", "g" } do values[name] = curve.parameters[name].value end
  return values
end

--- mt*a + tip + offset = Gt over longer windows, with a plug and without.
local function fit_tip(tests, delay, with_plug)
  local records = {}
  for i = 1, 3 do
    for _, from in ipairs(starts(tests[i], { 3, 6, 9, 20, 38 })) do records[#records + 1] = ground.part_of(tests[i], "tip", from, from + 0.8, delay) end
  end
  local p = { Rt = free("Rt", 2000, 1, "N"), qt = free("qt", 1.5e-3, 1e-4, "m", 2e-2), Jt = free("Jt", 0.2, 0, "s/m"), cp = free("cp", 300, 0, "N s/m"),
    mp = free("mp", 8, 0.1, "kg"), kp = free("kp", 1e6, 1e3, "N/m"), Fp = free("Fp", 500, 1, "N") }
  return lunid.fit_trajectory { model = imposed(free("mt", 8, 0, "kg"), tip_force(p, with_plug) + free("ot", -80, nil, "N")), record = records }
end

-- ---- the whole ----

local function found_delay(report, tests)
  local best, rows = nil, {}
  for delay = 0, 3 do
    local shaft, tip = ground.smith(tests, delay)
    local cost, p = shaft.summary.cost + tip.summary.cost, shaft.model.parameters
    if not best or cost < best.cost then best = { delay = delay, cost = cost, shaft = shaft, tip = tip } end
    rows[delay + 1] = { delay, shaft.summary.rmse, tip.summary.rmse, ("%.4g +- %.2g"):format(p.mb.value, p.mb.std or 0/0), ("%.3g"):format(p.Rs.value),
      ("%.3g"):format(1e3*p.qs.value), ("%.3g"):format(p.Js.value) }
  end
  if report then report:table { head = { "delay of the gauges [samples]", "shaft RMSE [N]", "tip RMSE [N]", "mb [kg]", "Rs [N]", "quake [mm]", "J [s/m]" },
    rows = rows, caption = "mb*a + Smith's shaft element + offset = Fh - Gt on tests 1 and 3 together: the least error gives delay and mass between the gauges" } end
  return best
end

local function show(report, smith, shaft, places, curve, plain, tip, embedded)
  report:table { head = { "part", "elements", "RMSE [N]" }, rows = {
    { "shaft", "Smith's", smith.shaft.summary.rmse }, { "shaft", "three slip elements, stiffer with depth, a limit for each window", shaft.summary.rmse },
    { "tip", "Smith's toe and a damper", plain.summary.rmse }, { "tip", "and a plug of soil", tip.summary.rmse } },
    caption = "What each step explains (other windows for Smith's shaft). The plug's mass is no column of its own at one frequency" }
  local order, x, fitted = {}, {}, {}
  for i = 1, #places.path do order[i] = i end
  table.sort(order, function(a, b) return places.path[a] < places.path[b] end)
  local p = values_of(curve)
  for k, i in ipairs(order) do
    x[k] = places.path[i]
    fitted[k] = limit_of(embedded, places.depth[i], places.path[i], p, math.exp)
  end
  report:figure("shaft_limit", lines { x = "path of the pile [m]", y = "limit of the shaft's friction [N]", series = {
    series { places.path, places.limit, label = "each window by itself", role = "measured", style = "points" },
    series { x, fitted, label = "of path and depth", role = "final", style = "line_points" } } },
    ("Wear and depth: the limit of friction found in %d windows of tests 1 to 3, and a law of the path and the depth (R2 %.3f)"):format(#places.path,
      curve.r2))
end

local function alone(restoring) return imposed(0, restoring) end

--- The answer as { whole =, shaft =, tip = }: the equation of motion under the head's force, and its parts along a motion that is given.
--- path: that the pile has gone before.
function ground.model(found, path)
  local worn = lunid.state { "worn", rate = abs(v), initial = path }
  local shaft = shaft_force(lunid.max(limit_of(found.embedded, y, worn, found, lunid.exp), 1), found.ks*(found.embedded + y), found.Js)
  local tip = tip_force(found, true)
  return { whole = lunid.model { mass = found.mb + found.mt, restoring = shaft + tip + found.os + found.ot }, shaft = alone(shaft), tip = alone(tip) }
end

-- ---- the penetration ----

--- How much too fast a free run sinks in each test, 2 to 10 s, with `less` newtons on the head: 0 is the rate that the gauges measured.
local function too_fast(found, tests, less)
  local off = {}
  for i, test in ipairs { tests[1], tests[2], tests[3] } do
    local pushed = setmetatable({ os = found.os + less }, { __index = found })
    local drive = ground.part_of(test, "head", 2, 10, found.delay)
    local run = lunid.simulate { model = ground.model(pushed, ground.path(test, 2)).whole, excitation = drive, from = "record", solver = "rk45" }
    local function sunk(column) return column[drive.rows] - column[1] end
    off[i] = run.summary.completed and sunk(run:column "y")/sunk(drive:column "y") - 1 or 10
  end
  return { less = less, off = off, square = off[1]^2 + off[2]^2 + off[3]^2 }
end

--- Puts the constant of the head's force right by the penetration. Tens of newtons in the mean of forces of kilonewtons decide how fast a
--- pile sinks, and no gauge of force holds its zero so well: but the tests themselves say how fast it sank. Two steps of a secant.
local function settle(report, found, tests)
  local tried = { too_fast(found, tests, 0), too_fast(found, tests, 30) }
  for _ = 1, 2 do
    table.sort(tried, function(one, other) return one.square < other.square end)
    local best, next, along, slopes = tried[1], tried[2], 0, 0
    for i = 1, 3 do
      local slope = (next.off[i] - best.off[i])/(next.less - best.less)
      along, slopes = along + slope*best.off[i], slopes + slope^2
    end
    tried[#tried + 1] = too_fast(found, tests, math.max(-100, math.min(100, best.less - along/slopes)))
  end
  table.sort(tried, function(one, other) return one.square < other.square end)
  found.os = found.os + tried[1].less
  if not report then return end
  table.sort(tried, function(one, other) return one.less < other.less end)
  local rows = {}
  for i, each in ipairs(tried) do rows[i] = { each.less, 1 + each.off[1], 1 + each.off[2], 1 + each.off[3] } end
  report:table { head = { "taken from the head's force [N]", "rate in test 1", "test 2", "test 3" }, rows = rows, caption = "Penetration rate of free runs "
    .. "over the measured one, 2 to 10 s, by what is taken from the head's force; the row nearest to 1 is kept" }
end

--- All that gauges tell of a ground: delay, masses, elements as numbers by name. With a report, how it was found.
function ground.identify(report, tests)
  local smith = found_delay(report, tests)
  local embedded = tests[1].gauges.embedded
  local shaft, places = fit_shaft(tests, smith.delay, embedded)
  local curve, tip = fit_limit(places, embedded), fit_tip(tests, smith.delay, true)
  if report then show(report, smith, shaft, places, curve, fit_tip(tests, smith.delay, false), tip, embedded) end
  local found = { delay = smith.delay, embedded = embedded, smith = smith }
  for _, model in ipairs { shaft.model, tip.model } do
    for _, row in ipairs(model.parameters) do found[row.name] = row.value end
  end
  for name, value in pairs(values_of(curve)) do found[name] = value end
  settle(report, found, tests)
  return found
end

--- The same of Smith's elements alone, fitted to tests 1 and 3, which know no wear, no depth and no plug.
function ground.smith_model(found)
  local values, sum, made = {}, 0, {}
  for _, part in ipairs { "shaft", "tip" } do
    local model = found.smith[part].model
    for _, row in ipairs(model.parameters) do values[row.name] = row.value end
    sum, made[part] = sum + model.restoring, alone(model.restoring)
  end
  made.whole = lunid.model { mass = values.mb + values.mt, restoring = sum }
  for name, model in pairs(made) do
    local own = {}
    for _, row in ipairs(model.parameters) do own[row.name] = values[row.name] end
    made[name] = model:with(own)
  end
  return made
end

return ground

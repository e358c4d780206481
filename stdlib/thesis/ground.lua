-- What the ground does to the pile, as far as gauges tell: a shaft whose friction slips part by part, grows with the embedded depth and
-- wears with the path that it has slipped; a toe that yields, lets go and grows with depth; a plug of soil that is torn loose. Fitted to tests 1 to 3,
-- which have two frequencies and two rates of lowering between them.
local lunid = require "lunid"
local y, v, abs = lunid.displacement, lunid.velocity, lunid.abs
local lines, series = lunid.figure.lines, lunid.figure.series

local ground = {}

--- Head's and tip's force as lists, put right by what was found of the gauges, faults = { delay =, gain = }: both are `delay` samples
--- late, and the head's shows `gain` times its force.
function ground.forces(test, faults)
  local gauges, head, tip = test.gauges, {}, {}
  local n = #gauges.t
  for i = 1, n do
    local at = math.min(n, i + faults.delay)
    head[i], tip[i] = gauges.head[at]/faults.gain, gauges.tip[at]
  end
  return head, tip
end

--- A test as a record from one time to another. F: of the "tip"; of the "shaft", the head's less the tip's; or of the "exciter", the head's
--- and what moves the vibrator's mass. y is the penetration since the test began.
function ground.part_of(test, force, from, to, faults)
  local gauges, head, shown = test.gauges, ground.forces(test, faults)
  for i = 1, #head do
    if force == "shaft" then shown[i] = head[i] - shown[i] end
    if force == "exciter" then shown[i] = head[i] + gauges.vibrator*gauges.a[i] end
  end
  return lunid.record { name = test.name, dt = gauges.dt, channels = { { "F", shown }, { "y", gauges.y }, { "v", gauges.v },
    { "a", gauges.a } } }:window(from, to)
end

--- The time of the deepest place within 0.15 s from a time on. There the toe yields and all friction slips, so that a run along the
--- motion knows what state the ground begins in.
function ground.deepest(test, from)
  local y, dt = test.gauges.y, test.gauges.dt
  local first = math.floor(from/dt + 0.5) + 1
  local best = first
  for i = first, first + math.floor(0.15/dt) do
    if y[i] > y[best] then best = i end
  end
  return (best - 1)*dt
end

--- The path that the pile has gone by a time, up and down: the integral of |v|.
function ground.path(test, time)
  local sum, dt = 0, test.gauges.dt
  for i = 1, math.floor(time/dt + 0.5) do sum = sum + math.abs(test.gauges.v[i])*dt end
  return sum
end

-- ---- elements ----

local function free(name, guess, min, unit, max) return lunid.parameter { name, guess, min = min, max = max, unit = unit } end

--- Parallel slip elements of one stiffness whose limits are spread evenly from 0 to twice their mean (Iwan 1966), and Smith's J. They
--- begin at their upper limits: a state that is to begin beyond its bound begins at it.
local function friction(name, limit, stiffness, J)
  local count, sum = 3, 0
  for i = 1, count do
    local reach = limit/stiffness*(2*i - 1)/count
    sum = sum + lunid.state { name .. i, rate = v, min = -reach, max = reach, initial = 1 }
  end
  local force = stiffness/count*sum
  return force + J*abs(force)*v
end

--- The catalogue's soil_plug with a damper between plug and pile. It begins as at the end of a downward stroke: the plug, ahead of the
--- pile by u0, slides and pulls the pile along.
local plug = lunid.effect { name = "plug", family = "soil", contribution = "z + c*(v - u0 - u)", parameters = { { "mp", min = 0, unit = "kg" },
    { "k", min = 0, unit = "N/m" }, { "Fs", min = 0, unit = "N" }, { "c", min = 0, unit = "N s/m" }, { "u0", unit = "m/s" } },
  states = { z = { rate = "k*(v - u0 - u)", initial = -1e6, min = "-Fs", max = "Fs", unit = "N" },
    u = { rate = "(z + c*(v - u0 - u))/mp", unit = "m/s" } } }

--- What lies below the lower gauge: Smith's toe, whose limit grows with depth, friction along the end of the shaft, and the plug, which
--- may be left out.
local function tip_force(p, with_plug)
  local denser = 1 + p.gt*y
  local force = lunid.effects.smith_toe { Ru = p.Rt*denser, q = p.qt*denser, J = p.Jt } + friction("below", p.Rb, p.kb, p.Jt)
  return with_plug and force + plug { mp = p.mp, k = p.kp, Fs = p.Fp, c = p.cp, u0 = p.u0 } or force
end

local function imposed(mass, restoring) return lunid.model { motion = "imposed", mass = mass, restoring = restoring } end

-- ---- what is fitted ----

--- Smith's elements for both parts.
local function fit_smith(tests, faults)
  local shaft, tip = {}, {}
  for _, test in ipairs { tests[1], tests[3] } do
    for _, from in ipairs { 3, 9 } do
      shaft[#shaft + 1] = ground.part_of(test, "shaft", from, from + 0.5, faults)
      tip[#tip + 1] = ground.part_of(test, "tip", from, from + 0.5, faults)
    end
  end
  local shaft_force = lunid.effects.smith_shaft { Ru = free("Rs", 800, 1, "N"), q = free("qs", 1e-3, 1e-4, "m", 2e-2), J = free("Js", 0.2, 0, "s/m") }
  local toe = lunid.effects.smith_toe { Ru = free("Rt", 3000, 1, "N"), q = free("qt", 1.5e-3, 1e-4, "m", 2e-2), J = free("Jt", 0.2, 0, "s/m") }
    + free("cp", 100, 0, "N s/m")*v
  return lunid.fit_trajectory { model = imposed(free("mb", 45, 10, "kg"), shaft_force + free("offset_s", -400, nil, "N")), record = shaft },
    lunid.fit_trajectory { model = imposed(free("mt", 8, 0, "kg"), toe + free("offset_t", -80, nil, "N")), record = tip }
end

--- Starts of windows after these times, of those that lie a second within a test.
local function starts(test, times)
  local list = {}
  for _, from in ipairs(times) do
    if from + 1 <= test.duration then list[#list + 1] = ground.deepest(test, from) end
  end
  return list
end

--- Windows of tests 1 to 3 as records of a part's force, and the path and depth of the pile in the middle of each.
local function windows(tests, part, times, length, faults)
  local records, places = {}, { path = {}, depth = {}, limit = {} }
  for i = 1, 3 do
    for _, from in ipairs(starts(tests[i], times)) do
      local k = #records + 1
      records[k] = ground.part_of(tests[i], part, from, from + length, faults)
      places.path[k] = ground.path(tests[i], from + length/2)
      places.depth[k] = tests[i].gauges.y[math.floor((from + length/2)/tests[i].gauges.dt)]
    end
  end
  return records, places
end

--- mb*a + shaft + offset = Fh - Gt over short windows, each with a limit of friction of its own; and where and when that limit was found.
local function fit_shaft(tests, faults, embedded)
  local records, places = windows(tests, "shaft", { 2, 3, 4.5, 6.5, 9.5, 14, 20, 28, 39 }, 0.3, faults)
  local force = friction("slip", free("Rs", 500, 1, "N"), free("ks", 8e5, 1e3, "N/m^2", 1e8)*(embedded + y), free("Js", 0.3, 0, "s/m"))
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

--- mt*a + tip + offset = Gt over longer windows, with a plug and without; each has a limit of friction of its own.
local function fit_tip(tests, faults, with_plug)
  local records, places = windows(tests, "tip", { 3, 6, 9, 20, 38 }, 0.8, faults)
  local p = { Rt = free("Rt", 2000, 1, "N"), gt = free("gt", 0, -1, "1/m", 5), qt = free("qt", 1.5e-3, 1e-4, "m", 2e-2), Jt = free("Jt", 0.2, 0, "s/m"),
    Rb = free("Rb", 200, 1, "N"), kb = free("kb", 4e5, 1e3, "N/m", 1e8), mp = free("mp", 8, 0.1, "kg"), kp = free("kp", 1e6, 1e3, "N/m"),
    Fp = free("Fp", 500, 1, "N"), cp = free("cp", 100, 0, "N s/m"), u0 = free("u0", 0.1, nil, "m/s") }
  local fit = lunid.fit_trajectory { model = imposed(free("mt", 8, 0, "kg"), tip_force(p, with_plug) + free("ot", -80, nil, "N")), record = records,
    separate = { "Rb" } }
  for i, model in ipairs(fit.models) do places.limit[i] = model.parameters.Rb.value end
  return fit, places
end

--- The friction below the lower gauge as a share of the shaft's, as the law of path and depth has it.
local function share_below(places, embedded, p)
  local both, squares = 0, 0
  for i, limit in ipairs(places.limit) do
    local of_shaft = limit_of(embedded, places.depth[i], places.path[i], p, math.exp)
    both, squares = both + limit*of_shaft, squares + of_shaft^2
  end
  return both/squares
end

-- ---- the whole ----

--- The delay of the gauges, by Smith's elements on tests 1 and 3.
local function found_delay(report, tests)
  local best, least, rows = nil, math.huge, {}
  for delay = 0, 3 do
    local shaft, tip = fit_smith(tests, { delay = delay, gain = 1 })
    local cost, p = shaft.summary.cost + tip.summary.cost, shaft.model.parameters
    if cost < least then best, least = delay, cost end
    rows[delay + 1] = { delay, shaft.summary.rmse, tip.summary.rmse, ("%.4g +- %.2g"):format(p.mb.value, p.mb.std or 0/0), ("%.3g"):format(p.Rs.value),
      ("%.3g"):format(1e3*p.qs.value), ("%.3g"):format(p.Js.value) }
  end
  if report then report:table { head = { "delay of the gauges [samples]", "shaft RMSE [N]", "tip RMSE [N]", "mb [kg]", "Rs [N]", "quake [mm]", "J [s/m]" },
    rows = rows, caption = "mb*a + Smith's shaft element + offset = Fh - Gt on tests 1 and 3 together: the least error gives the delay" } end
  return best
end

--- The gain of the head's gauge beside the tip's. Where it is not 1, a share of the tip's force is left in Fh - Gt, which no shaft makes:
--- the least error, by a parabola through three gains.
local function found_gain(report, tests, delay, embedded)
  local rows, cost = {}, {}
  for i, gain in ipairs { 0.96, 1, 1.04 } do
    local fit = fit_shaft(tests, { delay = delay, gain = gain }, embedded)
    cost[i] = (gain*fit.summary.rmse)^2  -- in newtons of the gauge
    rows[i] = { gain, gain*fit.summary.rmse, fit.model.parameters.mb.value }
  end
  local bend = cost[1] - 2*cost[2] + cost[3]
  local gain = bend > 0 and math.max(0.95, math.min(1.05, 1 - 0.02*(cost[3] - cost[1])/bend)) or 1
  if report then report:table { head = { "gain of the head's gauge", "shaft RMSE [N]", "mb [kg]" }, rows = rows,
    caption = ("Slip elements for the shaft, tests 1 to 3: the least error, between these, gives the gain %.3f"):format(gain) } end
  return gain
end

local function show(report, smith, shaft, places, curve, plain, tip, embedded)
  report:table { head = { "part", "elements", "RMSE [N]" }, rows = {
    { "shaft", "Smith's", smith.shaft.summary.rmse }, { "shaft", "three slip elements, stiffer with depth, a limit for each window", shaft.summary.rmse },
    { "tip", "Smith's toe and a damper", smith.tip.summary.rmse }, { "tip", "a toe that grows with depth, friction below the gauge", plain.summary.rmse },
    { "tip", "and a plug of soil", tip.summary.rmse } },
    caption = "What each step explains (other windows for Smith's). The plug's mass is no column of its own at one frequency" }
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

--- The answer as { whole =, shaft =, tip = }: the equation of motion of vibrator and pile under the exciter's force, and its parts along a
--- motion that is given. path: that the pile has gone before. The head's force would not do: it answers the motion, and whether every
--- stroke of a pile is alike or every second one hangs on the vibrator's mass.
function ground.model(found, path)
  local worn = lunid.state { "worn", rate = abs(v), initial = path }
  local limit = lunid.max(limit_of(found.embedded, y, worn, found, lunid.exp), 1)
  local shaft = friction("slip", limit, found.ks*(found.embedded + y), found.Js)
  local tip = tip_force(setmetatable({ Rb = found.share*limit }, { __index = found }), true)
  return { whole = lunid.model { mass = found.vibrator + found.mb + found.mt, restoring = shaft + tip + found.os + found.ot }, shaft = alone(shaft), tip = alone(tip) }
end

-- ---- the penetration ----

--- How much too fast a free run sinks in each test, 2 to 10 s, with `less` newtons taken from the exciter: 0 is the rate that the gauges measured.
local function too_fast(found, tests, less)
  local off = {}
  for i, test in ipairs { tests[1], tests[2], tests[3] } do
    local pushed = setmetatable({ os = found.os + less }, { __index = found })
    local drive = ground.part_of(test, "exciter", ground.deepest(test, 2), 10, found.faults)
    local run = lunid.simulate { model = ground.model(pushed, ground.path(test, 2)).whole, excitation = drive, from = "record", solver = "rk45" }
    local function sunk(column) return column[drive.rows] - column[1] end
    off[i] = run.summary.completed and sunk(run:column "y")/sunk(drive:column "y") - 1 or 10
  end
  return { less = less, off = off, square = off[1]^2 + off[2]^2 + off[3]^2 }
end

--- Puts the constant of the exciter's force right by the penetration. Tens of newtons in the mean of forces of kilonewtons decide how fast a
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
  report:table { head = { "taken from the exciter's force [N]", "rate in test 1", "test 2", "test 3" }, rows = rows, caption = "Penetration rate of free runs "
    .. "over the measured one, 2 to 10 s, by what is taken from the exciter's force; the row nearest to 1 is kept" }
end

--- All that gauges tell of a ground: faults of the gauges, masses, elements as numbers by name. With a report, how it was found.
function ground.identify(report, tests)
  local embedded, delay = tests[1].gauges.embedded, found_delay(report, tests)
  local faults = { delay = delay, gain = found_gain(report, tests, delay, embedded) }
  local smith = {}
  smith.shaft, smith.tip = fit_smith(tests, faults)
  local shaft, places = fit_shaft(tests, faults, embedded)
  local curve = fit_limit(places, embedded)
  local tip, below = fit_tip(tests, faults, true)
  if report then show(report, smith, shaft, places, curve, fit_tip(tests, faults, false), tip, embedded) end
  local found = { faults = faults, embedded = embedded, vibrator = tests[1].gauges.vibrator, smith = smith }
  for _, model in ipairs { shaft.model, tip.model } do
    for _, row in ipairs(model.parameters) do found[row.name] = row.value end
  end
  for name, value in pairs(values_of(curve)) do found[name] = value end
  found.share = share_below(below, embedded, found)
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
  made.whole = lunid.model { mass = found.vibrator + values.mb + values.mt, restoring = sum }
  for name, model in pairs(made) do
    local own = {}
    for _, row in ipairs(model.parameters) do own[row.name] = values[row.name] end
    made[name] = model:with(own)
  end
  return made
end

return ground

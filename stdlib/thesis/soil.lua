-- The pile's models that run freely: the channels put right by two frequencies, discovery step by step, Smith's elements fitted to
-- shaft and tip, and their judgement on tests that nothing was fitted to.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local lines, series, statistics = lunid.figure.lines, lunid.figure.series, lunid.statistics

local soil = {}
local g = 9.81

local function rows_of(list, from, to)
  local out = {}
  for i = from, to do out[#out + 1] = list[i] end
  return out
end

--- A test as a record from one time to another: a force in place of F, the displacement from the first row on.
local function part_of(test, force, from, to, delay)
  local gauges, moved, shifted = test.gauges, {}, {}
  local n, first = #gauges.t, math.floor(from/gauges.dt + 0.5) + 1
  for i = 1, n do
    moved[i] = gauges.y[i] - gauges.y[first]
    shifted[i] = force[math.min(n, i + (delay or 0))]
  end
  return lunid.record { name = test.name, dt = gauges.dt, channels = { { "F", shifted }, { "y", moved }, { "v", gauges.v },
    { "a", gauges.a } } }:window(from, to)
end

local function minus(one, other)
  local out = {}
  for i = 1, #one do out[i] = one[i] - other[i] end
  return out
end

-- ---- identification ----

--- Shaft: mb*a + Smith's element + an offset = Fh - Gt, along the measured motion; the channels' delay by the least error.
local function shaft_model()
  return lunid.model { motion = "imposed", mass = lunid.parameter { "mb", 45, min = 10, unit = "kg" },
    restoring = lunid.effects.smith_shaft { Ru = lunid.parameter { "Rs", 800, min = 1, unit = "N" },
      q = lunid.parameter { "qs", 1e-3, min = 1e-4, max = 2e-2, unit = "m" }, J = lunid.parameter { "Js", 0.2, min = 0, unit = "s/m" } }
      + lunid.parameter { "offset_s", -400, unit = "N" } }
end

local function tip_model()
  return lunid.model { motion = "imposed", mass = lunid.parameter { "mt", 8, min = 0, unit = "kg" },
    restoring = lunid.effects.smith_toe { Ru = lunid.parameter { "Rt", 3000, min = 1, unit = "N" },
      q = lunid.parameter { "qt", 1.5e-3, min = 1e-4, max = 2e-2, unit = "m" }, J = lunid.parameter { "Jt", 0.2, min = 0, unit = "s/m" } }
      + lunid.parameter { "cp", 100, min = 0, unit = "N s/m" }*v + lunid.parameter { "offset_t", -80, unit = "N" } }
end

--- Fits both parts on windows of two tests together, { from, to } each: an early and a late one, since the soil changes.
local function fit_parts(tests, delay, windows)
  local shaft, tip = {}, {}
  for _, test in ipairs { tests[1], tests[3] } do
    for _, window in ipairs(windows) do
      shaft[#shaft + 1] = part_of(test, minus(test.gauges.head, test.gauges.tip), window[1], window[2], delay)
      tip[#tip + 1] = part_of(test, test.gauges.tip, window[1], window[2], delay)
    end
  end
  return lunid.fit_trajectory { model = shaft_model(), record = shaft }, lunid.fit_trajectory { model = tip_model(), record = tip }
end

--- The shaft force of the first and the third test with what was found of mass and delay put right, for discovery.
function soil.shaft_records(tests, best, from, to)
  local records, mass = {}, best.shaft.model.parameters.mb.value
  for i, test in ipairs { tests[1], tests[3] } do
    local gauges, force = test.gauges, {}
    for k = 1, #gauges.t do
      local at = math.min(#gauges.t, k + best.delay)
      force[k] = gauges.head[at] - gauges.tip[at] - mass*(gauges.a[k] - g)
    end
    local vibration = lunid.record { channels = { { "y", gauges.y } }, dt = gauges.dt }:filter { from = 5 }
    records[i] = lunid.record { name = test.name, dt = gauges.dt, channels = { { "F", force }, { "y", vibration:column "y" }, { "v", gauges.v },
      { "a", gauges.a } } }:window(from, to)
  end
  return records
end

--- mb, mt, delay and Smith's elements, by the delay of least error; with a report, a table of all delays.
function soil.identify(report, tests, windows)
  local best, rows = nil, {}
  for delay = 0, 3 do
    local shaft, tip = fit_parts(tests, delay, windows)
    local cost = shaft.summary.cost + tip.summary.cost
    if not best or cost < best.cost then best = { shaft = shaft, tip = tip, cost = cost, delay = delay } end
    local p = shaft.model.parameters
    rows[delay + 1] = { delay, shaft.summary.rmse, tip.summary.rmse, ("%.4g +- %.2g"):format(p.mb.value, p.mb.std or 0/0),
      ("%.3g"):format(p.Rs.value), ("%.3g"):format(1e3*p.qs.value), ("%.3g"):format(p.Js.value) }
  end
  if report then report:table { head = { "delay of the gauges [samples]", "shaft RMSE [N]", "tip RMSE [N]", "mb [kg]", "Rs [N]", "quake [mm]", "J [s/m]" }, rows = rows,
    caption = "mb*a + Smith's shaft element + offset = Fh - Gt on tests 1 and 3 together: the least error gives delay and mass between the gauges" } end
  return best
end

--- The equation of motion of the whole: both masses and both elements under the head's force.
function soil.assembled(best)
  local shaft, tip = best.shaft.model, best.tip.model
  local values = {}
  for _, model in ipairs { shaft, tip } do
    for _, row in ipairs(model.parameters) do values[row.name] = row.value end
  end
  local function p(name, unit) return lunid.parameter { name, values[name], unit = unit } end
  return lunid.model { mass = values.mb + values.mt, restoring = lunid.effects.smith_shaft { Ru = p("Rs", "N"), q = p("qs", "m"), J = p("Js", "s/m") }
    + lunid.effects.smith_toe { Ru = p("Rt", "N"), q = p("qt", "m"), J = p("Jt", "s/m") } + p("cp", "N s/m")*v
    + values.offset_s + values.offset_t }
end

-- ---- judgement ----

--- Complex amplitude of a harmonic of a force over whole cycles.
local function harmonic(force, dt, frequency, order)
  local re, im, n = 0, 0, #force
  for i = 1, n do
    local angle = 2*math.pi*frequency*order*(i - 1)*dt
    re, im = re + 2/n*force[i]*math.cos(angle), im + 2/n*force[i]*math.sin(angle)
  end
  return math.sqrt(re^2 + im^2)
end

local function work(force, velocity, dt)
  local sum = 0
  for i = 1, #force do sum = sum + force[i]*velocity[i]*dt end
  return sum
end

local function without_mean(list)
  local sum, out = 0, {}
  for _, value in ipairs(list) do sum = sum + value end
  for i, value in ipairs(list) do out[i] = value - sum/#list end
  return out
end

--- A free run's forces beside the true ones: R2, loop work, harmonics 2 to 5, penetration rate.
local function scores(predicted, velocity, true_force, true_velocity, dt, frequency)
  local off = 0
  local first = harmonic(true_force, dt, frequency, 1)
  for order = 2, 5 do
    local one, other = harmonic(true_force, dt, frequency, order), harmonic(predicted, dt, frequency, order)
    if one > 0.02*first then off = math.max(off, math.abs(other/one - 1)) end
  end
  return { r2 = statistics.r2(true_force, predicted), work = work(predicted, velocity, dt)/work(true_force, true_velocity, dt), harmonics = off }
end

--- Runs the whole freely under the head's force of a test; its shaft and tip forces with their scores.
function soil.run_freely(best, model, test, from, to)
  local drive = part_of(test, test.gauges.head, from, to, best.delay)
  local run = lunid.simulate { model = model, excitation = drive, from = "record" }
  local out = { name = test.name, completed = run.summary.completed, stopped_at = run.summary.stopped_at }
  if not out.completed then return out end
  local record = run:record()
  local first = math.floor(from/test.gauges.dt + 0.5) + 1
  local last = first + record.rows - 1
  local velocity, true_velocity = record:column("v"):list(), rows_of(test.gauges.exact.v, first, last)
  local half = record.rows // 2
  for _, part in ipairs { "shaft", "tip" } do
    local partial = best[part].model
    local force, inertia = partial:force(record):list(), partial.parameters[part == "shaft" and "mb" or "mt"].value
    for i = 1, #force do force[i] = force[i] - inertia*record:column("a")[i] end
    local exact = rows_of(test.gauges.exact[part == "shaft" and "shaft" or "toe"], first, last)
    local p, q = without_mean(rows_of(force, half, #force)), without_mean(rows_of(exact, half, #exact))
    out[part] = scores(p, rows_of(velocity, half, #velocity), q, rows_of(true_velocity, half, #velocity), test.gauges.dt, test.frequency)
    out[part].force, out[part].exact = force, exact
  end
  local seconds = (last - first)*test.gauges.dt
  out.rate = (record:column("y")[record.rows] - record:column("y")[1])/seconds
  out.true_rate = (test.gauges.exact.y[last] - test.gauges.exact.y[first])/seconds
  out.record = record
  return out
end

--- Loading cycles of a free run beside the true ones, and the penetration.
function soil.loops(report, free, test)
  local record = free.record
  local last = record.rows
  local first = last - math.floor(3/(test.frequency*record.dt) + 0.5)
  local offset = math.floor(record.start/record.dt + 0.5)
  for _, part in ipairs { "shaft", "tip" } do
    report:figure("free_loops_" .. part, lines { x = "velocity [m/s]", y = part .. " force [N]", series = {
      series { rows_of(test.gauges.exact.v, first + offset, last + offset), rows_of(free[part].exact, first, last), label = "rig", role = "measured" },
      series { rows_of(record:column("v"):list(), first, last), rows_of(free[part].force, first, last), label = "free run", role = "final", style = "dashed" } } },
      ("Loading cycles of the %s force at the end of the sealed test: force over velocity"):format(part))
  end
  local true_depth, start = {}, test.gauges.y[offset + 1]
  for i = 1, last do true_depth[i] = test.gauges.y[offset + i] - start end
  report:figure("free_penetration", lines { x = "time [s]", y = "penetration [m]", series = {
    series { record:column "t", true_depth, label = "measured", role = "measured" },
    series { record:column "t", record:column "y", label = "free run", role = "final", style = "dashed" } } }, "Penetration in the sealed test")
end

--- A row for one soil: identified from its tests 1 and 3, run freely on its last one.
function soil.of_soil(number, tests, cells)
  local best = soil.identify(nil, tests, { { 3, 3.5 }, { 9, 9.5 } })
  local free = soil.run_freely(best, soil.assembled(best), tests[4], 2, 10)
  local name = ("%d (delay %d, mb %.1f kg)"):format(number, best.delay, best.shaft.model.parameters.mb.value)
  if not free.completed then return { name .. (", stops at %.3g s"):format(free.stopped_at) } end
  return cells(name, free.shaft, free.tip, free.rate/free.true_rate)
end

--- The model under three pure harmonics of the head's force (figures 3.24 to 3.26): amplitudes of both forces.
function soil.frequencies(best, model, test)
  local amplitude = test.whole:window(4, 8):column("F"):std()*math.sqrt(2)
  local mean = -(best.shaft.model.parameters.offset_s.value + best.tip.model.parameters.offset_t.value)
  local rows = {}
  for i, frequency in ipairs { 20, 40, 80 } do
    local run = lunid.simulate { model = model, duration = 4, dt = 0.00125,
      excitation = amplitude*lunid.sin(2*math.pi*frequency*lunid.time) - mean + 300 }
    local record = run:record()
    local late = record:window(3, record.start + record.duration)
    rows[i] = { frequency, run.summary.completed and "runs" or "stops", 500*(late:column("y"):max() - late:column("y"):min()) }
    for _, part in ipairs { "shaft", "tip" } do
      local force, inertia = best[part].model:force(late):list(), best[part].model.parameters[part == "shaft" and "mb" or "mt"].value
      for k = 1, #force do force[k] = force[k] - inertia*late:column("a")[k] end
      local low, high = math.huge, -math.huge
      for _, value in ipairs(force) do low, high = math.min(low, value), math.max(high, value) end
      rows[i][#rows[i] + 1] = (high - low)/2
    end
  end
  return { head = { "frequency [Hz]", "", "amplitude [mm]", "shaft force [N]", "tip force [N]" }, rows = rows,
    caption = ("Three harmonics of %.0f N: a vibration of more than the quake slips, so that the shaft's amplitude hardly depends on frequency, "
      .. "and what depends on it is the motion"):format(amplitude) }
end

--- What a rival gives along the measured motion of a test: a list of forces, scored as a free run is.
function soil.score_along(test, force, part, from, to)
  local first, last = math.floor(from/test.gauges.dt + 0.5) + 1, math.floor(to/test.gauges.dt + 0.5)
  local half = (first + last)//2
  local velocity = rows_of(test.gauges.v, half, last)
  local exact = without_mean(rows_of(test.gauges.exact[part == "shaft" and "shaft" or "toe"], half, last))
  return scores(without_mean(rows_of(force, half, last)), velocity, exact, rows_of(test.gauges.exact.v, half, last), test.gauges.dt, test.frequency)
end

--- Rivals that need the measured motion or the excitation alone: the best multiple of the acceleration, a sinusoid in step with the
--- head's force, polynomials (fits: by part). Gives { name, shaft, tip }.
function soil.rivals(tests, test, best, fits, from, to)
  local list = {}
  local function measured(which, part)
    local gauges, out = which.gauges, {}
    for k = 1, #gauges.t do
      local at = math.min(#gauges.t, k + best.delay)
      out[k] = part == "tip" and gauges.tip[at] - best.tip.model.parameters.mt.value*gauges.a[k]
        or gauges.head[at] - gauges.tip[at] - best.shaft.model.parameters.mb.value*gauges.a[k]
    end
    return out
  end
  local function regressed(part, signal)  -- least squares on one signal, over test 1
    local force, x = measured(tests[1], part), signal(tests[1])
    local first, last = math.floor(2/0.00125), math.floor(8/0.00125)
    local f, u = without_mean(rows_of(force, first, last)), without_mean(rows_of(x, first, last))
    local fu, uu = 0, 0
    for i = 1, #f do fu, uu = fu + f[i]*u[i], uu + u[i]^2 end
    local out = {}
    for i, value in ipairs(signal(test)) do out[i] = fu/uu*value end
    return out
  end
  local signals = { { "a multiple of the acceleration", function(which) return which.gauges.a end },
    { "a multiple of the head's force (a sinusoid)", function(which) return which.gauges.head end } }
  for _, each in ipairs(signals) do
    list[#list + 1] = { each[1], shaft = soil.score_along(test, regressed("shaft", each[2]), "shaft", from, to),
      tip = soil.score_along(test, regressed("tip", each[2]), "tip", from, to) }
  end
  local rx, noise = { "RX made again, along the measured motion" }, { "the channels, put right (limit of the noise)" }
  for _, part in ipairs { "shaft", "tip" } do
    local motion = lunid.record { name = test.name, dt = test.gauges.dt, channels = { { "F", test.gauges.head }, { "y", test.whole:filter { from = 5, channels = { "y" } }:column "y" },
      { "v", test.gauges.v }, { "a", test.gauges.a } } }
    rx[part] = soil.score_along(test, lunid.model { mass = 0, restoring = fits[part], motion = "imposed" }:force(motion):list(), part, from, to)
    noise[part] = soil.score_along(test, measured(test, part), part, from, to)
  end
  list[#list + 1], list[#list + 2] = rx, noise
  return list
end

return soil

-- The judgement of the pile's models: free runs on tests that nothing was fitted to, beside rivals, over soils.
local lunid = require "lunid"
local ground = require "ground"
local lines, series, statistics = lunid.figure.lines, lunid.figure.series, lunid.statistics

local soil = {}
local g = 9.81

local function rows_of(list, from, to)
  local out = {}
  for i = from, to do out[#out + 1] = list[i] end
  return out
end

--- The shaft force of the first and the third test with what was found of mass and gauges put right, for discovery.
function soil.shaft_records(tests, best, from, to)
  local records, mass = {}, best.mb
  for i, test in ipairs { tests[1], tests[3] } do
    local gauges, force, head, tip = test.gauges, {}, ground.forces(test, best.faults)
    for k = 1, #gauges.t do force[k] = head[k] - tip[k] - mass*(gauges.a[k] - g) end
    local vibration = lunid.record { channels = { { "y", gauges.y } }, dt = gauges.dt }:filter { from = 5 }
    records[i] = lunid.record { name = test.name, dt = gauges.dt, channels = { { "F", force }, { "y", vibration:column "y" }, { "v", gauges.v },
      { "a", gauges.a } } }:window(from, to)
  end
  return records
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
    if one > 0.05*first then off = math.max(off, math.abs(other/one - 1)) end
  end
  return { r2 = statistics.r2(true_force, predicted), work = work(predicted, velocity, dt)/work(true_force, true_velocity, dt), harmonics = off }
end

--- Runs a model { whole, shaft, tip } freely under the exciter's force of a test, from the deepest place after a time; its shaft and tip
--- forces with their scores, over the second half. how: solver, rtol.
function soil.run_freely(model, faults, test, from, to, how)
  from = ground.deepest(test, from)
  local drive = ground.part_of(test, "exciter", from, to, faults)
  how = how or { solver = "rk45" }
  local run = lunid.simulate { model = model.whole, excitation = drive, from = "record", solver = how.solver, rtol = how.rtol }
  local out = { name = test.name, completed = run.summary.completed, stopped_at = run.summary.stopped_at }
  if not out.completed then return out end
  local record = run:record()
  local first = math.floor(from/test.gauges.dt + 0.5) + 1
  local last = first + record.rows - 1
  local velocity, true_velocity = record:column("v"):list(), rows_of(test.gauges.exact.v, first, last)
  local half = record.rows // 2
  for _, part in ipairs { "shaft", "tip" } do
    local force = model[part]:force(record):list()
    local exact = rows_of(test.gauges.exact[part == "shaft" and "shaft" or "toe"], first, last)
    local p, q = without_mean(rows_of(force, half, #force)), without_mean(rows_of(exact, half, #exact))
    out[part] = scores(p, rows_of(velocity, half, #velocity), q, rows_of(true_velocity, half, #velocity), test.gauges.dt, test.frequency)
    out[part].force, out[part].exact = p, q
  end
  out.half = half
  local seconds = (last - first)*test.gauges.dt
  out.rate = (record:column("y")[record.rows] - record:column("y")[1])/seconds
  out.true_rate = (test.gauges.exact.y[last] - test.gauges.exact.y[first])/seconds
  out.record = record
  return out
end

--- The check of the step size (section 3.2, where the thesis' runs changed with it and were smoothed afterwards): a free run by other
--- methods and tolerances.
function soil.steps(report, model, faults, test)
  local rows = {}
  for i, how in ipairs { { solver = "rk45", rtol = 1e-6 }, { solver = "rk45", rtol = 1e-8 }, { solver = "rk45", rtol = 1e-10 }, { solver = "bdf", rtol = 1e-8 },
    { solver = "fixed" } } do
    local free = soil.run_freely(model, faults, test, 2, 10, how)
    rows[i] = { how.solver, how.rtol and ("%.0e"):format(how.rtol) or "steps halved until they are small enough" }
    if free.completed then
      table.move({ free.shaft.r2, free.shaft.work, free.tip.r2, free.tip.work, free.rate/free.true_rate }, 1, 5, 3, rows[i])
    end
  end
  report:table { head = { "solver", "tolerance", "shaft R2", "its work", "tip R2", "its work", "penetration rate" }, rows = rows,
    caption = "Does the free run depend on its steps? The sealed test, 2 to 10 s. Nothing is smoothed afterwards" }
end

local function over_time(t, measured, model, quantity)
  return lines { x = "time [s]", y = quantity, series = { series { t, measured, label = "rig", role = "measured" },
    series { t, model, label = "free run", role = "final", style = "dashed" } } }
end

--- A free run beside the truth (figures 3.19 to 3.23): forces, residuals and loading cycles at the end of the test, and the penetration.
function soil.show(report, free, test)
  local record = free.record
  local cycles = math.floor(3/(test.frequency*record.dt) + 0.5)
  local last = #free.shaft.force
  local offset = math.floor(record.start/record.dt + 0.5)
  local t = rows_of(record:column("t"):list(), record.rows - cycles, record.rows)
  local residuals = {}
  for _, part in ipairs { "shaft", "tip" } do
    local exact, force = rows_of(free[part].exact, last - cycles, last), rows_of(free[part].force, last - cycles, last)
    report:figure("free_" .. part, over_time(t, exact, force, part .. " force [N]"), ("Free run of the sealed test, its end: %s force"):format(part))
    report:figure("free_loops_" .. part, lines { x = "velocity [m/s]", y = part .. " force [N]", series = {
      series { rows_of(test.gauges.exact.v, offset + record.rows - cycles, offset + record.rows), exact, label = "rig", role = "measured" },
      series { rows_of(record:column("v"):list(), record.rows - cycles, record.rows), force, label = "free run", role = "final", style = "dashed" } } },
      ("Loading cycles of the %s force at the end of the sealed test: force over velocity"):format(part))
    local residual = {}
    for i = 1, #exact do residual[i] = exact[i] - force[i] end
    residuals[#residuals + 1] = series { t, residual, label = part, style = part == "tip" and "dashed" or "line" }
  end
  report:figure("free_residual", lines { x = "time [s]", y = "rig - free run [N]", series = residuals }, "Residual of the free run")
  local true_depth, start = {}, test.gauges.y[offset + 1] - record:column("y")[1]
  for i = 1, record.rows do true_depth[i] = test.gauges.y[offset + i] - start end
  report:figure("free_penetration", over_time(record:column "t", true_depth, record:column "y", "penetration [m]"), "Penetration in the sealed test")
end

--- A row for one soil: identified from its tests 1 to 3, run freely on its last one; and whether it meets the aims.
function soil.of_soil(number, tests, cells)
  local found = ground.identify(nil, tests)
  local free = soil.run_freely(ground.model(found, ground.path(tests[4], 2)), found.faults, tests[4], 2, 10)
  local name = ("%d (gain %.3f, mb %.1f kg)"):format(number, found.faults.gain, found.mb)
  if not free.completed then return { name .. (", stops at %.3g s"):format(free.stopped_at) } end
  return cells(name, free.shaft, free.tip, free.rate/free.true_rate)
end

--- The model under three pure harmonics of the exciter's force (figures 3.24 to 3.26): motion and both forces.
function soil.frequencies(report, found, test)
  local amplitude = ground.part_of(test, "exciter", 4, 8, found.faults):column("F"):std()*math.sqrt(2)
  local rows, shown = {}, { y = {}, shaft = {}, tip = {} }
  local styles = { "line", "dashed", "dotted" }
  for i, frequency in ipairs { 20, 40, 80 } do
    local model = ground.model(found, ground.path(test, 8))
    local run = lunid.simulate { model = model.whole, duration = 4, dt = 0.00125,
      excitation = amplitude*lunid.sin(2*math.pi*frequency*lunid.time) + found.os + found.ot + 300 }
    local record = run:record()
    local late = record:window(3, record.start + record.duration)
    local few = late:window(3, 3 + 3/frequency)
    rows[i] = { frequency, run.summary.completed and "runs" or "stops", 500*(late:column("y"):max() - late:column("y"):min()) }
    local phase = {}
    for k, t in ipairs(few:column("t"):list()) do phase[k] = (t - 3)*frequency end
    for _, part in ipairs { "y", "shaft", "tip" } do
      local values = part == "y" and late:column "y" or model[part]:force(late)
      if part ~= "y" then rows[i][#rows[i] + 1] = (values:max() - values:min())/2 end
      local list = rows_of(values:list(), 1, few.rows)
      shown[part][i] = series { phase, part == "y" and without_mean(list) or list, label = ("%d Hz"):format(frequency), style = styles[i] }
    end
  end
  for _, each in ipairs { { "y", "harmonics", "displacement [m]" }, { "tip", "harmonics_tip", "tip force [N]" }, { "shaft", "harmonics_shaft", "shaft force [N]" } } do
    report:figure(each[2], lines { x = "cycles", y = each[3], series = shown[each[1]] }, "Three harmonics of the exciter's force (figures 3.24 to 3.26): "
      .. each[3]:match "^[^%[]+")
  end
  report:table { head = { "frequency [Hz]", "", "amplitude [mm]", "shaft force [N]", "tip force [N]" }, rows = rows,
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
--- head's force, a linear ARX, polynomials (fits: by part), the oracle's forces; and Smith's elements, run freely. Gives { name, shaft, tip, rate }.
function soil.rivals(tests, test, found, fits, oracle, from, to)
  local list = {}
  local function measured(which, part)
    local out, head, tip = {}, ground.forces(which, found.faults)
    for k, a in ipairs(which.gauges.a) do out[k] = part == "tip" and tip[k] - found.mt*a or head[k] - tip[k] - found.mb*a end
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
  local arx = { "linear ARX, from the head's force" }
  for _, part in ipairs { "shaft", "tip" } do
    local function record_of(which)
      return lunid.record { dt = which.gauges.dt, channels = { { "F", which.gauges.head }, { "R", measured(which, part) } } }
    end
    local model = lunid.arx { record = record_of(tests[1]):window(2, 8), output = "R", input = "F", outputs = 4, inputs = 4, delay = 0, constant = true }
    arx[part] = soil.score_along(test, model:free_run(record_of(test)).values:list(), part, from, to)
  end
  list[#list + 1] = arx
  local rx, noise = { "RX made again, along the measured motion" }, { "the channels, put right (limit of the noise)" }
  for _, part in ipairs { "shaft", "tip" } do
    local motion = lunid.record { name = test.name, dt = test.gauges.dt, channels = { { "F", test.gauges.head }, { "y", test.whole:filter { from = 5, channels = { "y" } }:column "y" },
      { "v", test.gauges.v }, { "a", test.gauges.a } } }
    rx[part] = soil.score_along(test, lunid.model { mass = 0, restoring = fits[part], motion = "imposed" }:force(motion):list(), part, from, to)
    noise[part] = soil.score_along(test, measured(test, part), part, from, to)
  end
  local smith = soil.run_freely(ground.smith_model(found), found.faults, test, from, to)
  list[#list + 1] = rx
  if smith.completed then
    list[#list + 1] = { "Smith's elements, run freely", shaft = smith.shaft, tip = smith.tip, rate = smith.rate/smith.true_rate }
  end
  list[#list + 1] = { "an oracle that knows the soil, along the measured motion", shaft = soil.score_along(test, oracle.shaft, "shaft", from, to),
    tip = soil.score_along(test, oracle.tip, "tip", from, to) }
  list[#list + 1] = noise
  return list
end

return soil

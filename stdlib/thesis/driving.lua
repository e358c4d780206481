-- What the pile's study does with gauges, forces and models: the channel arithmetic (3.2) to (3.6), checks of identifiability that need
-- no truth, and the judgement of models that run freely.
local lunid = require "lunid"
local plots = require "plots"
local y, v, a = lunid.displacement, lunid.velocity, lunid.acceleration
local lines, series, statistics = lunid.figure.lines, lunid.figure.series, lunid.statistics

local driving = {}
local g = 9.81

-- ---- records ----

--- A record of all gauges: F the head's force, G the tip's, and the motion.
function driving.record(gauges, name)
  return lunid.record { name = name, dt = gauges.dt, channels = { { "F", gauges.head }, { "G", gauges.tip }, { "y", gauges.y },
    { "v", gauges.v }, { "a", gauges.a } } }
end

--- The vibration of a channel without its slow part.
local function vibration(record, channel) return record:filter { from = 5, channels = { channel } }:column(channel) end

--- Shaft force Rs = Fh - Rt - m*a, or tip force Rt, as lists; `delay`: samples by which the gauges lag.
function driving.forces(test, mass, delay)
  local gauges, shaft, tip = test.gauges, {}, {}
  local n = #gauges.t
  for i = 1, n do
    local at = math.min(n, i + (delay or 0))
    tip[i] = gauges.tip[at]
    shaft[i] = gauges.head[at] - tip[i] - mass*gauges.a[i]
  end
  return shaft, tip
end

--- The force of one part over the vibration of the pile, as the thesis fits it.
function driving.force_record(test, part, mass, from, to)
  local shaft, tip = driving.forces(test, mass)
  local whole = test.whole
  if part == "combined" then
    for i = 1, #shaft do shaft[i] = shaft[i] + tip[i] end
  end
  return lunid.record { name = ("%s force of %s"):format(part, test.name), dt = whole.dt, channels = {
    { "F", part == "tip" and tip or shaft }, { "y", vibration(whole, "y") }, { "v", vibration(whole, "v") },
    { "a", whole:column "a" } } }:window(from, to)
end

--- Work per cycle of a force over rows of a test, by the trapezoidal rule.
local function work_per_cycle(force, velocity, dt, frequency)
  local sum = 0
  for i = 1, #force - 1 do sum = sum + (force[i]*velocity[i] + force[i + 1]*velocity[i + 1])/2*dt end
  return sum / ((#force - 1)*dt*frequency)
end

local function rows_of(list, from, to)
  local out = {}
  for i = from, to do out[#out + 1] = list[i] end
  return out
end

local function rms(list)
  local sum = 0
  for _, value in ipairs(list) do sum = sum + value^2 end
  return math.sqrt(sum/#list)
end

function driving.show(report, test)
  local part = test.whole:window(4, 4.25)
  local t = part:column "t"
  report:figure("displacement", lines { series = { series { test.whole:column "t", test.whole:column "y", role = "measured" } }, x = "time [s]",
    y = "penetration [m]" }, "Measured penetration of " .. test.name)
  report:figure("velocity", lines { series = { series { t, part:column "v", role = "measured" } }, x = "time [s]", y = "velocity [m/s]" },
    "Measured velocity, some cycles")
  report:figure("forces", lines { series = { series { t, part:column "F", label = "head, Fh" }, series { t, part:column "G", label = "tip, Gt",
    style = "dashed" } }, x = "time [s]", y = "force [N]" }, "External forcing and measured tip force")
end

-- ---- what a record can tell ----

--- How the shaft force changes with the mass, the gain of a gauge and the delay between the channels.
function driving.sensitivity(test, mass)
  local first, last = math.floor(2/0.00125) + 1, math.floor(10/0.00125)
  local velocity = rows_of(test.gauges.v, first, last)
  local rows = {}
  for _, each in ipairs { { "as in the thesis", 0, 0, 1 }, { "m - 1 kg", -1, 0, 1 }, { "m + 1 kg", 1, 0, 1 }, { "head gauge + 3 %", 0, 0, 1.03 },
    { "gauges 1 sample earlier", 0, 1, 1 }, { "gauges 2 samples earlier", 0, 2, 1 }, { "gauges 3 samples earlier", 0, 3, 1 } } do
    local shaft, tip = driving.forces(test, mass + each[2], each[3])
    for i = 1, #shaft do shaft[i] = shaft[i] + (each[4] - 1)*test.gauges.head[i] end
    local part, below = rows_of(shaft, first, last), rows_of(tip, first, last)
    rows[#rows + 1] = { each[1], rms(part), work_per_cycle(part, velocity, test.gauges.dt, test.frequency),
      work_per_cycle(below, velocity, test.gauges.dt, test.frequency) }
  end
  return { head = { "channels", "rms of Rs [N]", "work of Rs per cycle [J]", "work of Rt per cycle [J]" }, rows = rows,
    caption = "Shaft force of " .. test.name .. ", 2 to 10 s. Friction takes up work: a negative one is an error of the channels, not soil" }
end

--- Can mass and stiffness be told apart? One test alone, and two frequencies together.
function driving.mass_and_stiffness(tests, table_a1)
  local function fit(list)
    local records = {}
    for i, test in ipairs(list) do
      local force = {}
      for k = 1, #test.gauges.t do force[k] = test.gauges.head[k] - test.gauges.tip[k] end
      records[i] = lunid.record { dt = test.gauges.dt, name = test.name, channels = { { "F", force }, { "y", vibration(test.whole, "y") },
        { "v", vibration(test.whole, "v") }, { "a", vibration(test.whole, "a") } } }:window(2, 10)
    end
    local full = lunid.regress { record = records, features = { a, y, v } }
    local column_y, column_a = records[1]:column "y", records[1]:column "a"
    return { math.abs(statistics.correlation(column_y, column_a)), full.condition, full.terms.a.value, full.terms.a.block_std or full.terms.a.std,
      full.terms.y.value, #full.unexcited > 0 and full.unexcited[1] or "" }
  end
  local rows = {}
  for _, each in ipairs { { "test 1 alone", { tests[1] } }, { "test 3 alone", { tests[3] } }, { "tests 1 and 3 together", { tests[1], tests[3] } } } do
    rows[#rows + 1] = { each[1], table.unpack(fit(each[2])) }
  end
  local w = 2*math.pi*33.1
  return { head = { "m*a + k*y + c*v on", "|correlation of y and a|", "condition", "m [kg]", "deviation", "k [N/m]", "cannot be told apart" },
    rows = rows, caption = ("At one frequency a = -w^2 y, and m*a and k*y are one column. Table A.1 has %.4g and %.4g y per unit of mass in its shaft forces; "
      .. "(2 pi 33.1 Hz)^2 is %.4g: that stiffness is the inertia term"):format(table_a1.shaft1.polynomial[5][3], table_a1.shaft2.polynomial[5][3], w^2) }
end

--- Do segments of time share their terms?
function driving.segments(test, mass)
  local rows = {}
  for from = 2, 8, 2 do
    local fit = lunid.regress { record = driving.force_record(test, "shaft", mass, from, from + 2), features = { lunid.polynomials({ y, v }, 3) },
      solver = lunid.stlsq { threshold = 0.05 } }
    local names = {}
    for _, term in ipairs(fit.terms) do
      if term.value ~= 0 then names[#names + 1] = ("%.3g %s"):format(term.value, term.feature) end
    end
    rows[#rows + 1] = { ("%d to %d s"):format(from, from + 2), fit.r2, table.concat(names, ", ") }
  end
  return { head = { "segment", "R2", "terms" }, rows = rows, caption = "Fits of the shaft force by segments of time: they do not share their terms" }
end

-- ---- figures of forces ----

--- What a fit says of a part's force beside the gauges, for three periods from a time on: a panel.
local function fitted_panel(fit, test, part, mass, from)
  local record = driving.force_record(test, part, mass, from, from + 3/test.frequency)
  return lines { x = "time [s]", y = part .. " force [N]", title = ("%s, at %g s"):format(test.name:match "^test %d+", from), series = {
    series { record:column "t", record:column "F", label = "measured", role = "measured" },
    series { record:column "t", lunid.compare { model = fit.model, record = record, lags = 1 }.predicted, label = "fit", role = "final", style = "dashed" } } }
end

--- Loading cycles, three of them, over displacement and their section over velocity.
local function cycles(report, name, fit, test, part, mass)
  local record = driving.force_record(test, part, mass, 5, 5 + 3/test.frequency)
  local predicted, panels = lunid.compare { model = fit.model, record = record, lags = 1 }.predicted, {}
  for i, over in ipairs { { "y", "displacement [m]" }, { "v", "velocity [m/s]" } } do
    panels[i] = lines { x = over[2], y = part .. " force [N]", series = { series { record:column(over[1]), record:column "F", label = "measured", role = "measured" },
      series { record:column(over[1]), predicted, label = "fit", role = "final", style = "dashed" } } }
  end
  report:figure(name .. "loops", lunid.figure.grid { panels, columns = 2 }, ("Fitted loading cycles of the %s force of %s"):format(part, test.name))
end

--- What appendix N shows of the force of one part fitted on one test: data, surfaces, the fit on every test early and late, cycles.
function driving.show_part(report, part, number, tests, mass, fit, quick)
  local test, name = tests[number], ("%s%d_"):format(part, number)
  local record = driving.force_record(test, part, mass, 4, 6)
  plots.learners(report, name, record, 0, plots.learners_of(quick), true)
  local surface = lunid.rfs { record = record, order = { 2, 2 }, interpolate = lunid.grid {} }
  plots.faces(report, name, surface, part .. " force")
  plots.views(report, name, surface, ("Surface of the %s force of %s (2 x 2 as a polynomial: R2 %.3f)"):format(part, test.name, surface.r2))
  report:figure(name .. "phase", lunid.figure.phase_portrait { record:window(5, 5.3) }, "Phase portrait of the training data, some cycles")
  plots.pruning(report, record, { lunid.polynomials({ y, v }, 3) }, nil, name)
  local panels = {}
  for _, onto in ipairs(tests) do
    for _, from in ipairs { 5, onto.duration - 1 } do panels[#panels + 1] = fitted_panel(fit, onto, part, mass, from) end
  end
  report:figure(name .. "fits", lunid.figure.grid { panels, columns = 2, width = 20 },
    ("The fit of the %s force of %s on all tests, early and late"):format(part, test.name))
  cycles(report, name, fit, test, part, mass)
end

--- The function library (figures 3.4 and 3.5): what a force could be made of, each over its own reach.
function driving.library(report)
  local x, gap = {}, 0.3
  for i = 1, 201 do x[i] = (i - 101)/100 end
  local kinds = { { "y^3", function(at) return at^3 end }, { "tanh(4 y)", function(at) return (math.exp(8*at) - 1)/(math.exp(8*at) + 1) end },
    { "sign(y)", function(at) return at > 0 and 1 or at < 0 and -1 or 0 end },
    { "clearance", function(at) return at > gap and at - gap or at < -gap and at + gap or 0 end },
    { "T(y, 5)", function(at) return 16*at^5 - 20*at^3 + 5*at end }, { "f1, as assumed", function(at) return (at + 0.56)*(1 + (math.exp(4*(at + 0.56)) - 1)/(math.exp(4*(at + 0.56)) + 1))/2 end } }
  local panels = {}
  for i, kind in ipairs(kinds) do
    local values = {}
    for k, at in ipairs(x) do values[k] = kind[2](at) end
    panels[i] = lines { title = kind[1], x = "y, scaled", series = { series { x, values } } }
  end
  report:figure("function_library", lunid.figure.grid { panels, columns = 3, width = 20 }, "Functions that the thesis' library offers (figures 3.4 and 3.5)")
end

-- ---- published expressions ----

--- The equations of motion that table A.1 makes: shaft and tip per unit of mass, times the mass.
function driving.published_models(published, mass)
  local p = published.pile
  local function polynomial(each) return published.polynomial(each.polynomial, mass) end
  local f1 = (y + 0.0056)*(1 + lunid.tanh(2*(y + 0.0056)))/2
  local function model(restoring) return lunid.model { mass = mass, restoring = restoring } end
  local function rename(each, prefix)  -- two expressions in one model need names of their own
    local sum = 0
    for _, term in ipairs(each.polynomial) do
      sum = sum + lunid.parameter { prefix .. term[1] .. term[2], term[3]*mass } * y^term[1] * v^term[2]
    end
    return sum
  end
  return {
    { "Shaft Force 1 + Tip Force 1 (custom RX; f1 assumed)", model(rename(p.shaft1, "s") + rename(p.tip1, "t") + mass*p.tip1.f1[1]*f1) },
    { "Shaft Force 2 + Tip Force 2 (PySINDy)", model(rename(p.shaft2, "s") + rename(p.tip2, "t")) },
    { "Combined (3.2, Chebyshev, the stable one)", model(polynomial(p.combined) + published.chebyshev(p.combined.chebyshev, mass)) },
  }
end

--- The model under the vibrating part of a test's head force: how its linear part stands, and what its free run does.
function driving.free_row(name, model, ...)
  local values = { y = 0, v = 0 }
  for _, row in ipairs(model.parameters) do values[row.name] = row.value end
  local mass = model.mass:at(values)
  local k, c = model.restoring:derivative(y):at(values), model.restoring:derivative(v):at(values)
  local row = { name, k > 0 and math.sqrt(k/mass)/(2*math.pi) or "no spring", k > 0 and c/(2*math.sqrt(k*mass)) or c }
  for _, test in ipairs { ... } do
    local force = vibration(test.whole, "F")
    local drive = lunid.record { name = test.name, dt = test.whole.dt, channels = { { "F", force }, { "y", vibration(test.whole, "y") },
      { "v", vibration(test.whole, "v") } } }:window(2, 10)
    local run = lunid.simulate { model = model, excitation = drive, from = "record" }
    local summary = run.summary
    row[#row + 1] = summary.completed and ("runs; run error %.3g"):format(statistics.nrmse(drive:column "y", run:column "y"))
      or ("stops at %.3g s"):format(summary.stopped_at)
  end
  return row
end

--- The describing function of a clearance is a stiffness over the amplitude; with y in its place it is no force of a clearance.
function driving.describing_functions()
  local stiffness, gap, rows = 1e6, 1e-3, {}
  local function described(size)
    local theta = math.asin(gap/size)
    return stiffness*size/(2*math.pi)*(math.pi - 2*theta + math.sin(2*theta) - 4*gap/size*math.cos(theta))
  end
  for _, size in ipairs { 1.2e-3, 2e-3, 4e-3, 8e-3 } do
    local first, n = 0, 2000  -- the first harmonic of the true clearance under size*cos
    for i = 1, n do
      local angle = 2*math.pi*(i - 0.5)/n
      local place = size*math.cos(angle)
      local force = place > gap and stiffness*(place - gap) or place < -gap and stiffness*(place + gap) or 0
      first = first + 2/n*force*math.cos(angle)
    end
    rows[#rows + 1] = { 1e3*size, first, described(size), stiffness*(size - gap) }
  end
  return { head = { "amplitude, or y [mm]", "first harmonic of a clearance [N]", "section 3.1, of the amplitude [N]", "force of the clearance at y [N]" },
    rows = rows, caption = "Clearance of 1 mm, 1e6 N/m: section 3.1's functions are half of the describing function of an amplitude, and are not the force at a "
      .. "displacement, for which the thesis took them" }
end

return driving

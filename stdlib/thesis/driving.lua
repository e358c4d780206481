-- What the pile's study does with gauges and forces: the channel arithmetic (3.2) to (3.6), and checks of identifiability that need no
-- truth.
local lunid = require "lunid"
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
function driving.vibration(record, channel) return record:filter { from = 5, channels = { channel } }:column(channel) end

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
    { "F", part == "tip" and tip or shaft }, { "y", driving.vibration(whole, "y") }, { "v", driving.vibration(whole, "v") },
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
      records[i] = lunid.record { dt = test.gauges.dt, name = test.name, channels = { { "F", force }, { "y", driving.vibration(test.whole, "y") },
        { "v", driving.vibration(test.whole, "v") }, { "a", driving.vibration(test.whole, "a") } } }:window(2, 10)
    end
    local full = lunid.regress { record = records, features = { a, y, v } }
    local column_y, column_a = records[1]:column "y", records[1]:column "a"
    return { math.abs(statistics.correlation(column_y, column_a)), full.condition, full.terms.a.value, full.terms.a.block_std or full.terms.a.std,
      full.terms.y.value, full.terms.y.block_std or full.terms.y.std }
  end
  local rows = {}
  for _, each in ipairs { { "test 1 alone", { tests[1] } }, { "test 3 alone", { tests[3] } }, { "tests 1 and 3 together", { tests[1], tests[3] } } } do
    rows[#rows + 1] = { each[1], table.unpack(fit(each[2])) }
  end
  local w = 2*math.pi*33.1
  return { head = { "m*a + k*y + c*v on", "|correlation of y and a|", "condition", "m [kg]", "its deviation", "k [N/m]", "its deviation" },
    rows = rows, caption = ("At one frequency a = -w^2 y, and m*a and k*y are one column. Table A.1 has %.4g and %.4g y per unit of mass in its shaft forces; "
      .. "(2 pi 33.1 Hz)^2 is %.4g: that stiffness is the inertia term"):format(table_a1.shaft1.polynomial[5][3], table_a1.shaft2.polynomial[5][3], w^2) }
end

return driving

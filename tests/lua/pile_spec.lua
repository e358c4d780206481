-- The pile's virtual rig against what must hold of any pile, and what the study makes of its gauges on one soil.
local lunid = require "lunid"
local spec = require "spec"

-- The study's own files, as the thesis cases load them.
local stdlib = assert(spec.lunid "doctor":match "stdlib%s+(%S+)")
for _, name in ipairs { "rig", "driving", "soil", "ground", "plots", "published" } do
  spec.shell(("cp '%s/thesis/%s.lua' ."):format(stdlib, name))
end
spec.write("study.lua", [[
local lunid = require "lunid"
local rig, soil, ground, driving = require "rig", require "soil", require "ground", require "driving"
local site = rig.site(1)
local tests = {}
for i, test in ipairs { { 54, 33.1, 0.01 }, { 55, 33.1, 0.05 }, { 56, 25, 0.01 }, { 58, 29, 0.02 } } do
  tests[i] = { number = test[1], frequency = test[2], lowering = test[3], duration = 10.5, name = "test " .. test[1] }
  tests[i].gauges = rig.test(site, tests[i])
  tests[i].whole = driving.record(tests[i].gauges, tests[i].name)
end
local e, g = tests[1].gauges.exact, tests[1].gauges

-- The momentum of what lies between the gauges: mb*a + Rs + Gt = Fh + mb*g, over whole cycles at the end.
local impulse, forces, from, to = 0, 0, 7201, 8400
for i = from, to do
  forces = forces + (e.head[i] - e.tip[i] - e.shaft[i] + e.between_gauges*9.81)*g.dt
end
impulse = e.between_gauges*(e.v[to] - e.v[from])
local size = 0
for i = from, to do size = size + math.abs(e.head[i])*g.dt end
print(("momentum %.6f"):format((forces - impulse)/size))

-- Friction takes up work in every cycle; the toe never pulls beyond plug and friction.
local work = 0
for i = from, to do work = work + e.shaft[i]*e.v[i]*g.dt end
print(("work %.1f"):format(work))

-- Test 1 alone cannot tell mass from stiffness; two frequencies can.
local rows = driving.mass_and_stiffness(tests, require("published").pile).rows
print(("condition %.1f %.1f"):format(rows[1][3], rows[3][3]))

local found = ground.identify(nil, tests)
print(("delay %d, mb %.2f of %.2f, plug %.1f of %.1f"):format(found.delay, found.mb/site.gain, e.between_gauges, found.mp, site.plug*site.mass))
local free = soil.run_freely(ground.model(found, ground.path(tests[4], 2)), found.delay, tests[4], 2, 10)
print(("free %s, shaft %.4f %.4f, tip %.4f %.4f"):format(free.completed, free.shaft.r2, free.shaft.work, free.tip.r2, free.tip.work))
print(("rate %.3f"):format(free.rate/free.true_rate))
local smith = soil.run_freely(ground.smith_model(found), found.delay, tests[4], 2, 10)
print(("smith shaft %.4f"):format(smith.completed and smith.shaft.r2 or -1))
]])

local said, code = spec.lunid "run study.lua --out out"

local function numbers(pattern)
  local found = { said:match(pattern) }
  assert(#found > 0, said)
  return table.unpack(found)
end

spec.case("the study runs", function() spec.equal(code, 0) end)

spec.case("the rig keeps momentum between its gauges, and its friction takes up work", function()
  spec.near(tonumber(numbers "momentum (%S+)"), 0, 5e-3)  -- of the impulse of the head's force; a is that of the upper end
  assert(tonumber(numbers "work (%S+)") > 0, said)
end)

spec.case("two frequencies tell mass from stiffness, one does not", function()
  local one, two = numbers "condition (%S+) (%S+)"
  assert(tonumber(one) > 2*tonumber(two), said)
end)

spec.case("delay and masses are found", function()
  local delay, mb, true_mb, plug, true_plug = numbers "delay (%d+), mb (%S+) of (%S+), plug (%S+) of (%S+)"
  spec.equal(delay, "2")
  spec.near(mb/true_mb, 1, 0.03)
  spec.near(plug/true_plug, 1, 0.4)  -- part of it moves with the pile
end)

spec.case("a sealed test is run freely: both forces beyond 0.9, work within 10 %, Smith's elements are beaten by half", function()
  local shaft, shaft_work, tip, tip_work = numbers "free true, shaft (%S+) (%S+), tip (%S+) (%S+)"
  assert(tonumber(shaft) > 0.9 and tonumber(tip) > 0.9, said)
  spec.near(tonumber(shaft_work), 1, 0.1)
  spec.near(tonumber(tip_work), 1, 0.1)
  assert(1 - shaft < 0.5*(1 - numbers "smith shaft (%S+)"), said)
end)

spec.case("the sealed test sinks as fast as the pile did, within 20 %: the constant of the head's force is that of the tests' penetration", function()
  spec.near(tonumber(numbers "rate (%S+)"), 1, 0.2)
end)

spec.clean()
spec.finish()

-- The pile's virtual rig against what must hold of any pile, and what the study makes of its gauges on one soil.
local lunid = require "lunid"
local spec = require "spec"

-- The study's own files, as the thesis cases load them.
local stdlib = assert(spec.lunid "doctor":match "stdlib%s+(%S+)")
for _, name in ipairs { "rig", "driving", "soil", "ground", "plots", "published", "approach" } do
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
print(("delay %d, gain %.4f of %.4f, mb %.2f of %.2f, mt %.2f of %.2f, plug %.1f of %.1f"):format(found.faults.delay, found.faults.gain, site.gain,
  found.mb, e.between_gauges, found.mt, e.below_tip_gauge, found.mp, site.plug*site.mass))
local free = soil.run_freely(ground.model(found, ground.path(tests[4], 2)), found.faults, tests[4], 2, 10)
print(("free %s, shaft %.4f %.4f, tip %.4f %.4f"):format(free.completed, free.shaft.r2, free.shaft.work, free.tip.r2, free.tip.work))
print(("harmonics %.3f %.3f"):format(free.shaft.harmonics, free.tip.harmonics))
print(("rate %.3f"):format(free.rate/free.true_rate))
local report = lunid.report { title = "Approach" }
require("approach").run(report, tests, 49)
report:save()
local smith = soil.run_freely(ground.smith_model(found), found.faults, tests[4], 2, 10)
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

spec.case("the gauges' delay and gain are found, and all three masses", function()
  local delay, gain, true_gain, mb, true_mb, mt, true_mt, plug, true_plug =
    numbers "delay (%d+), gain (%S+) of (%S+), mb (%S+) of (%S+), mt (%S+) of (%S+), plug (%S+) of (%S+)"
  spec.equal(delay, "2")
  spec.near(gain/true_gain, 1, 0.015)  -- the elements of the shaft are three, and the soil's twenty
  spec.near(mb/true_mb, 1, 0.02)
  spec.near(mt/true_mt, 1, 0.05)
  spec.near(plug/true_plug, 1, 0.1)
end)

spec.case("a sealed test is run freely: both forces beyond 0.95, harmonics within 20 %, work within 10 %, Smith's elements beaten by half", function()
  local shaft, shaft_work, tip, tip_work = numbers "free true, shaft (%S+) (%S+), tip (%S+) (%S+)"
  local of_shaft, of_tip = numbers "harmonics (%S+) (%S+)"
  assert(tonumber(shaft) > 0.95 and tonumber(tip) > 0.95, said)
  assert(tonumber(of_shaft) < 0.2 and tonumber(of_tip) < 0.2, said)
  spec.near(tonumber(shaft_work), 1, 0.1)
  spec.near(tonumber(tip_work), 1, 0.1)
  assert(1 - shaft < 0.5*(1 - numbers "smith shaft (%S+)"), said)
end)

spec.case("the sealed test sinks as fast as the pile did, within 20 %: the constant of the exciter's force is that of the tests' penetration", function()
  spec.near(tonumber(numbers "rate (%S+)"), 1, 0.2)
end)

spec.case("the published expressions are drawn along the motion, and the pairs of shaft and tip run away", function()
  local from = said:find("The expressions of table A.1 along the vibration", 1, true)
  for _, name in ipairs { "Shaft Force 1", "Shaft Force 2", "Shaft Force 3", "Tip Force 1", "Tip Force 2", "Combined, Tip Force 3" } do
    assert(said:find(name, from, true), name)
  end
  spec.contains(spec.shell "head -c 2000 out/figures/table_a1.csv", "Shaft Force 1")
  local _, away = said:gsub("Shaft Force %d %+ Tip Force %d [^\n]*stops at 2 s%s+stops at 2 s", "")
  spec.equal(away, 2)
end)

spec.case("the command: every part, each run and soil with its figures of merit", function()
  local whole, code = spec.lunid "thesis pile --quick --out pile"
  spec.equal(code, 0)
  for _, part in ipairs { "The channel arithmetic", "One frequency cannot tell mass from stiffness", "Two frequencies together",
    "Shaft, toe and plug", "Other soils, sealed" } do
    spec.contains(whole, part)
  end
  local text, completed = spec.shell "cat pile/results.json", 0
  for rate, r2 in text:gmatch '"rate": ([%d.e+-]+),.-"shaft": {.-"r2": ([%d.e+-]+)' do
    spec.near(tonumber(rate), 1, 0.3)
    assert(tonumber(r2) > 0.9, "shaft R2 " .. r2)
    completed = completed + 1
  end
  spec.equal(completed, 5)
  spec.contains(text, '"of": 2')
  spec.contains(spec.shell "cat pile/report.html", "sealed test of soil")
end)

spec.clean()
spec.finish()

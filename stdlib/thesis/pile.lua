-- The pile (thesis, chapter 3): its measurements are not public, so tests 54 to 57 are run on a virtual rig whose inside is not told.
-- The channel arithmetic (3.2) to (3.6), why the thesis' expressions could not be simulated, shown by checks that need no truth, and
-- how far a model gets that is fitted to two frequencies together. `exact` of the rig serves only to judge.
local lunid = require "lunid"
local published, rig, driving, approach = require "published", require "rig", require "driving", require "approach"
local soil, ground = require "soil", require "ground"
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Pile: vibratory driving on a virtual rig" }
local site = rig.site(seed)
local long = quick and 10.5 or 40.5
local tests = {
  { number = 54, frequency = 33.1, lowering = 0.01, duration = long, name = "test 1 (54): high frequency, slow" },
  { number = 55, frequency = 33.1, lowering = 0.05, duration = 10.5, name = "test 2 (55): high frequency, fast" },
  { number = 56, frequency = 25, lowering = 0.01, duration = long, name = "test 3 (56): normal frequency, slow" },
  { number = 57, frequency = 25, lowering = 0.05, duration = 10.5, name = "test 4 (57): normal frequency, fast" },
}
for i, test in ipairs(tests) do
  test.gauges = rig.test(site, test)
  test.whole = driving.record(test.gauges, test.name)
  report:progress("tests", i, #tests)
end
local mass = 49  -- as in the thesis
driving.show(report, tests[1])

-- ---- the arithmetic, and what it hides ----

report:section "The channel arithmetic (3.2) to (3.6), and what it makes of the shaft force"
report:table(driving.sensitivity(tests[1], mass))
report:text("Rs = Fh - Rt - m*a is a small difference of large forces: a kilogram is 43 kN/m of apparent stiffness at 33 Hz, and a delay of the "
  .. "gauges turns inertia into work. Between the gauges lie mb kg, not 49: mb*a + Rs + Gt = Fh + mb*g.")

report:section "One frequency cannot tell mass from stiffness"
report:table(driving.mass_and_stiffness(tests, published.pile))

local fits = approach.fit(report, tests, mass, quick)
local expressions = approach.run(report, tests, mass)

-- ---- two frequencies together ----

report:section "Two frequencies together: discovery from the naive baseline, step by step"
local best = ground.identify(report, tests)
local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local discovery = lunid.discover { model = lunid.model { mass = 0, restoring = c*lunid.velocity, motion = "imposed" },
  train = soil.shaft_records(tests, best, 4, 4.5), test = soil.shaft_records(tests, best, 4.6, 5), max_effects = 2, out = "discovery",
  catalogue = { "smith_shaft", "elastic_slip", "iwan", "coulomb_friction", "linear_stiffness", "constant_force" } }
report:verbatim(tostring(discovery))

report:section "Shaft, toe and plug, free under the exciter's force"
report:text(("The head's force answers the motion, and a pile that is given it moves as one without a vibrator: it loses step where strokes come in "
  .. "unlike pairs. What drives vibrator and pile is the exciter's force, Fh + mv*a with the vibrator's %.1f kg."):format(best.vibrator))
local sealed = { number = 58, frequency = 29, lowering = 0.02, duration = quick and 10.5 or 40.5, name = "sealed test: 29 Hz, 20 mm/s" }
sealed.gauges = rig.test(site, sealed)
sealed.whole = driving.record(sealed.gauges, sealed.name)
local limits, judged, runs = { r2 = 0.1, work = 0.1, harmonics = 0.2, rate = 0.2 }, {}, {}
local function cells(name, shaft, tip, rate)
  return { name, shaft.r2, shaft.work, shaft.harmonics, tip.r2, tip.work, tip.harmonics, rate }
end
for _, test in ipairs { tests[1], tests[2], tests[3], tests[4], sealed } do
  local free = soil.run_freely(ground.model(best, ground.path(test, 2)), best.faults, test, 2, test.duration - 0.5)
  judged[#judged + 1] = free.completed and cells(test.name, free.shaft, free.tip, free.rate/free.true_rate)
    or { test.name .. ("; stops at %.3g s"):format(free.stopped_at) }
  runs[#runs + 1] = { seed = seed, equation = 1, test = test.name, free_run = { completed = free.completed, stopped_at = free.stopped_at,
    shaft = free.completed and { r2 = free.shaft.r2, work = free.shaft.work, harmonics = free.shaft.harmonics } or nil,
    tip = free.completed and { r2 = free.tip.r2, work = free.tip.work, harmonics = free.tip.harmonics } or nil,
    rate = free.completed and free.rate/free.true_rate or nil } }
  if free.completed and test == sealed then soil.show(report, free, test) end
end
local head = { "free run from 2 s to the end", "shaft R2", "its work", "its harmonics off", "tip R2", "its work", "its harmonics off", "penetration rate" }
report:table { head = head, rows = judged, caption = ("Fitted on windows of tests 1 to 3; test 4 and the sealed one were not seen. Judged on the second half "
  .. "of each run against the rig's own forces; work and rate over the truth, harmonics 2 to 5 that are above 5 %% of the first. Aims: R2 %.1f of "
  .. "what the noise allows, work within %.0f %%, harmonics and rate within %.0f %%"):format(1 - limits.r2, 100*limits.work, 100*limits.rate) }
local rivals = {}
for i, rival in ipairs(soil.rivals(tests, sealed, best, { shaft = fits.shaft1.restoring, tip = fits.tip1.restoring }, rig.oracle(site, sealed.gauges),
  2, sealed.duration - 0.5)) do
  rivals[i] = cells(rival[1], rival.shaft, rival.tip, rival.rate)
end
head[1] = "rivals on the sealed test"
report:table { head = head, rows = rivals, caption = "They get the measured motion or force of the test; only Smith's elements run freely, under the same force" }

soil.steps(report, ground.model(best, ground.path(sealed, 2)), best.faults, sealed)
soil.frequencies(report, best, tests[1])

-- ---- other soils ----

report:section "Other soils, sealed: the same study"
local others, soils, met = lunid.option { "soils", quick and 2 or 5 }, {}, {}
for number = seed + 1, seed + others do
  local other, list = rig.site(number), {}
  for i, test in ipairs { tests[1], tests[2], tests[3], sealed } do
    list[i] = { number = test.number, frequency = test.frequency, lowering = test.lowering, duration = 10.5, name = test.name }
    list[i].gauges = rig.test(other, list[i])
  end
  local row = soil.of_soil(number, list, cells)
  for i, aim in ipairs { "r2", "work", "harmonics", "r2", "work", "harmonics", "rate" } do
    local off = row[i + 1] and (aim == "harmonics" and row[i + 1] or math.abs(1 - row[i + 1]))
    met[i] = (met[i] or 0) + (off and off <= limits[aim] and 1 or 0)
  end
  soils[#soils + 1] = row
  report:progress("soils", #soils, others)
end
head[1] = "sealed test of soil"
report:table { head = head, rows = soils, caption = "Each identified anew from its tests 1 to 3, run freely on its sealed test; failures are shown as they are. "
  .. "Below: in how many each aim is met, R2 itself being 0.9 or more" }
report:table { head = head, rows = { { ("of %d soils"):format(others), table.unpack(met) } } }

report:results { case = "pile", variant = "1", runs = runs, expressions = expressions, soils = { of = others, met = met },
  discovery = { verdict = discovery.verdict, sentence = discovery.sentence } }
report:save()

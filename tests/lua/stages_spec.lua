-- The stages of discovery one by one, and the experiment that would tell rivals apart.
local lunid = require "lunid"
local spec = require "spec"
local y, v = lunid.displacement, lunid.velocity

local train = lunid.read("../data/spring_multisine.csv"):window(0, 4)
local baseline = lunid.model { mass = 49, restoring = lunid.parameter { "k", min = 0, unit = "N/m" } * y
  + lunid.parameter { "c", min = 0, unit = "N s/m" } * v }

-- The spring of the record (tests/data/README.md): k3*y^3 is hidden from the baseline.
spec.case("locate: a cubic spring grows with |y|, odd; friction is not seen", function()
  local where = lunid.locate { model = baseline, record = train }
  spec.equal(where.above_noise, true)
  assert(not tostring(where):match "test record", tostring(where))  -- a stage has none
  assert(where.loop_share < 0.05)
  spec.contains(where.sentence, "|y|")
  spec.contains(where.sentence, "odd")
  spec.contains(tostring(where), "the same on loading and unloading")
  local map = where.maps.y
  assert(map.share > 0.8 and map.share > 3 * where.maps.v.share)
  spec.equal(#map.x, #map.level)
  spec.equal(#where.maps.plane.value, #where.maps.plane.v)
  spec.equal(#where.force, #where.t)
  assert(lunid.figure.lines { series = { lunid.figure.series { map.x, map.value }, lunid.figure.series { map.x, map.level } } })
end)

-- Rubber in a steady tone is a spring and a damper. Generic forces that one tone does not tell apart were fitted to the
-- noise, thousands of newtons against each other, and what smoothing makes of them stood in the map: 33 N of 100.
spec.case("locate: nothing is fitted to what the baseline leaves of the noise", function()
  local rubber = lunid.model { mass = 49, restoring = 7.7e5*y + 369*v + lunid.effects.maxwell_relaxation { k = 1.4e5, tau = 8e-3 } }
  local run = lunid.simulate { model = rubber, excitation = 100*lunid.sin(91*lunid.time), duration = 4.5, dt = 1/800 }
  local noisy = run:record():with_noise { y = lunid.noise.gaussian { relative = 0.01 }, F = 0.001, seed = 11 }
  local tone = lunid.record { dt = 1/800,
    channels = { { "F", noisy:column "F", unit = "N" }, { "y", noisy:column "y", unit = "m" } } }:window(2.5, 4.4)
  assert(lunid.locate { model = baseline, record = tone }.rms < 1)
end)

spec.case("propose: the cubic spring leads, what the baseline can do by itself has no gain", function()
  local list = lunid.propose { model = baseline, record = train, catalogue = { "quadratic_stiffness", "cubic_stiffness",
    "linear_stiffness", "coulomb_friction" } }
  spec.equal(list[1].name, "cubic_stiffness")
  assert(list[1].gain > 5 * list[2].gain and list[1].p_value < 1e-6)
  spec.equal(list[4].name, "linear_stiffness")
  spec.contains(list[4].remark, "a combination of the baseline's own")
  spec.contains(tostring(list), "of the force")
  spec.contains(tostring(list), "(by the larger of the two gains, to first order;")
end)

spec.case("rank: sets by their left-out gap; a criterion may reject and order them", function()
  local sets = { "cubic_stiffness", { "cubic_stiffness", "coulomb_friction" }, "constant_force" }
  local rows = lunid.rank { model = baseline, record = train, sets = sets }
  spec.equal(#rows, 4)
  assert(rows[1].name:match "^cubic_stiffness")
  local by_name = {}
  for _, row in ipairs(rows) do by_name[row.name] = row end
  assert(by_name.cubic_stiffness.left_out_gap < 0.3 * by_name.baseline.left_out_gap)
  assert(by_name.baseline.z > 2.33, "the baseline is not told from the best")
  assert(by_name.constant_force.p_value > 1e-3)
  -- the fit of each is a model: the cubic one is that of the generator within 1 % (noise 30 dB, 3200 rows)
  local k3 = by_name.cubic_stiffness.model.parameters.cubic_stiffness_k3.value
  local whole = lunid.fit_trajectory { model = by_name.cubic_stiffness.model, record = train }
  spec.near(whole.model.parameters.cubic_stiffness_k3.value / k3, 1, 0.01)
  local chosen = lunid.rank { model = baseline, record = train, sets = sets, criterion = function(row)
    if row.name:match "coulomb" then return false end
    return #row.model.parameters
  end }
  spec.equal(chosen[1].name, "baseline")
  spec.equal(#chosen, 3)
  spec.equal(chosen.rejected[1].name, "cubic_stiffness + coulomb_friction")
  spec.contains(tostring(chosen), "rejected by the criterion")
  spec.contains(tostring(rows), "nested: the one holds all of the other)")
end)

spec.case("discover: what a criterion of one's own refuses is not named, in no set, and said", function()
  local asked = {}
  local found = lunid.discover { model = baseline, train = train, test = lunid.read "../data/spring_sweep.csv",
    catalogue = { "cubic_stiffness", "quadratic_stiffness", "coulomb_friction" },
    criterion = function(set)
      asked[set.name] = set
      local k3 = set.model.parameters.cubic_stiffness_k3
      return not k3 or k3.value < 0
    end }
  assert(asked.cubic_stiffness and asked.cubic_stiffness.gap < 0.05, "the cubic spring was not asked about")
  spec.near(asked.cubic_stiffness.model.parameters.cubic_stiffness_k3.value/1.161e10, 1, 0.02)
  spec.equal(found.verdict, "unknown-effect")
  spec.equal(spec.names_of(found), "")
  for _, rival in ipairs(found.rivals) do assert(not rival.name:match "cubic", rival.name) end
  spec.contains(table.concat(found.warnings, "\n"), "refused by the criterion: cubic_stiffness")
  local function discover_by(criterion)
    return spec.message_of(function()
      lunid.discover { model = baseline, train = train, catalogue = { "cubic_stiffness" }, criterion = criterion }
    end)
  end
  spec.equal(discover_by(function() return 1 end),
    "discover: criterion: of cubic_stiffness: expected the function to return true or false, got 1")
  spec.contains(discover_by(function(set) return set.gaps < 1 end), "attempt to compare nil with number")
end)

spec.case("stages say what is wrong with their fields", function()
  spec.equal(spec.message_of(function() lunid.rank { model = baseline, record = train, sets = { "cubic_stifness" } } end),
    "rank: sets: unknown effect 'cubic_stifness', did you mean 'cubic_stiffness'?")
  spec.equal(spec.message_of(function() lunid.rank { model = baseline, record = train, sets = { "clearance + coulomb_friction" } } end),
    [[rank: sets: 'clearance + coulomb_friction': several effects at once are a list, { "clearance", "coulomb_friction" }]])
  local still = lunid.record { dt = 0.01, channels = { { "force", (function() local f = {} for i = 1, 60 do f[i] = i % 7 end return f end)() } } }
  spec.contains(spec.message_of(function() lunid.propose { model = baseline, record = still } end),
    "propose: the record has no channels 'y', 'F' (it has force); name its column, e.g. --columns \"y=header [unit], F=header [unit]\" "
      .. '(in a study columns = "...")')
  spec.equal(spec.message_of(function() lunid.propose { model = baseline, record = train, catalogue = { "cubic_stifness" } } end),
    "propose: catalogue: unknown effect 'cubic_stifness', did you mean 'cubic_stiffness'?")
  local magnet = lunid.effect { name = "magnet", family = "stiffness", contribution = "k*y^3", parameters = { { "k" } } }
  spec.equal(spec.message_of(function() lunid.rank { model = baseline, record = train, sets = { "magnets" }, effects = { magnet } } end),
    "rank: sets: unknown effect 'magnets', did you mean 'magnet'?")
  spec.equal(spec.message_of(function()
    lunid.rank { model = baseline, record = train, sets = { "constant_force" }, criterion = function() return "good" end }
  end), "rank: criterion: expected the function to return true, false or a number, got the string 'good'")
  local own = lunid.effect { name = "cubic_stiffness", family = "stiffness", contribution = "k*y^3", parameters = { { "k" } } }
  spec.equal(spec.message_of(function() lunid.propose { model = baseline, record = train, effects = { own } } end),
    "propose: effects: 'cubic_stiffness' is in the catalogue already; give it another name")
  spec.equal(spec.message_of(function() lunid.locate { record = train } end),
    "locate: missing field 'model': a model from lunid.model")
end)

spec.case("without: entries that are left out by name, of those first tried and of all others", function()
  local some = { "quadratic_stiffness", "cubic_stiffness", "quintic_stiffness" }
  local list = lunid.propose { model = baseline, record = train, catalogue = some, without = { "cubic_stiffness" } }
  spec.equal(#list, 2)
  for _, row in ipairs(lunid.propose { model = baseline, record = train, without = { "cubic_stiffness", "clearance" } }) do
    assert(row.name ~= "cubic_stiffness" and row.name ~= "clearance", row.name)
  end
  local found = lunid.discover { model = baseline, train = train, catalogue = some, without = { "cubic_stiffness" } }
  for _, text in ipairs { found.json, tostring(found) } do assert(not text:find "cubic_stiffness", text) end
  local function refused(call, fields, text)
    fields.model = baseline
    spec.equal(spec.message_of(function() call(fields) end), text)
  end
  refused(lunid.discover, { train = train, without = { "cubic_stifnes" } },
    "discover: without: unknown effect 'cubic_stifnes', did you mean 'cubic_stiffness'?")
  refused(lunid.propose, { record = train, without = { "cubic_stifness" } },
    "propose: without: unknown effect 'cubic_stifness', did you mean 'cubic_stiffness'?")
  refused(lunid.discover, { train = train, catalogue = { "clearance" }, without = { "clearance" } },
    "discover: without: leaves no effect to try")
end)

-- ---- several coordinates ----

local function two_masses(k, c, joint)
  return lunid.chain { masses = { 1.2, 0.8 }, ends = "left", forces = { 1 },
    element = function(d, w, index) return k*d + c*w + (index == 2 and joint(d) or 0) end }
end
local two = two_masses(lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" },
  function() return 0 end)
-- The cubic spring of the joint is hidden.
local push = lunid.excitation.multisine { from = 4, to = 45, rms = 12, dt = 1/1000, duration = 3, seed = 4 }
local shaken = lunid.simulate { model = two_masses(2e4, 6, function(d) return 4e9*d^3 end),
  excitation = lunid.record { channels = { { "F1", push:column "F" } }, dt = push.dt } }:record():with_noise { y1 = 0.01, y2 = 0.01, seed = 2 }
local pair = lunid.record { channels = { { "F1", shaken:column "F1" }, { "y1", shaken:column "y1" }, { "y2", shaken:column "y2" } },
  dt = shaken.dt }

spec.case("locate looks where most is left, or at the place that is asked for", function()
  local where = lunid.locate { model = two, record = pair }
  spec.equal(where.place, "y1 - y2")
  spec.contains(where.sentence, "in y1 - y2: ")
  spec.contains(where.sentence, "odd")
  spec.contains(where.no_data, "y1 - y2 below ")
  local other = lunid.locate { model = two, record = pair, place = "y2" }
  spec.equal(other.place, "y2")
  assert(other.maps.y.share < 0.6 * where.maps.y.share)
  spec.equal(spec.message_of(function() lunid.locate { model = two, record = pair, place = "y3" } end),
    "locate: place: expected one of y1, y2, y1 - y2, got 'y3'")
  spec.equal(spec.message_of(function() lunid.locate { model = baseline, record = train, place = "y" } end),
    "locate: place: the model has one coordinate: leave it out, got 'y'")
end)

spec.case("entries are proposed and ranked at their places", function()
  local tried = { "cubic_stiffness", "quadratic_drag", "constant_force" }
  local list = lunid.propose { model = two, record = pair, catalogue = tried }
  spec.equal(#list, 9)
  spec.equal(list[1].name, "cubic_stiffness in y1 - y2")
  spec.equal(list[1].parameters[1].name, "k3")
  local rows = lunid.rank { model = two, record = pair, sets = { "cubic_stiffness", "quadratic_drag at y1",
    { "cubic_stiffness in y1 - y2", "constant_force at y2" } } }
  spec.equal(#rows, 6)  -- the first name at each of three places, two more sets, the baseline
  local by_name = {}
  for _, row in ipairs(rows) do by_name[row.name] = row end
  local right = by_name["cubic_stiffness in y1 - y2"]
  assert(right.left_out_gap < 0.1 * by_name.baseline.left_out_gap)
  assert(by_name["cubic_stiffness at y2"].left_out_gap > 5 * right.left_out_gap)
  spec.equal(by_name["cubic_stiffness in y1 - y2 + constant_force at y2"].z, nil)  -- holds the likeliest
  spec.near(right.model.parameters.cubic_stiffness_k3_1_2.value / 4e9, 1, 0.02)
  spec.equal(spec.message_of(function() lunid.rank { model = two, record = pair, sets = { "cubic_stiffness at y3" } } end),
    "rank: sets: no effect 'cubic_stiffness at y3', there are: cubic_stiffness at y1, cubic_stiffness at y2, "
    .. "cubic_stiffness in y1 - y2")
  spec.equal(spec.message_of(function() lunid.rank { model = two, record = pair, sets = { "base_motion" } } end),
    "rank: sets: not to be tested on these records: base_motion (with one coordinate alone: a base moves all)")
end)

-- ---- design_experiment ----

local a = lunid.model { mass = 1, restoring = lunid.parameter { "k", 1 } * y + lunid.parameter { "c", 0.1 } * v
  + lunid.parameter { "k3", 0.3 } * y^3 }
local b = lunid.model { mass = 1, restoring = lunid.parameter { "k", 1 } * y + lunid.parameter { "c", 0.1 } * v
  + lunid.parameter { "k2", 0.3 } * lunid.abs(y) * y }
local limits = { force = 0.5, displacement = 1.5, frequency = { 0.08, 0.4 } }

spec.case("a design is a table, prints, and its excitation drives a model and is written", function()
  local design = lunid.design_experiment { models = { a, b }, names = { "cubic", "odd" }, limits = limits, noise = 0.01,
    duration = 100, rate = 4 }
  spec.equal(design.rivals[2], "odd")
  spec.equal(design.best.name, design.candidates[1].name)
  spec.equal(#design.candidates, 9)
  spec.contains(tostring(design), "stepped_amplitude")
  spec.contains(tostring(design), design.sentence)
  local run = lunid.simulate { model = a, excitation = design.excitation, from = { 0, 0 } }
  spec.equal(run.summary.completed, true)
  assert(run:column("y"):max() <= 1.5 and run:column("y"):min() >= -1.5)
  design.excitation:save "next.csv"
  design:save "next.json"
  local data = lunid.design_experiment { models = { a, b }, limits = limits, noise = 0.01, duration = 100, rate = 4 }
  spec.equal(data.candidates[1].separation, design.candidates[1].separation)  -- the same input, the same bits
end)

spec.case("a design asks for what it cannot know", function()
  local function message(fields)
    return spec.message_of(function() lunid.design_experiment(fields) end)
  end
  spec.equal(message { limits = limits, noise = 1 }, "design_experiment: give either models or from, a discovery")
  spec.equal(message { models = { a, b }, limits = limits },
    "design_experiment: missing field 'noise': a number; only a discovery (from = ...) brings its own")
  spec.equal(message { models = { a, b }, noise = 1, limits = { force = 1 } },
    "design_experiment: limits: missing field 'frequency'; only a discovery (from = ...) brings its own")
  spec.equal(message { models = { a, b }, noise = 1, limits = { forces = 1 } },
    "design_experiment: limits: unknown field 'forces', did you mean 'force'?")
  spec.equal(message { models = { a, b }, noise = 1, limits = { force = 1, frequency = 3 } },
    "design_experiment: limits.frequency: expected { lowest, highest } in Hz, got 3")
  spec.equal(message { models = { a, b }, noise = 1, limits = limits, rate = 1 },
    "design_experiment: rate: expected >= 3.2 Hz, eight rows in a period of limits.frequency[2], got 1")
end)

spec.clean()
spec.finish()

-- The research questions of the thesis (section 0.5, and "revisited" in its conclusions), each answered by a table that is computed here.
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Questions: what the thesis asked" }
local duffing = lunid.systems.duffing {}
local library = lunid.polynomials({ y, v }, quick and 3 or 5)
local answers, done = {}, 0

local function step(total)
  done = done + 1
  report:progress("questions", done, total or 7)
end

local function records(system, given)
  local train = lunid.thesis_record { system = system, frequency = given.frequency or { 20, 30 }, amplitude = given.amplitude or 2000,
    noise = given.noise or 0.05, seed = 10*(given.seed or seed) }
  return train, lunid.thesis_validation { system = system, from = type(train) == "table" and train[1] or train }
end

local function chosen(train, features, most)
  return lunid.select { record = train, mass = 1, features = features or { library }, most_terms = most or 5 }
end

local function run_error(model, test)
  return lunid.compare { model = model, record = test, lags = 1 }.nrmse
end

--- False and missing terms, and the largest error of the true ones in per cent.
local function verdict(model, truth)
  local seen, wrong, worst = 0, 0, 0
  for _, row in ipairs(model.parameters) do
    local value = truth[row.name]
    if value then
      seen, worst = seen + 1, math.max(worst, math.abs(row.value/value - 1)*100)
    elseif math.abs(row.value) > 0 and not row.fixed then
      wrong = wrong + 1
    end
  end
  local all = 0
  for _ in pairs(truth) do all = all + 1 end
  return ("%d false, %d missing"):format(wrong, all - seen), worst
end

-- ---- 1, 2: limited measurements, and which method ----

report:section "1 and 2. Can a system be identified from limited measurements, and by which method?"
local p = lunid.parameter { "p", 30, min = 5, max = 300 }
local systems = { { "Duffing", duffing, { library }, { c_y = 2e4, c_y3 = 1e6, c_v = 10 } } }
if not quick then
  systems[2] = { "tanh yield", lunid.systems.tanh_yield {}, { lunid.polynomials({ y, v }, 2), lunid.tanh(p*y) }, { c_tanh_p_y = 3000, p = 80, c_v = 10 } }
  systems[3] = { "modified Duffing", lunid.systems.modified_duffing {}, { library }, { c_y = 1e4, c_y3 = 1e5, c_y5 = 5e6, c_y3_v2 = 2000, c_v = 10 } }
end
local rows = {}
for _, each in ipairs(systems) do
  for _, noise in ipairs(quick and { 0.01, 0.05 } or { 0.01, 0.05, 0.1 }) do
    local train, test = records(each[2], { noise = noise })
    local found = chosen(train, each[3])
    local surface = lunid.rfs { record = train, mass = 1, order = { 4, 4 } }
    for _, way in ipairs { { "Lunid", found.model }, { "usual pipeline", found.naive.model },
      { "RFS, 4 x 4", lunid.model { mass = 1, restoring = surface.restoring } } } do
      local terms, worst = verdict(way[2], each[4])
      if way[1]:match "^RFS" then terms, worst = "a surface", nil end
      rows[#rows + 1] = { each[1], 100*noise, way[1], terms, worst, run_error(way[2], test) }
    end
  end
end
report:table { head = { "system", "noise [%]", "method", "terms", "largest error of a true one [%]", "run error" }, rows = rows,
  caption = "Two records of 3 s at 20 and 30 Hz. A dash: the free run stopped, or no term is true" }
answers.methods = rows
step()

-- ---- 3: physics ----

report:section "3. How physics-informed, and what does it buy?"
local train, test = records(duffing, {})
local truth = { c_y = 2e4, c_y3 = 1e6, c_v = 10 }
local signs = { lunid.at_least(y, 0), lunid.at_least(v, 0), lunid.at_least(y^3, 0), lunid.passive {} }
local function regressed(given)
  given.record, given.mass, given.features = train, 1, given.features or { library }
  return lunid.regress(given)
end
local physics = {}
for _, each in ipairs {
  { "library alone", regressed { solver = lunid.stlsq {} }.model },
  { "signs and passivity", regressed { solver = lunid.stlsq {}, constraints = signs }.model },
  { "damping known", lunid.model { mass = 1, restoring = 10*v + regressed { features = { y, y^2, y^3, y^4, y^5 }, known = 10*v, solver = lunid.stlsq {} }.restoring } },
  { "only the true terms, equation error", regressed { features = { y, y^3, v } }.model },
  { "only the true terms, weak form", regressed { features = { y, y^3, v }, form = lunid.weak_form {} }.model },
  { "library, free runs and trajectory", chosen(train).model },
} do
  local terms, worst = verdict(each[2], truth)
  physics[#physics + 1] = { each[1], terms, worst, run_error(each[2], test) }
end
report:table { head = { "what is known", "terms", "largest error of a true one [%]", "run error" }, rows = physics, caption = "Case 1" }
answers.physics = physics
step()

-- ---- 4: criteria ----

report:section "4. By which criteria is fidelity judged, and do they agree?"
local front, columns = {}, { r2 = {}, rmse = {}, qqcc = {}, mi = {}, error = {} }
local candidates = { { "least squares", regressed {}.model } }
for _, threshold in ipairs { 0.005, 0.02, 0.05, 0.1, 0.3 } do
  candidates[#candidates + 1] = { ("STLSQ, %g"):format(threshold), regressed { solver = lunid.stlsq { threshold = threshold } }.model }
end
for terms = 1, quick and 4 or 8 do
  candidates[#candidates + 1] = { ("best subset of %d"):format(terms), regressed { solver = lunid.best_subset { terms = terms } }.model }
  candidates[#candidates + 1] = { ("weak form, best of %d"):format(terms), regressed { solver = lunid.best_subset { terms = terms }, form = lunid.weak_form {} }.model }
end
local board = lunid.scoreboard { models = candidates, record = train, test = test, truth = duffing }
for _, row in ipairs(board.rows) do
  local at = #columns.error + 1
  columns.r2[at], columns.rmse[at], columns.qqcc[at], columns.mi[at] = row.force.r2, -row.force.rmse, row.force.qqcc, row.force.mutual_information
  columns.error[at] = row.free.nrmse and -row.free.nrmse or -1e3
end
for _, each in ipairs { { "R2 of the force", "r2" }, { "RMSE of the force", "rmse" }, { "QQCC", "qqcc" }, { "mutual information", "mi" } } do
  front[#front + 1] = { each[1], lunid.statistics.spearman(columns[each[2]], columns.error) }
end
report:table { head = { "criterion on the training records", "rank correlation with the free run on the test" }, rows = front,
  caption = ("%d candidate models of case 1: does a better criterion mean a better free run? 1: always, 0: it says nothing"):format(#candidates) }
report:table(board:measures())
answers.criteria = front
step()

-- ---- other excitations, frequencies, hidden components, sampling ----

report:section "Does it extrapolate; do two frequencies help; what is hidden; how fast to sample?"
local sweep = lunid.simulate { model = duffing, excitation = lunid.excitation.swept_sine { amplitude = 400, from = 5, to = 60, dt = 0.00125, duration = 4 } }:record()
local frequencies = {}
for _, each in ipairs { { "20 Hz", 20 }, { "30 Hz", 30 }, { "both", { 20, 30 } } } do
  local learnt = records(duffing, { frequency = each[2] })
  local found = chosen(type(learnt) == "table" and learnt or { learnt })
  local terms, worst = verdict(found.model, truth)
  frequencies[#frequencies + 1] = { each[1], terms, worst, run_error(found.model, test), run_error(found.model, sweep), run_error(found.naive.model, sweep) }
end
report:table { head = { "trained on", "terms", "largest error [%]", "run error, validation", "sweep 5-60 Hz", "usual pipeline, sweep" }, rows = frequencies }
answers.frequencies = frequencies
step()

local hidden = {}
local modified = lunid.systems.modified_duffing {}
for _, amplitude in ipairs { 300, 1000, 2000 } do
  local learnt = records(modified, { amplitude = amplitude })
  local best = lunid.fit_trajectory { model = modified, record = learnt, channels = { "y", "v" } }.model.parameters
  local cells = { amplitude }
  for _, name in ipairs { "k", "k3", "k5", "e", "c" } do
    local ratio = math.abs(modified.parameters[name].value)/best[name].std
    cells[#cells + 1] = ratio > 3 and ("seen, %.0f deviations"):format(ratio) or ("hidden, %.1f"):format(ratio)
  end
  hidden[#hidden + 1] = cells
end
report:table { head = { "amplitude [N]", "y", "y^3", "y^5", "y^3 v^2", "v" }, rows = hidden,
  caption = "Case 2: which terms can a record in 5 % noise show at all? The true equation fitted to it: value over deviation" }
answers.hidden = hidden
step()

local rates = {}
for _, rate in ipairs(quick and { 150, 300, 800 } or { 100, 150, 200, 300, 400, 800, 1600 }) do
  local learnt = lunid.thesis_record { system = duffing, frequency = { 20, 30 }, dt = 1/rate, seed = 10*seed }
  local good, found = pcall(chosen, learnt)
  if not good and tostring(found):match "interrupted" then error(found, 0) end
  if good then
    local terms, worst = verdict(found.model, truth)
    rates[#rates + 1] = { rate, rate/30, terms, worst, run_error(found.model, test), run_error(found.naive.model, test) }
  else
    rates[#rates + 1] = { rate, rate/30, "no model runs freely" }
  end
end
report:table { head = { "rate [Hz]", "samples a period", "terms", "largest error [%]", "run error", "usual pipeline" }, rows = rates,
  caption = "The thesis' rule is 10 to 20 samples a period" }
answers.sampling = rates
step()

-- ---- 5: time ----

report:section "5. Would a time-invariant model do, to be refined by time-variant parts?"
local k, k1, c = lunid.parameter { "k", 2e4 }, lunid.parameter { "k1", -600 }, lunid.parameter { "c", 10 }
local drifting = lunid.model { mass = 1, restoring = (k + k1*t)*y + 1e6*y^3 + c*v }
local push = lunid.excitation.multisine { from = 5, to = 40, rms = 150, period = 2, dt = 0.00125, duration = 6, seed = 3 }
local whole = lunid.simulate { model = drifting, excitation = push }:record():with_noise { y = 0.05, v = 0.05, seed = seed }
local early, late = whole:window(0, 3), whole:window(3, 6)
local fixed_model = lunid.model { mass = 1, restoring = lunid.parameter { "k", 1.9e4 }*y + lunid.parameter { "k3", 9e5 }*y^3 + lunid.parameter { "c", 9 }*v }
local moving = lunid.model { mass = 1, restoring = (lunid.parameter { "k", 1.9e4 } + lunid.parameter { "k1", 0 }*t)*y + lunid.parameter { "k3", 9e5 }*y^3
  + lunid.parameter { "c", 9 }*v }
local time = {}
for _, each in ipairs { { "time-invariant, fitted on the whole", fixed_model, whole }, { "time-invariant, fitted on the first half", fixed_model, early },
  { "with a drift of k, fitted on the first half", moving, early } } do
  local fit = lunid.fit_trajectory { model = each[2], record = each[3], channels = { "y", "v" } }
  local row = fit.model.parameters.k1
  time[#time + 1] = { each[1], fit.model.parameters.k.value, row and ("%.0f +- %.0f"):format(row.value, row.std), run_error(fit.model, early), run_error(fit.model, late) }
end
report:table { head = { "model", "k at t = 0", "k1 [N/m/s]", "run error, first half", "second half" }, rows = time,
  caption = "Case 1 whose stiffness falls by 600 N/m in a second (18 % in 6 s), in 5 % noise" }
answers.time = time
step()

report:results { case = "questions", variant = "0.5", runs = {}, answers = answers }
report:save()

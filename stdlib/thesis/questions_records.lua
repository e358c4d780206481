-- The questions of the thesis about records: other excitations, frequencies, hidden components, sampling, and systems that change in
-- time. Each function writes its table into the report and gives its rows.
local lunid = require "lunid"
local asked = require "asked"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local quick, duffing, truth = asked.quick, asked.duffing, asked.truth
local chosen, verdict, run_error = asked.chosen, asked.verdict, asked.run_error

local questions = {}

function questions.frequencies(report)
  report:section "Does it extrapolate, and do two frequencies help?"
  local _, test = asked.records(duffing, {})
  local sweep = lunid.simulate { model = duffing, excitation = lunid.excitation.swept_sine { amplitude = 400, from = 5, to = 60, dt = 0.00125,
    duration = 4 } }:record()
  local rows = {}
  for i, each in ipairs { { "20 Hz", 20 }, { "30 Hz", 30 }, { "both", { 20, 30 } } } do
    local learnt = asked.records(duffing, { frequency = each[2] })
    local found = chosen(type(learnt) == "table" and learnt or { learnt })
    local terms, worst = verdict(found.model, truth)
    rows[i] = { each[1], terms, worst, run_error(found.model, test), run_error(found.model, sweep), run_error(found.naive.model, sweep) }
  end
  report:table { head = { "trained on", "terms", "largest error [%]", "run error, validation", "sweep 5-60 Hz", "usual pipeline, sweep" }, rows = rows }
  return rows
end

function questions.hidden(report)
  report:section "What is hidden?"
  local modified, rows = lunid.systems.modified_duffing {}, {}
  for i, amplitude in ipairs { 300, 1000, 2000 } do
    local learnt = asked.records(modified, { amplitude = amplitude })
    local best = lunid.fit_trajectory { model = modified, record = learnt, channels = { "y", "v" } }.model.parameters
    rows[i] = { amplitude }
    for _, name in ipairs { "k", "k3", "k5", "e", "c" } do
      local ratio = math.abs(modified.parameters[name].value)/best[name].std
      table.insert(rows[i], (ratio > 3 and "seen, %.0f deviations" or "hidden, %.1f"):format(ratio))
    end
  end
  report:table { head = { "amplitude [N]", "y", "y^3", "y^5", "y^3 v^2", "v" }, rows = rows,
    caption = "Case 2: which terms can a record in 5 % noise show at all? The true equation fitted to it: value over deviation" }
  return rows
end

function questions.sampling(report)
  report:section "How fast to sample?"
  local _, test = asked.records(duffing, {})
  local rows = {}
  for i, rate in ipairs(quick and { 150, 300, 800 } or { 100, 150, 200, 300, 400, 800, 1600 }) do
    local learnt = lunid.thesis_record { system = duffing, frequency = { 20, 30 }, dt = 1/rate, seed = 10*asked.seed }
    local good, found = pcall(chosen, learnt)
    if not good and tostring(found):match "interrupted" then error(found, 0) end
    rows[i] = { rate, rate/30, "no model runs freely" }
    if good then
      local terms, worst = verdict(found.model, truth)
      rows[i] = { rate, rate/30, terms, worst, run_error(found.model, test), run_error(found.naive.model, test) }
    end
  end
  report:table { head = { "rate [Hz]", "samples a period", "terms", "largest error [%]", "run error", "usual pipeline" }, rows = rows,
    caption = "The thesis' rule is 10 to 20 samples a period" }
  return rows
end

--- A Duffing oscillator to be fitted, whose stiffness may drift.
local function guess(drifts)
  local k = lunid.parameter { "k", 1.9e4 }
  if drifts then k = k + lunid.parameter { "k1", 0 }*t end
  return lunid.model { mass = 1, restoring = k*y + lunid.parameter { "k3", 9e5 }*y^3 + lunid.parameter { "c", 9 }*v }
end

function questions.time(report)
  report:section "5. Would a time-invariant model do, to be refined by time-variant parts?"
  local k, k1, c = lunid.parameter { "k", 2e4 }, lunid.parameter { "k1", -600 }, lunid.parameter { "c", 10 }
  local drifting = lunid.model { mass = 1, restoring = (k + k1*t)*y + 1e6*y^3 + c*v }
  local push = lunid.excitation.multisine { from = 5, to = 40, rms = 150, period = 2, dt = 0.00125, duration = 6, seed = 3 }
  local whole = lunid.simulate { model = drifting, excitation = push }:record():with_noise { y = 0.05, v = 0.05, seed = asked.seed }
  local early, late = whole:window(0, 3), whole:window(3, 6)
  local rows = {}
  for i, each in ipairs { { "time-invariant, fitted on the whole", guess(false), whole }, { "time-invariant, fitted on the first half", guess(false), early },
    { "with a drift of k, fitted on the first half", guess(true), early } } do
    local model = lunid.fit_trajectory { model = each[2], record = each[3], channels = { "y", "v" } }.model
    local row = model.parameters.k1
    rows[i] = { each[1], model.parameters.k.value, row and ("%.0f +- %.0f"):format(row.value, row.std), run_error(model, early), run_error(model, late) }
  end
  report:table { head = { "model", "k at t = 0", "k1 [N/m/s]", "run error, first half", "second half" }, rows = rows,
    caption = "Case 1 whose stiffness falls by 600 N/m in a second (18 % in 6 s), in 5 % noise" }
  return rows
end

return questions

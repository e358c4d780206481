-- Questions 1 to 4 of the thesis: which method identifies what, what physics buys, and by which criteria fidelity is judged. Each
-- function writes its table into the report and gives its rows.
local lunid = require "lunid"
local asked = require "asked"
local y, v = lunid.displacement, lunid.velocity
local quick, duffing, library, truth = asked.quick, asked.duffing, asked.library, asked.truth
local chosen, verdict, run_error = asked.chosen, asked.verdict, asked.run_error

local questions = {}

--- Systems { name, system, features, truth by the name of the coefficient }.
local function systems()
  local list = { { "Duffing", duffing, { library }, truth } }
  if quick then return list end
  local p = lunid.parameter { "p", 30, min = 5, max = 300 }
  list[2] = { "tanh yield", lunid.systems.tanh_yield {}, { lunid.polynomials({ y, v }, 2), lunid.tanh(p*y) }, { c_tanh_p_y = 3000, p = 80, c_v = 10 } }
  list[3] = { "modified Duffing", lunid.systems.modified_duffing {}, { library }, { c_y = 1e4, c_y3 = 1e5, c_y5 = 5e6, c_y3_v2 = 2000, c_v = 10 } }
  return list
end

function questions.methods(report)
  report:section "1 and 2. Can a system be identified from limited measurements, and by which method?"
  local rows = {}
  for _, each in ipairs(systems()) do
    for _, noise in ipairs(quick and { 0.01, 0.05 } or { 0.01, 0.05, 0.1 }) do
      local train, test = asked.records(each[2], { noise = noise })
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
  return rows
end

--- Least squares of the force of case 1, with what is given beside record and mass.
local function regressed(train, given)
  given.record, given.mass, given.features = train, 1, given.features or { library }
  return lunid.regress(given)
end

function questions.physics(report)
  report:section "3. How physics-informed, and what does it buy?"
  local train, test = asked.records(duffing, {})
  local signs = { lunid.at_least(y, 0), lunid.at_least(v, 0), lunid.at_least(y^3, 0), lunid.passive {} }
  local rows = {}
  for i, each in ipairs {
    { "library alone", regressed(train, { solver = lunid.stlsq {} }).model },
    { "signs and passivity", regressed(train, { solver = lunid.stlsq {}, constraints = signs }).model },
    { "damping known", lunid.model { mass = 1, restoring = 10*v
      + regressed(train, { features = { y, y^2, y^3, y^4, y^5 }, known = 10*v, solver = lunid.stlsq {} }).restoring } },
    { "only the true terms, equation error", regressed(train, { features = { y, y^3, v } }).model },
    { "only the true terms, weak form", regressed(train, { features = { y, y^3, v }, form = lunid.weak_form {} }).model },
    { "library, free runs and trajectory", chosen(train).model },
  } do
    local terms, worst = verdict(each[2], truth)
    rows[i] = { each[1], terms, worst, run_error(each[2], test) }
  end
  report:table { head = { "what is known", "terms", "largest error of a true one [%]", "run error" }, rows = rows, caption = "Case 1" }
  return rows
end

--- Many models of case 1, good and bad: { name, model }.
local function candidates(train)
  local list = { { "least squares", regressed(train, {}).model } }
  for _, threshold in ipairs { 0.005, 0.02, 0.05, 0.1, 0.3 } do
    list[#list + 1] = { ("STLSQ, %g"):format(threshold), regressed(train, { solver = lunid.stlsq { threshold = threshold } }).model }
  end
  for terms = 1, quick and 4 or 8 do
    local best = lunid.best_subset { terms = terms }
    list[#list + 1] = { ("best subset of %d"):format(terms), regressed(train, { solver = best }).model }
    list[#list + 1] = { ("weak form, best of %d"):format(terms), regressed(train, { solver = best, form = lunid.weak_form {} }).model }
  end
  return list
end

function questions.criteria(report)
  report:section "4. By which criteria is fidelity judged, and do they agree?"
  local train, test = asked.records(duffing, {})
  local board = lunid.scoreboard { models = candidates(train), record = train, test = test, truth = duffing }
  local columns = { r2 = {}, rmse = {}, qqcc = {}, mi = {}, error = {} }
  for i, row in ipairs(board.rows) do
    columns.r2[i], columns.rmse[i], columns.qqcc[i], columns.mi[i] = row.force.r2, -row.force.rmse, row.force.qqcc, row.force.mutual_information
    columns.error[i] = row.free.nrmse and -row.free.nrmse or -1e3
  end
  local rows = {}
  for i, each in ipairs { { "R2 of the force", "r2" }, { "RMSE of the force", "rmse" }, { "QQCC", "qqcc" }, { "mutual information", "mi" } } do
    rows[i] = { each[1], (lunid.statistics.spearman(columns[each[2]], columns.error)) }  -- and not its probability
  end
  report:table { head = { "criterion on the training records", "rank correlation with the free run on the test" }, rows = rows,
    caption = ("%d candidate models of case 1: does a better criterion mean a better free run? 1: always, 0: it says nothing"):format(#board.rows) }
  report:table(board:measures())
  return rows
end

return questions

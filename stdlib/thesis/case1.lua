-- Case 1 (thesis, section 2.3): a Duffing oscillator, a + 2e4*y + 1e6*y^3 + 10*v = F, shaken at 20 and 30 Hz and measured with
-- 5 % noise. Which of 20 terms does its equation hold? The thesis ended with four false ones; Lunid judges candidates by
-- free runs, fits them on the trajectory, and ends with the three true ones.
local lunid = require "lunid"
local published, plots = require "published", require "plots"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Case 1: Duffing oscillator" }
local system = lunid.systems.duffing {}  -- the truth; its defaults are those of the case
local library = lunid.polynomials({ y, v }, 5)  -- the 20 terms of the thesis

--- A test by the thesis' protocol (section 2.1), and the validation record that nothing is fitted to.
local function records(number)
  local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, seed = 10*number }
  return train, lunid.thesis_validation { system = system, from = train[1] }
end

--- What the equation holds, by free runs and the trajectory.
local function identified(train) return lunid.select { record = train, mass = 1, features = { library } } end

-- ---- one test in full ----

local train, test = records(seed)
plots.data(report, train[1], 1)

report:section "The restoring force surface"
local surface = lunid.rfs { record = train, mass = 1, order = { 4, 4 }, expand = "quadrature",
  interpolate = quick and { lunid.grid {}, lunid.nearest {}, lunid.mlp {} } or "all" }
plots.surface(report, surface, train, plots.learners_of(quick))
report:table(published.rfs_table(published.case1.rfs, surface))

report:section "Which terms?"
local found = identified(train)
local cut = lunid.regress { record = train, mass = 1, features = { library }, solver = lunid.stlsq { threshold = 0.05 } }
local ranking = lunid.rank_features { record = train[1], mass = 1, features = { library },
  regression = lunid.regress { record = train[1], mass = 1, features = { library } } }
plots.ranking(report, ranking, { "y", "y^3", "v" })
plots.pruning(report, train, library, 1)

report:section "The answers side by side"
local board = lunid.scoreboard { record = train, test = test, truth = system, models = {
  { "thesis, custom RX", published.model(published.case1.rx) },
  { "PySINDy as published", published.model(published.case1.pysindy) },
  { "RX made again", cut.model },
  { "usual pipeline made again", found.naive.model },
  { "RFS, 4 x 4", lunid.model { mass = 1, restoring = surface.restoring } },
  { "Lunid", found.model },
  { "truth", system },
} }
report:table(board:terms())
report:table(board:measures())
for _, each in ipairs(board:figures()) do report:figure(each.name, each.figure, each.caption) end
report:text(("The thesis gives R2 %.2f for the force of its RFS; its records, and their noise, are not these. RX made again: least "
  .. "squares on the derived acceleration, cut off at 5 %% of the force; usual pipeline: central differences and STLSQ."):format(
  published.case1.rfs_r2))

-- ---- five seeds of the noise ----

report:section "Every seed of the noise"
local runs, rows = {}, {}
for number = seed, seed + (quick and 2 or 4) do
  local fitted, validation = train, test
  if number > seed then fitted, validation = records(number) end
  local answer = number > seed and identified(fitted) or found
  local own = lunid.scoreboard { record = fitted, test = validation, truth = system, models = { { "Lunid", answer.model } } }
  local run = own:result "Lunid"
  run.seed, run.equation = number, 1
  runs[#runs + 1] = run
  local function off(term) return ("%.2f"):format(100*(run.terms[term].value / run.terms[term].truth - 1)) end
  rows[#rows + 1] = { number, answer.terms, off "y", off "y^3", off "v", ("%.4f"):format(run.free_run.nrmse) }
  report:progress("seeds", #runs, quick and 3 or 5)
end
report:table { head = { "seed", "terms", "k1 off [%]", "k3 off [%]", "c off [%]", "run error" }, rows = rows,
  caption = "Lunid's answer; the truth has 3 terms. The information in such a record limits k1, k3 and c to 0.3, 0.3 and 0.4 %" }

report:results { case = "case1", variant = "1", runs = runs }
report:save()

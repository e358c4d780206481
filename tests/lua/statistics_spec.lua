-- lunid.statistics on columns, lunid.compare on models and records, lunid.rank_features on features.
local lunid = require "lunid"
local spec = require "spec"
local statistics = lunid.statistics

local y, v = lunid.displacement, lunid.velocity
local model = lunid.model { mass = 49, restoring = 773.8e3*y + 369*v + 1.161e10*y^3 }
local record = lunid.read "../data/spring_multisine.csv"
local run = lunid.simulate { model = model, excitation = record, from = "record" }

local a = { 1, 2, 2, 3, 4, 7, 5, 9 }
local b = { 0, 2, 1, 5, 5, 6, 8, 7 }

spec.case("measures of plain columns", function()
  spec.equal(statistics.rmse({ 1, 2, 3, 4 }, { 1, 2, 3, 6 }), 1)
  spec.near(statistics.nrmse({ 1, 2, 3, 4 }, { 1, 2, 3, 6 }), 1/math.sqrt(1.25), 1e-15)
  spec.near(statistics.r2({ 1, 2, 3, 4 }, { 1, 2, 3, 6 }), 1 - 4/5, 1e-15)
  spec.near(statistics.fit({ 1, 2, 3, 4 }, { 1, 2, 3, 6 }), 100*(1 - 1/math.sqrt(1.25)), 1e-12)
  local tau, p = statistics.kendall(a, b)
  spec.near(tau, 22/27, 1e-14)  -- 24 pairs of one order, 2 of the other, one tie in either
  assert(p > 0.001 and p < 0.02, p)
  local rho = statistics.spearman(a, b)
  assert(rho > 0.8 and rho < 1)
  local r, chance = statistics.correlation(record:column "F", record:column "a")
  assert(math.abs(r) > 0.1 and chance < 0.05, r)
  spec.equal(statistics.dtw({ { 0, 1, 2 } }, { { 0, 2 } }), 1)
  spec.equal(statistics.significance_index(0.5, -3, { 1, -4, 2 }), 6)
end)

spec.case("information, components, distributions and residual tests of a record", function()
  local force, displacement, velocity = record:column "F", record:column "y", record:column "v"
  local acceleration = record:column "a"
  local alone = statistics.mutual_information(displacement, acceleration)
  assert(alone > 0.3 and alone < 5, alone)
  local beyond = statistics.conditional_mutual_information(force, acceleration, { displacement })  -- F = m*a + f(y, v)
  assert(beyond > 2*statistics.mutual_information(force, acceleration), beyond)
  local components = statistics.principal_components { { displacement, velocity, force } }
  spec.equal(#components.directions, 3)
  spec.near(components.shares[1] + components.shares[2] + components.shares[3], 1, 1e-12)
  spec.contains(tostring(components), "3 principal components: ")
  local points = statistics.qq(displacement)
  spec.equal(#points.expected, #displacement)
  spec.equal(statistics.qqcc(displacement), points.qqcc)
  local d, p = statistics.kolmogorov_smirnov { { -1.2, -0.4, 0.1, 0.6, 1.4 }, std = 1 }
  assert(d < 0.3 and p > 0.5, p)
  d, p = statistics.kolmogorov_smirnov { { 1, 2, 3, 4, 5 }, { 6, 7, 8, 9, 10 } }
  spec.equal(d, 1)
  spec.near(p, 2/252, 1e-14)  -- two of the 252 orders
  local white = statistics.whiteness { displacement, lags = 10 }
  spec.equal(#white.coefficients, 10)
  assert(white.p_value < 1e-10 and white.beyond == 10)
  local q, chance = statistics.ljung_box { displacement, lags = 10 }
  spec.equal(q, white.statistic)
  spec.equal(chance, white.p_value)
  local z = statistics.runs_test(displacement)
  assert(z < -3, z)
  local follows = statistics.cross_correlation { displacement, force, lags = 5 }
  spec.equal(#follows.lags, 11)
  spec.contains(tostring(follows), "cross-correlation at 11 lags: ")
end)

spec.case("an interval of any statistic, one's own too", function()
  local noise = lunid.excitation.white_noise { rms = 1, seed = 3, dt = 0.01, duration = 4 }:column "F"
  local mean = statistics.interval { of = function(x) return x:mean() end, columns = { noise }, draws = 299 }
  assert(mean.low < mean.value and mean.value < mean.high)
  spec.near(mean.std, 1/math.sqrt(401), 0.02)
  local again = statistics.interval { of = function(x) return x:mean() end, columns = { noise }, draws = 299 }
  spec.equal(mean.low, again.low)
  local information = statistics.interval { of = statistics.mutual_information, method = "jackknife",
    columns = { record:column "y", record:column "F" } }
  assert(information.low < information.value and information.value < information.high)
  spec.contains(tostring(information), "jackknife of blocks of ")
end)

spec.case("a free run beside a record: every measure, with mode, data and window", function()
  local found = lunid.compare { run = run, record = record, data = "train", window = lunid.window(1, 7), interval = 0.9,
    draws = 199 }
  spec.equal(found.mode, "free_run")
  spec.equal(found.data, "train")
  spec.equal(found.record, record.name)
  spec.equal(found.rows, 4801)
  spec.near(found.window.from, 1, 1e-9)
  spec.equal(found.unit, "m")
  assert(found.r2 > 0.97 and found.qqcc > 0.9 and found.dtw < 0.2 and found.mutual_information > 1, tostring(found))
  assert(found.intervals.rmse.low < found.rmse and found.rmse < found.intervals.rmse.high)
  spec.near(found.residual:rms(), found.rmse, 1e-15)
  spec.contains(tostring(found),
    ("free run of y on train record %s, 1 to 7 s (4801 rows at 800 Hz)\n  rmse      "):format(record.name))
  for _, word in ipairs { "R2", "QQCC", "DTW", "MI", "Kendall", "Ljung-Box", "cross-correlations", "intervals hold with 90 %" } do
    spec.contains(tostring(found), word)
  end
  spec.equal(#found:qq().found, 4801)
  spec.contains(tostring(found:figure()), "figure")
end)

spec.case("a model by free run, by one step and by equation error; a regression; columns", function()
  local part = lunid.window(1, 2)
  local free = lunid.compare { model = model, record = record, window = part }
  local step = lunid.compare { model = model, record = record, window = part, mode = "one_step" }
  local equation = lunid.compare { model = model, record = record, window = part, mode = "equation_error" }
  spec.equal(free.mode, "free_run")
  spec.contains(tostring(step), "one-step prediction of y on record")
  spec.contains(tostring(equation), "equation error of F - m*a on record")
  assert(step.rows == free.rows - 1 and equation.dtw == nil and equation.unit == "N")
  local fit = lunid.regress { record = record, mass = 49, features = { y, v, y^3 }, window = part }
  local fitted = lunid.compare { regression = fit, record = record, window = part }
  spec.near(fitted.r2, fit.r2, 1e-9)
  spec.near(fitted.rmse, fit.rmse, 1e-9*fit.rmse)
  local own = lunid.compare { predicted = free.predicted, record = record, window = part, mode = "free_run" }
  spec.equal(own.rmse, free.rmse)
end)

spec.case("a run that explodes has no measures and says why", function()
  local explosive = lunid.model { mass = 49, restoring = -1e6*y - 1e12*y^3 }
  local found = lunid.compare { model = explosive, record = record }
  spec.equal(found.rmse, nil)
  assert(found.stopped_at < 8 and #found.cause > 0)
  spec.contains(tostring(found), "; no measure holds for such a run")
end)

spec.case("an imposed motion is judged by its force", function()
  local damper = lunid.model { mass = 49, restoring = 773.8e3*y + 369*v, motion = "imposed" }
  local found = lunid.compare { model = damper, record = record }
  spec.equal(found.mode, "imposed_motion")
  spec.equal(found.quantity, "F")
end)

spec.case("features ranked by what they tell", function()
  local fit = lunid.regress { record = record, mass = 49, features = { lunid.polynomials({ y, v }, 3) } }
  local ranking = lunid.rank_features { record = record, mass = 49, regression = fit, given = { y } }
  spec.equal(#ranking, 9)
  assert(ranking[1].information >= ranking[2].information)
  assert(ranking["y^3"].information > ranking["v^2"].information)
  spec.near(ranking.y.significance, ranking.y.information * ranking.y.contribution, 1e-9*ranking.y.significance)
  spec.contains(tostring(ranking), ("features of F - 49*a; record %s, 0 to 8 s, 6401 rows\n"):format(record.name))
  spec.contains(tostring(ranking), "MI beyond: what the feature tells beyond y")
  local plain = lunid.rank_features { target = record:column "F", columns = { { "y", record:column "y" } } }
  spec.equal(plain[1].name, "y")
end)

local function fault(run_it, message) spec.equal(spec.message_of(run_it), message) end

spec.case("faults of columns", function()
  fault(function() statistics.kendall({ 1, 2, 3 }, { 1, 2 }) end,
    "kendall: columns 1 and 2 have 3 and 2 rows: cut them to one window")
  fault(function() statistics.spearman({ 1, 2, 3 }, { 5, 5, 5 }) end,
    "spearman: column 2 is constant, 5: nothing can vary with it")
  fault(function() statistics.r2({ 5, 5, 5 }, { 1, 2, 3 }) end, "r2: the column is constant, 5: nothing can vary with it")
  fault(function() statistics.rmse(record:column "y", { 1 }) end,
    "rmse: columns 1 and 2 have 6401 and 1 rows: cut them to one window")
  fault(function() statistics.mutual_information({ 1, 2, 3, 4 }, { 1, 2, 3, 5 }) end,
    "mutual_information: column 1: expected 5 rows or more, got 4")
  fault(function() statistics.mutual_information({ 1, 2, 3, 4, 5 }, { 1, 2, 3, 5, 4 }, 5) end,
    "mutual_information: neighbours: expected 1 to 4, got 5")
  fault(function() statistics.kendall({ 1, 2, 3 }, "y") end,
    "statistics.kendall: b: expected a column or a list of numbers, got the string 'y'")
  local gap = record:with_noise { y = lunid.noise.dropped { fraction = 0.01, fill = "gap" }, seed = 1 }:column "y"
  local row = 1
  while gap[row] == gap[row] do row = row + 1 end
  fault(function() statistics.rmse(gap, record:column "y") end,
    ("rmse: column 1 is not a number at row %d of 6401: leave such rows out of the window"):format(row))
  fault(function() statistics.whiteness { { 1, 2, 3, 4, 6 }, lags = 5 } end, "whiteness: lags: expected 1 to 4, got 5")
  fault(function() statistics.ljung_box { { 1, 2, 3, 4, 6 }, lags = 5 } end,
    "ljung_box: lags: expected more than 0 and fewer than 5, got 5")
  fault(function() statistics.dtw({ { 1, 2 } }, { { 1, 2 }, { 1, 2 } }) end,
    "dtw: expected as many columns in the one curve as in the other, got 1 and 2")
  fault(function() statistics.interval { of = function() return "x" end, columns = { record:column "y" } } end,
    "interval: of: expected the function to return a number, got the string 'x'")
  fault(function() statistics.interval { of = statistics.rmse, columns = { a } } end,
    "interval: the column: expected 10 rows or more, got 8")
  fault(function() statistics.kolmogorov_smirnov { a, mean = 1 } end, "statistics.kolmogorov_smirnov: mean: goes with std")
  fault(function() statistics.kolmogorov_smirnov { a, b, std = 1 } end,
    "statistics.kolmogorov_smirnov: other: expected another column or a normal distribution, got both")
  fault(function() return statistics.kendal end, "lunid.statistics has no 'kendal', did you mean 'kendall'?")
end)

spec.case("faults of comparisons and rankings", function()
  fault(function() lunid.compare { record = record } end,
    "compare: expected one of run, model, regression and predicted, got 0 of them")
  fault(function() lunid.compare { run = run, record = record, window = lunid.window(2, 9) } end,
    "compare: window: 2 to 9 s is not within 0 to 8 s, the time of run and record")
  fault(function() lunid.compare { model = model, record = record, window = lunid.window(2, 9) } end,
    "compare: window: 2 to 9 s is not within 0 to 8 s, the time of the record")
  fault(function() lunid.compare { run = run, record = record, mode = "one_step" } end,
    "compare: mode: a run is a 'free_run'; give the model for 'one_step'")
  fault(function() lunid.compare { run = run, record = record, channel = "x" } end,
    "compare: channel: the record has no 'x' (it has F, y, v, a)")
  fault(function() lunid.compare { predicted = { 1, 2 }, record = record, mode = "free_run" } end,
    "compare: predicted: expected 6401 rows, as the record has in the window, got 2")
  fault(function() lunid.compare { predicted = record:column "y", record = record } end,
    "compare: mode: say what the predicted column is: 'free_run', 'one_step' or 'equation_error'")
  local other = lunid.simulate { model = model, excitation = 10*lunid.sin(lunid.time), dt = 0.01, duration = 1 }
  fault(function() lunid.compare { run = other, record = record } end,
    "compare: the run steps by 0.01 s, the record by 0.00125 s: simulate with the record as excitation")
  local z = lunid.state { "z", rate = v }
  local memory = lunid.model { mass = 49, restoring = 1e5*y + 10*z }
  fault(function() lunid.compare { model = memory, record = record, mode = "one_step" } end,
    "compare: mode 'one_step': the state 'z' is not measured: take mode = \"free_run\"")
  fault(function() lunid.compare { model = memory, record = record, mode = "equation_error" } end,
    "compare: the state 'z' is not measured: take mode = \"free_run\"")
  local damper = lunid.model { mass = 0, restoring = 369*v, motion = "imposed" }
  fault(function() lunid.compare { model = damper, record = record, mode = "one_step" } end,
    "compare: mode: the motion of this model is imposed, its force is compared; got 'one_step'")
  fault(function() lunid.compare { model = model, record = record, mode = "one_step", channel = "v" } end,
    "compare: channel: mode 'one_step' has no other, got 'v'")
  fault(function() lunid.rank_features { record = record, features = { y, 1 } } end,
    "rank_features: the feature '1' is constant, 1: leave it out")
  fault(function() lunid.rank_features { features = { y } } end,
    "rank_features: expected a record with features, or a target with columns")
  fault(function() lunid.rank_features { record = record, features = { lunid.sqrt(-1 - y^2) } } end,
    "rank_features: 'sqrt(-1 - y^2)' is not finite at t = 0 s: leave such rows out of the window")
end)

spec.clean()
spec.finish()

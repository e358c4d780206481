-- How uncertainty in measurements propagates to the model and to its predictions (thesis, conclusions): case 1 at several levels of noise.
-- Deviations of the parameters come from one fit, that of the predicted motion from them and the sensitivities of the free run; what many
-- seeds of the noise scatter by stands beside them.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Uncertainty: from the noise to the prediction" }
local system = lunid.systems.duffing {}
local names, truth = { "k", "k3", "c" }, { k = 2e4, k3 = 1e6, c = 10 }
local guess = lunid.model { mass = 1, restoring = lunid.parameter { "k", 1.9e4 }*y + lunid.parameter { "k3", 9e5 }*y^3 + lunid.parameter { "c", 9 }*v }
local clean = lunid.thesis_record { system = system, frequency = { 20, 30 }, noise = 0, seed = 1 }
local test = lunid.thesis_validation { system = system, from = clean[1] }

--- The deviation of the predicted y at each row of a run: of the parameters', by the run's sensitivities to them.
local function predicted_deviation(fit, run)
  local slopes, deviation = {}, {}
  for i, name in ipairs(names) do slopes[i] = run:sensitivity("y", name) end
  for r = 1, run.rows do
    local variance = 0
    for i, one in ipairs(names) do
      for j, other in ipairs(names) do
        variance = variance + slopes[i][r]*slopes[j][r]*fit.correlation[i][j]*fit.model.parameters[one].std*fit.model.parameters[other].std
      end
    end
    deviation[r] = math.sqrt(variance)
  end
  return deviation
end

local rows, runs, scale = {}, {}, test:column("y"):std()
local seeds = quick and 6 or 20
local levels = quick and { 0.02, 0.05 } or { 0.01, 0.02, 0.05, 0.1 }
for level, noise in ipairs(levels) do
  local said, scatter, error_square, said_square, within, count = { k = 0, k3 = 0, c = 0 }, { k = 0, k3 = 0, c = 0 }, 0, 0, 0, 0
  for number = 1, seeds do
    local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, noise = noise, seed = 1000*seed + seeds*level + number }
    local fit = lunid.fit_trajectory { model = guess, record = train, channels = { "y", "v" } }
    local run = lunid.simulate { model = fit.model, excitation = test, from = "record", sensitivities = true }
    local deviation, error = predicted_deviation(fit, run), {}
    for r = 1, run.rows do
      error[r] = run:column("y")[r] - test:column("y")[r]
      error_square, said_square, count = error_square + error[r]^2, said_square + deviation[r]^2, count + 1
      within = within + (math.abs(error[r]) <= 2*deviation[r] and 1 or 0)
    end
    for _, name in ipairs(names) do
      local row = fit.model.parameters[name]
      said[name], scatter[name] = said[name] + row.std^2/seeds, scatter[name] + (row.value - truth[name])^2/seeds
    end
    if number == 1 and noise == 0.05 then
      local t, off, high, low = {}, {}, {}, {}
      for r = 1, math.floor(0.3/run.dt) do t[r], off[r], high[r], low[r] = run:column("t")[r], error[r], 2*deviation[r], -2*deviation[r] end
      local series = lunid.figure.series
      report:figure("prediction", lunid.figure.lines { x = "time [s]", y = "error of the free run [m]", series = { series { t, off, label = "run - truth",
        role = "residual" }, series { t, high, label = "two deviations", role = "noise", style = "dashed" }, series { t, low, role = "noise",
        style = "dashed" } } }, "The error of the free run at the beginning of the validation record, and what the fit says of it (5 % noise)")
    end
  end
  local row = { 100*noise }
  for _, name in ipairs(names) do row[#row + 1] = ("%.3f, %.3f"):format(100*math.sqrt(said[name])/truth[name], 100*math.sqrt(scatter[name])/truth[name]) end
  row[5], row[6], row[7] = 100*math.sqrt(said_square/count)/scale, 100*math.sqrt(error_square/count)/scale, 100*within/count
  rows[level] = row
  runs[level] = { noise = noise, said = math.sqrt(said_square/count)/scale, found = math.sqrt(error_square/count)/scale, within = within/count }
  report:progress("noise levels", level, #levels)
end
report:table { head = { "noise [%]", "k: said, found [%]", "k3", "c", "run: said [%]", "found [%]", "within 2 deviations [%]" }, rows = rows,
  caption = ("Deviations that one fit says, and what %d seeds scatter by; of the free run over the validation record, over the deviation of its motion. "
    .. "Uncertainty grows as the noise does: nothing of it comes from false terms"):format(seeds) }
report:results { case = "uncertainty", variant = "conclusions", runs = runs }
report:save()

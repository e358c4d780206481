-- lunid.fit_trajectory: what a fit tells, and its faults.
local lunid = require "lunid"
local spec = require "spec"

local record = lunid.read "../data/spring_multisine.csv"
local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", 7e5, min = 0, unit = "N/m" }
local c = lunid.parameter { "c", 300, min = 0 }
local k3 = lunid.parameter { "k3", 9e9 }
local model = lunid.model { mass = 49, restoring = k*y + c*v + k3*y^3 }

spec.case("a fit tells values, deviations, correlations and intervals", function()
  local fit = lunid.fit_trajectory { model = model, record = record, interpolation = "band_limited" }
  assert(fit.summary.converged and fit.summary.rows == record.rows)
  local row = fit.model.parameters.k3
  assert(math.abs(row.value - 1.1607e10) < 4*row.std, tostring(fit))  -- tests/data/README: the truth
  assert(math.abs(fit.correlation[1][1] - 1) < 1e-12 and math.abs(fit.correlation[1][2] - fit.correlation[2][1]) < 1e-12)
  local profile = fit:profile "k3"
  assert(profile.low < row.value and row.value < profile.high)
  spec.equal(#profile.value, #profile.drop)
  assert(math.abs(fit:residual():std() - fit.summary.rmse) < 0.01*fit.summary.rmse)
  spec.contains(tostring(fit), "k3 = ")
  assert(math.abs(fit.summary.gap/(fit.summary.rmse/record:column "y":std()) - 1) < 0.01)
  assert(not tostring(fit):find("no fit", 1, true))
end)

spec.case("a fit that a constant does as well as is said to be none", function()
  local fit = lunid.fit_trajectory { model = model:with { k = 7e7, k3 = 0 }, record = record, max_iterations = 1 }
  assert(fit.summary.gap > 0.9, tostring(fit))
  spec.contains(tostring(fit), "this is no fit: a constant leaves as much of the motion")
end)

spec.case("what a free decay does not tell has no deviation, and the fit says so", function()
  local ys, nothing = {}, {}
  for i = 1, 600 do
    local t = 0.01*(i - 1)
    ys[i], nothing[i] = 0.02*math.exp(-0.3*t)*math.cos(9*t), 0
  end
  local decay = lunid.record { channels = { { "F", nothing }, { "y", ys } }, dt = 0.01 }
  local m = lunid.parameter { "m", 1.2, min = 0.1 }
  local open = lunid.model { mass = m, restoring = lunid.parameter { "k", 80, min = 0 }*y + lunid.parameter { "c", 1 }*v }
  local fit = lunid.fit_trajectory { model = open, record = decay }
  spec.equal(table.concat(fit.summary.unidentifiable, " "), "m k c")
  spec.contains(tostring(fit), "(not identifiable)")
  spec.contains(tostring(fit), "note: other values of m, k, c, together, make the same motion on these records: fix one of them")
  local known = lunid.fit_trajectory { model = open:with { m = { value = 1, fixed = true } }, record = decay }
  spec.equal(#known.summary.unidentifiable, 0)
  spec.near(known.model.parameters.k.value, 81.09, 0.01)
end)

spec.case("separate parameters, one model for each record", function()
  local fit = lunid.fit_trajectory { model = model, record = { record:window(0, 3), record:window(3, 6) },
    separate = { "c" }, interpolation = "band_limited" }
  spec.equal(#fit.models, 2)
  spec.equal(fit.models[1].parameters.k.value, fit.models[2].parameters.k.value)
  assert(fit.models[1].parameters.c.value ~= fit.models[2].parameters.c.value)
  spec.contains(tostring(fit), "(record 2)")
end)

-- Samples that are far off raise what a spectrum shows of noise tenfold; the weight of y beside v must not see that.
spec.case("a run goes through no gap: what was interpolated there, motion and force, is fitted by nobody", function()
  local rows, whole = {}, record:column "t":list()
  local force, motion = record:column "F":list(), record:column "y":list()
  for i = 1, #whole do
    if i <= 2000 or i > 2060 then rows[#rows + 1] = ("%.17g,%.17g,%.17g"):format(whole[i], force[i], motion[i]) end
  end
  spec.write("gap.csv", "t,F,y\n" .. table.concat(rows, "\n") .. "\n")
  local cut = lunid.read(spec.folder .. "/gap.csv", { resample = true })
  local fit = lunid.fit_trajectory { model = model, record = cut, interpolation = "band_limited" }
  spec.equal(fit.summary.rows, #rows)
  local row = fit.model.parameters.k3
  assert(math.abs(row.value - 1.1607e10) < 4*row.std, tostring(fit))
end)

spec.case("outliers in one channel leave the weights of the channels alone", function()
  local truth = lunid.model { mass = 1, restoring = 2e4*y + 10*v }
  local push = lunid.excitation.multisine { from = 5, to = 60, rms = 60, period = 2, dt = 0.00125, duration = 2, seed = 1 }
  local wild = lunid.simulate { model = truth, excitation = push }:record():with_noise { seed = 1, v = 0.03,
    y = { lunid.noise.gaussian { relative = 0.03 }, lunid.noise.outliers { fraction = 0.005, relative = 5 } } }
  local fit = lunid.fit_trajectory { model = lunid.model { mass = 1, restoring = k*y + c*v }:with { k = 1.8e4, c = 15 }, record = wild,
    channels = { "y", "v" }, loss = "huber" }
  local share = fit.summary.outliers/fit.summary.rows
  assert(0.15 < share and share < 0.25, share)  -- 18 % of a Gaussian lie beyond 1.345 deviations
  local row = fit.model.parameters.k
  assert(math.abs(row.value - 2e4) < 4*row.std, tostring(fit))
  assert(fit.summary.checked < 1e-4)
  spec.equal(lunid.fit_trajectory { model = fit.model, record = wild, check = false }.summary.checked, nil)
end)

spec.case("a parameter that the rows do not show has no deviation", function()
  local truth = lunid.model { mass = 1, restoring = 2e4*y + 10*v }
  local push = lunid.excitation.multisine { from = 5, to = 60, rms = 60, period = 2, dt = 0.00125, duration = 2, seed = 1 }
  local record = lunid.simulate { model = truth, excitation = push }:record():with_noise { seed = 1, y = 0.01 }
  local stop = lunid.parameter { "ks", value = 1e4, min = 0 } * lunid.max(y - 1, 0)  -- a metre away
  local fit = lunid.fit_trajectory { model = lunid.model { mass = 1, restoring = k*y + c*v + stop }:with { k = 1.8e4, c = 15 },
    record = record }
  assert(fit.model.parameters.k.std > 0)
  spec.equal(fit.model.parameters.ks.std, nil)
  spec.equal(fit.model.parameters.ks.value, 1e4)
  assert(tostring(fit):find "ks = 10000\n" or tostring(fit):find "ks = 10000$", tostring(fit))
end)

local function fault(run, message)
  local good, said = pcall(run)
  assert(not good, "no error")
  spec.contains(tostring(said), message)
end

spec.case("faults", function()
  fault(function() lunid.fit_trajectory { model = model, record = record, separate = { "kk" } } end,
    "fit_trajectory: separate: the model has no parameter 'kk', did you mean 'k'?")
  fault(function() lunid.fit_trajectory { model = model, record = record, channels = { "x" } } end,
    "fit_trajectory: channels: expected displacements, velocities or accelerations of the model, got 'x'")
  fault(function() lunid.fit_trajectory { model = model, record = record, los = "huber" } end,
    "fit_trajectory: unknown field 'los', did you mean 'loss'?")
end)

spec.case("a guess whose run leaves the motion, and is stiff out there, chooses no steps: its fit converges on the truth", function()
  local c1, f1, p = lunid.parameter { "c1", 10 }, lunid.parameter { "f1", 3000 }, lunid.parameter { "p", 80 }
  local system = lunid.model { mass = 1, restoring = f1*lunid.tanh(p*y) + c1*v }
  local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, seed = 10 }
  local b1, slope = lunid.parameter { "b1", 17.39 }, lunid.parameter { "slope", 30, min = 5, max = 300 }
  local fit = lunid.fit_trajectory { model = lunid.model { mass = 1, restoring = f1*lunid.tanh(slope*y) + c1*v + b1*y*v^2 }, record = train }
  spec.equal(fit.summary.converged, true)
  local row = fit.model.parameters.slope
  spec.near(row.value, 80, 3*row.std)
end)

spec.clean()
spec.finish()

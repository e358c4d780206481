-- The choice of a model: many cheap candidates out of one library of features, judged by free runs.
--
-- Candidates come from regressions on motions smoothed to several widths, term after term taken away. Free runs reject
-- what is unstable, the best of each size are fitted on the trajectory and thinned there by what is not significant, and
-- the judge of the rest is a free run over data that nothing was fitted to.
local candidates = require "lunid.candidates"
local core = require "lunid.core"
local regression = require("lunid.regression")
local schema = require "lunid.schema"
local solvers = require "lunid.solvers"
local trajectory = require "lunid.trajectory_search"
local types = schema.types

local selection = {}

local record = types.is("record", "lunid.read")
local key_of, smoothed = candidates.key_of, candidates.smoothed
local judge, reject, criterion, refined = trajectory.judge, trajectory.reject, trajectory.criterion, trajectory.refined

--- The share of rows that count as independent, from the residual's correlation with the row before: what a fit leaves
--- where there is no noise is the error of the integration, and that of neighbouring rows is one.
local function independent_share(fit, records)
  local products, squares = 0, 0
  for i = 1, #records do
    local residual = fit:residual(i)
    for k = 2, #residual do
      local product, square = residual[k]*residual[k - 1], residual[k]^2
      if product == product then products, squares = products + product, squares + square end
    end
  end
  local correlation = squares > 0 and math.max(0, math.min(0.9999, products / squares)) or 0
  return (1 - correlation) / (1 + correlation)
end

--- Per term its rms over that of the restoring force along the measured motion; nil for one with a parameter inside.
local function contributions(candidate, given, records)
  local features, held, places, out = {}, {}, {}, {}
  for i, feature in ipairs(candidate.features) do
    local inner = false
    for _, symbol in ipairs(core.is_expression(feature) and feature:symbols() or {}) do
      inner = inner or symbol.kind == "parameter"
    end
    if not inner then
      features[#features + 1], places[#places + 1] = feature, i
      local value = candidate.model.parameters[i].value
      held[#held + 1] = { terms = { { feature = feature, weight = 1 } }, lower = value, upper = value, place = "" }
    end
  end
  if #features == 0 then return out end
  local fit = core.regress(records, { mass = given.mass, known = given.known, features = features, constraints = held,
    blocks = 1 })
  for i, place in ipairs(places) do out[place] = fit.terms[i].contribution end
  return out
end

--- Rejects a candidate with a term that contributes less than the cut-off: what such a term describes is error.
local function cut_off(candidate, given, records)
  candidate.contributions = contributions(candidate, given, records)
  for i = 1, candidate.terms do
    local part = candidate.contributions[i]
    if part and part < given.cut_off then
      reject(candidate, ("%s is %.2g %% of the restoring force, below the cut-off of %g %%"):format(candidate.features[i],
        100*part, 100*given.cut_off))
      return
    end
  end
end

--- The candidate of least criterion for each number of terms, judged on the holdout.
local function pareto_front(fitted, given, train, holdout)
  local best, sharp = {}, trajectory.least_criterion(fitted)
  local share = sharp and independent_share(sharp.fit, train)
  for _, candidate in ipairs(fitted) do candidate.criterion = criterion(candidate, #given.features, share) end
  for _, candidate in ipairs(fitted) do
    local other = best[candidate.terms]
    if not other or candidate.criterion < other.criterion then best[candidate.terms] = candidate end
  end
  local sizes, front, least = {}, {}, math.huge
  for terms in pairs(best) do sizes[#sizes + 1] = terms end
  table.sort(sizes)
  for _, terms in ipairs(sizes) do
    local candidate, reason = best[terms], nil
    candidate.train_gap, reason = judge(candidate, train)
    if not candidate.train_gap then reject(candidate, reason) end
    candidate.holdout_gap, reason = judge(candidate, holdout)
    if not candidate.holdout_gap then reject(candidate, "on the holdout, " .. reason) end
    if not candidate.rejected then cut_off(candidate, given, train) end
    if not candidate.rejected then
      candidate.on_front = candidate.cost < least
      least = math.min(least, candidate.cost)
    end
    front[#front + 1] = candidate
  end
  return front
end

--- Among those whose free run on the holdout is within a tenth of the best one: the fewest terms whose criterion is
--- within `strong` of the least, since only strong evidence (Kass & Raftery 1995) is to add a term.
local function choose(front)
  local strong = 10
  local gap, least = math.huge, math.huge
  for _, candidate in ipairs(front) do
    if not candidate.rejected then gap = math.min(gap, candidate.holdout_gap) end
  end
  local function good(candidate) return not candidate.rejected and candidate.holdout_gap <= 1.1*gap end
  for _, candidate in ipairs(front) do
    if good(candidate) then least = math.min(least, candidate.criterion) end
  end
  for _, candidate in ipairs(front) do
    if good(candidate) and candidate.criterion <= least + strong then return candidate end
  end
end

--- What the equation error alone would choose: the least of the same criterion among the regressions on one smoothed
--- motion, never run.
local function by_equation_error(pool, given, holdout, half)
  local best, least = nil, math.huge
  for _, candidate in ipairs(pool) do
    if candidate.strong == half then
      local value = criterion({ model = candidate.model, rows = candidate.rows,
        cost = candidate.rows*math.max(1 - candidate.r2, 1e-300) }, #given.features, 1)
      if value < least then best, least = candidate, value end
    end
  end
  if not best then return nil end
  local gap, reason = judge(best, holdout)
  return { model = best.model, terms = best.terms, names = key_of(best.features), r2 = best.r2, holdout_gap = gap,
    rejected = reason }
end

--- What the usual pipeline gives: central differences and thresholded least squares.
local function naive_model(given, train)
  local fit = core.regress(smoothed(train, 0), { mass = given.mass, known = given.known, features = given.features,
    blocks = 1, search = given.search, solver = solvers.public.stlsq {} })
  return { model = fit.model, regression = fit, r2 = fit.r2 }
end

--- The first part of each record to learn from, the rest to judge.
local function split(list, part)
  local train, holdout = {}, {}
  for i, each in ipairs(list) do
    local at = each.start + (1 - part)*each.duration
    train[i], holdout[i] = each:window(each.start, at), each:window(at, each.start + each.duration)
  end
  return train, holdout
end

local function list_of(value) return type(value) == "table" and value or { value } end

local function gap_text(gap) return gap and ("%.4g"):format(gap) or "-" end

local function words_of(found)
  local lines = { ("selected %d of %d features by the free run on %s"):format(found.terms, found.library, found.holdout_name),
    "  terms   train gap  holdout gap    criterion" }
  for _, row in ipairs(found.front) do
    lines[#lines + 1] = ("%s %5d %11s %12s %12.1f  %s"):format(row == found.chosen and "*" or " ", row.terms,
      gap_text(row.train_gap), gap_text(row.holdout_gap), row.criterion, row.names .. (row.rejected and ": " .. row.rejected or ""))
  end
  for _, row in ipairs(found.model.parameters) do
    lines[#lines + 1] = ("  %s = %.6g%s"):format(row.name, row.value, row.std and (" +- %.2g"):format(row.std) or "")
  end
  local other = found.equation_error
  if other then
    lines[#lines + 1] = ("  the equation error alone would choose %d terms (%s): %s"):format(other.terms,
      other.names, other.rejected or "holdout gap " .. gap_text(other.holdout_gap))
  end
  if found.test_gap then lines[#lines + 1] = ("  test gap %s, opened once"):format(gap_text(found.test_gap)) end
  lines[#lines + 1] = ("  rejected: %d of %d candidates"):format(#found.rejected, found.candidates)
  return table.concat(lines, "\n")
end

selection.select = schema.define({
  name = "select",
  help = "Chooses a model out of a library of features: candidates from regressions on the motion smoothed to several "
    .. "widths, judged by free runs, refined on the trajectory. What runs away is rejected, with the reason.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several, to learn from" },
    { "holdout", types.either(record, types.list(record, 1)),
      help = "records on which free runs judge; else the last part of the records" },
    { "holdout_part", types.number { above = 0, below = 1 }, default = 0.25,
      help = "of each record that is kept from the fits to judge, where no holdout is given" },
    { "test", types.either(record, types.list(record, 1)), help = "opened once, after the choice" },
    { "mass", types.expression, required = true, unit = "kg", help = "of the moving body" },
    { "features", types.list(types.either(types.expression, types.is("features", "lunid.polynomials")), 1),
      required = true, help = "the library; parameters inside them need min and max" },
    { "known", types.expression, unit = "N", help = "part of the restoring force that is known" },
    { "most_terms", types.integer { min = 1, max = 30 }, default = 7, help = "of a candidate that is run" },
    { "cut_off", types.number { min = 0, below = 1 }, default = 0.005,
      help = "least rms of a term over that of the restoring force; below it a candidate is rejected" },
    { "channels", types.list(types.string, 1), help = "fitted on the trajectory; else y, and v where it was measured" },
    { "widths", types.list(types.integer { min = 2 }, 1),
      help = "half widths of the smoothing filters in samples; else parts of the motion's period" },
    { "search", types.is("search", "lunid.search"), help = "for parameters inside features" },
    { "iterations", types.integer { min = 1 }, default = 20, help = "of each trajectory fit" },
  },
  returns = "selection",
  example = [[local found = lunid.select { record = train, test = test, mass = 1, features = { lunid.polynomials({ y, v }, 5) } }]],
}, function(given)
  local records = list_of(given.record)
  given.features = regression.flat(given.features, records)
  local train, holdout = records, given.holdout and list_of(given.holdout)
  if not holdout then train, holdout = split(records, given.holdout_part) end
  local measured = records[1].channels.v
  given.channels = given.channels or (measured and not measured.derived and { "y", "v" } or { "y" })
  given.most_terms = math.min(given.most_terms, #given.features)
  local pool = { known = {} }
  local weak, widths = candidates.is_linear(given), given.widths or candidates.half_widths(train)
  for _, half in ipairs(widths) do
    if weak then candidates.add_weak(pool, given, train, 2*half) end
    candidates.add_strong(pool, given, train, half)
  end
  local fitted = trajectory.best_of_each_size(pool, given, train, pool.known)
  trajectory.on_trajectory(fitted, given, train, pool.known)
  local front = pareto_front(fitted, given, train, holdout)
  for _, row in ipairs(front) do row.names = key_of(row.features) end
  local chosen = choose(front)
  local rejected = {}
  for _, list in ipairs { pool, front } do
    for _, row in ipairs(list) do
      if row.rejected then rejected[#rejected + 1] = { names = key_of(row.features), reason = row.rejected } end
    end
  end
  if not chosen then
    schema.fail("select", ("no candidate runs freely over the holdout (%d tried; the first: %s): other features, or fewer "
      .. "terms"):format(#pool, rejected[1] and rejected[1].reason or "no candidate"))
  end
  local last = refined(chosen, given, given.holdout and train or records, given.iterations, true) or chosen
  local naive = naive_model(given, train)
  naive.holdout_gap, naive.rejected = judge(naive, holdout)
  local found = { front = front, chosen = chosen, model = last.model, fit = last.fit, terms = chosen.terms,
    features = chosen.features, library = #given.features, candidates = #pool, rejected = rejected, naive = naive,
    train_gap = chosen.train_gap, holdout_gap = chosen.holdout_gap,
    equation_error = by_equation_error(pool, given, holdout, widths[(#widths + 1)//2]),
    holdout_name = given.holdout and holdout[1].name or "the last part of the records" }
  if given.test then
    found.test_gap, found.test_rejected = judge(last, list_of(given.test))
    naive.test_gap = judge(naive, list_of(given.test))
  end
  return schema.object("selection", found, nil, words_of)
end)

return selection

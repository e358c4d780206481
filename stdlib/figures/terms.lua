-- Figures of what was fitted: paths of coefficients, scores, fronts, contributions, intervals, matrices.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
require "lunid.feature_ranking"  -- of which types.named_columns is
local types = schema.types

local regression = types.is("regression", "lunid.regress")
local selection = types.is("selection", "lunid.select")

-- ---- the path of a lasso ----

local coloured_terms = 6  -- that get a colour and a name: those that enter first

figures.define({
  name = "coefficient_path",
  help = "The coefficients of a lasso, each over its largest size, as the penalty falls; below, the error on left-out blocks.",
  positional = { "of" },
  fields = { { "of", regression, required = true, help = "fitted by lunid.lasso or lunid.elastic_net" } },
  example = [[lunid.figure.coefficient_path(fit):save "path.png"]],
}, function(given)
  local path = given.of.path
  if #path < 2 then
    figures.fail("coefficient_path", "the regression has no path: fit it with lunid.lasso or lunid.elastic_net "
      .. "{ lambda = \"cross-validate\" }")
  end
  local lambda, cv, low, high, fitted, columns = {}, {}, {}, {}, {}, {}
  for i, point in ipairs(path) do
    lambda[i], cv[i], fitted[i] = point.lambda, point.cv_rmse, point.rmse
    low[i], high[i] = point.cv_rmse - point.cv_std, point.cv_rmse + point.cv_std
    columns[i] = point.coefficients
  end
  local terms = {}
  for k, term in ipairs(given.of.terms) do
    local values, most, enters = {}, 0, math.huge
    for i = 1, #path do
      values[i] = columns[i][k]
      most = math.max(most, math.abs(values[i]))
      if values[i] ~= 0 and enters == math.huge then enters = i end
    end
    for i = 1, #path do values[i] = most > 0 and values[i]/most or 0 end
    terms[k] = { name = term.name, values = values, enters = enters, place = k }
  end
  table.sort(terms, function(a, b)
    if a.enters ~= b.enters then return a.enters < b.enters end
    return a.place < b.place
  end)
  local x, series = core.column(lambda), {}
  for k = 1, #terms do
    local role, style = figures.look_of(k)
    local named = k <= coloured_terms
    if terms[k].enters < math.huge then
      series[#series + 1] = { x = x, y = core.column(terms[k].values), role = named and role or "noise",
        style = named and style or "line", label = named and terms[k].name or k == coloured_terms + 1 and "others" or "" }
    end
  end
  local penalty = { name = "penalty λ", unit = "", scale = "log" }
  local panels = { { x = penalty, y = { name = "coefficient / largest", unit = "" }, series = series, legend = "above" } }
  if cv[1] == cv[1] then
    panels[2] = { x = penalty, y = { name = "rmse", unit = "N" },
      ribbons = { { x = x, low = core.column(low), high = core.column(high), role = "first", label = "± standard error" } },
      series = { { x = x, y = core.column(cv), role = "first", label = "left-out blocks" },
        { x = x, y = core.column(fitted), role = "second", style = "dashed", label = "the fit" } } }
  end
  return { share_x = true, panels = panels }
end)

-- ---- scores and fronts ----

--- Rows of a selection's front as columns; rejected ones have no gap.
local function front_columns(front)
  local terms, train, holdout, criterion = {}, {}, {}, {}
  for i, row in ipairs(front) do
    terms[i], criterion[i] = row.terms, row.criterion
    train[i], holdout[i] = row.train_gap or 0/0, row.holdout_gap or 0/0
  end
  return core.column(terms), core.column(train), core.column(holdout), core.column(criterion)
end

--- An axis of whole numbers: each has its tick, where there are not too many.
local function terms_axis(terms)
  local names, most = {}, terms:max()
  if most == most and most <= 25 then
    for i = 1, math.floor(most) do names[i] = tostring(i) end
  end
  return { name = "number of terms", unit = "", names = names }
end

figures.define({
  name = "score",
  help = "A score over the number of terms: the steps of a stepwise regression, or the free runs of a selection.",
  positional = { "of" },
  fields = {
    { "of", types.either(regression, selection, figures.series, types.list(figures.series, 1)), required = true,
      help = "a regression that went step by step, a selection, or series of terms and scores" },
    { "y", types.string, default = "score", help = "axis of plain series, with its unit" },
    { "log", types.boolean, default = false, help = "logarithmic axis of the score" },
  },
  example = [[lunid.figure.score(found):save "score.png"]],
}, function(given)
  local kind, scale = getmetatable(given.of), given.log and "log" or nil
  if kind == "lunid.selection" then
    local terms, train, holdout, criterion = front_columns(given.of.front)
    local chosen = given.of.chosen.terms
    local mark = { { value = chosen, vertical = true, role = "noise", label = "chosen" } }
    return { share_x = true, panels = {
      { x = terms_axis(terms), y = { name = "gap", unit = "", scale = scale }, lines = mark, series = {
        { x = terms, y = train, label = "train", role = "first", style = "line_points", width = 1.5 },
        { x = terms, y = holdout, label = "holdout", role = "second", style = "line_points", width = 1.5 } } },
      { x = terms_axis(terms), y = { name = "criterion", unit = "" }, lines = mark,
        series = { { x = terms, y = criterion, role = "third", style = "line_points", width = 1.5 } } } } }
  end
  if kind == "lunid.regression" then
    local steps = given.of.steps
    if #steps == 0 then figures.fail("score", "the regression did not go step by step: use frols, stepwise or lasso") end
    local terms, rmse, criterion = {}, {}, {}
    for i, step in ipairs(steps) do terms[i], rmse[i], criterion[i] = #step.features, step.rmse, step.criterion end
    local x = core.column(terms)
    local panels = { { x = terms_axis(x), y = { name = "rmse", unit = "N", scale = scale },
      series = { { x = x, y = core.column(rmse), role = "first", style = "line_points", width = 1.5 } } } }
    if criterion[1] == criterion[1] then
      panels[2] = { x = terms_axis(x), y = { name = "criterion", unit = "" },
        series = { { x = x, y = core.column(criterion), role = "third", style = "line_points", width = 1.5 } } }
    end
    return { share_x = true, panels = panels }
  end
  local y, series = figures.axis(given.y), {}
  y.scale = scale
  for i, each in ipairs(kind and { given.of } or given.of) do
    series[i] = { x = each.x, y = each.y, label = each.label, role = each.role or figures.look_of(i), style = "line_points",
      width = 1.5 }
  end
  return { panels = { { x = { name = "number of terms", unit = "" }, y = y, series = series } } }
end)

--- The points of which no other is at least as good in both, in rising x.
local function front_of(x, y)
  local order = {}
  for i = 1, #x do
    if x[i] == x[i] and y[i] == y[i] then order[#order + 1] = i end
  end
  table.sort(order, function(a, b)
    if x[a] ~= x[b] then return x[a] < x[b] end
    if y[a] ~= y[b] then return y[a] < y[b] end
    return a < b
  end)
  local fx, fy, least = {}, {}, math.huge
  for _, i in ipairs(order) do
    if y[i] < least then fx[#fx + 1], fy[#fy + 1], least = x[i], y[i], y[i] end
  end
  return core.column(fx), core.column(fy)
end

figures.define({
  name = "pareto",
  help = "Candidates by two costs, both better when smaller, and the front of those that none beats in both.",
  positional = { "of" },
  fields = {
    { "of", types.either(selection, figures.series), required = true, help = "a selection, or a series of two costs" },
    { "x", types.string, default = "number of terms", help = "axis across, with its unit" },
    { "y", types.string, default = "gap on the holdout", help = "axis upward, with its unit" },
    { "log", types.boolean, default = true, help = "logarithmic axis upward" },
  },
  example = [[lunid.figure.pareto(found):save "pareto.png"]],
}, function(given)
  local x, y, series
  if getmetatable(given.of) == "lunid.selection" then
    local terms, _, holdout = front_columns(given.of.front)
    x, y = terms, holdout
  else
    x, y = given.of.x, given.of.y
  end
  local front_x, front_y = front_of(x, y)
  if #front_x == 0 then figures.fail("pareto", "no candidate has both costs: there is no front") end
  series = { { x = x, y = y, style = "points", role = "noise", label = "candidates", width = 1.6 },
    { x = front_x, y = front_y, style = "line_points", role = "first", label = "front", width = 1.5 } }
  local chosen = given.of.chosen
  if chosen and chosen.holdout_gap then
    series[3] = { x = core.column { chosen.terms }, y = core.column { chosen.holdout_gap }, style = "points", role = "second",
      label = "chosen", width = 2.6 }
  end
  local axis = figures.axis(given.y)
  axis.scale = given.log and "log" or nil
  return { panels = { { x = figures.axis(given.x), y = axis, series = series } } }
end)

-- ---- contributions ----

local shares = { words = "a list of { name, number }", check = function(value)
  if type(value) ~= "table" or getmetatable(value) ~= nil or #value == 0 then return false, "a list of { name, number }" end
  for i, each in ipairs(value) do
    if type(each) ~= "table" or type(each[1]) ~= "string" or type(each[2]) ~= "number" then
      return false, ("entry %d: expected { name, number }"):format(i), nil, each
    end
  end
  return true, value
end }

figures.define({
  name = "contributions",
  help = "What each term contributes to the restoring force, in per cent of its rms, the largest on top.",
  positional = { "of" },
  fields = {
    { "of", types.either(regression, shares), required = true, help = "a regression, or a list of { name, per cent }" },
    { "cut_off", types.number { min = 0 }, unit = "%", help = "drawn as a line" },
    { "axis", types.string, default = "contribution [%]", help = "what the bars are, with their unit" },
  },
  example = [[lunid.figure.contributions { fit, cut_off = 5 }:save "contributions.png"]],
}, function(given)
  local rows = {}
  if getmetatable(given.of) == "lunid.regression" then
    for _, term in ipairs(given.of.terms) do
      if term.value ~= 0 then rows[#rows + 1] = { term.name, 100*term.contribution, #rows } end
    end
  else
    for i, row in ipairs(given.of) do rows[i] = { row[1], row[2], i } end
  end
  if #rows == 0 then figures.fail("contributions", "no term is left in the regression: there is nothing to show") end
  table.sort(rows, function(a, b)
    if a[2] ~= b[2] then return a[2] > b[2] end
    return a[3] < b[3]
  end)
  local names, values = {}, {}
  for i, row in ipairs(rows) do names[i], values[i] = row[1], row[2] end
  return { panels = { { x = figures.axis(given.axis), bars = { names = names,
    sets = { { label = "", value = core.column(values), role = "first" } } },
    lines = given.cut_off and { { value = given.cut_off, vertical = true, role = "baseline", label = "cut-off" } } or nil } } }
end)

-- ---- intervals ----

local fitted = types.either(regression, types.is("model", "lunid.model"), types.is("trajectory_fit", "lunid.fit_trajectory"))

local normal = 1.959964  -- of a two-sided 95 % interval

--- Rows { name, value, low, high } of a fit.
local function rows_of(fit)
  local rows = {}
  if getmetatable(fit) == "lunid.regression" then
    for _, term in ipairs(fit.terms) do
      if term.value ~= 0 then
        rows[#rows + 1] = { name = term.name, value = term.value, low = term.lower, high = term.upper }
      end
    end
    return rows
  end
  local model = getmetatable(fit) == "lunid.model" and fit or fit.model
  for i, p in ipairs(model.parameters) do
    local std = p.std or 0/0
    rows[i] = { name = p.name, value = p.value, low = p.value - normal*std, high = p.value + normal*std }
  end
  return rows
end

--- Names in their order of appearance, without those that are known not to be there; and those.
local function names_of(lists, truth)
  local real, false_ones, seen = {}, {}, {}
  for _, rows in ipairs(lists) do
    for _, row in ipairs(rows) do
      if not seen[row.name] then
        local list = truth[row.name] == 0 and false_ones or real
        list[#list + 1] = row.name
        seen[row.name] = true
      end
    end
  end
  return real, false_ones
end

--- The size of what a row is compared with: the truth, or where that is 0 or unknown the first value that is not.
local function reference(name, lists, truth)
  if truth[name] and truth[name] ~= 0 then return truth[name] end
  for _, rows in ipairs(lists) do
    for _, row in ipairs(rows) do
      if row.name == name and row.value ~= 0 then return row.value end
    end
  end
  return 1
end

--- Dots and whiskers in per cent of the reference, about `middle` times the reference.
local function interval_panel(lists, names, given, middle, words)
  local place, upward, series = {}, {}, {}
  for i, name in ipairs(names) do place[name], upward[#names + 1 - i] = #names + 1 - i, name end
  for k, rows in ipairs(lists) do
    local x, y, wx, wy = {}, {}, {}, {}
    for _, row in ipairs(rows) do
      if place[row.name] then
        local size = reference(row.name, lists, given.truth)
        local at = place[row.name] + ((#lists + 1)/2 - k)*0.5/#lists
        x[#x + 1], y[#y + 1] = 100*(row.value/size - middle), at
        if row.low == row.low then
          for _, value in ipairs { row.low, row.high, 0/0 } do wx[#wx + 1], wy[#wy + 1] = 100*(value/size - middle), at end
        end
      end
    end
    local role, label = figures.look_of(k), given.labels[k] or #lists > 1 and "fit " .. k or "fit, 95 % interval"
    series[#series + 1] = { x = core.column(wx), y = core.column(wy), role = role }
    series[#series + 1] = { x = core.column(x), y = core.column(y), role = role, style = "points", width = 1.9, label = label }
  end
  return { x = { name = words, unit = "%" }, y = { name = "", unit = "", names = upward }, series = series, legend = "above",
    lines = { { value = 0, vertical = true, role = "measured", label = middle == 0 and "" or next(given.truth) and "truth" or "" } } }
end

figures.define({
  name = "intervals",
  help = "Parameters of one fit or of several with their 95 % intervals, each as its deviation from the truth, or from the "
    .. "first fit's value; terms that are not there in truth by themselves, in per cent of their value.",
  positional = { "of" },
  fields = {
    { "of", types.either(fitted, types.list(fitted, 1)), required = true, help = "regressions, models or trajectory fits" },
    { "truth", types.table, default = {}, help = "true values by name: { k = 2e4 }; 0 for a term that is not there" },
    { "labels", types.list(types.string), default = {}, help = "of each fit" },
  },
  example = [[lunid.figure.intervals { fit, truth = { y = 2e4, ["y^3"] = 1e6, v = 10 } }:save "intervals.png"]],
}, function(given)
  local lists, panels = {}, {}
  for k, fit in ipairs(getmetatable(given.of) and { given.of } or given.of) do lists[k] = rows_of(fit) end
  local real, false_ones = names_of(lists, given.truth)
  if #real > 0 then
    local words = next(given.truth) and "deviation from the truth" or "deviation from the first value"
    panels[1] = interval_panel(lists, real, given, 1, words)
  end
  if #false_ones > 0 then
    panels[#panels + 1] = interval_panel(lists, false_ones, given, 0, "terms that are not there, of their value")
  end
  if #panels == 0 then figures.fail("intervals", "the fits have no parameters") end
  return { panels = panels }
end)

-- ---- matrices ----

--- A square matrix with names along both axes, the first on top; missing: what a cell without a number stands for.
local function matrix_panel(names, values, colour, diverging, missing)
  local places, upward, z, n = {}, {}, {}, #names
  for i = 1, n do
    places[i], upward[n + 1 - i], z[n + 1 - i] = i, names[i], values[i]
  end
  return { x = { name = "", unit = "", names = names }, y = { name = "", unit = "", names = upward },
    map = { x = core.column(places), y = core.column(places), z = z, colour = colour, diverging = diverging, numbers = true,
      missing = missing } }
end

figures.define({
  name = "information_matrix",
  help = "What each channel or feature tells about each other, as a matrix of mutual information.",
  positional = { "of" },
  fields = {
    { "of", types.either(types.is("record", "lunid.read"), types.named_columns), required = true,
      help = "a record, or a list of { name, column }" },
    { "channels", types.list(types.string, 2), default = { "y", "v", "a", "F" }, help = "of the record" },
    { "features", types.list(types.expression, 1), default = {}, help = "functions of its channels beside them" },
    { "rows", types.integer { min = 100 }, default = 4000, help = "of a longer record, every n-th is taken" },
    { "neighbours", types.integer { min = 1 }, default = 3, help = "of the estimate" },
  },
  example = [[lunid.figure.information_matrix { record, channels = { "y", "v", "F" } }:save "information.png"]],
}, function(given)
  local names, columns = {}, {}
  if getmetatable(given.of) == "lunid.record" then
    for _, channel in ipairs(given.channels) do
      names[#names + 1], columns[#columns + 1] = channel, given.of:column(channel)
    end
    for _, feature in ipairs(given.features) do
      names[#names + 1] = tostring(feature)
      columns[#columns + 1] = core.evaluate(given.of, feature, "figure.information_matrix")
    end
  else
    for i, each in ipairs(given.of) do names[i], columns[i] = each.name, each.values end
  end
  local step = math.max(1, math.ceil(#columns[1] / given.rows))
  for i, column in ipairs(columns) do columns[i] = column:every(step) end
  local values = {}
  for i, target in ipairs(columns) do
    local row = core.statistics.mutual_information(columns, target, {}, given.neighbours)
    for k = 1, #columns do row[k] = math.max(0, row[k]) end
    row[i] = 0/0  -- what a channel tells about itself is without bound
    values[i] = row
  end
  for i = 1, #columns do
    for k = 1, i - 1 do
      local mean = 0.5*(values[i][k] + values[k][i])
      values[i][k], values[k][i] = mean, mean
    end
  end
  return { panels = { matrix_panel(names, values, { name = "mutual information", unit = "nat", min = 0 }, false, "itself") } }
end)

figures.define({
  name = "correlation_matrix",
  help = "The correlations between the parameters of a fit: near 1 or -1, the data do not tell two apart.",
  positional = { "of" },
  fields = { { "of", types.is("trajectory_fit", "lunid.fit_trajectory"), required = true, help = "a fit of one record" } },
  example = [[lunid.figure.correlation_matrix(fit):save "correlation.png"]],
}, function(given)
  local names, values = {}, {}
  for i, p in ipairs(given.of.model.parameters) do names[i] = p.name end
  local all = given.of.correlation
  for i = 1, #names do
    values[i] = {}
    for k = 1, #names do values[i][k] = all[i] and all[i][k] or 0/0 end
  end
  return { panels = { matrix_panel(names, values, { name = "correlation", unit = "", min = -1, max = 1 }, true) } }
end)

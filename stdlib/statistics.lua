-- Measures of plain columns: lunid.statistics. lunid.compare puts them together for a model and a record.
local core = require "lunid.core"
local figures = require "lunid.figures"
require "lunid.figures.distributions"
local schema = require "lunid.schema"
local types = schema.types

local measures = core.statistics
local column = types.column  -- of figures
local columns = types.list(column, 1)

local statistics = {}

--- Declares lunid.statistics.<name>.
local function define(definition, body)
  local name = definition.name
  definition.name = "statistics." .. name
  statistics[name] = schema.define(definition, body)
end

-- ---- two columns, one number ----

--- Declares measures of two columns, told by their names and what they are.
local function of_pair(first, first_help, second, second_help)
  return function(name, help, example)
    define({
      name = name,
      help = help,
      style = "arguments",
      positional = { first, second },
      fields = {
        { first, column, required = true, help = first_help },
        { second, column, required = true, help = second_help },
      },
      returns = "number",
      example = example,
    }, function(given) return measures[name](given[first], given[second]) end)
  end
end

local of_model = of_pair("measured", "what was measured", "model", "what the model says, row by row")
local of_two = of_pair("a", "one column", "b", "another of the same length")

of_model("rmse", "Root of the mean squared error, in the unit of the columns.",
  [[local error = lunid.statistics.rmse(record:column "y", run:column "y")]])
of_model("nrmse", "RMSE over the standard deviation of the measurement.",
  [[local error = lunid.statistics.nrmse(record:column "y", run:column "y")]])
of_model("r2", "Share of the measured variance that the model explains, 1 - nrmse^2; below 0 it is worse than the mean.",
  [[local share = lunid.statistics.r2(record:column "y", run:column "y")]])
of_model("fit", "100 (1 - nrmse) %: 100 for a perfect model, 0 for the measured mean.",
  [[local percent = lunid.statistics.fit(record:column "y", run:column "y")]])

of_two("correlation", "Pearson's correlation. A second value is the probability of one as far from 0 by chance, by a block "
  .. "bootstrap that holds for coloured rows.", [[local r, p = lunid.statistics.correlation(record:column "F", record:column "y")]])
of_two("spearman", "Spearman's rank correlation. A second value is the probability of one as far from 0 by chance if the rows "
  .. "were independent.", [[local rho, p = lunid.statistics.spearman(record:column "F", record:column "y")]])
of_two("kendall", "Kendall's rank correlation tau-b. A second value is the probability of one as far from 0 by chance if the "
  .. "rows were independent.", [[local tau, p = lunid.statistics.kendall(record:column "F", record:column "y")]])

-- ---- information ----

local neighbours = { "neighbours", types.integer { min = 1 }, default = 3,
  help = "nearest neighbours: fewer for less bias, more for less scatter" }

define({
  name = "mutual_information",
  help = "What one column tells about another in any form, in nat, by nearest neighbours. 0 where they are independent, give or "
    .. "take 1/sqrt(rows).",
  style = "arguments",
  positional = { "x", "target", "neighbours" },
  fields = {
    { "x", column, required = true, help = "such as a feature" },
    { "target", column, required = true, help = "such as the force" },
    neighbours,
  },
  returns = "number",
  example = [[local nat = lunid.statistics.mutual_information(record:column "y", record:column "F")]],
}, function(given) return measures.mutual_information({ given.x }, given.target, {}, given.neighbours)[1] end)

define({
  name = "conditional_mutual_information",
  help = "What one column tells about another beyond what given columns tell, in nat.",
  style = "arguments",
  positional = { "x", "target", "given", "neighbours" },
  fields = {
    { "x", column, required = true, help = "such as a feature" },
    { "target", column, required = true, help = "such as the force" },
    { "given", columns, required = true, help = "the columns that are known already" },
    neighbours,
  },
  returns = "number",
  example = [[local nat = lunid.statistics.conditional_mutual_information(record:column "v", record:column "F",
  { record:column "y" })]],
}, function(given) return measures.mutual_information({ given.x }, given.target, given.given, given.neighbours)[1] end)

define({
  name = "significance_index",
  help = "Mutual information of a term and the force, times the term's largest force.",
  style = "arguments",
  positional = { "information", "coefficient", "feature" },
  fields = {
    { "information", types.number(), required = true, help = "of feature and target [nat]" },
    { "coefficient", types.number(), required = true, help = "of the feature in the fit" },
    { "feature", column, required = true, help = "its values along the record" },
  },
  returns = "number",
  example = [[local index = lunid.statistics.significance_index(0.8, 2e4, record:column "y")]],
}, function(given) return measures.significance_index(given.information, given.coefficient, given.feature) end)

-- ---- shapes and distributions ----

define({
  name = "dtw",
  help = "Dynamic time warping: the least sum of distances between two curves over all ways to run through both.",
  style = "arguments",
  positional = { "a", "b", "band" },
  fields = {
    { "a", columns, required = true, help = "the columns of one curve, such as { y, v }, in comparable units" },
    { "b", columns, required = true, help = "as many columns of the other; it may be longer or shorter" },
    { "band", types.integer { min = 0 }, help = "rows that a pairing may stray from the diagonal; else any" },
  },
  returns = "number",
  example = [[local far = lunid.statistics.dtw({ measured:column "y" }, { run:column "y" }, 100)]],
}, function(given) return measures.dtw(given.a, given.b, given.band) end)

define({
  name = "dtw_pairing",
  help = "The pairing of rows behind dtw: columns a and b of row numbers, counted from 1, and the distance; pairing:figure() "
    .. "draws it.",
  style = "arguments",
  positional = { "a", "b", "band" },
  fields = {
    { "a", columns, required = true, help = "the columns of one curve, such as { y, v }, in comparable units" },
    { "b", columns, required = true, help = "as many columns of the other; it may be longer or shorter" },
    { "band", types.integer { min = 0 }, help = "rows that a pairing may stray from the diagonal; else any" },
  },
  returns = "pairing",
  example = [[lunid.statistics.dtw_pairing({ measured:column "y" }, { run:column "y" }, 100):figure():save "dtw.png"]],
}, function(given)
  local found = { curves = { given.a[1], given.b[1] } }
  found.a, found.b, found.distance = measures.dtw_pairing(given.a, given.b, given.band)
  return schema.object("pairing", found, { figure = function(self) return figures.public.alignment(self) end }, function(self)
    return ("%d pairs of rows, distance %.6g"):format(#self.a, self.distance)
  end)
end)

define({
  name = "qq",
  help = "The points of a quantile-quantile plot: against the normal distribution of the column's own mean and deviation, or "
    .. "against another column. Fields expected, found, qqcc; qq:figure() draws it.",
  style = "arguments",
  positional = { "found", "expected" },
  fields = {
    { "found", column, required = true, help = "such as a residual" },
    { "expected", column, help = "a sample to compare with; else a normal distribution" },
  },
  returns = "quantiles",
  example = [[lunid.statistics.qq(comparison.residual):figure():save "qq.png"]],
}, function(given)
  local points = {}
  if given.expected then
    points.expected, points.found, points.qqcc = measures.quantiles(given.expected, given.found)
  else
    points.expected, points.found, points.qqcc = measures.quantiles(given.found)
  end
  return schema.object("quantiles", points, { figure = figures.public.qq }, function(self)
    return ("%d quantiles, QQCC %.6g"):format(#self.found, self.qqcc)
  end)
end)

define({
  name = "qqcc",
  help = "The correlation of the quantile-quantile plot's points: 1 where the distributions have one shape.",
  style = "arguments",
  positional = { "found", "expected" },
  fields = {
    { "found", column, required = true, help = "such as a residual" },
    { "expected", column, help = "a sample to compare with; else a normal distribution" },
  },
  returns = "number",
  example = [[local shape = lunid.statistics.qqcc(comparison.residual)]],
}, function(given) return statistics.qq(given.found, given.expected).qqcc end)

define({
  name = "kolmogorov_smirnov",
  help = "Largest distance of two distribution functions: of a column and any normal distribution, a known one (std =), or "
    .. "another column. A second value is the probability of as much by chance, for independent rows.",
  positional = { "x", "other" },
  fields = {
    { "x", column, required = true, help = "the column" },
    { "other", column, help = "another column" },
    { "mean", types.number(), help = "of a normal distribution known beforehand; else 0" },
    { "std", types.number { above = 0 }, help = "of a normal distribution known beforehand; else those of the column itself" },
  },
  returns = "number",
  example = [[local d, p = lunid.statistics.kolmogorov_smirnov { residual, std = 1e-5 }]],
}, function(given)
  if given.mean and not given.std then schema.fail("statistics.kolmogorov_smirnov: mean", "goes with std") end
  if given.other and given.std then
    schema.fail("statistics.kolmogorov_smirnov: other", "expected another column or a normal distribution, got both")
  end
  return measures.kolmogorov_smirnov(given.x, given)
end)

define({
  name = "principal_components",
  help = "The directions along which columns vary most: fields mean, scale, variances, shares, directions, scores (lists of "
    .. "columns).",
  positional = { "columns" },
  fields = {
    { "columns", columns, required = true, help = "of one length" },
    { "standardise", types.boolean, default = true, help = "bring each column to deviation 1 first" },
  },
  returns = "components",
  example = [[local components = lunid.statistics.principal_components { { record:column "y", record:column "v" } }]],
}, function(given)
  return schema.object("components", measures.principal_components(given.columns, given.standardise), nil, function(self)
    local shares = self.shares:list()
    for i, share in ipairs(shares) do shares[i] = ("%.3g %%"):format(100 * share) end
    return ("%d principal components: %s of the variance"):format(#shares, table.concat(shares, ", "))
  end)
end)

-- ---- residuals ----

local function probability(p)
  return p < 1e-300 and "p < 1e-300" or ("p = " .. (p < 1e-4 and "%.1e" or "%.3g")):format(p)
end
statistics.probability = probability

local function lag_test(words, found)
  return schema.object("lag_test", found, nil, function(self)
    return ("%s at %d lags: %d beyond +-%.3g, %s"):format(words, #self.lags, self.beyond, self.bound,
      probability(self.p_value))
  end)
end

local fitted = { "fitted", types.integer { min = 0 }, default = 0,
  help = "parameters of the autoregression whose innovations these are" }

define({
  name = "ljung_box",
  help = "Is a column white? The statistic of its autocorrelations at lags 1 to `lags`, and its probability by chance.",
  positional = { "x" },
  fields = { { "x", column, required = true, help = "such as a residual" },
    { "lags", types.integer { min = 1 }, default = 25, help = "largest lag, rows" }, fitted },
  returns = "number",
  example = [[local q, p = lunid.statistics.ljung_box { comparison.residual, lags = 20 }]],
}, function(given) return measures.ljung_box(given.x, given.lags, given.fitted) end)

define({
  name = "runs_test",
  help = "Are the signs about the median in random order? The normal deviate of the number of runs, and its probability.",
  style = "arguments",
  positional = { "x" },
  fields = { { "x", column, required = true, help = "such as a residual" } },
  returns = "number",
  example = [[local z, p = lunid.statistics.runs_test(comparison.residual)]],
}, function(given) return measures.runs_test(given.x) end)

define({
  name = "whiteness",
  help = "Autocorrelations of a column beside their 95 % bound: fields lags, coefficients, bound, beyond (how many), statistic, "
    .. "p_value.",
  positional = { "x" },
  fields = { { "x", column, required = true, help = "such as a residual" },
    { "lags", types.integer { min = 1 }, default = 25, help = "largest lag, rows" }, fitted },
  returns = "lag_test",
  example = [[print(lunid.statistics.whiteness { comparison.residual, lags = 20 })]],
}, function(given) return lag_test("autocorrelation", measures.whiteness(given.x, given.lags, given.fitted)) end)

define({
  name = "cross_correlation",
  help = "Correlation of a residual with an input that came so many rows before, beside its 95 % bound, which takes account of "
    .. "the colour of both. The fields are those of whiteness.",
  positional = { "residual", "input" },
  fields = {
    { "residual", column, required = true, help = "what is left" },
    { "input", column, required = true, help = "what it may follow" },
    { "lags", types.integer { min = 0 }, default = 25, help = "from -lags to lags; negative lags show a feedback" },
  },
  returns = "lag_test",
  example = [[print(lunid.statistics.cross_correlation { comparison.residual, record:column "F" })]],
}, function(given) return lag_test("cross-correlation", measures.cross_correlation(given.residual, given.input, given.lags)) end)

-- ---- intervals ----

define({
  name = "interval",
  help = "An interval for any statistic of columns, one of these or a function of your own, that holds for coloured rows: blocks "
    .. "of rows are resampled, or left out in turn. Fields value, low, high, std, level, block.",
  fields = {
    { "of", types.callable, required = true, help = "gets the columns, returns a number" },
    { "columns", columns, required = true, help = "of one length; their rows are resampled together" },
    { "level", types.number { above = 0, below = 1 }, default = 0.95, help = "probability that it holds the truth" },
    { "method", types.choice { "bootstrap", "jackknife" }, default = "bootstrap",
      help = "'jackknife' for mutual information, which repeated rows mislead" },
    { "draws", types.integer { min = 99 }, default = 999, help = "of the bootstrap" },
    { "block", types.integer { min = 1 }, help = "rows that stay together; else chosen by the columns' correlation" },
    { "seed", types.integer { min = 0 }, help = "of the draws; else that of the run (--seed)" },
  },
  returns = "interval",
  example = [[print(lunid.statistics.interval { of = lunid.statistics.kendall, columns = { a, b } })]],
}, function(given)
  local found = { level = given.level }
  found.value, found.low, found.high, found.std, found.block = measures.interval(given.of, given.columns, given)
  return schema.object("interval", found, nil, function(self)
    return ("%.6g (%g %%: %.6g to %.6g, %s of blocks of %d rows)"):format(self.value, 100 * self.level, self.low, self.high,
      given.method, self.block)
  end)
end)

statistics.public = {}
for name, value in pairs(statistics) do
  if schema.definitions["statistics." .. name] then statistics.public[name] = value end
end
statistics.public = { statistics = schema.strict_table("lunid.statistics", statistics.public) }
return statistics

-- Figures of what is left: quantiles, histograms, correlograms.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local types = schema.types

local distributions = {}
local measures = core.statistics

local comparison = types.is("comparison", "lunid.compare")
local column_or_comparison = types.either(types.column, comparison)

--- The residual of a comparison, or the column itself, with its axis.
local function residual_of(given, where)
  if getmetatable(given) ~= "lunid.comparison" then return given, { name = "value", unit = "" } end
  if not given.residual then figures.fail(where, "the comparison has no residual: its run stopped") end
  return given.residual, { name = "residual", unit = given.unit }
end

--- The column without what is not finite; at least `least` numbers must be left.
local function finite(column, where, least)
  local kept = {}
  for _, value in ipairs(column:list()) do
    if value - value == 0 then kept[#kept + 1] = value end
  end
  if #kept < least then
    figures.fail(where, ("expected at least %d finite numbers, got %d of %d"):format(least, #kept, #column))
  end
  return #kept == #column and column or core.column(kept)
end
distributions.finite = finite

--- The panel of a quantile-quantile plot: points { expected, found, qqcc }.
function distributions.qq_panel(points, axis)
  local low, high = points.expected:min(), points.expected:max()
  return { note = ("QQCC %.4f"):format(points.qqcc), x = { name = "expected quantiles", unit = axis.unit },
    y = { name = axis.name == "value" and "quantiles" or axis.name .. " quantiles", unit = axis.unit }, series = {
      { x = core.column { low, high }, y = core.column { low, high }, label = "equality", role = "baseline", style = "dashed" },
      { x = points.expected, y = points.found, label = "quantiles", role = "residual", style = "points" } } }
end

figures.define({
  name = "qq",
  help = "Quantiles of a residual, or of any column, over those of a normal distribution or of another column.",
  positional = { "of" },
  fields = {
    { "of", types.either(column_or_comparison, types.is("quantiles", "lunid.statistics.qq")), required = true,
      help = "a column, a comparison or the points of lunid.statistics.qq" },
    { "expected", types.column, help = "a sample to compare with; else a normal distribution" },
  },
  example = [[lunid.figure.qq(comparison):save "qq.png"]],
}, function(given)
  if getmetatable(given.of) == "lunid.quantiles" then
    return { panels = { distributions.qq_panel(given.of, { name = "value", unit = "" }) } }
  end
  local found, axis = residual_of(given.of, "qq")
  found = finite(found, "qq", 3)
  local points = {}
  if given.expected then
    points.expected, points.found, points.qqcc = measures.quantiles(finite(given.expected, "qq", 3), found)
  else
    points.expected, points.found, points.qqcc = measures.quantiles(found)
  end
  return { panels = { distributions.qq_panel(points, axis) } }
end)

--- As many classes as Freedman & Diaconis (1981) want: of width 2 (interquartile range) / n^(1/3).
local function classes(values)
  local n = #values
  local spread = values[math.ceil(0.75*n)] - values[math.max(1, math.floor(0.25*n))]
  local range = values[n] - values[1]
  if not (spread > 0) or not (range > 0) then return 1 end
  return math.max(1, math.min(200, math.ceil(range * n^(1/3) / (2*spread))))
end

figures.define({
  name = "histogram",
  help = "How often values occur, as a density, with the normal distribution of the same mean and deviation.",
  positional = { "of" },
  fields = {
    { "of", column_or_comparison, required = true, help = "a column, or a comparison, whose residual is shown" },
    { "bins", types.integer { min = 1, max = 1000 }, help = "else by the rule of Freedman and Diaconis" },
    { "normal", types.boolean, default = true, help = "draw the normal distribution" },
    { "axis", types.string, help = "what the values are, with their unit" },
  },
  example = [[lunid.figure.histogram { residual, axis = "residual [N]" }:save "histogram.png"]],
}, function(given)
  local column, axis = residual_of(given.of, "histogram")
  column = finite(column, "histogram", 1)
  axis = given.axis and figures.axis(given.axis) or axis
  local values = column:list()
  table.sort(values)
  local n, low, high = #values, values[1], values[#values]
  local bins = given.bins or classes(values)
  local width = high > low and (high - low) / bins or math.max(1e-12, 0.1*math.abs(low))
  if high == low then bins, low = 1, low - 0.5*width end
  local x, density = {}, {}
  for i = 1, bins do x[i], density[i] = low + (i - 0.5)*width, 0 end
  for _, value in ipairs(values) do
    local i = math.max(1, math.min(bins, math.floor((value - low) / width) + 1))
    density[i] = density[i] + 1 / (n*width)
  end
  local series = { { x = core.column(x), y = core.column(density), style = "columns", role = "first", label = "found" } }
  local mean, std = column:mean(), column:std()
  if given.normal and std > 0 then
    local at, curve = {}, {}
    for i = 0, 200 do
      at[i + 1] = math.min(low, mean - 3.5*std) + (math.max(values[n], mean + 3.5*std) - math.min(low, mean - 3.5*std))*i/200
      curve[i + 1] = math.exp(-0.5*((at[i + 1] - mean)/std)^2) / (std*math.sqrt(2*math.pi))
    end
    series[2] = { x = core.column(at), y = core.column(curve), role = "baseline", label = "normal" }
  end
  return { panels = { { x = axis, y = { name = "density", unit = axis.unit ~= "" and "1/" .. figures.grouped(axis.unit) or "" },
    note = ("%d values"):format(n), series = series } } }
end)

figures.define({
  name = "correlogram",
  help = "Autocorrelations of a column, or its correlations with an input, over the lag, beside their 95 % bounds.",
  positional = { "of" },
  fields = {
    { "of", types.either(column_or_comparison, types.is("lag_test", "lunid.statistics.whiteness")), required = true,
      help = "a column, a comparison or a test of lags" },
    { "input", types.column, help = "what the column may follow; else it is compared with itself" },
    { "lags", types.integer { min = 1 }, default = 40, help = "largest lag, rows" },
    { "dt", types.number { above = 0 }, unit = "s", help = "between rows: shows the lag in seconds" },
  },
  example = [[lunid.figure.correlogram { comparison, lags = 30 }:save "correlogram.png"]],
}, function(given)
  local test = given.of
  if getmetatable(test) ~= "lunid.lag_test" then
    local column = residual_of(given.of, "correlogram")
    test = given.input and measures.cross_correlation(column, given.input, given.lags)
      or measures.whiteness(column, given.lags, 0)
  end
  local lags, bound = test.lags:list(), test.bound
  for i = 1, #lags do lags[i] = lags[i] * (given.dt or 1) end
  return { panels = { { x = { name = "lag", unit = given.dt and "s" or "" },
    y = { name = given.input and "cross-correlation" or "autocorrelation", unit = "" },
    note = ("%d of %d beyond the bound"):format(test.beyond, #lags),
    lines = { { value = bound, role = "baseline", label = "95 % bound" }, { value = -bound, role = "baseline" },
      { value = 0, style = "line", role = "noise" } },
    series = { { x = core.column(lags), y = test.coefficients, style = "stems", role = "first" } } } } }
end)

return distributions

-- How good is this model on this record? All measures at once, each with its mode, its data and its window.
local core = require "lunid.core"
local distributions = require "lunid.figures.distributions"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local sources = require "lunid.figures.sources"
local simulation = require "lunid.simulation"
local statistics = require "lunid.statistics"
local types = schema.types

local comparison = {}

local mode_words = { free_run = "free run", one_step = "one-step prediction", equation_error = "equation error",
  imposed_motion = "imposed motion" }

local function fail(message) schema.fail("compare", message) end

-- ---- what is compared with what ----

--- The record within a window, which must lie within the time that there is (`whose` of it).
local function cut(record, window, whose)
  if not window then return record end
  local stop = record.start + record.duration
  if window.from < record.start - 0.5*record.dt or window.to > stop + 0.5*record.dt then
    fail(("window: %g to %g s is not within %g to %g s, the time of %s"):format(window.from, window.to, record.start, stop,
      whose))
  end
  return record:window(window.from, window.to)
end

local function measured_column(record, channel)
  if not record.channels[channel] then
    local names = {}
    for i, each in ipairs(record.channels) do names[i] = each.name end
    fail(("channel: the record has no '%s'%s"):format(channel, core.did_you_mean(core.nearest(channel, names))
      or " (it has " .. table.concat(names, ", ") .. ")"))
  end
  return record:column(channel)
end

--- The velocity that goes with a displacement: "v2" of "y2".
local function rate_of(channel) return channel:match "^y%d*$" and channel:gsub("^y", "v") or nil end

local function with_rates(data, record, channel, rate_column)
  local rate = rate_of(channel)
  if rate and record.channels[rate] then data.measured_rate, data.model_rate = record:column(rate), rate_column(rate) end
end

--- A run beside a record on the samples and in the time that both have.
local function of_run(given, run)
  local record, summary = given.record, run.summary
  if math.abs(run.dt / record.dt - 1) > 1e-9 then
    fail(("the run steps by %g s, the record by %g s: simulate with the record as excitation"):format(run.dt, record.dt))
  end
  local start = run:column "t"[1]
  local ends = start + (run.rows - 1)*run.dt
  local from = math.max(record.start, start)
  local to = math.min(record.start + record.duration, ends)
  if to < from then
    fail(("the run is from %g to %g s, the record from %g to %g s: they have no time in common"):format(start, ends,
      record.start, record.start + record.duration))
  end
  local offset = (start - record.start) / record.dt
  if math.abs(offset - math.floor(offset + 0.5)) > 1e-3 then
    fail("the samples of the run lie between those of the record: simulate with the record as excitation")
  end
  record = cut(record:window(from, to), given.window, "run and record")
  local data = { record = record, mode = "free_run", quantity = given.channel }
  data.measured = measured_column(record, given.channel)
  local stopped = summary.stopped_at or summary.ended_at
  if stopped and stopped < record.start + record.duration then
    data.stopped_at = stopped
    data.cause = summary.cause or "stop_when"
    return data
  end
  local part = run:record():window(record.start, record.start + record.duration)
  data.predicted = part:column(given.channel)
  with_rates(data, record, given.channel, function(rate) return part:column(rate) end)
  return data
end

local function one_coordinate(given, model, mode)
  if model.degrees > 1 then fail(("mode '%s' takes a model of one coordinate, got one of %d"):format(mode, model.degrees)) end
  if given.channel ~= "y" then fail(("channel: mode '%s' has no other, got '%s'"):format(mode, given.channel)) end
end

local ways = {}

function ways.free_run(given, model)
  local record = cut(given.record, given.window, "the record")
  local run = simulation.public.simulate { model = model, excitation = record, from = "record" }
  return of_run({ record = record, channel = given.channel }, run)
end

function ways.one_step(given, model)
  one_coordinate(given, model, "one_step")
  local record = cut(given.record, given.window, "the record")
  local y, v = core.predict_one_step(model, record)
  record = record:window(record.start + record.dt, record.start + record.duration)
  return { record = record, mode = "one_step", quantity = "y", measured = record:column "y", predicted = y,
    measured_rate = record:column "v", model_rate = v }
end

--- The restoring force along the measured motion, beside F - m*a.
function ways.equation_error(given, model)
  one_coordinate(given, model, "equation_error")
  local record = cut(given.record, given.window, "the record")
  local target = core.channel "F" - model.mass*core.channel "a"
  return { record = record, mode = "equation_error", quantity = tostring(model.mass) == "0" and "F" or "F - m*a",
    unit = sources.unit_in(record, "F") or "N", measured = core.evaluate(record, target, "compare"), predicted = core.evaluate(record, model.restoring, "compare") }
end

function ways.imposed_motion(given, model)
  local record = cut(given.record, given.window, "the record")
  return { record = record, mode = "imposed_motion", quantity = "F", measured = record:column "F",
    predicted = core.imposed_force(model, record) }
end

local function of_columns(given)
  if not given.mode then fail "mode: say what the predicted column is: 'free_run', 'one_step' or 'equation_error'" end
  local record = cut(given.record, given.window, "the record")
  local measured = measured_column(record, given.channel)
  if #given.predicted ~= #measured then
    fail(("predicted: expected %d rows, as the record has in the window, got %d"):format(#measured, #given.predicted))
  end
  return { record = record, mode = given.mode, quantity = given.channel, measured = measured, predicted = given.predicted }
end

local function gather(given)
  local count = 0
  for _, name in ipairs { "run", "model", "regression", "predicted" } do count = count + (given[name] and 1 or 0) end
  if count ~= 1 then fail(("expected one of run, model, regression and predicted, got %d of them"):format(count)) end
  if given.predicted then return of_columns(given) end
  if given.run then
    if given.mode and given.mode ~= "free_run" then
      fail(("mode: a run is a 'free_run'; give the model for '%s'"):format(given.mode))
    end
    return of_run(given, given.run)
  end
  local model = given.model or given.regression.model
  schema.expect_values("compare", model)
  if model.imposed_motion then
    if given.mode then fail(("mode: the motion of this model is imposed, its force is compared; got '%s'"):format(given.mode)) end
    return ways.imposed_motion(given, model)
  end
  return ways[given.mode or (given.regression and "equation_error" or "free_run")](given, model)
end

-- ---- the result ----

local methods = {}

--- The points of the residual's quantile-quantile plot.
function methods.qq(self)
  if not self.residual then fail "there is no residual: the run stopped" end
  return statistics.qq(self.residual)
end

--- Measurement and model over time, and the quantiles of the residual.
function methods.figure(self)
  local points = self:qq()
  local time = { name = "time", unit = "s" }
  return figures.make { columns = 2, panels = {
    { title = ("%s: R2 %.4g"):format(mode_words[self.mode], self.r2), x = time, y = { name = self.quantity, unit = self.unit }, series = {
      { x = self.t, y = self.measured, label = "measured", role = "measured" },
      { x = self.t, y = self.predicted, label = mode_words[self.mode], role = "final", style = "dashed" } } },
    distributions.qq_panel(points, { name = "residual", unit = self.unit }),
  } }
end

local rows = {
  { "rmse", "rmse", function(self) return "root of the mean squared error" .. (self.unit ~= "" and " [" .. self.unit .. "]" or "") end },
  { "nrmse", "nrmse", "rmse over the measured standard deviation" },
  { "r2", "R2", "share of the measured variance" },
  { "fit", "fit", "100 (1 - nrmse) %" },
  { "qqcc", "QQCC", "correlation of the residual's normal QQ plot" },
  { "dtw", "DTW", "mean distance of the phase portraits, in standard deviations" },
  { "mutual_information", "MI", "mutual information of measurement and model [nat]" },
  { "spearman", "Spearman", "rank correlation" },
  { "kendall", "Kendall", "rank correlation tau-b" },
}

local function measure_lines(self, lines)
  for _, row in ipairs(rows) do
    local value, interval = self[row[1]], self.intervals[row[1]]
    if value then
      local range = interval and ("%.4g to %.4g"):format(interval.low, interval.high) or ""
      local words = type(row[3]) == "string" and row[3] or row[3](self)
      lines[#lines + 1] = ("  %-10s%-12s%s%s"):format(row[2], ("%.5g"):format(value),
        self.level and ("%-24s"):format(range) or "", words)
    end
  end
end

local function test_lines(self, lines)
  local probability = statistics.probability
  if self.white then
    lines[#lines + 1] = ("  residual  %d of %d autocorrelations beyond +-%.3g, Ljung-Box %s; runs of signs %s"):format(
      self.white.beyond, self.white.count, self.white.bound, probability(self.white.p_value), probability(self.runs_p_value))
  end
  if self.follows then
    lines[#lines + 1] = ("  and F     %d of %d cross-correlations beyond +-%.3g, %s"):format(self.follows.beyond,
      self.follows.count, self.follows.bound, probability(self.follows.p_value))
  end
end

local function text(self)
  local lines = { ("%s of %s on %srecord %s, %g to %g s (%d rows at %.6g Hz)"):format(mode_words[self.mode], self.quantity,
    self.data and self.data .. " " or "", self.record, self.window.from, self.window.to, self.rows, 1/self.dt) }
  if self.stopped_at then
    lines[2] = ("  stopped at t = %.4g s: %s; no measure holds for such a run"):format(self.stopped_at, self.cause)
    return table.concat(lines, "\n")
  end
  measure_lines(self, lines)
  if self.level then
    lines[#lines + 1] = ("  intervals hold with %g %%, by blocks of %d rows"):format(100*self.level, self.block)
  end
  if self.dtw_band then lines[#lines + 1] = ("  DTW within a band of %d rows"):format(self.dtw_band) end
  test_lines(self, lines)
  return table.concat(lines, "\n")
end

local function input_of(record)
  for _, channel in ipairs(record.channels) do
    if channel.name:match "^F%d*$" then return record:column(channel.name) end
  end
end

comparison.compare = schema.define({
  name = "compare",
  help = "How good is a model on a record? RMSE, R2, fit, QQCC, DTW of the phase portraits, mutual information, rank correlations "
    .. "and tests of the residual, with the mode, the data and the window they hold for.",
  fields = {
    { "record", types.is("record", "lunid.read"), required = true, help = "what was measured" },
    { "run", types.is("run", "lunid.simulate"), help = "a free run on the record" },
    { "model", types.is("model", "lunid.model"), help = "a model: run freely from the record's first state, or as `mode` says" },
    { "regression", types.is("regression", "lunid.regress"), help = "its model: by equation error, or as `mode` says" },
    { "predicted", types.column, help = "a prediction of your own, row by row in the window" },
    { "mode", types.choice { "free_run", "one_step", "equation_error" },
      help = "'one_step': each row from the measured state before it; 'equation_error': the restoring force along the measured "
        .. "motion beside F - m*a" },
    { "data", types.choice { "train", "test" }, help = "what the record was to the model" },
    { "window", types.is("window", "lunid.window"), help = "part of the time that run and record have" },
    { "channel", types.string, default = "y", help = "the displacement that is compared" },
    { "interval", types.number { above = 0, below = 1 }, help = "such as 0.95: intervals by block bootstrap, for coloured errors" },
    { "draws", types.integer { min = 99 }, default = 999, help = "of the bootstrap" },
    { "band", types.number { min = 0 }, unit = "s", help = "that the time warping may bend; else any, for long records less" },
    { "neighbours", types.integer { min = 1 }, default = 3, help = "of the mutual information" },
    { "lags", types.integer { min = 1 }, default = 25, help = "of the residual's tests, rows" },
  },
  returns = "comparison",
  example = [[print(lunid.compare { run = run, record = test, data = "test", interval = 0.95 })]],
}, function(given)
  local data = gather(given)
  local record = data.record
  local found = {}
  if data.predicted then
    found = core.compare { measured = data.measured, model = data.predicted, measured_rate = data.measured_rate,
      model_rate = data.model_rate, input = input_of(record), neighbours = given.neighbours, lags = given.lags,
      band = given.band and math.floor(given.band / record.dt + 0.5), level = given.interval, draws = given.draws }
    found.predicted, found.residual = data.predicted, sources.minus(data.measured, data.predicted)
  end
  local channel = record.channels[data.quantity]
  found.mode, found.data, found.record, found.quantity = data.mode, given.data, record.name, data.quantity
  found.unit = data.unit or channel and channel.unit or ""
  found.window, found.dt, found.rows = { from = record.start, to = record.start + record.duration }, record.dt, record.rows
  found.t, found.measured, found.level = record:column "t", data.measured, given.interval
  found.stopped_at, found.cause, found.place = data.stopped_at, data.cause, core.place()
  return schema.object("comparison", found, methods, text)
end)

comparison.public = { compare = comparison.compare }
return comparison

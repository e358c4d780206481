-- What a record looks like over frequency and slow time: results with columns, to be drawn and saved.
local columns = require "lunid.columns"
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local channel = { "channel", types.string, default = "y", help = "whose" }
local length = { "length", types.integer { min = 16 }, unit = "rows",
  help = "of a segment, a power of two; else an eighth of the record or less" }

local function text(...)
  local line = string.format(...)
  return function() return line end
end

schema.method({
  name = "record:spectrum",
  help = "Power spectral density by Welch's method. Columns: frequency [Hz], density [unit^2/Hz], and its 95 % limits low, "
    .. "high.",
  positional = { "channel" },
  fields = { channel, length },
  returns = "spectrum",
  example = [[local s = record:spectrum { channel = "y" }
lunid.figure.lines { series = { lunid.figure.series { s.frequency, s.density } } }:save "spectrum.png"]],
}, function(record, given)
  local s = core.record_spectrum(record, given)
  return columns.result("spectrum", { "frequency", "density", "low", "high" }, s,
    text("spectrum of %s: %d segments of %d rows, %.4g Hz apart", given.channel, s.segments, s.length, s.frequency[2]))
end)

schema.method({
  name = "record:transfer",
  help = "Frequency response from an input to an output, with coherence and 95 % limits. H1 holds for noise in the output, "
    .. "H2 for noise in the input. Columns: frequency [Hz], real, imaginary, magnitude, phase [rad], coherence, "
    .. "magnitude_low, magnitude_high, phase_std [rad].",
  fields = {
    { "input", types.string, default = "F", help = "channel that drives" },
    { "output", types.string, default = "y", help = "channel that answers" },
    { "estimator", types.choice { "h1", "h2" }, default = "h1", help = "Sxy/Sxx or Syy/Syx" },
    length,
  },
  returns = "transfer",
  example = [[local h = record:transfer { input = "F", output = "y", estimator = "h1" }
h:save "frf.csv"]],
}, function(record, given)
  local t = core.record_transfer(record, given)
  return columns.result("transfer", { "frequency", "real", "imaginary", "magnitude", "phase", "coherence",
    "magnitude_low", "magnitude_high", "phase_std" }, t,
    text("%s from %s to %s: %d segments of %d rows, worth %.3g averages; coherence under %.2g may be chance",
      given.estimator:upper(), given.input, given.output, t.segments, t.length, t.averages, t.chance))
end)

local spectrogram_methods = {}

--- The density of one segment over frequency, as a column.
function spectrogram_methods.at(result, segment)
  local density = math.type(segment) == "integer" and result.densities[segment]
  if not density then
    schema.fail("at", ("segment: expected 1 to %d, got %s"):format(#result.densities, core.describe(segment)))
  end
  return density
end

schema.method({
  name = "record:spectrogram",
  help = "Power spectral densities along the record. Columns over its segments: time [s], ridge, the frequency of the "
    .. "largest density [Hz]; `:at(segment)` is the density over `.frequency`.",
  positional = { "channel" },
  fields = { channel, length,
    { "hop", types.integer { min = 1 }, unit = "rows", help = "from one segment to the next; else a quarter of one" } },
  returns = "spectrogram",
  example = [[local s = record:spectrogram { channel = "y", length = 256 }
lunid.figure.series { s.time, s.ridge }]],
}, function(record, given)
  local s = core.record_spectrogram(record, given)
  return columns.result("spectrogram", { "time", "ridge" }, s,
    text("spectrogram of %s: %d segments, %.4g Hz apart", given.channel, #s.time, s.frequency[2]), spectrogram_methods)
end)

schema.method({
  name = "record:envelope",
  help = "Amplitude and instantaneous frequency of a motion of one frequency at a time, without its noise. Columns: time "
    .. "[s], amplitude, frequency [Hz], phase [rad].",
  positional = { "channel" },
  fields = { channel },
  returns = "envelope",
  example = [[local e = decay:envelope "y"
lunid.figure.series { e.amplitude, e.frequency, label = "backbone" }]],
}, function(record, given)
  local e = core.record_envelope(record, given)
  return columns.result("envelope", { "time", "amplitude", "frequency", "phase" }, e,
    text("envelope of %s: amplitude %.4g to %.4g", given.channel, e.amplitude:min(), e.amplitude:max()))
end)

schema.method({
  name = "record:cycles",
  help = "Cycle by cycle, between upward crossings of the record's line. Columns: time [s] of the first crossing, period "
    .. "[s], frequency [Hz], amplitude, mean.",
  positional = { "channel" },
  fields = { channel },
  returns = "cycles",
  example = [[local c = decay:cycles "y"
print(c.frequency:mean(), c.amplitude:list())]],
}, function(record, given)
  local c = core.record_cycles(record, given)
  return columns.result("cycles", { "time", "period", "frequency", "amplitude", "mean" }, c,
    text("%d cycles of %s", #c.time, given.channel))
end)

schema.method({
  name = "record:noise",
  help = "The noise under a channel. Fields: white (the lowest level of its spectrum, which the record works with), robust (by "
    .. "the median of its sixth differences, which outliers do not reach), outliers, exponent and exponent_std of the "
    .. "background 1/f^exponent under tones and resonances, background (its deviation), coloured. Columns: frequency "
    .. "[Hz], density.",
  positional = { "channel" },
  fields = { channel },
  returns = "noise_report",
  example = [[local n = record:noise "y"
print(n.white, n.exponent, n.exponent_std)]],
}, function(record, given)
  local n = core.record_noise(record, given)
  local unit = record.channels[given.channel].unit
  n.coloured = math.abs(n.exponent) > math.max(4 * n.exponent_std, 0.2)
  return columns.result("noise_report", { "frequency", "density" }, n, function()
    return ("noise of %s: white part %.4g, by medians %.4g, %d outliers; under tones and resonances a background "
      .. "1/f^%.2f(%.2f) of deviation %.4g%s over all frequencies"):format(given.channel, n.white, n.robust, n.outliers,
      n.exponent, n.exponent_std, n.background, unit ~= "" and " " .. unit or "")
  end)
end)

schema.method({
  name = "record:summary",
  help = "Rows, rate, start, duration and the statistics of each channel. `summary.channels.y` has min, max, mean, std, noise, "
    .. "missing (rows that are no numbers) and held (the longest run that repeats a value).",
  fields = {},
  returns = "summary",
  example = [[print(record:summary())]],
}, function(record)
  local s = core.record_summary(record)
  s.rows, s.rate, s.start, s.duration = record.rows, 1 / record.dt, record.start, record.duration
  return schema.object("summary", s, nil, function(self) return self.text end)
end)

return {}

-- What is done to a whole record: filters, trends, rates, delays, integrals. Each method gives a new record, whose
-- history tells what was done. Streams have all but align, and give a new stream.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local channels = { "channels", types.list(types.string, 1), help = "such as { \"y\", \"F\" }; else all" }

schema.method({
  name = "record:filter",
  also = "stream",
  help = "A Butterworth filter forwards and backwards, so that nothing is delayed. The amplitude at a cut-off is halved. "
    .. "Also stream:filter, which gives a stream.",
  fields = {
    { "from", types.number { above = 0 }, unit = "Hz", help = "passes what lies above" },
    { "to", types.number { above = 0 }, unit = "Hz", help = "passes what lies below; with from: a band" },
    { "stop", types.boolean, default = false, help = "passes all but that" },
    { "order", types.integer { min = 1, max = 12 }, default = 4, help = "of the filter in each direction" },
    channels,
  },
  returns = "record",
  example = [[local smooth = record:filter { to = 120, channels = { "y" } }]],
}, core.filter_record)

schema.method({
  name = "record:detrend",
  also = "stream",
  help = "Takes off the least-squares polynomial of each channel. Also stream:detrend.",
  positional = { "degree" },
  fields = {
    { "degree", types.integer { min = 0, max = 12 }, default = 1, help = "0 the mean, 1 a line, 2 a parabola ..." },
    channels,
  },
  returns = "record",
  example = [[local flat = record:detrend { degree = 1, channels = { "y" } }]],
}, core.detrend_record)

schema.method({
  name = "record:decimate",
  also = "stream",
  help = "Every row of so many, after a filter that keeps the rest from folding in. Also stream:decimate.",
  positional = { "factor" },
  fields = { { "factor", types.integer { min = 1 }, required = true, help = "rows that become one" } },
  returns = "record",
  example = [[local coarse = record:decimate(4)]],
}, function(record, given) return core.decimate_record(record, given.factor) end)

schema.method({
  name = "record:resample",
  also = "stream",
  help = "The same time at another rate, by band-limited interpolation. Also stream:resample.",
  positional = { "rate" },
  fields = { { "rate", types.number { above = 0 }, required = true, unit = "Hz", help = "rows per second" } },
  returns = "record",
  example = [[local finer = record:resample(1000)]],
}, function(record, given) return core.resample_record(record, given.rate) end)

schema.method({
  name = "record:align",
  help = "Moves a record onto the time of another by the largest correlation of one channel, to a part of a row. Also "
    .. "gives the delay taken off [s] and the correlation.",
  positional = { "with" },
  fields = {
    { "with", types.is("record", "lunid.read"), required = true, help = "whose rows it gets" },
    { "channel", types.string, default = "y", help = "that both hold" },
    { "most", types.number { above = 0 }, unit = "s", help = "largest delay looked for; else half of the shorter record" },
  },
  returns = "record",
  example = [[local moved, delay, correlation = slave:align { with = master, channel = "F" }]],
}, function(record, given) return core.align_record(record, given.with, given) end)

schema.method({
  name = "record:integrate",
  also = "stream",
  help = "Velocity and displacement from an acceleration, or displacement from a velocity, rid of drift. Also "
    .. "stream:integrate.",
  fields = {
    { "from", types.string, help = "channel to integrate; else the measured v or a" },
    { "below", types.number { above = 0 }, unit = "Hz",
      help = "drift is what lies below: taken off by a high pass after each integration" },
    { "degree", types.integer { min = 0, max = 10 }, default = 1,
      help = "without below: of the polynomial taken off the first integral, one more off the second" },
  },
  returns = "record",
  example = [[local motion = record:integrate { from = "a", below = 0.5 }]],
}, core.integrate_record)

return {}

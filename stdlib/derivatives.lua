-- Velocity and acceleration from what was measured: record:derive { method = lunid.derivative.kalman {} }.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local derivative = {}

--- Declares lunid.derivative.<name>, whose fields core.derive_record takes as they are.
local function define(definition)
  local name = definition.name
  definition.name, definition.returns = "derivative." .. name, "derivative"
  derivative[name] = schema.define(definition, function(given)
    given.kind = name
    return schema.object("derivative", given, nil, function() return definition.name end)
  end)
end

local from_noise = "; else chosen from the noise"
local rows = { "rows", types.integer { min = 3 }, help = "of the window, an odd number" .. from_noise }
local order = { "order", types.integer { min = 1, max = 12 }, help = "of the polynomial" .. from_noise }

define {
  name = "finite_differences",
  help = "Central differences of any even order of accuracy, one-sided at the ends.",
  fields = {
    { "accuracy", types.integer { min = 2, max = 12 }, help = "even: the error falls as its power of dt" .. from_noise },
    { "step", types.integer { min = 1 }, help = "rows between the samples that are used" .. from_noise },
  },
  example = [[record:derive { method = lunid.derivative.finite_differences { accuracy = 4, step = 1 } }]],
}

define {
  name = "savitzky_golay",
  help = "A polynomial through a moving window.",
  fields = { rows, order },
  example = [[record:derive { method = lunid.derivative.savitzky_golay { rows = 21, order = 3 } }]],
}

define {
  name = "fourier",
  help = "In the frequency domain, continued beyond the ends so that the record need not be periodic. Without a cut-off "
    .. "the gain is Wiener's, from the record's own spectrum and noise.",
  fields = { { "cutoff", types.number { above = 0 }, unit = "Hz", help = "what lies above it is taken for noise" } },
  example = [[record:derive { method = lunid.derivative.fourier {} }]],
}

define {
  name = "spline",
  help = "A smoothing spline with a knot at each row.",
  fields = {
    { "degree", types.integer { min = 3, max = 5 }, default = 5, help = "3: penalises the square of the acceleration; 5: that of the jerk" },
    { "by", types.choice { "noise", "cross_validation" }, default = "noise",
      help = "how the weight is chosen: by the known noise, or by generalised cross-validation without it" },
    { "weight", types.number { above = 0 }, unit = "s^degree", help = "of the penalty's integral; else chosen" },
  },
  example = [[record:derive { method = lunid.derivative.spline { by = "cross_validation" } }]],
}

define {
  name = "total_variation",
  help = "Keeps jumps: one of the derivatives is constant in pieces, as few as the noise allows. Slow on long records.",
  fields = {
    { "order", types.integer { min = 1, max = 3 }, default = 3,
      help = "which is constant in pieces: 1 velocity, 2 acceleration, 3 jerk" },
    { "weight", types.number { above = 0 }, help = "of the jumps' sizes, in the channel's unit" .. from_noise },
  },
  example = [[record:derive { method = lunid.derivative.total_variation { order = 2 } }]],
}

define {
  name = "smoothed_differences",
  help = "Finite differences after a Savitzky-Golay filter.",
  fields = { rows, order,
    { "accuracy", types.integer { min = 2, max = 12 }, default = 2, help = "of the differences, an even number" } },
  example = [[record:derive { method = lunid.derivative.smoothed_differences { rows = 11, order = 3 } }]],
}

define {
  name = "kalman",
  help = "A Kalman smoother over y, v and a jointly, from all of them that were measured. Each channel has its noise; a "
    .. "higher derivative is white, and as strong as is most likely.",
  fields = {
    { "order", types.integer { min = 3, max = 6 }, default = 4,
      help = "which derivative is white: 3 the jerk, 4 the snap; higher ones for smoother motions" },
    { "density", types.number { above = 0 }, unit = "(m/s^order)^2/Hz", help = "of the white derivative; else most likely" },
  },
  example = [[record:derive { method = lunid.derivative.kalman {}, smooth = true }]],
}

schema.method({
  name = "record:derive",
  help = "Velocity and acceleration where they were not measured. Derived channels remember how "
    .. "(`record.channels.a.derivation`).",
  fields = {
    { "method", types.is("derivative", "lunid.derivative"), help = "lunid.derivative.fourier {} by default" },
    { "channels", types.list(types.string, 1), help = "to make, such as { \"a\" }; else what of v and a was not measured" },
    { "from", types.string, help = "channel to differentiate; else the nearest measured one (kalman: all of them)" },
    { "smooth", types.boolean, default = false, help = "replace measured channels too by what the method makes of them" },
  },
  returns = "record",
  example = [[local better = record:derive { method = lunid.derivative.kalman {} }]],
}, core.derive_record)

return { public = { derivative = schema.strict_table("lunid.derivative", derivative) } }

-- What sensors do to a record: record:with_noise { y = 0.05, v = { lunid.noise.gaussian { std = 1e-3 }, ... }, seed = 3 }.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local noise = {}

--- Declares lunid.noise.<name>; body(given) returns what core.disturb takes.
local function define(definition, body)
  local name = definition.name
  definition.name, definition.returns = "noise." .. name, "noise"
  noise[name] = schema.define(definition, function(given)
    local fault = body(given)
    fault.kind = name
    return schema.object("noise", fault, nil, function() return definition.name end)
  end)
end

--- Fields for a size, absolute or relative; size_of gives what core.disturb takes.
local function size_fields(name, what, relative_to)
  return { name, types.number { above = 0 }, help = what .. ", in the channel's unit" },
    { "relative", types.number { above = 0 }, help = "the same as a part of " .. relative_to }
end

local function size_of(given, called, name)
  if (given[name] == nil) == (given.relative == nil) then
    schema.fail("noise." .. called, ("give either %s, in the channel's unit, or relative"):format(name))
  end
  return { size = given[name] or given.relative, relative = given.relative ~= nil }
end

local deviation, magnitude = "the channel's standard deviation", "the channel's largest magnitude"
local fraction_field = { "fraction", types.number { above = 0, max = 1 }, required = true,
  help = "probability of a row to be hit" }

local std, std_relative = size_fields("std", "standard deviation", deviation)
define({
  name = "gaussian",
  help = "Independent Gaussian noise on every row.",
  fields = { std, std_relative },
  example = [[lunid.noise.gaussian { std = 1e-4 }]],
}, function(given) return size_of(given, "gaussian", "std") end)

local half_width, half_width_relative = size_fields("half_width", "largest error", deviation)
define({
  name = "uniform",
  help = "Independent noise on every row, even within -half_width to half_width.",
  fields = { half_width, half_width_relative },
  example = [[lunid.noise.uniform { half_width = 100 }]],
}, function(given) return size_of(given, "uniform", "half_width") end)

define({
  name = "coloured",
  help = "Noise that depends on itself: power density 1/f^exponent, or an autoregression of its rows. Give one of them.",
  fields = {
    { "exponent", types.number { min = -4, max = 4 }, help = "0 white, 1 pink, 2 brown, -1 blue" },
    { "ar", types.list(types.number(), 1), help = "x[i] = ar[1]*x[i-1] + ar[2]*x[i-2] + ... + white noise" },
    std, std_relative,
  },
  example = [[lunid.noise.coloured { exponent = 1, relative = 0.05 }]],
}, function(given)
  local fault = size_of(given, "coloured", "std")
  if (given.exponent == nil) == (given.ar == nil) then
    schema.fail("noise.coloured", "give either exponent, of the spectrum, or ar, of the rows")
  end
  fault.exponent, fault.ar = given.exponent, given.ar
  return fault
end)

define({
  name = "multiplicative",
  help = "A gain that is not constant: every row times 1 + std*N(0, 1).",
  fields = { { "std", types.number { above = 0 }, required = true, help = "standard deviation of the gain" } },
  example = [[lunid.noise.multiplicative { std = 0.02 }]],
}, function(given) return { size = given.std } end)

local count, count_relative = size_fields("count", "value of one count", deviation)
define({
  name = "poisson",
  help = "Counting noise: values come in counts, whose number is random about its mean. The variance is count*abs(x).",
  fields = { count, count_relative },
  example = [[lunid.noise.poisson { count = 1e-5 }]],
}, function(given) return size_of(given, "poisson", "count") end)

local size, size_relative = size_fields("size", "how far off", deviation)
define({
  name = "outliers",
  help = "Single rows that are far off, upwards or downwards.",
  fields = { fraction_field, size, size_relative },
  example = [[lunid.noise.outliers { fraction = 0.01, relative = 5 }]],
}, function(given)
  local fault = size_of(given, "outliers", "size")
  fault.fraction = given.fraction
  return fault
end)

define({
  name = "dropped",
  help = "Samples that are lost. The time base stays even: a lost row is filled, and the record's warnings count them.",
  fields = {
    fraction_field,
    { "fill", types.choice { "hold", "linear", "gap" }, default = "hold",
      help = "the value before it, as a converter repeats it; a straight line; 'gap': not a number, to test with" },
  },
  example = [[lunid.noise.dropped { fraction = 0.02 }]],
}, function(given) return { fraction = given.fraction, fill = given.fill } end)

local step, range = { "step", types.number { above = 0 }, help = "distance of two values, in the channel's unit" },
  { "range", types.number { above = 0 }, help = "with bits: largest value; else " .. magnitude }
define({
  name = "quantised",
  help = "Values in steps, as a converter gives them. Give step, or bits over -range to range.",
  fields = { step, { "bits", types.integer { min = 2, max = 52 }, help = "of the converter" }, range },
  example = [[lunid.noise.quantised { bits = 12, range = 0.01 }]],
}, function(given)
  if (given.step == nil) == (given.bits == nil) then
    schema.fail("noise.quantised", "give either step, in the channel's unit, or bits")
  end
  if given.step then
    if given.range then schema.fail("noise.quantised", "range goes with bits, not with step") end
    return { size = given.step }
  end
  return { size = given.range or 1, relative = given.range == nil, bits = given.bits }
end)

local level, level_relative = size_fields("level", "largest value that it shows", magnitude)
define({
  name = "clipped",
  help = "A sensor at its limit: values held within -level to level.",
  fields = { level, level_relative },
  example = [[lunid.noise.clipped { level = 0.01 }]],
}, function(given) return size_of(given, "clipped", "level") end)

local told = { outliers = "%d of %d rows are outliers", dropped = "%d of %d rows were lost", quantised = "%d of %d rows "
  .. "are beyond the converter's range", clipped = "%d of %d rows are clipped" }
local filled = { hold = "; each repeats the one before it", linear = "; filled by straight lines",
  gap = "; they are not numbers" }

--- A number is Gaussian noise relative to the channel; one fault or a list of them is applied in order.
local function faults_of(channel, value)
  if type(value) == "number" then
    if not (value >= 0 and value < math.huge) then
      schema.fail("with_noise: " .. channel, ("expected >= 0, got %g"):format(value))
    end
    return value > 0 and { noise.gaussian { relative = value } } or {}
  end
  if getmetatable(value) == "lunid.noise" then return { value } end
  local good, kept = types.list(types.is("noise", "lunid.noise")).check(value)
  if good then return kept end
  schema.fail("with_noise: " .. channel,
    ("expected a number, a noise from lunid.noise or a list of them, got %s"):format(core.describe(value)))
end

core.add_method("lunid.record", "with_noise", function(record, given)
  if type(given) ~= "table" or getmetatable(given) ~= nil then
    schema.fail("with_noise", "expected a table { channel = noise, ... }, got " .. core.describe(given))
  end
  local names = {}
  for name in pairs(given) do
    if name ~= "seed" then
      if type(name) ~= "string" or not record.channels[name] then
        local known = {}
        for i, channel in ipairs(record.channels) do known[i] = channel.name end
        schema.fail("with_noise", ("the record has no channel '%s'%s"):format(name,
          core.did_you_mean(core.nearest(name, known)) or " (it has " .. table.concat(known, ", ") .. ")"))
      end
      names[#names + 1] = name
    end
  end
  if given.seed ~= nil and (math.type(given.seed) ~= "integer" or given.seed < 0) then
    schema.fail("with_noise: seed", "expected a whole number >= 0, got " .. core.describe(given.seed))
  end
  table.sort(names)
  for _, name in ipairs(names) do
    local faults, hit = faults_of(name, given[name]), nil
    record, hit = core.disturb(record, name, faults, given.seed)
    for i, fault in ipairs(faults) do
      if hit[i] > 0 then
        record = core.warn_record(record, ("channel '%s': %s%s"):format(name, told[fault.kind]:format(hit[i], record.rows),
          filled[fault.fill] or ""))
      end
    end
  end
  return record
end)

return { public = { noise = schema.strict_table("lunid.noise", noise) } }

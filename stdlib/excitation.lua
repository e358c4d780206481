-- Excitations: forces on an even time base. Each is a record with the channel F, to be driven with, saved, cut and added
-- like a measured one; where the force has a formula the record keeps it, and a run takes it between the samples.
local core = require "lunid.core"
local schema = require "lunid.schema"
local symbols = require "lunid.symbols"
local types = schema.types

local t, pi = symbols.time, math.pi
local cos, exp, max, min, sin = symbols.cos, symbols.exp, symbols.max, symbols.min, symbols.sin

local excitation = {}

-- ---- the time base that all share ----

local most_rows = 1e8  -- of a record in memory: 0.8 GB a channel

local base_fields = {
  { "dt", types.number { above = 0 }, required = true, unit = "s", help = "sample time" },
  { "duration", types.number { above = 0 }, required = true, unit = "s", help = "from the first sample to the last" },
  { "start", types.number(), default = 0, unit = "s", help = "time of the first sample" },
  { "taper", types.number { min = 0, max = 1 }, default = 0,
    help = "part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window" },
}
local seed_field = { "seed", types.integer { min = 0 },
  help = "of its random numbers; else that of the run (--seed)" }

local function fail(given, field, message) schema.fail(given.called .. ": " .. field, message) end

--- Fills in rows and the Nyquist frequency.
local function check_base(given)
  given.rows = math.floor(given.duration / given.dt + 1e-6) + 1
  given.nyquist = 0.5 / given.dt
  if given.rows < 6 then
    fail(given, "dt", ("expected at most a fifth of the duration, %g s, got %g"):format(given.duration / 5, given.dt))
  end
  if given.duration / given.dt > most_rows then
    fail(given, "dt", ("%.3g s in steps of %g s are %.3g rows, %.3g GB a channel; take a larger step or a part of the time")
      :format(given.duration, given.dt, given.duration / given.dt, given.duration / given.dt * 8e-9))
  end
end

local function check_frequency(given, field)
  if given[field] >= given.nyquist then
    fail(given, field, ("expected < %g Hz, the Nyquist frequency of dt = %g s, got %g"):format(given.nyquist, given.dt,
      given[field]))
  end
end

local function check_band(given)
  if given.to <= given.from then
    fail(given, "to", ("expected > from, which is %g, got %g"):format(given.from, given.to))
  end
  check_frequency(given, "to")
end

--- The time of a jump as that of a sample: a jump between samples cannot be seen on them.
local function nearest_sample(given)
  local at, stop = given.at or given.start, given.start + given.duration
  if at < given.start or at > stop then
    fail(given, "at", ("expected within %g to %g s, got %g"):format(given.start, stop, at))
  end
  return given.start + given.dt * math.floor((at - given.start) / given.dt + 0.5)
end

--- Tukey's window over the duration as a formula: rises over half of `part` of it, falls over the other half. (Harris
--- 1978, Proc. IEEE 66, 51.)
local function window(given)
  local ramp = 0.5 * given.taper * given.duration
  local edge = min(t - given.start, given.start + given.duration - t)
  return 0.5 - 0.5*cos(pi / ramp * max(0, min(edge, ramp)))
end

--- The record of a force: `formula`, an expression of the time, and `values`, a column; `between`: what values do between
--- the samples.
local function record_of(given, description, force)
  local values, formula = force.values, force.formula
  if given.taper > 0 then
    local taper = window(given)
    formula = formula and taper * formula
    if values then
      local weights = core.make_excitation { name = "taper", start = given.start, dt = given.dt, rows = given.rows,
        formula = taper }:column "F"
      local tapered = {}
      for i = 1, given.rows do tapered[i] = weights[i] * values[i] end
      values = core.column(tapered)
    end
    description = ("%s, taper %g"):format(description, given.taper)
  end
  return core.make_excitation { name = description, source = description, start = given.start, dt = given.dt,
    rows = given.rows, formula = formula, values = values, between = force.between or "linear" }
end

--- Declares lunid.excitation.<name>: its own fields, then the time base. body(given) returns a description and the force
--- { formula =, values =, between = }.
local function define(definition, body)
  local name = definition.name
  definition.name = "excitation." .. name
  definition.returns = "record"
  local fields = {}
  for _, field in ipairs(definition.fields) do fields[#fields + 1] = field end
  for _, field in ipairs(base_fields) do fields[#fields + 1] = field end
  for _, field in ipairs(base_fields) do field.shared = "Time base" end  -- told once in the manual
  definition.fields = fields
  excitation[name] = schema.define(definition, function(given)
    given.called = definition.name
    check_base(given)
    return record_of(given, body(given))
  end)
end

local function random_of(given, fields)
  fields.rows, fields.dt, fields.seed = given.rows, given.dt, given.seed
  fields.stream = given.called
  return core.random_signal(fields)
end

local function scaled(column, factor)
  local values = column:list()
  for i = 1, #values do values[i] = factor * values[i] end
  return core.column(values)
end

-- ---- with a formula: exact between the samples ----

define({
  name = "harmonic",
  help = "A cosine: amplitude*cos(2*pi*frequency*t + phase).",
  fields = {
    { "amplitude", types.number(), required = true, unit = "N", help = "largest force" },
    { "frequency", types.number { above = 0 }, required = true, unit = "Hz", help = "cycles per second" },
    { "phase", types.number(), default = 0, unit = "rad", help = "at t = 0; -pi/2 makes a sine" },
  },
  example = [[local push = lunid.excitation.harmonic { amplitude = 2000, frequency = 20, dt = 0.00125, duration = 5 }]],
}, function(given)
  check_frequency(given, "frequency")
  return ("harmonic, %g N at %g Hz"):format(given.amplitude, given.frequency),
    { formula = given.amplitude * cos(2 * pi * given.frequency * t + given.phase) }
end)

--- Phases of n lines of equal amplitude: Schroeder's make the sum nearly flat (1970, IEEE Trans. Inf. Theory 16, 85).
local function phases_of(given, n)
  local phases = {}
  local random = given.phases == "random"
    and core.random_signal { kind = "uniform", rows = n, seed = given.seed, stream = given.called }
  for i = 1, n do phases[i] = random and pi * random[i] or -pi * i * (i - 1) / n end
  return phases
end

--- Whole numbers k with from <= k/period <= to, the odd ones alone where asked for.
local function lines_of(given)
  local lines, slack = {}, 1e-9
  for k = math.max(1, math.ceil(given.from * given.period - slack)), math.floor(given.to * given.period + slack) do
    if not given.odd or k % 2 == 1 then lines[#lines + 1] = k end
  end
  if #lines == 0 then
    fail(given, "period", ("no %sline k/period, %g Hz apart, lies within %g to %g Hz; expected a longer period"):format(
      given.odd and "odd " or "", 1 / given.period, given.from, given.to))
  end
  return lines
end

define({
  name = "multisine",
  help = "A sum of cosines of equal amplitude at the multiples of 1/period in a band. Give rms or amplitude.",
  fields = {
    { "from", types.number { min = 0 }, required = true, unit = "Hz", help = "lowest frequency" },
    { "to", types.number { above = 0 }, required = true, unit = "Hz", help = "highest frequency" },
    { "rms", types.number { above = 0 }, unit = "N", help = "of the whole force over a period" },
    { "amplitude", types.number { above = 0 }, unit = "N", help = "of each cosine" },
    { "period", types.number { above = 0 }, unit = "s", help = "time after which it repeats; else the duration" },
    { "phases", types.choice { "random", "schroeder" }, default = "random",
      help = "'schroeder': a low peak for its rms" },
    { "odd", types.boolean, default = false,
      help = "odd multiples alone: even lines of a response then come from the structure" },
    seed_field,
  },
  example = [[local push = lunid.excitation.multisine { from = 5, to = 60, rms = 300, period = 2, dt = 0.00125, duration = 8,
  phases = "schroeder", odd = true }]],
}, function(given)
  check_band(given)
  given.period = given.period or given.duration
  if (given.rms == nil) == (given.amplitude == nil) then
    fail(given, "rms", "give either rms, of the whole force, or amplitude, of each cosine")
  end
  if given.duration + given.dt < given.period * (1 - 1e-9) then
    fail(given, "duration", ("expected at least one period, %g s, got %g"):format(given.period, given.duration))
  end
  local lines = lines_of(given)
  local amplitude = given.amplitude or given.rms * math.sqrt(2 / #lines)
  local phases, sum = phases_of(given, #lines), 0
  for i, k in ipairs(lines) do sum = sum + cos(2 * pi * k / given.period * t + phases[i]) end
  return ("multisine, %d lines of %.6g N, %g to %g Hz"):format(#lines, amplitude, given.from, given.to),
    { formula = amplitude * sum }
end)

define({
  name = "swept_sine",
  help = "A cosine whose frequency runs from one value to another over the duration, up or down.",
  fields = {
    { "amplitude", types.number(), required = true, unit = "N", help = "largest force" },
    { "from", types.number { above = 0 }, required = true, unit = "Hz", help = "frequency at the start" },
    { "to", types.number { above = 0 }, required = true, unit = "Hz", help = "frequency at the end" },
    { "law", types.choice { "linear", "logarithmic" }, default = "linear",
      help = "even in Hz per second, or in octaves per second" },
    { "phase", types.number(), default = 0, unit = "rad", help = "at the start" },
  },
  example = [[local sweep = lunid.excitation.swept_sine { amplitude = 50, from = 5, to = 80, law = "logarithmic", dt = 0.001,
  duration = 20 }]],
}, function(given)
  check_frequency(given, "from")
  check_frequency(given, "to")
  if given.from == given.to then fail(given, "to", ("expected another frequency than from, %g Hz"):format(given.from)) end
  local since, phase = t - given.start, nil
  if given.law == "linear" then
    phase = 2 * pi * (given.from + (given.to - given.from) / (2 * given.duration) * since) * since
  else
    local octaves = math.log(given.to / given.from)
    phase = 2 * pi * given.from * given.duration / octaves * (exp(octaves / given.duration * since) - 1)
  end
  return ("swept sine, %g N, %g to %g Hz, %s"):format(given.amplitude, given.from, given.to, given.law),
    { formula = given.amplitude * cos(phase + given.phase) }
end)

define({
  name = "stepped_sine",
  help = "A cosine that dwells at each of several frequencies in turn, without a jump of its phase.",
  fields = {
    { "amplitude", types.number(), required = true, unit = "N", help = "largest force" },
    { "frequencies", types.list(types.number { above = 0 }, 2), required = true, unit = "Hz",
      help = "in the order in which they come, each for the same time" },
    { "phase", types.number(), default = 0, unit = "rad", help = "at the start" },
  },
  example = [[local steps = lunid.excitation.stepped_sine { amplitude = 50, frequencies = { 10, 12, 14 }, dt = 0.001,
  duration = 9 }]],
}, function(given)
  local frequencies, dwell = given.frequencies, given.duration / #given.frequencies
  for i, frequency in ipairs(frequencies) do
    if frequency >= given.nyquist then
      fail(given, "frequencies", ("entry %d: expected < %g Hz, the Nyquist frequency of dt = %g s, got %g"):format(i,
        given.nyquist, given.dt, frequency))
    end
  end
  local phase = frequencies[1] * (t - given.start)
  for i = 2, #frequencies do
    phase = phase + (frequencies[i] - frequencies[i - 1]) * max(0, t - given.start - (i - 1) * dwell)
  end
  return ("stepped sine, %g N, %d frequencies, %g s each"):format(given.amplitude, #frequencies, dwell),
    { formula = given.amplitude * cos(2 * pi * phase + given.phase) }
end)

define({
  name = "formula",
  help = "Any force that is an expression of lunid.time.",
  fields = {
    { "force", types.expression, required = true, unit = "N", help = "an expression of lunid.time alone" },
  },
  example = [[local push = lunid.excitation.formula { force = 75*lunid.sin(60*lunid.time), dt = 0.001, duration = 2 }]],
}, function(given)
  for _, symbol in ipairs(core.is_expression(given.force) and given.force:symbols() or {}) do
    if symbol.name ~= "t" then
      fail(given, "force", ("expected an expression of lunid.time alone, got one with '%s'"):format(symbol.name))
    end
  end
  return "formula, " .. tostring(given.force), { formula = given.force }
end)

-- ---- with jumps: held between the samples ----

local function held(given, value_at)
  local values = {}
  for i = 1, given.rows do values[i] = value_at(given.start + given.dt * (i - 1)) end
  return { values = core.column(values), between = "hold" }
end

define({
  name = "step",
  help = "A force that is switched on and stays.",
  fields = {
    { "height", types.number(), required = true, unit = "N", help = "the force from then on" },
    { "at", types.number(), unit = "s", help = "time of the jump, at the nearest sample; else the start" },
  },
  example = [[local push = lunid.excitation.step { height = 100, at = 0.5, dt = 0.001, duration = 4 }]],
}, function(given)
  local at = nearest_sample(given)
  return ("step, %g N at %g s"):format(given.height, at),
    held(given, function(time) return time > at - 0.5 * given.dt and given.height or 0 end)
end)

define({
  name = "pulse",
  help = "A force for a short time: rectangular, or half a sine.",
  fields = {
    { "height", types.number(), required = true, unit = "N", help = "largest force" },
    { "width", types.number { above = 0 }, required = true, unit = "s", help = "how long it lasts" },
    { "at", types.number(), unit = "s", help = "when it begins, at the nearest sample; else the start" },
    { "shape", types.choice { "rectangular", "half_sine" }, default = "rectangular", help = "its course" },
  },
  example = [[local blow = lunid.excitation.pulse { height = 500, width = 0.02, shape = "half_sine", dt = 0.001,
  duration = 2 }]],
}, function(given)
  if given.width < given.dt then
    fail(given, "width", ("expected at least one sample, dt = %g s, got %g"):format(given.dt, given.width))
  end
  local at = nearest_sample(given)
  local width = given.dt * math.floor(given.width / given.dt + 0.5)
  local words = ("%s pulse, %g N for %g s at %g s"):format(given.shape:gsub("_", " "), given.height, width, at)
  if given.shape == "half_sine" then
    local part = max(0, min(1, (t - at) / width))
    return words, { formula = given.height * sin(pi * part) }
  end
  return words, held(given, function(time)
    local since = time - at + 0.5 * given.dt
    return since > 0 and since < width and given.height or 0
  end)
end)

define({
  name = "impulse",
  help = "A blow: a given impulse within one sample, so that a mass at rest leaves with impulse/mass.",
  fields = {
    { "impulse", types.number(), required = true, unit = "N s", help = "force times time" },
    { "at", types.number(), unit = "s", help = "when, at the nearest sample; else the start" },
  },
  example = [[local blow = lunid.excitation.impulse { impulse = 2, dt = 0.001, duration = 2 }]],
}, function(given)
  local at = nearest_sample(given)
  return ("impulse, %g N s at %g s"):format(given.impulse, at),
    held(given, function(time) return math.abs(time - at) < 0.5 * given.dt and given.impulse / given.dt or 0 end)
end)

-- ---- random: band-limited between the samples ----

local rms_field = { "rms", types.number { above = 0 }, required = true, unit = "N", help = "root mean square of the force" }

define({
  name = "white_noise",
  help = "Independent random forces at the samples. Gaussian ones have the rms in the mean; uniform ones a half-width.",
  fields = {
    { "rms", types.number { above = 0 }, required = true, unit = "N",
      help = "standard deviation that the numbers are drawn from" },
    { "distribution", types.choice { "gaussian", "uniform" }, default = "gaussian",
      help = "'uniform': within -sqrt(3)*rms to sqrt(3)*rms" },
    seed_field,
  },
  example = [[local push = lunid.excitation.white_noise { rms = 100, seed = 7, dt = 0.001, duration = 10 }]],
}, function(given)
  local uniform = given.distribution == "uniform"
  local column = random_of(given, { kind = uniform and "uniform" or "white" })
  return ("white noise, %g N rms"):format(given.rms),
    { values = scaled(column, uniform and math.sqrt(3) * given.rms or given.rms), between = "band_limited" }
end)

define({
  name = "band_limited_noise",
  help = "Gaussian noise of even power density within a band and none outside, scaled to its rms.",
  fields = {
    { "from", types.number { min = 0 }, required = true, unit = "Hz", help = "lowest frequency" },
    { "to", types.number { above = 0 }, required = true, unit = "Hz", help = "highest frequency" },
    rms_field,
    seed_field,
  },
  example = [[local push = lunid.excitation.band_limited_noise { from = 5, to = 60, rms = 100, dt = 0.001, duration = 10 }]],
}, function(given)
  check_band(given)
  local narrowest = 1 / (given.rows * given.dt)
  if given.to - given.from < narrowest then
    fail(given, "to", ("expected a band of at least 1/duration = %g Hz, got %g"):format(narrowest, given.to - given.from))
  end
  return ("band-limited noise, %g N rms, %g to %g Hz"):format(given.rms, given.from, given.to), { values = scaled(
    random_of(given, { kind = "band_limited", from = given.from, to = given.to }), given.rms), between = "band_limited" }
end)

define({
  name = "coloured_noise",
  help = "Gaussian noise whose power density falls as 1/f^exponent, scaled to its rms.",
  fields = {
    { "exponent", types.number { min = -4, max = 4 }, required = true, help = "0 white, 1 pink, 2 brown, -1 blue" },
    rms_field,
    seed_field,
  },
  example = [[local push = lunid.excitation.coloured_noise { exponent = 1, rms = 100, dt = 0.001, duration = 10 }]],
}, function(given)
  return ("coloured noise, %g N rms, 1/f^%g"):format(given.rms, given.exponent),
    { values = scaled(random_of(given, { kind = "coloured", exponent = given.exponent }), given.rms),
      between = "band_limited" }
end)

-- ---- sums ----

local record = types.is("record", "lunid.excitation")

--- What the sampled parts of a sum do between the samples: what they agree on; held ones beside a formula run straight.
local function between_of(parts)
  local between, formula = nil, false
  for _, part in ipairs(parts) do
    local force = part.channels.F
    formula = formula or force.formula ~= nil
    local own = force.formula == nil and force.between or nil
    if own and between and own ~= between then between = "linear" else between = own or between end
  end
  return between == "hold" and formula and "linear" or between or "linear"
end

local sum = schema.define({
  name = "excitation.sum",
  help = "Several excitations at once, on one time base: { parts = { a, b } }, or { a, b } for short.",
  fields = {
    { "parts", types.list(record, 1), required = true, help = "of equal dt, start and number of rows" },
    { "interpolation", types.choice { "hold", "linear", "cubic", "band_limited" },
      help = "of the parts without a formula; else what they agree on, or straight lines" },
  },
  returns = "record",
  example = [[local push = lunid.excitation.sum { sweep, blow }]],
}, function(given)
  local first, names = given.parts[1], {}
  for i, part in ipairs(given.parts) do
    if not part.channels.F then schema.fail("excitation.sum", ("parts: entry %d has no channel F"):format(i)) end
    if part.rows ~= first.rows or math.abs(part.dt / first.dt - 1) > 1e-9
      or math.abs(part.start - first.start) > 1e-6 * first.dt then
      schema.fail("excitation.sum", ("parts: entry %d: expected %d rows of %g s from %g s as entry 1, got %d rows of %g s "
        .. "from %g s"):format(i, first.rows, first.dt, first.start, part.rows, part.dt, part.start))
    end
    names[i] = part.name
  end
  return core.sum_excitations(given.parts, table.concat(names, " + "), given.interpolation or between_of(given.parts))
end)

--- Parts may stand in the table itself.
function excitation.sum(given)
  if type(given) ~= "table" or getmetatable(given) ~= nil or given.parts ~= nil or given[1] == nil then return sum(given) end
  local named = { parts = { table.unpack(given) } }
  for key, value in pairs(given) do
    if math.type(key) ~= "integer" then named[key] = value end
  end
  return sum(named)
end

return { public = { excitation = schema.strict_table("lunid.excitation", excitation) }, between_of = between_of }

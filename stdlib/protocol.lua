-- The thesis' data protocol (section 2.1): what a test of one of its systems would have measured.
local core = require "lunid.core"
local excitation = require("lunid.excitation").public.excitation
local schema = require "lunid.schema"
local simulation = require("lunid.simulation").public
local symbols = require "lunid.symbols"
local types = schema.types

local model_type = types.is("model", "lunid.systems or lunid.model")
local dt_field = { "dt", types.number { above = 0 }, default = 0.00125, unit = "s", help = "sample time" }
local duration_field = { "duration", types.number { above = 0 }, default = 5, unit = "s",
  help = "from t = 0, before the trimming" }

local fine_substeps = 16

--- The true motion: the fixed path in fine steps, and BDF at a tight tolerance where these are unstable.
local function true_run(where, model, force, from)
  local run = simulation.simulate { model = model, excitation = force, from = from, solver = "fixed",
    substeps = fine_substeps }
  if not run.summary.completed then
    local implicit = simulation.simulate { model = model, excitation = force, from = from, solver = "bdf", rtol = 1e-11 }
    if not implicit.summary.completed then
      schema.fail(where, ("the system's run stopped at t = %.4g s: %s"):format(run.summary.stopped_at, run.summary.cause))
    end
    run = implicit
  end
  return run
end

--- Channels that the protocol measures: "F", "y", "v", or "F1", "F2", "y1", "v1" ... of several coordinates.
local function measured_channels(model)
  local forces, motion, n = {}, {}, model.degrees
  for i, input in ipairs(model.inputs) do forces[i] = input end
  for i = 1, n do
    local number = n > 1 and i or ""
    motion[2 * i - 1], motion[2 * i] = "y" .. number, "v" .. number
  end
  return forces, motion
end

local function measured(given, frequency, number)
  local time = { dt = given.dt, duration = given.duration }
  local function with_time(fields)
    for key, value in pairs(time) do fields[key] = value end
    return fields
  end
  local parts = { excitation.harmonic(with_time { amplitude = given.amplitude, frequency = frequency }) }
  if given.force_noise > 0 then
    parts[2] = excitation.white_noise(with_time { distribution = "uniform",
      rms = given.force_noise * math.abs(given.amplitude) / math.sqrt(3), seed = given.seed + number - 1 })
  end
  local force = excitation.sum { parts = parts, interpolation = "band_limited" }
  local run = true_run("thesis_record", given.system, force, given.from)
  local channels, motion = measured_channels(given.system)
  local noise = { seed = given.seed + number - 1 }
  for _, channel in ipairs(motion) do
    noise[channel] = given.noise
    channels[#channels + 1] = channel
  end
  local record = run:record():with_noise(noise)
  local name = ("thesis, %g N at %g Hz"):format(given.amplitude, frequency)
  return core.measured_motion(record, channels, name):window(given.trim, given.duration)
end

local thesis_record = schema.define({
  name = "thesis_record",
  help = "A system's test by the thesis' data protocol, one record for each frequency. F = amplitude*cos(2*pi*frequency*t) "
    .. "with noise that the system feels, noisy y and v, the acceleration derived from v, the beginning cut off.",
  fields = {
    { "system", model_type, required = true, help = "the truth" },
    { "frequency", types.either(types.number { above = 0 }, types.list(types.number { above = 0 }, 1)),
      required = true, unit = "Hz", help = "20 and 30 in the thesis; a list gives a list of records" },
    { "amplitude", types.number(), default = 2000, unit = "N", help = "of the force" },
    { "force_noise", types.number { min = 0 }, default = 0.05,
      help = "the force gets amplitude times this times U(-1, 1), straight into the system and the record" },
    { "noise", types.number { min = 0 }, default = 0.05, help = "Gaussian noise of y and of v, over their own std" },
    { "trim", types.number { min = 0 }, default = 2, unit = "s", help = "cut off at the beginning" },
    dt_field, duration_field,
    { "from", types.list(types.number(), 2), default = { 0, 0 }, help = "first state { y, v } or { y1, v1, y2, v2 ... }" },
    { "seed", types.integer { min = 0 }, help = "of the noise, one more for each frequency; else that of the run (--seed)" },
  },
  returns = "record",
  example = [[local train = lunid.thesis_record { system = lunid.systems.duffing {}, frequency = 20, seed = 1 }]],
}, function(given)
  if given.trim >= given.duration then
    schema.fail("thesis_record: trim", ("expected < duration, which is %g s, got %g"):format(given.duration, given.trim))
  end
  given.seed = given.seed or core.run_seed()
  if type(given.frequency) == "number" then return measured(given, given.frequency, 1) end
  local records = {}
  for i, frequency in ipairs(given.frequency) do records[i] = measured(given, frequency, i) end
  return records
end)

--- The motion of a record's first row.
local function first_state(model, from)
  if getmetatable(from) ~= "lunid.record" then return from end
  local _, motion = measured_channels(model)
  for i, channel in ipairs(motion) do motion[i] = from:column(channel)[1] end
  return motion
end

local thesis_validation = schema.define({
  name = "thesis_validation",
  help = "The thesis' validation record, without noise. No force up to 2.2 s, then amplitude*(sin(w*t) + sin(2*w*t) + "
    .. "sin(3*w*t)).",
  fields = {
    { "system", model_type, required = true, help = "the truth" },
    { "from", types.either(types.is("record", "lunid.thesis_record"), types.list(types.number(), 2)), required = true,
      help = "first state { y, v ... }, or the trimmed record whose first row it is" },
    { "amplitude", types.number(), default = 75, unit = "N", help = "of each of the three sines" },
    { "frequency", types.number { above = 0 }, default = 30, unit = "Hz", help = "w is 2*pi times this" },
    { "quiet", types.number { min = 0 }, default = 2.2, unit = "s", help = "how long there is no force" },
    dt_field, duration_field,
  },
  returns = "record",
  example = [[local test = lunid.thesis_validation { system = lunid.systems.duffing {}, from = train }]],
}, function(given)
  local t, w, sin = symbols.time, 2 * math.pi * given.frequency, symbols.sin
  local force = excitation.formula { dt = given.dt, duration = given.duration, force = symbols.where(symbols.less_equal(t,
    given.quiet), 0, given.amplitude * (sin(w*t) + sin(2*w*t) + sin(3*w*t))) }
  local run = true_run("thesis_validation", given.system, force, first_state(given.system, given.from))
  return run:record()
end)

return { public = { thesis_record = thesis_record, thesis_validation = thesis_validation } }

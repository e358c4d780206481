-- Figures over frequency: spectra, spectrograms, coherence, transfer functions, frequency responses.
local core = require "lunid.core"
local figures = require "lunid.figures"
local sources = require "lunid.figures.sources"
local schema = require "lunid.schema"
local types = schema.types

local record = types.is("record", "lunid.read")
local length = { "length", types.integer { min = 16 }, unit = "rows", help = "of a segment; else as the record's method says" }

local function as_list(value) return getmetatable(value) and { value } or value end

local function squared(unit) return unit == "" and "1/Hz" or figures.grouped(unit) .. "^2/Hz" end

local function unit_of(each, channel) return sources.unit_in(each, channel) or "" end

-- ---- spectra ----

local function spectrum_of(each, given)
  if getmetatable(each) == "lunid.spectrum" then return each, "" end
  return each:spectrum { channel = given.channel, length = given.length }, unit_of(each, given.channel)
end

figures.define({
  name = "spectrum",
  help = "Power spectral densities by Welch's method; a lone one with its 95 % limits.",
  positional = { "of" },
  fields = {
    { "of", types.either(record, types.is("spectrum", "record:spectrum"), types.list(types.either(record,
      types.is("spectrum", "record:spectrum")), 1)), required = true, help = "records or spectra: one or a list" },
    { "channel", types.string, default = "y", help = "of the records" },
    { "labels", types.list(types.string), default = {}, help = "of each; else the records' names" },
    { "log_frequency", types.boolean, default = false, help = "logarithmic axis of the frequency" },
    length,
  },
  example = [[lunid.figure.spectrum { { train, test }, channel = "F" }:save "spectra.png"]],
}, function(given)
  local list, series, ribbons, unit = as_list(given.of), {}, {}, ""
  for i, each in ipairs(list) do
    local found, its_unit = spectrum_of(each, given)
    unit = its_unit ~= "" and its_unit or unit
    local role, style = figures.look_of(i)
    local name = given.labels[i] or getmetatable(each) == "lunid.record" and each.name or ""
    series[i] = { x = found.frequency, y = found.density, role = role, style = style, label = #list > 1 and name or "" }
    if #list == 1 then
      ribbons[1] = { x = found.frequency, low = found.low, high = found.high, label = "95 % limits", role = role }
    end
  end
  return { panels = { { x = { name = "frequency", unit = "Hz", scale = given.log_frequency and "log" or nil },
    y = { name = "spectral density", unit = squared(unit), scale = "log" }, series = series, ribbons = ribbons } } }
end)

figures.define({
  name = "spectrogram",
  help = "Power spectral density over frequency and time.",
  positional = { "of" },
  fields = {
    { "of", types.either(record, types.is("spectrogram", "record:spectrogram")), required = true, help = "a record or its spectrogram" },
    { "channel", types.string, default = "y", help = "of the record" },
    length,
    { "to", types.number { above = 0 }, unit = "Hz", help = "highest frequency shown; else all" },
    { "decades", types.number { above = 0, max = 30 }, default = 6, help = "of density below the largest that are shown" },
    { "ridge", types.boolean, default = false, help = "mark the frequency of the largest density" },
  },
  example = [[lunid.figure.spectrogram { record, channel = "y", to = 60 }:save "spectrogram.png"]],
}, function(given)
  local measured = getmetatable(given.of) == "lunid.record"
  local s = measured and given.of:spectrogram { channel = given.channel, length = given.length } or given.of
  local frequencies, rows, most = {}, {}, 0
  for _, f in ipairs(s.frequency:list()) do
    if not given.to or f <= given.to then frequencies[#frequencies + 1] = f end
  end
  for i = 1, #frequencies do rows[i] = {} end
  for segment = 1, #s.time do
    local density = s:at(segment):list()
    for i = 1, #frequencies do
      rows[i][segment] = density[i]
      most = math.max(most, density[i])
    end
  end
  if not (most > 0) then figures.fail("spectrogram", "the channel is 0 throughout: there is nothing to show") end
  local least = most * 10^-given.decades
  return { panels = { { x = { name = "time", unit = "s" }, y = { name = "frequency", unit = "Hz" },
    map = { x = s.time, y = core.column(frequencies), z = rows, diverging = false, colour = { name = "spectral density",
      unit = squared(measured and unit_of(given.of, given.channel) or ""), scale = "log", min = least, max = most } },
    series = given.ridge and { { x = s.time, y = s.ridge, role = "baseline", style = "dashed", label = "ridge" } } or nil } } }
end)

-- ---- from input to output ----

local transfer_fields = {
  { "of", types.either(record, types.is("transfer", "record:transfer")), required = true, help = "a record or its transfer function" },
  { "input", types.string, default = "F", help = "channel that drives" },
  { "output", types.string, default = "y", help = "channel that answers" },
  length,
  { "to", types.number { above = 0 }, unit = "Hz", help = "highest frequency shown; else all" },
}

local function transfer_of(given)
  if getmetatable(given.of) == "lunid.transfer" then return given.of, "" end
  local input, output = unit_of(given.of, given.input), unit_of(given.of, given.output)
  return given.of:transfer { input = given.input, output = given.output, length = given.length }, ("%s/%s"):format(output, figures.grouped(input))
end

local function coherence_panel(t, frequency)
  return { x = frequency, y = { name = "coherence", unit = "", min = 0, max = 1.02 },
    lines = { { value = t.chance, label = "may be chance", role = "noise" } },
    series = { { x = t.frequency, y = t.coherence, role = "first" } } }
end

local function copy(fields)
  local list = {}
  for i, field in ipairs(fields) do list[i] = field end
  return list
end

figures.define({
  name = "coherence",
  help = "The part of an output that follows an input linearly, over frequency.",
  positional = { "of" },
  fields = copy(transfer_fields),
  example = [[lunid.figure.coherence(record):save "coherence.png"]],
}, function(given)
  local t = transfer_of(given)
  return { panels = { coherence_panel(t, { name = "frequency", unit = "Hz", max = given.to }) } }
end)

figures.define({
  name = "transfer",
  help = "A measured frequency response: magnitude with its 95 % limits, phase and coherence.",
  positional = { "of" },
  fields = copy(transfer_fields),
  example = [[lunid.figure.transfer { record, input = "F", output = "y", to = 60 }:save "transfer.png"]],
}, function(given)
  local t, unit = transfer_of(given)
  local frequency = { name = "frequency", unit = "Hz", max = given.to }
  local low, high = t.phase:list(), t.phase:list()
  for i, std in ipairs(t.phase_std:list()) do low[i], high[i] = low[i] - 2*std, high[i] + 2*std end
  return { share_x = true, panels = {
    { x = frequency, y = { name = "magnitude", unit = unit, scale = "log" },
      series = { { x = t.frequency, y = t.magnitude, role = "first" } },
      ribbons = { { x = t.frequency, low = t.magnitude_low, high = t.magnitude_high, label = "95 % limits", role = "first" } } },
    { x = frequency, y = { name = "phase", unit = "rad", min = -3.3, max = 3.3 },
      series = { { x = t.frequency, y = t.phase, role = "first" } },
      ribbons = { { x = t.frequency, low = core.column(low), high = core.column(high), role = "first" } } },
    coherence_panel(t, frequency) } }
end)

figures.define({
  name = "response",
  help = "A frequency response: stable branches solid, unstable ones dashed, folds and bifurcations marked.",
  positional = { "response" },
  fields = {
    { "response", types.is("response", "lunid.frequency_response"), required = true, help = "what to draw" },
    { "quantity", types.string, default = "amplitude", help = "a column of the response, such as \"amplitude_3\" or \"phase_1\"" },
    { "state", types.string, help = "whose motion; else the first displacement" },
    { "backbone", types.is("backbone", "lunid.backbone"), help = "drawn with it" },
    { "series", types.list(figures.series), default = {}, help = "curves to compare with" },
    { "log", types.boolean, default = false, help = "logarithmic axis of the quantity" },
  },
  example = [[lunid.figure.response(response):save "frf.png"]],
}, function(given) return require("lunid.response_figure").of(given) end)

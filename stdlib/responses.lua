-- Frequency responses, backbone curves and Poincare sections.
local table_of = require "lunid.columns"
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"
local simulation = require "lunid.simulation"
local types = schema.types

local responses = {}

local methods = { "auto", "harmonic_balance", "shooting", "stepped_up", "stepped_down", "swept_up", "swept_down" }
local words = { peak = "peak", fold = "fold", branch_point = "branch point", period_doubling = "period doubling",
  neimark_sacker = "Neimark-Sacker" }

local function check_path(path)
  if type(path) ~= "string" then schema.fail("save", "expected a path, got " .. core.describe(path)) end
end

-- ---- frequency responses ----

local methods_of = {}

local function curve_of(response, index)
  index = index or 1
  if math.type(index) ~= "integer" or not response.curves[index] then
    schema.fail("column", ("curve: expected 1 to %d, got %s"):format(#response.curves, tostring(index)))
  end
  return response.curves[index]
end

--- A column of the response: of the first curve unless `curve` says otherwise, of the first displacement unless `state`.
function methods_of.column(response, name, curve, state) return curve_of(response, curve):column(name, state) end

--- Writes all curves as CSV: amplitude of the excitation, frequency, and what each displacement does.
function methods_of.save(response, path)
  check_path(path)
  local texts = {}
  for i, curve in ipairs(response.curves) do
    local frequency = curve:column "frequency"
    local force = frequency:list()
    for row = 1, #force do force[row] = response.amplitudes[i] end
    local columns = { { "excitation", core.column(force) }, { "frequency", frequency } }
    for _, name in ipairs { "branch", "stable", "multiplier", "harmonics" } do
      columns[#columns + 1] = { name, curve:column(name) }
    end
    for _, state in ipairs(curve.states) do
      if state:match "^y%d*$" then
        for _, name in ipairs { "amplitude", "mean", "amplitude_1", "phase_1", "amplitude_2", "amplitude_3", "amplitude_5" } do
          columns[#columns + 1] = { state .. "_" .. name, curve:column(name, state) }
        end
      end
    end
    local text = table_of.csv(columns)
    texts[i] = i == 1 and text or text:gsub("^[^\n]*\n", "")
  end
  return output.write(path, table.concat(texts))
end

--- Ranges of frequency between stable points, as the branch runs.
local function unstable_ranges(curve)
  local frequency, stable, branch = curve:column "frequency", curve:column "stable", curve:column "branch"
  local special, ranges, low, high = {}, {}, nil, nil
  for _, point in ipairs(curve.special) do special[point.row] = true end
  local function close()
    if low then ranges[#ranges + 1] = { low, high } end
    low, high = nil, nil
  end
  for row = 1, #frequency do
    if row > 1 and branch[row] ~= branch[row - 1] then close() end
    if stable[row] == 0 and not low then
      low, high = frequency[row], frequency[row]
      if row > 1 and special[row - 1] and branch[row] == branch[row - 1] then
        low, high = math.min(low, frequency[row - 1]), math.max(high, frequency[row - 1])
      end
    elseif low and (stable[row] == 0 or special[row]) then
      low, high = math.min(low, frequency[row]), math.max(high, frequency[row])
    elseif low then
      close()
    end
  end
  close()
  return ranges
end

local function excitation_words(response, i)
  return ("%.6g %s"):format(response.amplitudes[i], response.unit)
end

local function curve_text(response, i)
  local curve = response.curves[i]
  local lines = { ("%s: %d points by %s"):format(excitation_words(response, i), curve.rows, curve.method) }
  for _, point in ipairs(curve.special) do
    lines[#lines + 1] = ("  %-15s %-11s %.4g m"):format(words[point.kind], ("%.5g Hz"):format(point.frequency),
      point.amplitude)
  end
  if not curve.method:find "^s[tw]e" then
    for _, range in ipairs(unstable_ranges(curve)) do
      lines[#lines + 1] = ("  %-15s %.5g to %.5g Hz"):format("unstable", range[1], range[2])
    end
  end
  for _, text in ipairs(curve.stopped) do lines[#lines + 1] = "  " .. text end
  if curve.truncated then lines[#lines + 1] = "  the harmonics did not suffice everywhere for the accuracy" end
  return table.concat(lines, "\n")
end

local function to_string(response)
  local parts = { ("frequency response, %.6g to %.6g Hz"):format(response.from, response.to) }
  for i in ipairs(response.curves) do parts[#parts + 1] = curve_text(response, i) end
  return table.concat(parts, "\n")
end

local frequency_response = schema.define({
  name = "frequency_response",
  help = "The periodic answers of a model to a harmonic excitation over a range of frequencies: stable and unstable "
    .. "branches by continuation, or what a stepped or swept sine shows.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "what is driven" },
    { "amplitude", types.either(types.number { above = 0 }, types.list(types.number { above = 0 }, 1)), required = true,
      unit = "N", help = "of the force amplitude*cos(2*pi*f*t), or of the base's displacement in m; a list gives a curve "
        .. "for each" },
    { "input", types.string, help = "the force that acts, such as 'F2', or 'base'; else the model's first input" },
    { "from", types.number { above = 0 }, required = true, unit = "Hz", help = "lowest frequency" },
    { "to", types.number { above = 0 }, required = true, unit = "Hz", help = "highest frequency" },
    { "method", types.choice(methods), default = "auto",
      help = "'auto': harmonic balance, and shooting where the model has switches or bounds" },
    { "harmonics", types.integer { min = 1, max = 500 }, help = "of harmonic balance; else as many as are needed, up to 63" },
    { "accuracy", types.number { above = 0, below = 1 }, default = 1e-6,
      help = "of harmonics left out, and of steadiness, over the amplitude" },
    { "max_step", types.number { above = 0, max = 1 }, default = 0.1,
      help = "largest relative change of motion and frequency from point to point" },
    { "max_points", types.integer { min = 2, max = 1000000 }, default = 5000, help = "of a branch" },
    { "stability", types.boolean, default = true, help = "find the Floquet multipliers of each point" },
    { "points", types.integer { min = 2, max = 100000 }, default = 200, help = "frequencies of a stepped sine" },
    { "max_periods", types.integer { min = 1, max = 10000000 }, default = 2000,
      help = "in which a stepped sine must become steady" },
    { "rate", types.number { above = 0 }, unit = "Hz/s", help = "of a swept sine" },
  },
  returns = "response",
  example = [[local response = lunid.frequency_response { model = model, amplitude = 300, from = 0.5, to = 150 }]],
}, function(given)
  schema.expect_values("frequency_response", given.model)
  local amplitudes = type(given.amplitude) == "table" and given.amplitude or { given.amplitude }
  local curves = {}
  for i, amplitude in ipairs(amplitudes) do
    given.amplitude = amplitude
    curves[i] = core.frequency_response(given.model, given)
  end
  return schema.object("response", { curves = curves, amplitudes = amplitudes, from = given.from, to = given.to,
    unit = given.input == "base" and "m" or "N" }, methods_of, to_string)
end)

-- ---- backbone curves ----

local backbone = schema.define({
  name = "backbone",
  help = "The free motions that grow out of a mode: frequency and damping ratio over amplitude.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "its damping is made up for, its forces are 0" },
    { "from", types.number { above = 0 }, required = true, unit = "m",
      help = "smallest amplitude of the displacement that moves most" },
    { "to", types.number { above = 0 }, required = true, unit = "m", help = "largest amplitude" },
    { "mode", types.integer { min = 1 }, default = 1, help = "counted from the lowest frequency" },
    { "harmonics", types.integer { min = 1, max = 500 }, help = "else as many as are needed, up to 63" },
    { "accuracy", types.number { above = 0, below = 1 }, default = 1e-6, help = "of harmonics left out, over the amplitude" },
    { "max_step", types.number { above = 0, max = 1 }, default = 0.1,
      help = "largest relative change of motion and frequency from point to point" },
    { "max_points", types.integer { min = 2, max = 1000000 }, default = 5000, help = "of the curve" },
  },
  returns = "backbone",
  example = [[local curve = lunid.backbone { model = model, from = 1e-4, to = 0.2 }]],
}, function(given)
  schema.expect_values("backbone", given.model)
  return core.backbone(given.model, given)
end)

core.add_method("lunid.backbone", "save", function(curve, path)
  check_path(path)
  local columns = {}
  for _, name in ipairs { "frequency", "damping", "amplitude", "mean", "amplitude_1", "amplitude_2", "amplitude_3" } do
    columns[#columns + 1] = { name, curve:column(name) }
  end
  return output.write(path, table_of.csv(columns))
end)

-- ---- Poincare sections ----

local section_methods = {}

--- A column of the section: t, y, v or an internal state, one row per period.
function section_methods.column(section, name) return core.column(section.pick(section.run:column(name))) end

function section_methods.save(section, path)
  check_path(path)
  local columns = {}
  for _, name in ipairs { "t", "y", "v" } do columns[#columns + 1] = { name, section:column(name) } end
  return output.write(path, table_of.csv(columns))
end

--- Rows of a run at one phase of each period, the first `transient` periods left out.
local function picker(given)
  local first = given.transient * given.samples + math.floor(given.phase * given.samples + 0.5)
  return function(column)
    local list, values = {}, column:list()
    for i = 1, given.points do list[i] = values[first + (i - 1) * given.samples + 1] end
    return list
  end
end

local poincare = schema.define({
  name = "poincare",
  help = "The states of a free run once per period of its excitation.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "what moves" },
    { "excitation", types.either(types.expression, types.table), required = true, unit = "N",
      help = "an expression of lunid.time, or a table of them by channel, as of lunid.simulate" },
    { "period", types.number { above = 0 }, required = true, unit = "s", help = "of the excitation" },
    { "from", types.list(types.number(), 2), default = { 0, 0 }, help = "first state { y, v, ... }" },
    { "points", types.integer { min = 1, max = 1000000 }, default = 500, help = "periods shown" },
    { "transient", types.integer { min = 0, max = 1000000 }, default = 100, help = "periods before them that are left out" },
    { "phase", types.number { min = 0, below = 1 }, default = 0, help = "part of the period at which to look" },
    { "samples", types.integer { min = 8, max = 100000 }, default = 64, help = "of a period; each is two steps" },
  },
  returns = "section",
  example = [[local section = lunid.poincare { model = model, excitation = 0.3*lunid.cos(1.2*t), period = 2*math.pi/1.2 }]],
}, function(given)
  local periods = given.transient + given.points
  local run = simulation.public.simulate { model = given.model, excitation = given.excitation, from = given.from,
    dt = given.period / given.samples, duration = given.period * periods, solver = "fixed", substeps = 2 }
  if not run.summary.completed then
    schema.fail("poincare", ("the run stopped at t = %.4g s: %s"):format(run.summary.stopped_at, run.summary.cause))
  end
  return schema.object("section", { run = run, pick = picker(given), rows = given.points }, section_methods,
    function(section) return ("section of %d periods"):format(section.rows) end)
end)

responses.public = { frequency_response = frequency_response, backbone = backbone, poincare = poincare }
return responses

-- History models: the next sample of the output from samples before it.
local core = require "lunid.core"
local output = require "lunid.output"
local record_list = require "lunid.record_list"
local schema = require "lunid.schema"
local types = schema.types

local histories = {}

local record = types.is("record", "lunid.read")

local fields = {
  record = { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
  output = { "output", types.string, default = "y", help = "channel that is predicted" },
  input = { "input", types.string, default = "F", help = "channel that drives it" },
  outputs = { "outputs", types.integer { min = 0, max = 200 }, default = 2, help = "past samples of the output: y_1, y_2" },
  inputs = { "inputs", types.integer { min = 0, max = 200 }, default = 2, help = "samples of the input, beginning with delay" },
  delay = { "delay", types.integer { min = 0, max = 1000 }, default = 1,
    help = "first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)" },
  noise = { "noise", types.integer { min = 1, max = 50 }, default = 2, help = "past prediction errors: e_1, e_2" },
  degree = { "degree", types.integer { min = 1, max = 5 }, default = 3, help = "of the polynomial in all lagged samples" },
  features = { "features", types.list(types.expression, 1),
    help = [[terms in place of the polynomial: expressions of lunid.channel "y_1", "F_1", "e_1" ...]] },
  constant = { "constant", types.boolean, default = false, help = "a constant among the terms" },
  max_passes = { "max_passes", types.integer { min = 1 }, default = 200, help = "of extended least squares" },
  window = { "window", types.is("window", "lunid.window"), help = "part of the records" },
}

local function constructor(name, help, names, example)
  local chosen = {}
  for i, field in ipairs(names) do
    chosen[i] = {}
    for key, value in pairs(fields[field]) do chosen[i][key] = value end
  end
  histories[name] = schema.define({
    name = name,
    help = help,
    fields = chosen,
    returns = "history_model",
    example = example,
  }, function(given) return core.fit_history(record_list(given.record, given.window), given) end)
end

constructor("arx", "The next output as a linear sum of past outputs and inputs, by least squares. Noise that is measured "
  .. "with the output biases it: see armax, and model:free_run.",
  { "record", "output", "input", "outputs", "inputs", "delay", "constant", "window" },
  [[local model = lunid.arx { record = train, outputs = 2, inputs = 2 }]])
constructor("armax", "An ARX model with past prediction errors, which describe coloured noise, by extended least squares.",
  { "record", "output", "input", "outputs", "inputs", "delay", "noise", "constant", "max_passes", "window" },
  [[local model = lunid.armax { record = train, outputs = 2, inputs = 2, noise = 2 }]])
constructor("narx", "The next output as a polynomial, or as given terms, of past outputs and inputs.",
  { "record", "output", "input", "outputs", "inputs", "delay", "degree", "features", "constant", "window" },
  [[local model = lunid.narx { record = train, outputs = 2, inputs = 1, degree = 3 }]])
constructor("narmax", "A NARX model with past prediction errors, by extended least squares.",
  { "record", "output", "input", "outputs", "inputs", "delay", "noise", "degree", "features", "constant", "max_passes",
    "window" },
  [[local model = lunid.narmax { record = train, degree = 3, noise = 2 }]])

histories.history_orders = schema.define({
  name = "history_orders",
  help = "Compares ARX models of all orders on the same rows, the one with the least BIC first.",
  fields = { fields.record, fields.output, fields.input,
    { "outputs", types.integer { min = 1, max = 50 }, default = 6, help = "past outputs, at most" },
    { "inputs", types.integer { min = 1, max = 50 }, default = 6, help = "inputs, at most" },
    fields.delay, fields.window },
  returns = "orders",
  example = [[print(lunid.history_orders { record = train })]],
}, function(given)
  local list = core.history_orders(record_list(given.record, given.window), given)
  return schema.object("orders", list, nil, function(orders)
    local lines = { "outputs  inputs  residual std         AIC         BIC" }
    for _, row in ipairs(orders) do
      lines[#lines + 1] = ("%7d %7d %13.5g %11.1f %11.1f"):format(row.outputs, row.inputs, row.residual_std, row.aic, row.bic)
    end
    return table.concat(lines, "\n")
  end)
end)

histories.history_model = schema.define({
  name = "history_model",
  help = "A history model by its terms, as model:save writes it.",
  fields = {
    fields.output, fields.input,
    { "dt", types.number { above = 0 }, required = true, unit = "s", help = "time between samples" },
    { "between", types.choice { "hold", "linear", "cubic", "band_limited" }, default = "linear",
      help = "what the input does between samples" },
    { "residual_std", types.number { min = 0 }, help = "of one-step predictions" },
    { "terms", types.list(types.table, 1), required = true, help = [[entries { "y_1", 1.97, std = 1e-3 }]] },
  },
  returns = "history_model",
  example = [[local model = lunid.history_model { dt = 1e-3, terms = { { "y_1", 0.9 }, { "F_1", 1e-6 } } }]],
}, function(given)
  for i, term in ipairs(given.terms) do
    local text, value = term[1], term[2]
    if type(text) ~= "string" or type(value) ~= "number" then
      schema.fail("history_model: terms", ("entry %d: expected { \"y_1\", a number }"):format(i))
    end
    for name in text:gmatch "[%a_][%w_]*" do
      if name:match "_%d+$" then core.channel(name) end
    end
    given.terms[i] = { feature = core.parse(text, "history_model: terms"), value = value, std = term.std }
  end
  return core.stored_history(given)
end)

--- The record that a method works on.
local function record_of(method, value)
  if getmetatable(value) ~= "lunid.record" then
    schema.fail(method, "expected a record from lunid.read, got " .. core.describe(value))
  end
  return value
end

core.add_method("lunid.history_model", "predict", function(model, measured, steps)
  record_of("predict", measured)
  steps = steps or 1
  if math.type(steps) ~= "integer" or steps < 1 then
    schema.fail("predict", "steps: expected a whole number >= 1, got " .. core.describe(steps))
  end
  return model:predict_rows(measured, steps)
end)

core.add_method("lunid.history_model", "free_run", function(model, measured)
  return model:predict_rows(record_of("free_run", measured), 0)
end)

core.add_method("lunid.history_model", "save", function(model, path)
  if type(path) ~= "string" then schema.fail("save", "expected a path, got " .. core.describe(path)) end
  local lines = { 'local lunid = require "lunid"', "", "return lunid.history_model {",
    ("  output = %q, input = %q, dt = %s, between = %q, residual_std = %s,"):format(model.output, model.input,
      core.number_text(model.dt), model.between, core.number_text(model.residual_std)), "  terms = {" }
  for _, term in ipairs(model.terms) do
    lines[#lines + 1] = ("    { %q, %s%s },"):format(term.name, core.number_text(term.value),
      term.std and ", std = " .. core.number_text(term.std) or "")
  end
  lines[#lines + 1] = "  },\n}\n"
  return output.write(path, table.concat(lines, "\n"))
end)

return histories

-- Models: m*a + restoring(y, v, z, t) = F.
local core = require "lunid.core"
local output = require "lunid.output"
local records = require "lunid.records"
local schema = require "lunid.schema"
local strict = require "lunid.strict"
local types = schema.types

local models = {}

models.model = schema.define({
  name = "model",
  help = "The equation of motion m*a + restoring = F. With imposed motion, y and v drive it and F is its output.",
  fields = {
    { "mass", types.expression, required = true, unit = "kg", help = "a number, a parameter, or an expression" },
    { "restoring", types.expression, required = true, unit = "N", help = "restoring force; 0 for none" },
    { "states", types.list(types.expression), default = {},
      help = "internal states that the restoring force does not name" },
    { "motion", types.choice { "free", "imposed" }, default = "free",
      help = "'imposed': the measured motion drives the model; the mass may then be 0" },
  },
  returns = "model",
  example = [[local model = lunid.model { mass = 49, restoring = k*y + c*v }]],
}, function(given)
  given.imposed_motion = given.motion == "imposed"
  return core.model(given)
end)

local function field(name, value)
  if value == nil or value == "" or value == false then return "" end
  if type(value) == "number" then value = core.number_text(value) end
  if type(value) == "string" and name == "unit" then value = ("%q"):format(value) end
  return (", %s = %s"):format(name, tostring(value))
end

local function parameter_text(row)
  local value = row.value and ", " .. core.number_text(row.value) or ""
  return ("local %s = lunid.parameter { %q%s%s%s%s%s%s }"):format(row.name, row.name, value, field("min", row.min),
    field("max", row.max), field("unit", row.unit), field("fixed", row.fixed), field("std", row.std))
end

local function state_text(state)
  local function bound(name) return state[name] and (", %s = %s"):format(name, state[name]:text "lua") or "" end
  return ("local %s = lunid.state { %q, rate = function(%s) return %s end, initial = %s%s%s }"):format(state.name,
    state.name, state.name, state.rate:text "lua", core.number_text(state.initial), bound "min", bound "max")
end

--- Lua that loads again to the same model.
function models.text(model)
  local lines = { "-- " .. model:equation():gsub("\n", "\n-- "), 'local lunid = require "lunid"' }
  lines[#lines + 1] = "local y, v, a, t, F = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time, "
    .. "lunid.force"
  for _, row in ipairs(model.parameters) do lines[#lines + 1] = parameter_text(row) end
  local names = {}
  for i, state in ipairs(model.states) do
    names[i] = state.name
    lines[#lines + 1] = state_text(state)
  end
  lines[#lines + 1] = ("return lunid.model {\n  mass = %s,\n  restoring = %s,%s%s\n}"):format(
    model.mass:text "lua", model.restoring:text "lua",
    #names > 0 and ("\n  states = { %s },"):format(table.concat(names, ", ")) or "",
    model.imposed_motion and '\n  motion = "imposed",' or "")
  return table.concat(lines, "\n") .. "\n"
end

core.add_method("lunid.model", "save", function(model, path)
  if type(path) ~= "string" then schema.fail("save", "expected a path, got " .. core.describe(path)) end
  return output.write(path, models.text(model))
end)

models.load = schema.define({
  name = "load",
  help = "Loads a model that model:save wrote, or that is written by hand in the same form.",
  positional = { "path" },
  fields = { { "path", types.string, required = true, help = "a Lua file that returns a lunid.model" } },
  returns = "model",
  example = [[local model = lunid.load "pile.lua"]],
}, function(given)
  local path = records.find(given.path)
  local chunk = strict.load_file(path)
  core.note_input(path)
  local model = chunk()
  if getmetatable(model) ~= "lunid.model" then
    schema.fail("load", ("'%s' returned %s, not a lunid.model"):format(path, core.describe(model)))
  end
  return model
end)

models.polynomials = schema.define({
  name = "polynomials",
  help = "All products of powers of the variables up to an order, without the constant unless asked for.",
  style = "arguments",
  positional = { "variables", "order", "constant" },
  fields = {
    { "variables", types.list(types.expression, 1), required = true, help = "such as { y, v }" },
    { "order", types.integer { min = 1, max = 20 }, required = true, help = "largest sum of the powers" },
    { "constant", types.boolean, default = false, help = "put the constant 1 first" },
  },
  returns = "features",
  example = [[features = { lunid.polynomials({ y, v }, 5) }]],
}, function(given)
  local features = {}
  local function add(variable, left, term)
    if variable > #given.variables then
      if left == 0 then features[#features + 1] = term end
      return
    end
    for power = left, 0, -1 do
      local factor = power > 0 and given.variables[variable] ^ power or nil
      add(variable + 1, left - power, factor and (term and term * factor or factor) or term)
    end
  end
  if given.constant then features[1] = 1 end
  for order = 1, given.order do add(1, order, nil) end
  return schema.object("features", features, nil, function(self) return ("%d features"):format(#self) end)
end)

return models

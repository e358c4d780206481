-- An entry of the catalogue as an element of a model: `lunid.effects.bouc_wen { k = 1e4, zy = 1e-3, rho = 0.7, n = 1.5 }`.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local element = {}

--- A number within an entry's bounds, or an expression in its place.
local function value_type(row)
  local number = types.number { min = row.min, max = row.max }
  local words = number.words .. " or an expression"
  return { words = words, check = function(value)
    if core.is_expression(value) then return true, value end
    local good, kept = number.check(value)
    return good, not good and type(value) ~= "number" and words or kept
  end }
end

--- What an entry takes to become an element: its parameters, and the fields of every element.
function element.definition(entry)
  local fields, positional = {}, {}
  for i, row in ipairs(entry.parameters) do
    positional[i] = row[1]
    fields[i] = { name = row[1], type = value_type(row), unit = row.unit }
  end
  fields[#fields + 1] = { name = "displacement", type = types.expression }
  fields[#fields + 1] = { name = "prefix", type = types.string, default = entry.name }
  if #entry.variants > 1 then
    fields[#fields + 1] = { name = "variant", type = types.integer { min = 1, max = #entry.variants }, default = 1 }
  end
  return { name = "effects." .. entry.name, fields = fields, positional = positional }
end

--- The time derivative of an expression in displacements and velocities.
local function rate_of(where, f)
  local sum = 0
  for _, symbol in ipairs(core.is_expression(f) and f:symbols() or {}) do
    local letter, number = symbol.name:match "^([yv])(b?%d*)$"
    if symbol.kind == "channel" and letter then
      local slope = f:derivative(core.channel(symbol.name))
      sum = sum + slope * core.channel((letter == "y" and "v" or "a") .. number)
    elseif symbol.kind ~= "parameter" then
      schema.fail(where, ("displacement: expected an expression in displacements, such as y2 - y1, got '%s' in it")
        :format(symbol.name))
    end
  end
  return sum
end

local function check_conditions(where, entry, given)
  for _, each in ipairs(entry.conditions) do
    local at, numbers = {}, true
    for _, row in ipairs(entry.parameters) do at[row[1]] = type(given[row[1]]) == "number" and given[row[1]] or nil end
    local left, right = core.parse(each.left, where), core.parse(each.right, where)
    for _, side in ipairs { left, right } do
      for _, symbol in ipairs(side:symbols()) do numbers = numbers and at[symbol.name] ~= nil end
    end
    if numbers and left:at(at) < right:at(at) then schema.fail(where, ("expected %s"):format(each.text)) end
  end
end

--- The names that a variant of an entry holds, its states' rates and bounds among them, as a set.
function element.symbols_in(entry, variant)
  local held, parts = {}, { entry.variants[variant] }
  for _, state in ipairs(entry.states) do
    for _, part in ipairs { state.rate, state.min or 0, state.max or 0 } do parts[#parts + 1] = part end
  end
  for _, part in ipairs(parts) do
    for _, symbol in ipairs(core.is_expression(part) and part:symbols() or {}) do held[symbol.name] = true end
  end
  return held
end

--- A number that the variant does not hold would do nothing.
local function check_variant(where, entry, given)
  local number = given.variant or 1
  local held = element.symbols_in(entry, number)
  for i, row in ipairs(entry.rows) do
    local own = entry.parameters[i][1]
    if given[own] ~= nil and not held[row.name] then
      schema.fail(where, ("%s: variant %d, %s, has no %s"):format(own, number, entry.formulas[number], own))
    end
  end
end

--- What stands for each symbol of the entry in this element.
local function replacements(where, entry, given)
  local by = {}
  for i, row in ipairs(entry.rows) do
    local own = entry.parameters[i][1]
    local value = given[own]
    by[row.name] = core.is_expression(value) and value or core.parameter { name = given.prefix .. "_" .. own,
      value = value, min = row.min, max = row.max, unit = row.unit, fixed = row.fixed, place = core.place() }
  end
  for _, state in ipairs(entry.states) do by[state.name] = core.state_symbol(given.prefix .. "_" .. state.own) end
  if given.displacement then
    by.y = given.displacement
    by.v = rate_of(where, by.y)
    by.a = rate_of(where, by.v)
  end
  return by
end

--- The entry's force as an expression, which carries its parameters and states along; of a faulty channel the table that
--- the fields `measures` and `acts` of a model take, of a delay what its field `delay` takes.
function element.make(entry, ...)
  local definition = element.definition(entry)
  local given, where = schema.validate(definition, ...), definition.name
  schema.check_name(where, given.prefix)
  check_conditions(where, entry, given)
  check_variant(where, entry, given)
  local by, states = replacements(where, entry, given), {}
  for i, state in ipairs(entry.states) do
    states[i] = core.state { name = given.prefix .. "_" .. state.own, initial = state.initial, place = core.place(),
      rate = core.substitute(state.rate, by), min = state.min and core.substitute(state.min, by),
      max = state.max and core.substitute(state.max, by), anchored = state.anchored }
  end
  local variant = given.variant or 1
  local form, map = core.substitute(entry.variants[variant], by, states), entry.maps[variant]
  if map.field == "delay" then return { delay = form } end
  return map.channel and { [map.channel] = form } or form
end

return element

-- The catalogue: its entries by name, and each of them as an element that a model can hold.
local core = require "lunid.core"
local effect = require "lunid.effect"
local schema = require "lunid.schema"
local types = schema.types

local catalogue = {}

-- Every entry, in the order in which they are printed.
catalogue.names = {
  "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "quintic_stiffness", "clearance", "one_sided_stop",
  "bilinear_stiffness", "saturating_stiffness", "preload", "constant_force", "sinusoidal_stiffness",
  "odd_quadratic_stiffness", "impact_hunt_crossley",
  "viscous_damping", "quadratic_drag", "cubic_damping", "power_law_damping", "van_der_pol_damping",
  "asymmetric_damping", "coulomb_friction", "position_dependent_friction", "fractional_damping", "stribeck_friction",
  "elastic_slip", "iwan", "dahl_friction", "lugre_friction", "bouc_wen", "pinching_degrading_hysteresis",
  "backlash_play", "maxwell_relaxation", "friction_lift_off",
  "hyperbolic_soil", "masing_soil", "smith_shaft", "smith_toe", "rate_power_law", "shaft_softening",
  "vibro_liquefaction", "soil_plug", "radiation_damping", "degrading_resistance", "setup_recovery",
  "depth_resistance", "crane_lowering",
  "added_mass", "velocity_dependent_mass", "displacement_dependent_mass", "stiffness_drift", "damping_drift",
  "parametric_stiffness", "hidden_mode",
  "missing_harmonic", "base_motion",
}

-- Those that discovery tries where a study names none.
catalogue.searched = { "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "clearance", "one_sided_stop",
  "constant_force", "viscous_damping", "quadratic_drag", "coulomb_friction", "bouc_wen" }

local loaded = {}

--- The entry of that name, which must be one of catalogue.names.
function catalogue.entry(name)
  loaded[name] = loaded[name] or require("lunid.effects." .. name)(effect)
  return loaded[name]
end

--- The entries of these names (nil: those searched), in the catalogue's order. Raises on a name that there is not.
function catalogue.entries(names)
  local wanted, known, entries = {}, {}, {}
  for _, name in ipairs(catalogue.names) do known[name] = true end
  for _, name in ipairs(names or catalogue.searched) do
    if not known[name] then
      local near = core.nearest(name, catalogue.names)
      schema.fail("discover: catalogue", ("unknown effect '%s'%s"):format(name,
        near and (", did you mean '%s'?"):format(near) or " (see `lunid list effects`)"))
    end
    wanted[name] = true
  end
  for _, name in ipairs(catalogue.names) do
    if wanted[name] then entries[#entries + 1] = catalogue.entry(name) end
  end
  return entries
end

-- ---- elements of a model ----

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

local definitions = {}

--- What `lunid.effects.<name>` takes: the entry's parameters, and the fields of every element.
function catalogue.definition(name)
  if definitions[name] then return definitions[name] end
  local entry = catalogue.entry(name)
  local fields, positional = {}, {}
  for i, row in ipairs(entry.parameters) do
    positional[i] = row[1]
    fields[i] = { name = row[1], type = value_type(row), unit = row.unit }
  end
  fields[#fields + 1] = { name = "displacement", type = types.expression }
  fields[#fields + 1] = { name = "prefix", type = types.string, default = name }
  if #entry.variants > 1 then
    fields[#fields + 1] = { name = "variant", type = types.integer { min = 1, max = #entry.variants }, default = 1 }
  end
  definitions[name] = { name = "effects." .. name, fields = fields, positional = positional }
  return definitions[name]
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

--- `lunid.effects.<name> { ... }`: the entry's force as an expression, which carries its parameters and states along.
function catalogue.element(name, ...)
  local definition, entry = catalogue.definition(name), catalogue.entry(name)
  local given = schema.validate(definition, ...)
  local where = definition.name
  require("lunid.symbols").check_name(where .. ": prefix", given.prefix)
  check_conditions(where, entry, given)
  local by, states = replacements(where, entry, given), {}
  for i, state in ipairs(entry.states) do
    states[i] = core.state { name = given.prefix .. "_" .. state.own, initial = state.initial, place = core.place(),
      rate = core.substitute(state.rate, by), min = state.min and core.substitute(state.min, by),
      max = state.max and core.substitute(state.max, by) }
  end
  return core.substitute(entry.variants[given.variant or 1], by, states)
end

local elements = {}
for _, name in ipairs(catalogue.names) do
  elements[name] = function(...) return catalogue.element(name, ...) end
end

catalogue.public = { effect = effect, effects = schema.strict_table("lunid.effects", elements) }
return catalogue

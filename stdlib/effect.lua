-- Catalogue entries: what an effect adds to the restoring force, and how it is told apart.
local core = require "lunid.core"
local schema = require "lunid.schema"
local symbols = require "lunid.symbols"
local types = schema.types

local families = { "stiffness", "damping", "friction", "hysteresis", "soil", "inertia", "extra_dof", "time_variation",
  "input", "sensor" }

local text_or_expression = types.either(types.string, types.expression)

--- The entry's own names become private ones, `<effect>_<name>`, in a text or in an expression.
local function privately(entry, private)
  return function(form)
    if type(form) == "string" then
      return core.parse(form:gsub("[%a_][%w_]*", private), entry)
    end
    return core.rename_symbols(form, private)
  end
end

local function check_row(entry, row)
  local allowed = { min = true, max = true, unit = true }
  for key in pairs(row) do
    if key ~= 1 and not allowed[key] then
      schema.fail("effect: " .. entry, ("parameters: unknown field '%s' (fields: min, max, unit)"):format(key))
    end
  end
  if type(row[1]) ~= "string" then schema.fail("effect: " .. entry, "parameters: each entry begins with its name") end
  symbols.check_name("effect: " .. entry, row[1])
end

local function list(value)
  return type(value) == "table" and getmetatable(value) ~= "lunid.expression" and value or { value }
end

local effect = schema.define({
  name = "effect",
  help = "An entry of the catalogue, for lunid.discover { effects = { ... } }. Its names are private to it.",
  fields = {
    { "name", types.string, required = true, help = "snake_case, as results will call it" },
    { "family", types.choice(families), required = true, help = "kind of physics" },
    { "contribution", types.either(text_or_expression, types.list(text_or_expression, 1)), required = true, unit = "N",
      help = "what it adds to the restoring force, as text or expression; a list: its mirror images" },
    { "formula", types.string, help = "as an engineer writes it; else the text of the first contribution" },
    { "parameters", types.list(types.table, 1), required = true, help = "rows { \"k\", min =, max =, unit = }" },
    { "states", types.table, default = {}, help = "z = { rate = \"...\", initial = 0, min =, max = }" },
    { "guess", types.callable,
      help = "function(scale, variant) returning a list of { name = value }: first guesses of the shape parameters" },
    { "range", types.callable,
      help = "function(scale, variant) returning { name = { least, most } }: where a record can show a shape parameter" },
    { "signature", types.string, default = "", help = "parity, harmonics, loop: how it shows in a record" },
    { "sentence", types.string, default = "", help = "what an engineer would say about it" },
    { "confusers", types.list(types.string), default = {}, help = "entries that look like it" },
    { "special_case_of", types.list(types.string), default = {}, help = "entries that contain it exactly" },
    { "channels", types.list(types.string), default = {}, help = "channels that it needs beside y, v and F" },
    { "source", types.string, default = "", help = "paper or textbook" },
  },
  returns = "effect",
  example = [[lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(p*y)",
  parameters = { { "k", unit = "N" }, { "p", min = 0, unit = "1/m" } },
  guess = function(scale) return { { p = 1/scale.y_max } } end }]],
}, function(given)
  symbols.check_name("effect", given.name)
  local private, rows, state_names = {}, {}, {}
  for _, row in ipairs(given.parameters) do
    check_row(given.name, row)
    private[row[1]] = given.name .. "_" .. row[1]
  end
  for name in pairs(given.states) do state_names[#state_names + 1] = name end
  table.sort(state_names)
  for _, name in ipairs(state_names) do
    private[name] = given.name .. "_" .. name
    core.state_symbol(private[name])
  end
  local make = privately(given.name, private)
  for i, row in ipairs(given.parameters) do
    rows[i] = { name = private[row[1]], min = row.min, max = row.max, unit = row.unit or "" }
  end
  local forms, variants, states = list(given.contribution), {}, {}
  for i, form in ipairs(forms) do variants[i] = make(form) end
  for i, name in ipairs(state_names) do
    local state = given.states[name]
    states[i] = core.state { name = private[name], rate = make(state.rate), initial = state.initial,
      min = state.min and make(state.min), max = state.max and make(state.max) }
  end
  given.private, given.rows, given.variants, given.state_values = private, rows, variants, states
  given.formula = given.formula or tostring(forms[1])
  return schema.object("effect", given, nil, function(self) return self.name .. "  " .. self.formula end)
end)

local effects = { public = { effect = effect } }

-- The catalogue of this version, in the order in which it is printed.
effects.names = { "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "clearance", "one_sided_stop",
  "constant_force", "viscous_damping", "quadratic_drag", "coulomb_friction", "bouc_wen" }

--- The entries of these names (all when nil), in the catalogue's order.
function effects.catalogue(names)
  local wanted = names and {}
  for _, name in ipairs(names or {}) do
    local known = false
    for _, each in ipairs(effects.names) do known = known or each == name end
    if not known then
      local near = core.nearest(name, effects.names)
      schema.fail("discover: catalogue", ("unknown effect '%s'%s"):format(name,
        near and (", did you mean '%s'?"):format(near) or " (see `lunid list effects`)"))
    end
    wanted[name] = true
  end
  local entries = {}
  for _, name in ipairs(effects.names) do
    if not wanted or wanted[name] then entries[#entries + 1] = require("lunid.effects." .. name)(effect) end
  end
  return entries
end

return effects

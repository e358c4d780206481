-- An entry of the catalogue: what an effect adds to the restoring force, and how it is told apart.
local core = require "lunid.core"
local element = require "lunid.element"
local schema = require "lunid.schema"
local types = schema.types
local units = require "lunid.units"

local families = { "stiffness", "damping", "friction", "hysteresis", "soil", "inertia", "extra_dof", "time_variation",
  "input", "sensor" }

local text_or_expression = types.either(types.string, types.expression)

--- A text with the entry's own names, or an expression, over the symbols that stand for them (own: name -> symbol).
local function with_symbols(where, own)
  local names = {}
  for name, symbol in pairs(own) do names[name] = tostring(symbol) end
  return function(form)
    if type(form) ~= "string" then return core.substitute(form, own) end
    local expression = core.parse(form:gsub("%f[%w_][%a_][%w_]*", names), where)
    for _, symbol in ipairs(expression:symbols()) do
      local known = symbol.kind ~= "parameter"
      for _, name in pairs(names) do known = known or name == symbol.name end
      if not known then
        schema.fail(where, ("unknown name '%s' in '%s'; declare it in parameters or states"):format(symbol.name, form))
      end
    end
    return expression
  end
end

--- Raises where a row has an unknown field, or one of another type: known is { { "rate", type }, ... }.
local function check_row(where, row, known, first)
  local names, types_of = {}, {}
  for i, field in ipairs(known) do names[i], types_of[field[1]] = field[1], field[2] end
  for key in pairs(row) do
    if not types_of[key] and not (first and key == 1) then
      schema.fail(where, ("unknown field '%s'%s"):format(key, core.did_you_mean(core.nearest(key, names))
        or (" (fields: %s)"):format(table.concat(names, ", "))))
    end
  end
  for _, field in ipairs(known) do
    local value = row[field[1]]
    local good, expected = true, nil
    if value ~= nil then good, expected = field[2].check(value) end
    if not good then
      schema.fail(where, ("%s: expected %s, got %s"):format(field[1], expected, core.describe(value)))
    end
  end
  local problem = row.unit and units.problem(row.unit)
  if problem then schema.fail(where, "unit: " .. problem) end
end

local parameter_fields = { { "min", types.number() }, { "max", types.number() }, { "unit", types.string },
  { "fixed", types.boolean } }

--- The parameter that stands for an entry's own one, by a row of its table.
local function private_parameter(entry, row, known)
  local where = "effect: " .. entry.name
  if type(row[1]) ~= "string" then schema.fail(where, "parameters: each entry begins with its name") end
  schema.check_name(where, row[1])
  if known[row[1]] then schema.fail(where, ("parameters: '%s' is there twice"):format(row[1])) end
  where = ("%s: parameters: %s"):format(where, row[1])
  check_row(where, row, parameter_fields, true)
  schema.check_bounds(where, row)
  return { name = entry.name .. "_" .. row[1], min = row.min, max = row.max, unit = row.unit or "",
    fixed = row.fixed or false }
end

--- Raises where a parameter stands nowhere: nothing could tell its value.
local function check_used(where, given, rows, variants, states)
  local used, parts = {}, { table.unpack(variants) }
  for _, state in ipairs(states) do
    for _, part in ipairs { "rate", "min", "max" } do parts[#parts + 1] = state[part] end
  end
  for _, part in ipairs(parts) do
    for _, symbol in ipairs(core.is_expression(part) and part:symbols() or {}) do used[symbol.name] = true end
  end
  for i, row in ipairs(rows) do
    if not used[row.name] then
      schema.fail(where, ("parameters: nothing uses '%s'; name it in the contribution or in a state's rate, or leave it out")
        :format(given.parameters[i][1]))
    end
  end
end

local function list(value)
  return type(value) == "table" and getmetatable(value) ~= "lunid.expression" and value or { value }
end

--- What the variants are: forces, then what channels show, then what acts of what a channel shows, then the force's
--- delay. Of what channels show and what acts each is { field = "measures", channel = "y", form = "y + b" }.
local function forms_of(given)
  local forms, where = {}, "effect: " .. given.name
  for i, form in ipairs(given.contribution and list(given.contribution) or {}) do forms[i] = { form = form } end
  for _, field in ipairs { "measures", "acts" } do
    local known = field == "measures" and "y" or "F"
    local tables = given[field] or {}
    for _, maps in ipairs(tables[1] and tables or { given[field] }) do
      if type(maps) ~= "table" or core.is_expression(maps) or next(maps) == nil then
        schema.fail(where, ("%s: expected { %s = ... }, or a list of them, got %s"):format(field, known,
          type(maps) == "table" and "an empty table" or core.describe(maps)))
      end
      local channel, form = next(maps)
      if channel ~= known or next(maps, channel) then
        schema.fail(where, ("%s: expected { %s = ... }, or a list of them, got %s"):format(field, known,
          channel == known and "several channels" or ("'%s'"):format(tostring(channel))))
      end
      if not text_or_expression.check(form) then
        schema.fail(where, ("%s: %s: expected %s, got %s"):format(field, channel, text_or_expression.words, core.describe(form)))
      end
      forms[#forms + 1] = { field = field, channel = channel, form = form }
    end
  end
  if given.delay then forms[#forms + 1] = { field = "delay", form = given.delay } end
  if #forms == 0 then schema.fail(where, "expected a contribution, a channel that measures or acts, or a delay") end
  return forms
end

--- A formula for each form.
local function formulas_of(where, given, forms)
  if type(given) == "table" and #given ~= #forms then
    schema.fail(where, ("formula: expected one, or %d as there are forms, got %d"):format(#forms, #given))
  end
  local formulas = {}
  for i, each in ipairs(forms) do
    formulas[i] = type(given) == "table" and given[i] or given
      or (each.channel and each.channel .. " -> " or "") .. tostring(each.form)
  end
  return formulas
end

--- Each formula once.
local function words_of(formulas)
  local texts, seen = {}, {}
  for _, text in ipairs(formulas) do
    if not seen[text] then texts[#texts + 1] = text end
    seen[text] = true
  end
  return table.concat(texts, "; or ")
end

--- A condition "Fs >= Fc" as its two sides.
local function condition(where, text)
  local left, right = text:match "^(.-)>=(.*)$"
  if not left then schema.fail(where, ("requires: expected 'a >= b', got '%s'"):format(text)) end
  return { text = text, left = left, right = right }
end

local state_fields = { { "rate", text_or_expression }, { "initial", types.number() }, { "min", text_or_expression },
  { "max", text_or_expression }, { "unit", types.string }, { "anchored", types.boolean },
  { "absolute", types.boolean } }

local function check_state(where, name, state, own)
  if type(name) ~= "string" then
    schema.fail(where, ("states: expected z = { rate = ... }, got entry %s: %s"):format(name, core.describe(state)))
  end
  schema.check_name(where, name)
  if own[name] then schema.fail(where, ("states: '%s' is a parameter already"):format(name)) end
  where = ("%s: states: %s"):format(where, name)
  if type(state) ~= "table" or core.is_expression(state) then
    schema.fail(where, "expected { rate = ... }, got " .. core.describe(state))
  end
  if state[1] ~= nil then schema.fail(where, ("unexpected entry 1: %s; write rate = ..."):format(core.describe(state[1]))) end
  check_row(where, state, state_fields)
  if state.rate == nil then schema.fail(where, "missing field 'rate': " .. text_or_expression.words) end
end

--- The states of an entry in a fixed order, with their expressions.
local function take_states(entry, own)
  local names, states, absolute = {}, {}, {}
  for name in pairs(entry.states) do names[#names + 1] = name end
  table.sort(names, function(a, b) return tostring(a) < tostring(b) end)
  for _, name in ipairs(names) do check_state("effect: " .. entry.name, name, entry.states[name], own) end
  for _, name in ipairs(names) do own[name] = core.state_symbol(entry.name .. "_" .. name) end
  local make = with_symbols("effect: " .. entry.name, own)
  for i, name in ipairs(names) do
    local state = entry.states[name]
    if state.absolute then absolute[#absolute + 1] = entry.name .. "_" .. name end
    states[i] = { own = name, name = entry.name .. "_" .. name, rate = make(state.rate), initial = state.initial,
      min = state.min and make(state.min), max = state.max and make(state.max), anchored = state.anchored,
      unit = state.unit or "" }
  end
  return states, make, absolute
end

--- Of `separate`: the parameters that a test record has for itself, { { parameter = , unless = channel } }.
local function own_of_record(where, separate, parameters, known)
  local list, names, unless = {}, {}, type(separate) == "table" and separate or {}
  for i, row in ipairs(parameters) do
    names[i] = row[1]
    if separate == true or unless[row[1]] then list[#list + 1] = { parameter = row[1], unless = unless[row[1]] or "" } end
  end
  for name, channel in pairs(unless) do
    if not known[name] then
      schema.fail(where, ("separate: no parameter '%s'%s"):format(name, core.did_you_mean(core.nearest(name, names)) or ""))
    end
    if type(channel) ~= "string" then
      schema.fail(where, ("separate: %s: expected a channel, got %s"):format(name, core.describe(channel)))
    end
  end
  return list
end

return schema.define({
  name = "effect",
  help = "An entry of the catalogue, for lunid.discover { effects = { ... } }. Its names are private to it. Called with "
    .. "values, as magnet { k = 3, p = 40 }, it is an element of a model, as those of lunid.effects.",
  fields = {
    { "name", types.string, required = true, help = "snake_case, as results will call it" },
    { "family", types.choice(families), required = true, help = "kind of physics" },
    { "contribution", types.either(text_or_expression, types.list(text_or_expression, 1)), unit = "N",
      help = "what it adds to the restoring force, as text or expression; a list: its forms, such as mirror images" },
    { "measures", types.table, help = "of a sensor's fault: { y = \"y + b\" }, what the channel shows of the true motion; "
      .. "a list: the forms that it may have" },
    { "any_motion", types.boolean, default = false, help = "what it measures of y holds of v or a too, where one of these was recorded" },
    { "separate", types.either(types.boolean, types.table), default = false, help = "its parameters are those of one record, "
      .. "such as a drift: a test record has its own, found on it while all others are held; { phi = \"shaft_angle\" }: phi "
      .. "alone, where the records do not hold that channel" },
    { "repeats", types.boolean, default = false, help = "may stand several times at one place, as stops on either side; the "
      .. "names of the second end in _b" },
    { "acts", types.table, help = "of a fault of the force: { F = \"g*F\" }, the force that acts, of what its channel shows, "
      .. "of force_rate, the rate of that, and of y and v (a coil that leaves its field: \"F*(1 - b*y^2)\"); affine in F" },
    { "delay", text_or_expression, unit = "s", help = "by which the force acts later than its channel says" },
    { "formula", types.either(types.string, types.list(types.string, 1)),
      help = "as an engineer writes it, one for all forms or one for each; else the text of each contribution" },
    { "parameters", types.list(types.table, 1), required = true,
      help = "rows { \"k\", min =, max =, unit =, fixed = }; a fixed one stays at its first guess; a form has those that it holds" },
    { "states", types.table, default = {}, help = "z = { rate = \"...\", initial = 0, min =, max =, unit =, "
      .. "anchored =, absolute = }; anchored: as in lunid.state; absolute: the velocity of a mass of its own, against which a "
      .. "base that moves acts" },
    { "requires", types.list(types.string), default = {}, help = "what holds between parameters, as \"Fs >= Fc\"" },
    { "guess", types.callable,
      help = "function(scale, variant) returning a list of { name = value }: first guesses of the shape parameters, within their bounds" },
    { "range", types.callable,
      help = "function(scale, variant) returning { name = { least, most } }: where a record can show a shape parameter" },
    { "passive", types.either(types.boolean, types.string),
      help = "false where it can create energy over a cycle; \"where c >= 0\" where that depends" },
    { "signature", types.string, default = "", help = "parity, harmonics, loop: how it shows in a record" },
    { "sentence", types.string, default = "", help = "what an engineer would say about it" },
    { "note", types.string, default = "", help = "how the formula was made into equations, and its error" },
    { "confusers", types.list(types.string), default = {}, help = "entries that look like it" },
    { "special_case_of", types.list(types.string), default = {}, help = "entries that contain it, exactly or as a limit" },
    { "acts_on", types.list(types.string), default = {}, help = "entries that it modifies" },
    { "channels", types.list(types.string), default = {}, help = "channels that it needs beside y, v and F" },
    { "source", types.string, default = "", help = "paper or textbook" },
  },
  returns = "effect",
  example = [[lunid.effect { name = "magnet", family = "stiffness", contribution = "k*sin(p*y)",
  parameters = { { "k", unit = "N" }, { "p", min = 0, unit = "1/m" } },
  guess = function(scale) return { { p = 1/scale.y_max } } end }]],
}, function(given)
  schema.check_name("effect", given.name)
  local where = "effect: " .. given.name
  local own, rows, conditions = {}, {}, {}
  for i, row in ipairs(given.parameters) do
    rows[i] = private_parameter(given, row, own)
    own[row[1]] = core.parse(rows[i].name, where)
  end
  given.own_of_record = own_of_record(where, given.separate, given.parameters, own)
  local states, make, absolute = take_states(given, own)
  local forms, variants, maps = forms_of(given), {}, {}
  for i, each in ipairs(forms) do
    variants[i] = make(each.form)
    maps[i] = { field = each.field, channel = each.channel }
  end
  local margins = {}
  for i, text in ipairs(given.requires) do
    conditions[i] = condition(where, text)
    margins[i] = make(conditions[i].left) - make(conditions[i].right)
  end
  check_used(where, given, rows, variants, states)
  given.rows, given.states, given.variants, given.conditions = rows, states, variants, conditions
  given.margins = margins
  given.absolute = absolute
  given.maps = maps
  given.state_values = {}
  for i, state in ipairs(states) do given.state_values[i] = core.state(state) end
  given.formulas = formulas_of(where, given.formula, forms)
  given.formula = words_of(given.formulas)
  return schema.object("effect", given, nil, function(self) return self.name .. "  " .. self.formula end, element.make)
end)

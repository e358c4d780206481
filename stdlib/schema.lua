-- One schema per constructor: it validates, fills in defaults, feeds `lunid help`, the editor stubs and the docs check.
local core = require "lunid.core"

local schema = {}

--- Types of fields. A type is { words, check }: check(value) gives true and the value to keep, or false and what was
--- expected ("> 0" where only the range is wrong).
local types = {}
schema.types = types

local function type_of(words, check) return { words = words, check = check } end

local function simple(kind, words)
  return type_of(words, function(value)
    if type(value) == kind then return true, value end
    return false, words
  end)
end

types.string = simple("string", "a string")
types.boolean = simple("boolean", "true or false")
types.callable = simple("function", "a function")
types.table = simple("table", "a table")
types.any = type_of("any value", function(value) return true, value end)

--- Range in words: { above = 0 } is "> 0", { min = 0, max = 1 } is "0 to 1".
local function range_words(range)
  if range.above and range.below then return ("> %g and < %g"):format(range.above, range.below) end
  if range.min and range.max then return ("%g to %g"):format(range.min, range.max) end
  if range.min and range.below then return (">= %g and < %g"):format(range.min, range.below) end
  if range.above and range.max then return ("> %g and <= %g"):format(range.above, range.max) end
  if range.above then return ("> %g"):format(range.above) end
  if range.min then return (">= %g"):format(range.min) end
  if range.below then return ("< %g"):format(range.below) end
  if range.max then return ("<= %g"):format(range.max) end
end

local function in_range(value, range)
  return value == value and not (range.min and value < range.min) and not (range.above and value <= range.above)
    and not (range.max and value > range.max) and not (range.below and value >= range.below)
end

local function number_type(noun, is)
  return function(range)
    range = range or {}
    local limits = range_words(range)
    return type_of(limits and noun .. " " .. limits or noun, function(value)
      if not is(value) then return false, limits and noun .. " " .. limits or noun end
      if not in_range(value, range) then return false, limits or noun end
      return true, value
    end)
  end
end

types.number = number_type("a number", function(value) return type(value) == "number" end)
types.integer = number_type("a whole number", function(value) return math.type(value) == "integer" end)

function types.choice(words)
  local text = "'" .. table.concat(words, "', '") .. "'"
  local last = #words > 1 and text:gsub(", ('[^,]*')$", " or %1") or text
  return type_of(last, function(value)
    for _, word in ipairs(words) do
      if value == word then return true, value end
    end
    return false, last, core.did_you_mean(core.nearest(value, words))
  end)
end

--- A value of a bound type or of an object of the standard library: types.is("record", "lunid.read").
function types.is(kind, from)
  local words = (kind:match "^[aeiou]" and "an " or "a ") .. kind .. (from and " from " .. from or "")
  return type_of(words, function(value)
    local good = getmetatable(value) == "lunid." .. kind
    return good, good and value or words
  end)
end

types.expression = type_of("an expression or a number", function(value)
  local good = type(value) == "number" or core.is_expression(value)
  return good, good and value or "an expression or a number"
end)

--- The parts of "a number or an expression".
local function alternatives(words)
  local parts = {}
  for part in (words .. " or "):gmatch "(.-) or " do parts[#parts + 1] = part end
  return parts
end

--- "a record from lunid.read" -> "records from lunid.read"
local function plural(words)
  local parts = alternatives(words)
  for i, part in ipairs(parts) do
    local noun, rest = part:match "^an? (%a+ number)(.*)$"
    if not noun then noun, rest = part:match "^an? ([%a_]+)(.*)$" end
    local ending = noun and (noun:match "s$" and "" or noun:match "[^aeiou]y$" and "ies" or "s")
    if noun then parts[i] = (ending == "ies" and noun:sub(1, -2) or noun) .. ending .. rest end
  end
  return table.concat(parts, " or ")
end

--- "entries" of any value have no words of their own; how many an inner list holds is told by its own message.
local function list_words(of, least)
  local of_what = of == types.any and "" or " of " .. plural((of.words:gsub(" %(%d+ or more%)", "")))
  return "a list" .. of_what .. (least and (" (%d or more)"):format(least) or "")
end

--- A table that is no object of a type.
function schema.is_plain(value)
  local kind = type(value) == "table" and getmetatable(value)
  return type(value) == "table" and (kind == nil or kind == "lunid.list")
end

--- A message of what is wrong within a value, such as "entry 2: expected a number", has its "expected" already.
local function says_where(text) return text:find("expected ", 1, true) ~= nil end

function types.list(of, least)
  local words = list_words(of, least)
  return type_of(words, function(value)
    if not schema.is_plain(value) then return false, words end
    local kept = {}
    for i = 1, #value do
      local good, entry, hint, culprit = of.check(value[i])
      if not good and says_where(entry) then return false, ("entry %d: %s"):format(i, entry), hint, culprit end
      if not good then return false, ("entry %d: expected %s"):format(i, of.words), hint, value[i] end
      kept[i] = entry
    end
    for key in pairs(value) do  -- what has a name would be lost without a word
      if type(key) == "string" then return false, words .. " and no named fields" end
    end
    if #kept < (least or 0) then return false, words end
    return true, kept
  end)
end

function types.either(...)
  local all, words, said_before = { ... }, {}, {}
  for _, each in ipairs(all) do
    for _, part in ipairs(alternatives(each.words)) do
      if not said_before[part] then words[#words + 1] = part end
      said_before[part] = true
    end
  end
  local text = table.concat(words, " or ")
  return type_of(text, function(value)
    local said, number_of_matches = nil, 0
    for _, each in ipairs(all) do
      local good, kept, hint, culprit = each.check(value)
      if good then return true, kept end
      if culprit ~= nil and says_where(kept) then return false, kept, hint, culprit end
      if type(value) == "number" and each.words:match "number" then said, number_of_matches = kept, 1 end
    end
    return false, number_of_matches > 0 and said or text
  end)
end

--- What a value is, in words; of a plain table what it holds, so that "expected a list" is told from the one that came.
function schema.describe(value)
  if not schema.is_plain(value) then return core.describe(value) end
  if next(value) == nil then return "an empty table" end
  local names = {}
  for key in pairs(value) do
    if math.type(key) ~= "integer" then names[#names + 1] = tostring(key) end
  end
  if #names == 0 then
    return #value == 1 and "a list of one: " .. core.describe(value[1]) or ("a list of %d"):format(#value)
  end
  table.sort(names)
  local first = table.concat(names, " = , ", 1, math.min(#names, 3)) .. " ="
  return ("a table { %s%s }"):format(first, #names > 3 and ", ..." or "")
end

--- All definitions, by name and in the order of declaration.
schema.definitions = {}

--- Raises `where: message` with the user's file and line.
function schema.fail(where, message) core.raise(where .. ": " .. message, "study") end

--- Raises where a parameter of a model that is to be run has no value.
function schema.expect_values(where, model)
  for _, row in ipairs(model.parameters) do
    if not row.value then
      schema.fail(where, ("parameter '%s' has no value: model:with { %s = ... }, or fit it first"):format(row.name, row.name))
    end
  end
end

local keywords = {}
for word in ([[and break do else elseif end false for function goto if in local nil not or repeat return then true
               until while lunid]]):gmatch "%S+" do
  keywords[word] = true
end

--- A name that can stand in an expression and in a saved model.
function schema.check_name(where, name)
  if not name:match "^[%a_][%w_]*$" then
    schema.fail(where, ("name: expected letters, digits and _, got '%s'"):format(name))
  end
  if keywords[name] then schema.fail(where, ("name: '%s' is a word of Lua; choose another"):format(name)) end
end

--- Bounds of a parameter.
function schema.check_bounds(where, given)
  if given.min and given.max and given.min > given.max then
    schema.fail(where, ("min: expected <= max, which is %g, got %g"):format(given.max, given.min))
  end
end

--- What messages call it: "filter" of record:filter.
local function called(definition) return (definition.name:gsub("^%l+:(%S)", "%1")) end

--- How it is written: "lunid.read", "record:filter".
function schema.spelled(definition) return (definition.name:find ":" and "" or "lunid.") .. definition.name end

local function field_named(definition, name)
  for _, field in ipairs(definition.fields) do
    if field.name == name then return field end
  end
end

local function names_of_fields(definition)
  local names = {}
  for i, field in ipairs(definition.fields) do names[i] = field.name end
  return names
end

local function known_fields(definition)
  local names = names_of_fields(definition)
  return #names > 0 and " (fields: " .. table.concat(names, ", ") .. ")" or " (it has no fields)"
end

--- What is wrong with a field of that name, or nil.
function schema.problem_of_name(definition, key)
  if field_named(definition, key) then return nil end
  local meant = core.did_you_mean(core.nearest(key, names_of_fields(definition)))
  return ("unknown field '%s'%s"):format(key, meant or known_fields(definition))
end

local function check_field(definition, field, value)
  if value == nil then
    if field.required then
      schema.fail(called(definition), ("missing field '%s': %s"):format(field.name, field.type.words))
    end
    return field.default
  end
  local good, kept, hint, culprit = field.type.check(value)
  if good then return kept end
  local expected = says_where(kept) and kept or "expected " .. kept
  local got = schema.describe(culprit == nil and value or culprit)
  if got == "an empty table" and expected:find("list", 1, true) then got = "an empty list" end
  schema.fail(called(definition) .. ": " .. field.name, ("%s, got %s%s"):format(expected, got, hint or ""))
end

--- Checks a value that is written for a field as the call would.
function schema.check_value(definition, name, value) check_field(definition, field_named(definition, name), value) end

--- The field that the first value without a name is of.
local function first_field(definition)
  return definition.positional and field_named(definition, definition.positional[1])
end

--- A plain list in place of the fields is the first of them where that takes a list and no other reading fits:
--- ljung_box { 1, 2, 3 }. What is wrong in such a list is told of the field.
local function as_first_field(definition, given)
  local first = first_field(definition)
  if not first or given[1] == nil or not first.type.words:find("list", 1, true) then return given end
  for key in pairs(given) do
    if math.type(key) ~= "integer" then return given end
  end
  if first.type.check(given[1]) then return given end
  if first.type.check(given) or type(given[1]) == "number" and #given > #definition.positional then
    return { [first.name] = given }
  end
  return given
end

--- What is to be written where an entry has no field.
local function fail_unexpected(definition, given, key)
  local first, list = first_field(definition), {}
  for i, entry in ipairs(given) do list[i] = entry end
  if first and #list > 1 and first.type.check(list) then
    for i, entry in ipairs(list) do list[i] = i < 4 and core.describe(entry) or i == 4 and "..." or nil end
    schema.fail(called(definition), ("several go in one list: %s { { %s } }"):format(schema.spelled(definition),
      table.concat(list, ", ")))
  end
  schema.fail(called(definition), ("unexpected entry %d: %s; fields are written name = value%s"):format(key,
    schema.describe(given[key]), known_fields(definition)))
end

--- Gives positional entries their names and refuses unknown keys.
local function named(definition, given)
  local values = {}
  for key, value in pairs(given) do
    local name = key
    if math.type(key) == "integer" then
      name = definition.positional and definition.positional[key]
      if not name then fail_unexpected(definition, given, key) end
    else
      local problem = schema.problem_of_name(definition, key)
      if problem then schema.fail(called(definition), problem) end
    end
    values[name] = value
  end
  return values
end

--- Values without names, and named ones in a table at the end, as one table.
local function positional(given, count)
  local last = given[count]
  if count > 1 and type(last) == "table" and getmetatable(last) == nil and last[1] == nil then
    given[count] = nil
    for key, value in pairs(last) do given[key] = value end
  end
  return given
end

--- The arguments of a call by their names or places. Raises where there are too many, or none where a table is needed.
local function arguments_of(definition, ...)
  local given, count = { ... }, select("#", ...)
  while count > 0 and given[count] == nil do count = count - 1 end
  local first = given[1]
  if definition.style == "arguments" then
    if count == 1 and schema.is_plain(first) and first[1] == nil and field_named(definition, (next(first))) then
      schema.fail(called(definition), ("expected %s(%s), got %s"):format(schema.spelled(definition),
        table.concat(definition.positional, ", "), schema.describe(first)))
    end
    if count > #definition.positional then
      schema.fail(called(definition), ("expected %d arguments, got %d"):format(#definition.positional, count))
    end
    return given
  end
  if count == 1 and type(first) == "table" and getmetatable(first) == nil then return as_first_field(definition, first) end
  if definition.positional and first ~= nil then  -- lunid.read "run.csv", lunid.read("run.csv", { ... })
    return positional(given, count)
  end
  schema.fail(called(definition), count > 1 and ("expected a table { ... }, got %d arguments"):format(count)
    or ("expected a table { ... }, got %s"):format(core.describe(first)))
end

--- Checks the arguments of a call against a definition; returns the named values with defaults filled in.
function schema.validate(definition, ...)
  local values, checked = named(definition, arguments_of(definition, ...)), {}
  for _, field in ipairs(definition.fields) do checked[field.name] = check_field(definition, field, values[field.name]) end
  return checked
end

--- Declares a public function: definition { name, help, fields = { { "name", type, ... } }, positional, style, returns }
--- and the body that gets the checked values.
function schema.define(definition, body)
  for _, field in ipairs(definition.fields) do
    field.name, field.type = field.name or field[1], field.type or field[2]
  end
  schema.definitions[#schema.definitions + 1] = definition
  schema.definitions[definition.name] = definition
  return function(...) return body(schema.validate(definition, ...)) end
end

--- Declares a method of a bound type: definition.name is "record:filter", and the body gets the record and the checked
--- values. Without arguments all fields are at their defaults. `also`: another type that has it.
function schema.method(definition, body)
  local type, name = definition.name:match "^(%l+):([%l_]+)$"
  schema.define(definition)
  for _, owner in ipairs { type, definition.also } do
    core.add_method("lunid." .. owner, name, function(self, ...)
      if getmetatable(self) ~= "lunid." .. owner then
        schema.fail(name, ("expected %s:%s { ... }, with a colon"):format(owner, name))
      end
      if select("#", ...) == 0 then return body(self, schema.validate(definition, {})) end
      return body(self, schema.validate(definition, ...))
    end)
  end
end

--- " (required, default 3, [N])": what else is to be said of a field; "" for nothing.
function schema.notes(field)
  local notes = {}
  if field.required then notes[#notes + 1] = "required" end
  if field.default ~= nil and type(field.default) ~= "table" and field.default ~= "" then
    notes[#notes + 1] = "default " .. (type(field.default) == "number" and ("%g"):format(field.default)
      or tostring(field.default))
  end
  if field.unit then notes[#notes + 1] = "[" .. field.unit .. "]" end
  return #notes > 0 and " (" .. table.concat(notes, ", ") .. ")" or ""
end

--- An object of the standard library: a table whose metatable is locked and says what it is.
function schema.object(kind, fields, methods, to_string, call)
  return setmetatable(fields, {
    __metatable = "lunid." .. kind,
    __words = (kind:match "^[aeiou]" and "an " or "a ") .. kind,
    __index = methods,
    __call = call,
    __tostring = to_string or function() return kind end,
  })
end

--- A table of public functions: an unknown name is an error with "did you mean"; nothing can be assigned. `meant`: what
--- stands for words that have no name near them.
function schema.strict_table(words, public, meant)
  local names = {}
  for name in pairs(public) do names[#names + 1] = name end
  table.sort(names)
  return schema.strict_list(words, names, function(name) return public[name] end, meant)
end

--- The same of names, in their order, whose values are made when they are asked for.
function schema.strict_list(words, names, value_of, meant)
  local known = {}
  for i, name in ipairs(names) do known[name] = i end
  return setmetatable({}, {
    __metatable = "locked",
    __index = function(_, name)
      if known[name] then return value_of(name) end
      local hint = meant and meant[name] and (", did you mean %s?"):format(meant[name])
        or core.did_you_mean(core.nearest(tostring(name), names)) or ""
      core.raise(("%s has no '%s'%s"):format(words, name, hint), "study")
    end,
    __newindex = function(_, name) core.raise(("%s.%s cannot be assigned"):format(words, name), "study") end,
    __pairs = function()
      return function(_, name)
        local next_name = names[(known[name] or 0) + 1]
        if next_name then return next_name, value_of(next_name) end
      end
    end,
  })
end

return schema

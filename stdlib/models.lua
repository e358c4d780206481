-- Models: m*a + restoring(y, v, z, t) = F.
local core = require "lunid.core"
local output = require "lunid.output"
local records = require "lunid.records"
local schema = require "lunid.schema"
local strict = require "lunid.strict"
local units = require "lunid.units"
local types = schema.types

local models = {}

--- An expression for one coordinate, or one for each of several.
local list = types.list(types.expression, 1)
types.rows = { words = "an expression or a number, or a list of them", check = function(value)
  local good, kept = types.expression.check(value)
  if good then return true, kept end
  if not schema.is_plain(value) or #value == 0 then return false, types.rows.words end
  return list.check(value)
end }

--- The same, or the rows of a matrix.
local rows = types.list(list, 1)
types.mass = { words = "an expression or a number, a list of them, or the rows of a matrix", check = function(value)
  if schema.is_plain(value) and schema.is_plain(value[1]) then return rows.check(value) end
  local good, kept, hint, culprit = types.rows.check(value)
  return good, not good and culprit == nil and types.mass.words or kept, hint, culprit
end }

--- { y = expression }, or several channels.
local maps = { words = "a table { channel = expression }", check = function(value)
  if not schema.is_plain(value) or value[1] ~= nil then return false, "a table { channel = expression }" end
  for channel, map in pairs(value) do
    if not types.expression.check(map) then
      return false, ("%s: expected %s"):format(tostring(channel), types.expression.words), nil, map
    end
  end
  return true, value
end }

--- Rows of a mass matrix as the masses on its diagonal; what stands beside it joins the restoring forces.
local function take_matrix(matrix, restoring)
  local masses = {}
  for i, row in ipairs(matrix) do
    if #row ~= #matrix then
      schema.fail("model: mass", ("row %d: expected %d entries, got %d"):format(i, #matrix, #row))
    end
    masses[i] = row[i]
    for j, entry in ipairs(row) do
      if j ~= i and entry ~= 0 then restoring[i] = restoring[i] + entry*core.channel("a" .. j) end
    end
  end
  return masses
end

--- Lists of masses and restoring forces, one entry for each coordinate.
local function take_rows(given)
  local is_list = type(given.restoring) == "table" and not core.is_expression(given.restoring)
  local restoring = is_list and given.restoring or { given.restoring }
  local mass = given.mass
  if type(mass) ~= "table" or core.is_expression(mass) then mass = { mass } end
  if #mass ~= #restoring then
    schema.fail("model: mass", ("expected %d %s, as many as restoring forces, got %d"):format(#restoring,
      #restoring == 1 and "entry" or "entries", #mass))
  end
  local is_matrix = type(mass[1]) == "table" and not core.is_expression(mass[1])
  given.mass, given.restoring = is_matrix and take_matrix(mass, restoring) or mass, restoring
end

--- A delay, or what an entry that is one gives: a table, so that it cannot be added to a force.
local delay = { words = types.expression.words, check = function(value)
  local of_entry = type(value) == "table" and not core.is_expression(value) and core.is_expression(value.delay)
  return types.expression.check(of_entry and value.delay or value)
end }

models.model = schema.define({
  name = "model",
  help = "The equation of motion m*a + restoring = F, or one of them for each of several coordinates. With imposed "
    .. "motion, y and v drive it and F is its output.",
  fields = {
    { "mass", types.mass, required = true, unit = "kg",
      help = "a number, a parameter, or an expression; for several coordinates a list, or the rows of a matrix" },
    { "restoring", types.rows, required = true, unit = "N",
      help = "restoring force; 0 for none; for several coordinates a list" },
    { "forces", types.list(types.integer { min = 1 }, 1),
      help = "the coordinates that a force acts on, such as { 1 }; else all" },
    { "delay", delay, unit = "s",
      help = "the forces act so much later than they are recorded; a number or a parameter, >= 0; "
        .. "what came before a record is predicted from its rows, a formula's force follows the formula" },
    { "measures", maps, help = "what displacements, velocities and accelerations show in a record where it is not their true value: "
      .. "{ y = y + b }; fits and gaps compare with that, runs give the true motion" },
    { "acts", maps, help = "the force that acts where it is not what its channel shows: { F = g*F }, or { F = F*(1 - b*y^2) } of a "
      .. "coil that leaves its field; affine in F" },
    { "states", types.list(types.expression), default = {},
      help = "internal states that the restoring force does not name" },
    { "interpolation", types.choice { "hold", "linear", "cubic", "band_limited" },
      help = "what recorded forces do between their rows, where neither the call nor the record says it; else straight "
        .. "lines. Models that discover returns have what was found" },
    { "motion", types.choice { "free", "imposed" }, default = "free",
      help = "'imposed': the measured motion drives the model; the mass may then be 0" },
  },
  returns = "model",
  example = [[local model = lunid.model { mass = 49, restoring = k*y + c*v }]],
}, function(given)
  given.imposed_motion = given.motion == "imposed"
  take_rows(given)
  return core.model(given)
end)

local wall = {}

--- The force of the element between two neighbours; a wall stands still.
local function element(given, index, left, right)
  local function difference(quantity)
    return left == wall and right[quantity] or right == wall and -left[quantity] or right[quantity] - left[quantity]
  end
  local force = given.element(difference "y", difference "v", index)
  if not types.expression.check(force) then
    schema.fail("chain: element", "expected the function to return an expression, got " .. core.describe(force))
  end
  return force
end

models.chain = schema.define({
  name = "chain",
  help = "Masses in a row with an element between neighbours: y1 ... yn, each element a function of its elongation and "
    .. "the rate of it.",
  fields = {
    { "masses", types.list(types.expression, 1), required = true, unit = "kg", help = "one for each coordinate" },
    { "element", types.callable, required = true, unit = "N",
      help = "function(elongation, rate, index) that returns the force, positive in tension; index 1 stands before the "
        .. "first mass and n + 1 behind the last, whatever is tied" },
    { "ends", types.choice { "fixed", "left", "right", "free", "base" }, default = "fixed",
      help = "which ends an element ties to the ground: both, the first mass, the last, none; base: the first, to a base that moves (yb, vb)" },
    { "forces", types.list(types.integer { min = 1 }, 1), help = "the coordinates that a force acts on; else all" },
  },
  returns = "model",
  example = [[local model = lunid.chain { masses = { 1, 1, 1 }, element = function(d, w) return 2e4*d + 3*w end }]],
}, function(given)
  local n, restoring = #given.masses, {}
  local function place(i)
    if i < 1 and given.ends == "base" then return { y = core.channel "yb", v = core.channel "vb" } end
    if i < 1 or i > n then return wall end
    local number = n > 1 and i or ""
    return { y = core.channel("y" .. number), v = core.channel("v" .. number) }
  end
  for i = 1, n do restoring[i] = 0 end
  local first = given.ends == "left" or given.ends == "base"
  for i = 0, n do  -- element i + 1 stands between mass i and mass i + 1
    local tied = i > 0 and i < n or given.ends == "fixed" or i == 0 and first or i == n and given.ends == "right"
    if tied then
      local force = element(given, i + 1, place(i), place(i + 1))
      if i > 0 then restoring[i] = restoring[i] - force end
      if i < n then restoring[i + 1] = restoring[i + 1] + force end
    end
  end
  return models.model { mass = given.masses, restoring = restoring, forces = given.forces }
end)

local function field(name, value)
  if value == nil or value == "" or value == false then return "" end
  if type(value) == "number" then value = core.number_text(value) end
  if type(value) == "string" and name == "unit" then value = ("%q"):format(value) end
  return (", %s = %s"):format(name, tostring(value))
end

local function parameter_text(row)
  local value = row.value and ", " .. core.number_text(row.value) or ""
  local unit = not units.problem(row.unit) and row.unit or ""  -- a file's own one, of a column taken as it is
  return ("local %s = lunid.parameter { %q%s%s%s%s%s%s }"):format(row.name, row.name, value, field("min", row.min),
    field("max", row.max), field("unit", unit), field("fixed", row.fixed), field("std", row.std))
end

local function state_text(state)
  local function bound(name) return state[name] and (", %s = %s"):format(name, state[name]:text "lua") or "" end
  return ("local %s = lunid.state { %q, rate = function(%s) return %s end, initial = %s%s%s%s }"):format(state.name,
    state.name, state.name, state.rate:text "lua", core.number_text(state.initial), bound "min", bound "max",
    state.anchored and ", anchored = true" or "")
end

--- Lua has room for 200 local names.
local most_coordinates = 30

local function channel_text(model)
  local n = model.degrees
  local text = "local t, yb, vb, ab = lunid.time, lunid.base_displacement, lunid.base_velocity, lunid.base_acceleration"
  local further = {}
  for _, input in ipairs(model.inputs) do
    if input:match "_" then further[#further + 1] = ("\nlocal %s = lunid.%s"):format(input, input) end
  end
  text = text .. table.concat(further)
  if n == 1 then
    local base = table.concat(model.inputs, " "):match "b" and "\n" .. text:gsub("t, yb", "yb", 1):gsub("lunid.time, ", "", 1)
      or table.concat(further)
    return "local y, v, a, t, F = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time, lunid.force" .. base
  end
  local lines = { text }
  for letter, name in ("y displacements v velocities a accelerations F forces "):gmatch "(%a) (%a+) " do
    local names = {}
    for i = 1, n do names[i] = letter .. i end
    lines[#lines + 1] = ("local %s = lunid.%s(%d)"):format(table.concat(names, ", "), name, n)
  end
  return table.concat(lines, "\n")
end

--- An expression, or a list of one for each coordinate.
local function row_text(value)
  if core.is_expression(value) then return value:text "lua" end
  local texts = {}
  for i, row in ipairs(value) do texts[i] = row:text "lua" end
  return "{\n    " .. table.concat(texts, ",\n    ") .. ",\n  }"
end

local function forces_text(model)
  if #model.forces == model.degrees then return "" end
  return ("\n  forces = { %s },"):format(table.concat(model.forces, ", "))
end

--- "measures = { y = y + b }," with the channels in their order.
local function maps_text(field, maps)
  if not maps then return "" end
  local names, texts = {}, {}
  for name in pairs(maps) do names[#names + 1] = name end
  table.sort(names)
  for i, name in ipairs(names) do texts[i] = ("%s = %s"):format(name, maps[name]:text "lua") end
  return ("\n  %s = { %s },"):format(field, table.concat(texts, ", "))
end

--- All expressions of a model.
local function parts_of(model)
  local parts = {}
  for _, rows in ipairs { model.mass, model.restoring } do
    for _, row in ipairs(core.is_expression(rows) and { rows } or rows) do parts[#parts + 1] = row end
  end
  parts[#parts + 1] = model.delay
  for _, field in ipairs { "measures", "acts" } do
    for _, map in pairs(model[field] or {}) do parts[#parts + 1] = map end
  end
  for _, state in ipairs(model.states) do
    for _, part in ipairs { "rate", "min", "max" } do parts[#parts + 1] = state[part] end
  end
  return parts
end

local function list_text(column)
  local texts = {}
  for i, value in ipairs(column:list()) do texts[i] = core.number_text(value) end
  return "{ " .. table.concat(texts, ", ") .. " }"
end

--- A table of values is written with all of them; a function in Lua has no text.
local function function_text(called)
  if not called.table then
    schema.fail("save", ("the model calls the %s, which has no text: keep the study that makes it"):format(called.words))
  end
  local axes, values = {}, {}
  for i, axis in ipairs(called.table.axes) do axes[i] = list_text(axis) end
  for i, row in ipairs(called.table.values) do values[i] = #axes == 1 and core.number_text(row[1]) or list_text(row) end
  return ("local %s = lunid.lookup { %q, between = %q, axes = { %s }, values = {\n  %s } }"):format(called.name, called.name,
    called.table.between, table.concat(axes, ", "), table.concat(values, ",\n  "))
end

--- Lua that loads again to the same model.
function models.text(model)
  if model.degrees > most_coordinates then
    schema.fail("save", ("a model of %d coordinates cannot be written (at most %d): keep the study that makes it"):format(
      model.degrees, most_coordinates))
  end
  local lines = { "-- " .. model:equation():gsub("\n", "\n-- "), 'local lunid = require "lunid"' }
  lines[#lines + 1] = channel_text(model)
  for _, called in ipairs(core.functions_of(parts_of(model))) do lines[#lines + 1] = function_text(called) end
  for _, row in ipairs(model.parameters) do lines[#lines + 1] = parameter_text(row) end
  local names = {}
  for i, state in ipairs(model.states) do
    names[i] = state.name
    lines[#lines + 1] = state_text(state)
  end
  lines[#lines + 1] = ("return lunid.model {\n  mass = %s,\n  restoring = %s,%s%s%s\n}"):format(
    row_text(model.mass), row_text(model.restoring), (model.imposed_motion and "" or forces_text(model))
      .. (model.delay and ("\n  delay = %s,"):format(model.delay:text "lua") or "")
      .. maps_text("measures", model.measures) .. maps_text("acts", model.acts)
      .. (model.interpolation and ("\n  interpolation = %q,"):format(model.interpolation) or ""),
    #names > 0 and ("\n  states = { %s },"):format(table.concat(names, ", ")) or "",
    model.imposed_motion and '\n  motion = "imposed",' or "")
  return table.concat(lines, "\n") .. "\n"
end

core.add_method("lunid.model", "save", function(model, path)
  if type(path) ~= "string" then schema.fail("save", "expected a path, got " .. core.describe(path)) end
  return output.write(path, models.text(model))
end)

local row_names = { "value", "min", "max", "unit", "fixed", "std" }

--- A row of `with`, as { min = 0, fixed = true }; a row of model.parameters is one too.
local function check_row(where, name, row)
  if next(row) == nil then
    schema.fail(where, "expected a number or fields (" .. table.concat(row_names, ", ") .. "), got an empty table")
  end
  local known = {}
  for _, field in ipairs(row_names) do known[field] = true end
  if row[1] ~= nil then
    schema.fail(where, ("unexpected entry 1: %s; fields are written name = value, such as value = 3"):format(core.describe(row[1])))
  end
  for field, value in pairs(row) do
    if not known[field] and not (field == "name" and value == name) then
      schema.fail(where, ("unknown field '%s'%s"):format(field, core.did_you_mean(core.nearest(field, row_names))
        or " (fields: " .. table.concat(row_names, ", ") .. ")"))
    end
    if field == "fixed" and type(value) ~= "boolean" then
      schema.fail(where .. ": fixed", "expected true or false, got " .. core.describe(value))
    elseif field == "unit" then
      local problem = type(value) ~= "string" and "expected a string, got " .. core.describe(value) or units.problem(value)
      if problem then schema.fail(where .. ": unit", problem) end
    elseif field ~= "fixed" and field ~= "name" and (type(value) ~= "number" or value ~= value) then
      schema.fail(where .. ": " .. field, "expected a number, got " .. core.describe(value))
    end
  end
end

--- A copy with other values: model:with { k = 3, c = { fixed = true, min = 0 } }.
core.add_method("lunid.model", "with", function(model, rows)
  if getmetatable(model) ~= "lunid.model" then schema.fail("with", "expected model:with { ... }, with a colon") end
  if type(rows) ~= "table" or getmetatable(rows) ~= nil then
    schema.fail("with", "expected a table { k = 3, c = { min = 0 } }, got " .. core.describe(rows))
  end
  local names = {}
  for i, row in ipairs(model.parameters) do names[i] = row.name end
  for name, row in pairs(rows) do
    if type(name) ~= "string" or not model.parameters[name] then
      schema.fail("with", ("the model has no parameter '%s'%s"):format(name, core.did_you_mean(core.nearest(name, names))
        or #names > 0 and " (parameters: " .. table.concat(names, ", ") .. ")" or ""))
    end
    if type(row) == "number" and row ~= row or type(row) ~= "number" and type(row) ~= "table" then
      schema.fail("with: " .. name, "expected a number or a table, got " .. core.describe(row))
    end
    if type(row) == "table" then check_row("with: " .. name, name, row) end
  end
  return core.model_with(model, rows)
end)

--- A file in C (the rates as a function) or in LaTeX (the equation and its parameters), by the path's ending.
core.add_method("lunid.model", "export", function(model, path)
  if type(path) ~= "string" then schema.fail("export", "expected a path, got " .. core.describe(path)) end
  if path:match "%.c$" then return output.write(path, model:c_code()) end
  if not path:match "%.tex$" then schema.fail("export", ("expected a path that ends in .c or .tex, got '%s'"):format(path)) end
  local lines = { "\\begin{gather*}", (model:equation "latex":gsub("\n", " \\\\\n")), "\\end{gather*}" }
  for _, row in ipairs(model.parameters) do
    local deviation = row.std and (" \\pm %.2g"):format(row.std) or ""
    lines[#lines + 1] = ("$%s = %s%s$%s \\\\"):format(core.parse(row.name, "export"):text "latex", row.value
      and core.number_text(row.value) or "?", deviation, row.unit ~= "" and "\\," .. row.unit or "")
  end
  return output.write(path, table.concat(lines, "\n") .. "\n")
end)

--- The force m*a + restoring along the motion of a record, its internal states driven by it: a column.
core.add_method("lunid.model", "force", function(model, record)
  if getmetatable(record) ~= "lunid.record" then
    schema.fail("force", "expected a record, got " .. core.describe(record))
  end
  schema.expect_values("force", model)
  return core.imposed_force(model, record)
end)

models.load = schema.define({
  name = "load",
  help = "Loads a model that model:save wrote, or that is written by hand in the same form.",
  positional = { "path" },
  fields = { { "path", types.string, required = true, help = "a Lua file that returns a lunid.model, or a lunid.history_model" } },
  returns = "model",
  example = [[local model = lunid.load "pile.lua"]],
}, function(given)
  local path = records.find(given.path)
  local chunk = strict.load_file(path)
  core.note_input(path)
  local model = chunk()
  if getmetatable(model) ~= "lunid.model" and getmetatable(model) ~= "lunid.history_model" then
    schema.fail("load", ("'%s' returned %s, not a lunid.model"):format(path, core.describe(model)))
  end
  return model
end)

return models

-- Ensembles: many members of one model, their quantities from grids or random draws; and tables that read back.
local core = require "lunid.core"
local option = require "lunid.option"
local output = require "lunid.output"
local records = require "lunid.records"
local schema = require "lunid.schema"
local types = schema.types

local ensembles = {}

-- ---- what may be varied ----

local range = schema.define({
  name = "range",
  help = "Evenly spaced values from the first to the last, for lunid.ensemble { vary = { ... } }.",
  style = "arguments",
  positional = { "from", "to", "count", "spacing" },
  fields = {
    { "from", types.number(), required = true, help = "first value" },
    { "to", types.number(), required = true, help = "last value" },
    { "count", types.integer { min = 2, max = 10000000 }, required = true, help = "number of values" },
    { "spacing", types.choice { "linear", "log" }, default = "linear", help = "of the values or of their logarithms" },
  },
  returns = "list",
  example = [[vary = { k = lunid.range(1e4, 3e4, 20) }]],
}, function(given)
  if given.spacing == "log" and not (given.from * given.to > 0) then
    schema.fail("range", ("spacing 'log': expected two values of one sign, got %g and %g"):format(given.from, given.to))
  end
  local values = {}
  for i = 1, given.count do
    local part = (i - 1) / (given.count - 1)
    values[i] = given.spacing == "log" and given.from * (given.to / given.from) ^ part
      or given.from + part * (given.to - given.from)
  end
  values[given.count] = given.to
  return values
end)

local function distribution(kind, a, b, words)
  return schema.object("distribution", { kind = kind, a = a, b = b }, nil, function() return words end)
end

--- uniform and log_uniform: between two values.
local function between(name, help, check)
  return schema.define({
    name = name,
    help = help,
    style = "arguments",
    positional = { "from", "to" },
    fields = {
      { "from", types.number(), required = true, help = "least value" },
      { "to", types.number(), required = true, help = "greatest value" },
    },
    returns = "distribution",
    example = ("draw = { k = lunid.%s(1e4, 3e4) }"):format(name),
  }, function(given)
    if given.to <= given.from then
      schema.fail(name, ("to: expected > from, which is %g, got %g"):format(given.from, given.to))
    end
    if check then check(given) end
    return distribution(name, given.from, given.to, ("%s(%g, %g)"):format(name, given.from, given.to))
  end)
end

local uniform = between("uniform", "A random quantity between two values, for lunid.ensemble { draw = { ... } }.")
local log_uniform = between("log_uniform", "A random quantity whose logarithm is uniform between two positive values.",
  function(given)
    if given.from <= 0 then schema.fail("log_uniform", ("from: expected > 0, got %g"):format(given.from)) end
  end)

local normal = schema.define({
  name = "normal",
  help = "A random quantity with a normal distribution, for lunid.ensemble { draw = { ... } }.",
  style = "arguments",
  positional = { "mean", "std" },
  fields = {
    { "mean", types.number(), required = true, help = "mean" },
    { "std", types.number { above = 0 }, required = true, help = "standard deviation" },
  },
  returns = "distribution",
  example = [[draw = { c = lunid.normal(10, 1) }]],
}, function(given) return distribution("normal", given.mean, given.std, ("normal(%g, %g)"):format(given.mean, given.std)) end)

-- ---- members ----

local most_members = 1e7

local function keys_of(given, field)
  for name in pairs(given) do
    if type(name) ~= "string" then
      schema.fail("ensemble: " .. field, ("expected name = %s, got an entry without a name"):format(
        field == "vary" and "{ values }" or "distribution"))
    end
  end
  if next(given) == nil then schema.fail("ensemble: " .. field, "expected 1 quantity or more") end
end

--- The names in an order that does not hang on the table: that of the model's parameters, then that of the
--- excitation's, then the alphabet.
local function ordered(given, field, model, excitation)
  keys_of(given, field)
  local names, seen = {}, {}
  local function take(name)
    if given[name] ~= nil and not seen[name] then names[#names + 1], seen[name] = name, true end
  end
  for _, row in ipairs(model.parameters) do take(row.name) end
  if core.is_expression(excitation) then
    for _, symbol in ipairs(excitation:symbols()) do take(symbol.name) end
  end
  local rest = {}
  for name in pairs(given) do rest[#rest + 1] = name end
  table.sort(rest)
  for _, name in ipairs(rest) do take(name) end
  return names
end

--- A list of numbers, or a column.
local function values_of(name, given)
  local values = given
  if getmetatable(given) == "lunid.column" then values = given:list() end
  if type(given) == "number" then values = { given } end
  if type(values) ~= "table" or getmetatable(values) ~= nil then
    schema.fail("ensemble: vary", ("%s: expected a list of numbers or lunid.range, got %s"):format(name, core.describe(given)))
  end
  if #values == 0 then schema.fail("ensemble: vary", ("%s: expected 1 value or more, got none"):format(name)) end
  for i, value in ipairs(values) do
    if type(value) ~= "number" or value ~= value or value - value ~= 0 then
      schema.fail("ensemble: vary", ("%s: entry %d: expected a finite number, got %s"):format(name, i, core.describe(value)))
    end
  end
  return values
end

--- Every combination; the last quantity changes fastest.
local function full_grid(names, lists)
  local members = 1
  for _, list in ipairs(lists) do members = members * #list end
  if members > most_members then
    schema.fail("ensemble: vary", ("the full grid has %.3g members, more than %g; take fewer values, or draw"):format(
      members, most_members))
  end
  local columns, repeated = {}, members
  for i, list in ipairs(lists) do
    repeated = repeated // #list
    local column = {}
    for m = 0, members - 1 do column[m + 1] = list[m // repeated % #list + 1] end
    columns[i] = column
  end
  return columns
end

local function drawn(given, names)
  local kinds = {}
  for i, name in ipairs(names) do
    local each = given.draw[name]
    if getmetatable(each) ~= "lunid.distribution" then
      schema.fail("ensemble: draw", ("%s: expected lunid.uniform, lunid.normal or lunid.log_uniform, got %s"):format(name,
        core.describe(each)))
    end
    kinds[i] = { kind = each.kind, a = each.a, b = each.b }
  end
  if not given.samples then schema.fail("ensemble", "samples: how many members to draw") end
  return core.draw(given.method, given.samples, given.seed, kinds)
end

--- One record for each member, made by the user's function from the member's values.
local function made_records(given, names, columns)
  local list = {}
  local members = columns[1] and #columns[1] or 1
  for m = 1, members do
    local case = { member = m }
    for i, name in ipairs(names) do case[name] = columns[i][m] end
    local record = given.excitation(case)
    if getmetatable(record) ~= "lunid.record" then
      schema.fail("ensemble: excitation", ("the function gave %s for member %d, expected a record"):format(
        core.describe(record), m))
    end
    list[m] = record
  end
  return list
end

local definition = {
  name = "ensemble",
  help = "Runs many members of one model that differ in parameters, first state or excitation, side by side on all cores "
    .. "(and on all ranks under mpirun). A member that explodes is a result.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "what moves; its values hold where not varied" },
    { "vary", types.table, help = "name = list of values or lunid.range: the full grid of all of them" },
    { "draw", types.table, help = "name = lunid.uniform, lunid.normal or lunid.log_uniform: random members" },
    { "samples", types.integer { min = 1, max = 10000000 }, help = "members to draw" },
    { "method", types.choice { "latin_hypercube", "sobol", "random" }, default = "latin_hypercube",
      help = "how the members are spread" },
    { "seed", types.integer { min = 0 }, help = "of the draw; else that of the run (--seed)" },
    { "excitation", types.either(types.is("record", "lunid.read"), types.expression, types.callable), required = true,
      unit = "N", help = "a record, an expression of lunid.time and of parameters that may be varied, or "
        .. "function(case) giving a record for each member" },
    { "from", types.list(types.number(), 1), help = "first state { y, v, ... } of all members; else rest" },
    { "duration", types.expression, unit = "s",
      help = "length of a run, where the force is an expression; may hold what is varied" },
    { "dt", types.expression, unit = "s",
      help = "sample time, where the force is an expression; may hold what is varied" },
    { "interpolation", types.choice { "hold", "linear", "cubic", "band_limited" },
      help = "what a record's force does between samples; else what the record says, or the model" },
    { "substeps", types.integer { min = 1, max = 1000 }, help = "per sample; else chosen by halving on a few members" },
    { "outputs", types.list(types.string, 1),
      help = "max, min, mean, std, rms, amplitude or last of a signal: \"rms_y\"; else rms and max of the displacements" },
    { "settled", types.number { min = 0, max = 0.99 }, default = 0,
      help = "part of each run before the outputs begin" },
    { "keep", types.choice { "summaries", "trajectories" }, default = "summaries",
      help = "'trajectories' keeps the outputs' signals whole" },
  },
  returns = "sweep",
  example = [[local sweep = lunid.ensemble { model = model, vary = { k = lunid.range(1e4, 3e4, 20) }, excitation = record }]],
}

local begun = 0

--- What the study's own functions (in Lua, tables, surfaces) come from, whose values no key can hold: its files and
--- options, and the ensembles before this one, since what a function refers to may change on the way.
local function origin_of_functions()
  local words = { tostring(begun) }
  for _, input in ipairs(core.inputs()) do words[#words + 1] = input.sha256 end
  for name, value in pairs(option.given) do words[#words + 1] = name .. "=" .. value end
  table.sort(words)
  return table.concat(words, "\n")
end

ensembles.ensemble = schema.define(definition, function(given)
  if given.vary and given.draw then schema.fail("ensemble", "give vary or draw, not both") end
  local field = given.vary and "vary" or "draw"
  local names = given[field] and ordered(given[field], field, given.model, given.excitation) or {}
  local columns = {}
  if given.vary then
    local lists = {}
    for i, name in ipairs(names) do lists[i] = values_of(name, given.vary[name]) end
    columns = full_grid(names, lists)
  elseif given.draw then
    columns = drawn(given, names)
  end
  local request = { names = names, values = columns, from = given.from, outputs = given.outputs, settled = given.settled,
    substeps = given.substeps, interpolation = given.interpolation, keep_trajectories = given.keep == "trajectories",
    partial = output.beside "ensemble-", functions = origin_of_functions() }
  begun = begun + 1
  if type(given.excitation) == "function" then
    for i, column in ipairs(columns) do columns[i] = type(column) == "userdata" and column:list() or column end
    request.records = made_records(given, names, columns)
  elseif getmetatable(given.excitation) == "lunid.record" then
    request.record = given.excitation
  else
    if not given.duration or not given.dt then
      schema.fail("ensemble", "duration and dt are needed where the excitation is an expression")
    end
    request.force, request.duration, request.dt = given.excitation, given.duration, given.dt
  end
  return core.ensemble(given.model, request)
end)

-- ---- tables ----

local function field_text(value)
  if value ~= value then return "" end
  return core.number_text(value)
end

core.add_method("lunid.sweep", "save", function(sweep, path)
  local ending = type(path) == "string" and path:match "%.(%w+)$"
  if ending ~= "csv" and ending ~= "h5" then
    schema.fail("save", "expected a path that ends in .csv or .h5, got " .. core.describe(path))
  end
  local names, columns = sweep.names, {}
  if ending == "h5" then
    for i, name in ipairs(names) do columns[i] = sweep:column(name) end
    core.write_columns(output.place(path), names, columns)
    return output.shown(path)
  end
  for i, name in ipairs(names) do columns[i] = sweep:column(name):list() end
  local lines, cells = { table.concat(names, ",") }, {}
  for row = 1, sweep.members do
    for i, column in ipairs(columns) do cells[i] = field_text(column[row]) end
    lines[row + 1] = table.concat(cells, ",")
  end
  return output.write(path, table.concat(lines, "\n") .. "\n")
end)

local methods = {}

--- The values under a header.
function methods.column(self, name)
  local column = self.columns[name]
  if not column then
    core.raise(("the table has no column '%s'%s"):format(tostring(name),
      core.did_you_mean(core.nearest(tostring(name), self.names)) or "; it has " .. table.concat(self.names, ", ")), "study")
  end
  return column
end

local function fault(path, line, message) core.raise(("%s:%d: %s"):format(path, line, message), "data") end

--- The cells of a line, split at commas.
local function cells_of(line)
  local cells = {}
  for cell in (line:gsub("\r$", "") .. ","):gmatch "([^,]*)," do cells[#cells + 1] = cell:match "^%s*(.-)%s*$" end
  return cells
end

--- The columns under their names.
local function table_of(path, names, lists)
  local columns = {}
  for i, name in ipairs(names) do
    if columns[name] then fault(path, 1, ("two columns of one name: '%s'"):format(name)) end
    if #lists[i] ~= #lists[1] then
      core.raise(("%s: column '%s' has %d values, '%s' has %d"):format(path, name, #lists[i], names[1], #lists[1]), "data")
    end
    columns[name] = lists[i]
  end
  return schema.object("table", { names = names, columns = columns, rows = #lists[1] }, methods, function(self)
    return ("table of %d rows: %s"):format(self.rows, table.concat(self.names, ", "))
  end)
end

ensembles.table = schema.define({
  name = "table",
  help = "Reads the columns of a CSV, HDF5 or MAT file of numbers, such as sweep:save wrote; an empty cell is no number "
    .. "(NaN).",
  positional = { "path" },
  fields = {
    { "path", types.string, required = true, help = "file, beside the study or from the current directory" },
  },
  returns = "table",
  example = [[local rms = lunid.table("sweep.csv"):column "rms_y"]],
}, function(given)
  local path = records.find(given.path)
  if not core.kind_of(path) then core.raise(("%s: no such file"):format(given.path), "data") end
  core.note_input(path)
  local stored, values = core.read_columns(path)
  if stored then return table_of(path, stored, values) end
  local names, lists, number = nil, {}, 0
  for line in (core.read_text(path):gsub("\n?$", "\n")):gmatch "([^\n]*)\n" do
    number = number + 1
    local cells = cells_of(line)
    if not names then
      names = cells
      for i in ipairs(names) do lists[i] = {} end
    elseif #cells ~= #names then
      fault(path, number, ("expected %d cells, got %d"):format(#names, #cells))
    else
      for i, cell in ipairs(cells) do
        local value = cell == "" and 0 / 0 or tonumber(cell)
        if not value then fault(path, number, ("column '%s': expected a number, got '%s'"):format(names[i], cell)) end
        lists[i][number - 1] = value
      end
    end
  end
  for i in ipairs(names) do lists[i] = core.column(lists[i]) end
  return table_of(path, names, lists)
end)

ensembles.public = { ensemble = ensembles.ensemble, table = ensembles.table, range = range, uniform = uniform,
  log_uniform = log_uniform, normal = normal }
return ensembles

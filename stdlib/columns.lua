-- Results that are columns side by side: read one by name, written as CSV, drawn as series.
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"

local columns = {}

--- CSV text of columns, given as pairs of name and column.
function columns.csv(list)
  local names, lines = {}, {}
  for i, column in ipairs(list) do names[i] = column[1] end
  lines[1] = table.concat(names, ",")
  for row = 1, #list[1][2] do
    local cells = {}
    for i, column in ipairs(list) do
      local value = column[2][row]
      cells[i] = value == value and ("%.17g"):format(value) or ""
    end
    lines[#lines + 1] = table.concat(cells, ",")
  end
  return table.concat(lines, "\n") .. "\n"
end

local methods = {}

--- A column by its name.
function methods.column(result, name)
  for _, column in ipairs(result.names) do
    if column == name then return result[name] end
  end
  schema.fail("column", ("%s has no column %s%s"):format(core.describe(result),
    type(name) == "string" and "'" .. name .. "'" or core.describe(name),
    core.did_you_mean(core.nearest(name, result.names)) or " (it has " .. table.concat(result.names, ", ") .. ")"))
end

--- Writes all columns as CSV.
function methods.save(result, path)
  if type(path) ~= "string" then schema.fail("save", "expected a path, got " .. core.describe(path)) end
  local list = {}
  for i, name in ipairs(result.names) do list[i] = { name, result[name] } end
  return output.write(path, columns.csv(list))
end

--- A result: `names` of its columns in order, which are fields of it, with numbers beside them; more methods, if any.
function columns.result(kind, names, fields, to_string, more)
  fields.names = names
  local all = setmetatable(more or {}, { __index = methods })
  return schema.object(kind, fields, all, to_string)
end

return columns

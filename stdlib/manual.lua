-- The sections of docs/language.md, written from the schemas: `lunid help manual` prints them, and a test compares.
local schema = require "lunid.schema"

local manual = {}

--- "`k` | a number (required, [N/m]) | help": the row of a field.
local function row(field)
  return ("| `%s` | %s%s | %s |"):format(field.name, field.type.words, schema.notes(field), field.help)
end

--- One constructor: what it is for, an example, its fields.
function manual.section(definition)
  local lines = { ("### `%s`"):format(schema.spelled(definition)), "", definition.help, "", "```lua", definition.example, "```" }
  local own, shared = {}, {}
  for _, field in ipairs(definition.fields) do
    if field.shared then
      shared[#shared + 1] = "`" .. field.name .. "`"
    else
      own[#own + 1] = row(field)
    end
  end
  if #own > 0 then
    lines[#lines + 1] = "\n| field | type | meaning |\n|---|---|---|\n" .. table.concat(own, "\n")
  end
  if #shared > 0 then  -- fields that the text above all these sections tells
    lines[#lines + 1] = ("\n%s: %s as above."):format(definition.fields[#definition.fields].shared,
      table.concat(shared, ", "))
  end
  lines[#lines + 1] = ("\nGives: %s.\n"):format(definition.returns)
  return table.concat(lines, "\n")
end

--- All of them, in the order of declaration.
function manual.text()
  require "lunid"
  local sections = {}
  for i, definition in ipairs(schema.definitions) do sections[i] = manual.section(definition) end
  return table.concat(sections, "\n")
end

return manual

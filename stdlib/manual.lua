-- The sections of docs/language.md, written from the schemas: `lunid help manual` prints them, and a test compares.
local schema = require "lunid.schema"

local manual = {}

--- "`k` | a number (required, [N/m]) | help": the row of a field.
local function row(field)
  local notes = {}
  if field.required then notes[#notes + 1] = "required" end
  if field.default ~= nil and type(field.default) ~= "table" and field.default ~= "" then
    notes[#notes + 1] = "default " .. tostring(field.default)
  end
  if field.unit then notes[#notes + 1] = "[" .. field.unit .. "]" end
  return ("| `%s` | %s%s | %s |"):format(field.name, field.type.words,
    #notes > 0 and " (" .. table.concat(notes, ", ") .. ")" or "", field.help)
end

--- One constructor: what it is for, an example, its fields.
function manual.section(definition)
  local lines = { ("### `lunid.%s`"):format(definition.name), "", definition.help, "", "```lua", definition.example, "```" }
  if #definition.fields > 0 then
    lines[#lines + 1] = "\n| field | type | meaning |\n|---|---|---|"
    for _, field in ipairs(definition.fields) do lines[#lines + 1] = row(field) end
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

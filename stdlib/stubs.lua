-- Editor stubs (LuaLS annotations), generated from the schemas into stdlib/meta/lunid.lua.
local schema = require "lunid.schema"

local stubs = {}

local plain = { any = true, number = true, string = true }  -- what a function returns that is no type of lunid
local names = { string = "a string", number = "a number", boolean = "true or false" }

--- The annotation's type for a schema type.
local function annotation(type)
  local words = type.words
  for luals, each in pairs(names) do
    if words == each then return luals end
  end
  if words:match "^a number" then return words:match "expression" and "number|lunid.expression" or "number" end
  if words:match "^a whole number" then return "integer" end
  if words:match "^an expression or a number" then return "number|lunid.expression" end
  if words:match "^'" then
    return (words:gsub(" or a list .*", "|table"):gsub("'([^']*)'", '"%1"'):gsub(", ", "|"):gsub(" or ", "|"))
  end
  if words:match "^a list" then return "table" end
  if words:match "^a function" then return "function" end
  local kind = words:match "^an? (%l+)"
  return kind and not words:match " or " and "lunid." .. kind or "any"
end

local function stub(definition)
  local lines = { "", "---" .. definition.help }
  local call = "fields"
  if definition.style == "arguments" then
    for _, field in ipairs(definition.fields) do
      lines[#lines + 1] = ("---@param %s%s %s # %s"):format(field.name, field.required and "" or "?",
        annotation(field.type), field.help)
    end
    call = table.concat(definition.positional, ", ")
  else
    local class = "lunid." .. definition.name:gsub(":", ".") .. ".fields"
    lines[#lines + 1] = "---@class " .. class
    for _, field in ipairs(definition.fields) do
      lines[#lines + 1] = ("---@field %s%s %s # %s"):format(field.name, field.required and "" or "?",
        annotation(field.type), field.help)
    end
    lines[#lines + 1] = "---@param fields " .. class
  end
  lines[#lines + 1] = "---@return " .. (plain[definition.returns] and definition.returns or "lunid." .. definition.returns)
  lines[#lines + 1] = ("function %s(%s) end"):format(schema.spelled(definition), call)
  return table.concat(lines, "\n")
end

--- The whole file.
function stubs.text()
  require "lunid"
  local groups, seen = { "effects = {}" }, {}  -- lunid.effects.<name>: entries of the catalogue
  for _, definition in ipairs(schema.definitions) do
    local group = definition.name:match "^(.*)%."
    if group and not seen[group] then groups[#groups + 1] = group .. " = {}" end
    seen[group or ""] = true
  end
  local lines = { "---@meta", "-- Written from the schemas by `lunid help stubs`; a test compares it with them.",
    "---@class lunid", "local lunid = { " .. table.concat(groups, ", ") .. " }", "---@class lunid.record",
    "local record = {}" }
  for _, definition in ipairs(schema.definitions) do lines[#lines + 1] = stub(definition) end
  lines[#lines + 1] = "\nreturn lunid\n"
  return table.concat(lines, "\n")
end

return stubs

-- What `lunid run STUDY.lua key=value` hands to the study.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local option = { given = {}, read = {} }

local function converted(name, text, default)
  if type(default) == "number" then
    local value = tonumber(text)
    if not value then core.raise(("option: %s: expected a number, got '%s'"):format(name, text), "usage") end
    return value
  elseif type(default) == "boolean" then
    if text ~= "true" and text ~= "false" then
      core.raise(("option: %s: expected true or false, got '%s'"):format(name, text), "usage")
    end
    return text == "true"
  end
  return text
end

--- Takes `key=value` words from the command line.
function option.take(words)
  for _, word in ipairs(words) do
    local key, value = word:match "^([%a_][%w_]*)=(.*)$"
    if not key then core.raise(("expected key=value, got '%s'"):format(word), "usage") end
    option.given[key] = value
  end
end

--- After the study: an option that it never read is an error.
function option.check_all_read()
  local unread, known = {}, {}
  for key in pairs(option.read) do known[#known + 1] = key end
  for key in pairs(option.given) do
    if not option.read[key] then unread[#unread + 1] = key end
  end
  table.sort(unread)
  table.sort(known)
  if #unread == 0 then return end
  core.raise(("the study has no option '%s'%s"):format(unread[1], core.did_you_mean(core.nearest(unread[1], known)) or ""),
    "usage")
end

option.public = {
  option = schema.define({
    name = "option",
    help = "A value that `lunid run STUDY.lua key=value` may set.",
    positional = { "name", "default" },
    fields = {
      { "name", types.string, required = true, help = "the key on the command line" },
      { "default", types.any, required = true, help = "value without the key; its type is the option's type" },
    },
    returns = "any",
    example = [[local amplitude = lunid.option { "amplitude", 2.5 }]],
  }, function(given)
    option.read[given.name] = true
    local text = option.given[given.name]
    if text == nil then return given.default end
    return converted(given.name, text, given.default)
  end),
}

return option

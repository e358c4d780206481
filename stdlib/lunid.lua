-- The module `lunid`: everything that a study may call.
local core = require "lunid.core"

local public = { version = core.version }

for _, room in ipairs { "symbols", "records", "models", "constraints", "regression", "simulation", "effect",
  "discovery", "figures", "option" } do
  local exported = require("lunid." .. room)
  for name, value in pairs(exported.public or exported) do
    if name ~= "public" then public[name] = value end
  end
end

local names = {}
for name in pairs(public) do names[#names + 1] = name end
table.sort(names)

return setmetatable({}, {
  __metatable = "lunid",
  __index = function(_, name)
    local value = public[name]
    if value == nil then
      local near = core.nearest(tostring(name), names)
      core.raise(("lunid has no '%s'%s"):format(name, near and (", did you mean '%s'?"):format(near) or ""), "study")
    end
    return value
  end,
  __newindex = function(_, name) core.raise(("lunid.%s cannot be assigned"):format(name), "study") end,
  __pairs = function() return next, public, nil end,
})

-- One name, one type: two types of one name in a namespace share what the linker keeps of their templates.
local spec = require "spec"

local function lines_of(command)
  local pipe, list = io.popen(command), {}
  for line in pipe:lines() do list[#list + 1] = line end
  pipe:close()
  return list
end

--- Calls found(name) for each type that a file defines outside its functions, other types and unnamed namespaces.
local function each_type(path, found)
  local within = {}
  for line in io.lines(path) do
    local opened = line:match "^namespace%s*([%w_:]*)%s*{"
    if opened then
      within[#within + 1] = opened
    elseif line:match "^}%s*// namespace" then
      within[#within] = nil
    else
      local text = line:gsub("^template%s*<.->%s*", "")
      local name, rest = text:match "^struct%s+([%w_]+)(.*)$"
      if not name then name, rest = text:match "^class%s+([%w_]+)(.*)$" end
      if not name then name, rest = text:match "^enum class%s+([%w_]+)(.*)$" end
      local hidden = false
      for _, namespace in ipairs(within) do hidden = hidden or namespace == "" end
      if name and not hidden and not rest:match "^::" and not rest:match "^[^{]*;%s*" and not rest:match "^<" then
        found(table.concat(within, "::") .. "::" .. name)
      end
    end
  end
end

spec.case("no two files of the runtime and the bindings define types of one name", function()
  local first, twice, count = {}, {}, 0
  for _, path in ipairs(lines_of "find runtime bindings -name '*.[hc]pp' | sort") do
    each_type(path, function(name)
      if first[name] then twice[#twice + 1] = ("%s is defined in %s and in %s"):format(name, first[name], path) end
      first[name], count = path, count + 1
    end)
  end
  spec.equal(table.concat(twice, "\n"), "")
  assert(count > 400, "only " .. count .. " types were found")
end)

spec.finish()

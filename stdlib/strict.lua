-- The environment of a study: reading or writing an undeclared global is an error with its name and line.
local core = require "lunid.core"

local strict = {}

-- What a study may use of Lua itself. `load` and friends would leave the strict environment.
local allowed = { "assert", "coroutine", "error", "getmetatable", "io", "ipairs", "math", "next", "os", "pairs",
  "pcall", "print", "rawequal", "rawget", "rawlen", "rawset", "select", "setmetatable", "string", "table", "tonumber",
  "tostring", "type", "utf8", "xpcall", "_VERSION" }

local loaded = {}  -- the study's own modules, by path

local function is_number(x) return type(x) == "number" or type(x) == "string" and tonumber(x) ~= nil end

--- Raises where an argument of math.<name> is no number.
local function refuse(name, ...)
  local texts, culprit = {}, nil
  for i = 1, select("#", ...) do
    local argument = select(i, ...)
    texts[i] = tostring(argument)
    if not is_number(argument) and (culprit == nil or core.is_expression(argument)) then culprit = argument end
  end
  if not core.is_expression(culprit) then
    core.raise(("math.%s: expected a number, got %s"):format(name, core.describe(culprit)), "study")
  end
  core.raise(("math.%s: expected a number, got an expression: %s"):format(name, core.functions[name]
    and ("write lunid.%s(%s)"):format(name, table.concat(texts, ", ")) or "the language has no such function"), "study")
end

--- Lua's math for a study: of an expression it says which function of the language to write.
local function math_of_numbers()
  local functions = {}
  for name, f in pairs(math) do functions[name] = f end
  for _, name in ipairs { "abs", "acos", "asin", "ceil", "cos", "deg", "exp", "floor", "rad", "sin", "sqrt", "tan" } do
    local f = math[name]
    functions[name] = function(x)
      if not is_number(x) then refuse(name, x) end
      return f(x)
    end
  end
  for _, name in ipairs { "atan", "log", "max", "min" } do
    local f = math[name]
    functions[name] = function(x, ...)
      local good = is_number(x)
      for i = 1, select("#", ...) do good = good and is_number((select(i, ...))) end
      if not good then refuse(name, x, ...) end
      return f(x, ...)
    end
  end
  return functions
end

local study_math = math_of_numbers()

--- Names that are in sight of the study's innermost frame, for "did you mean".
local function names_in_sight(environment)
  local names = {}
  for name in pairs(environment) do names[#names + 1] = name end
  table.sort(names)
  for level = 3, 6 do
    local info = debug.getinfo(level, "Sf")
    if info and info.what ~= "C" then
      for i = 1, 200 do
        local name = debug.getlocal(level, i)
        if not name then break end
        names[#names + 1] = name
      end
      for i = 1, 60 do
        local name = debug.getupvalue(info.func, i)
        if not name then break end
        names[#names + 1] = name
      end
      break
    end
  end
  return names
end

--- A fresh environment. `folder`: where the study's own modules are.
function strict.environment(folder)
  local environment = {}
  for _, name in ipairs(allowed) do environment[name] = _G[name] end
  environment.math = study_math
  function environment.require(name)
    if name == "lunid" or type(name) ~= "string" then return require(name) end
    local path = (folder ~= "" and folder .. "/" or "") .. name:gsub("%.", "/") .. ".lua"
    if not core.kind_of(path) then
      core.raise(("require: no module '%s' (looked for '%s')"):format(name, path), "study")
    end
    if loaded[path] == nil then
      local chunk = strict.load_file(path)
      core.note_input(path)
      local module = chunk()
      loaded[path] = module == nil and true or module
    end
    return loaded[path]
  end
  return setmetatable(environment, {
    __metatable = "locked",
    __index = function(_, name) core.raise(strict.words_of_undeclared(tostring(name), names_in_sight(environment)), "study") end,
    __newindex = function(_, name)
      core.raise(("assignment to the undeclared name '%s'; write `local %s = ...`"):format(name, name), "study")
    end,
  })
end

--- What is said of a name that is not declared; `names`: those that are.
function strict.words_of_undeclared(name, names)
  local said = ("undeclared name '%s'"):format(name)
  if name == "lunid" then return said .. "; begin with local lunid = require \"lunid\"" end
  if core.functions[name] then return ("%s, did you mean lunid.%s?"):format(said, name) end
  return said .. (core.did_you_mean(core.nearest(name, names)) or "")
end

--- Compiles a file for a fresh strict environment; messages carry its path as given.
function strict.load_file(path)
  local chunk, message = load(core.read_text(path), "@" .. path, "t", strict.environment(core.parent_of(path)))
  if not chunk then core.raise(message, "study") end
  return chunk
end

return strict

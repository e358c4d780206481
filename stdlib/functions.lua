-- Functions that the language does not hold: a user's own in Lua, and tables of values. Called with expressions they
-- give an expression.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local functions = {}

functions.lua_function = schema.define({
  name = "lua_function",
  help = "A function in Lua as a last resort, where the language has no words for it: damper(y, v) then stands in models "
    .. "and regressions like any expression. It is slow, runs on one thread, and is taken for smooth.",
  positional = { "name", "call" },
  fields = {
    { "name", types.string, required = true, help = "how it is written in equations" },
    { "call", types.callable, required = true, help = "function of 1 to 4 numbers that returns a number" },
    { "gradient", types.callable,
      help = "function of the same numbers that returns the derivative by each; else by central differences" },
    { "scale", types.list(types.number { above = 0 }, 1),
      help = "size of each argument below which differences take it for 0; else 1e-3" },
  },
  returns = "function",
  example = [[
local damper = lunid.lua_function { "damper", function(y, v) return 20*v*math.exp(-y*y) end }
local model = lunid.model { mass = 1, restoring = k*y + damper(y, v) }]],
}, function(given)
  schema.check_name("lua_function", given.name)
  given.place = core.place()
  return core.lua_function(given)
end)

local row = types.list(types.number(), 1)

functions.lookup = schema.define({
  name = "lookup",
  help = "A table of values as a function of one or two variables. Beyond its ends it goes on straight.",
  positional = { "name" },
  fields = {
    { "name", types.string, required = true, help = "how it is written in equations" },
    { "axes", types.list(row, 1), required = true, help = "one list of increasing values, or two" },
    { "values", types.list(types.either(types.number(), row), 1), required = true,
      help = "one number for each point; with two axes a list over the second axis for each point of the first" },
    { "between", types.choice { "linear", "cubic" }, default = "linear",
      help = "the points: straight lines, or a spline without a jump in its first and second derivatives" },
  },
  returns = "function",
  example = [[
local spring = lunid.lookup { "spring", axes = { { -0.01, 0, 0.02 } }, values = { -90, 0, 210 } }
local model = lunid.model { mass = 1, restoring = spring(y) + c*v }]],
}, function(given)
  schema.check_name("lookup", given.name)
  for i, value in ipairs(given.values) do
    if type(value) == "number" then given.values[i] = { value } end
  end
  return core.lookup(given)
end)

return functions

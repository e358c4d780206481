-- Symbols: signals, parameters, internal states, and the functions of the language.
local core = require "lunid.core"
local schema = require "lunid.schema"
local units = require "lunid.units"
local types = schema.types

local symbols = {
  displacement = core.channel "y",
  velocity = core.channel "v",
  acceleration = core.channel "a",
  time = core.channel "t",
  force = core.channel "F",
  base_displacement = core.channel "yb",
  base_velocity = core.channel "vb",
  base_acceleration = core.channel "ab",
  shaft_angle = core.channel "shaft_angle",
  shaft_speed = core.channel "shaft_speed",
  shaft_rate = core.channel "shaft_rate",
  force_rate = core.channel "force_rate",
  pi = math.pi,
}

--- sin cos ... where, and the conditions greater, less, greater_equal, less_equal.
for name, f in pairs(core.functions) do symbols[name] = f end

--- local y1, y2 = lunid.displacements(2)
local function numbered(name, letter, words)
  symbols[name] = schema.define({
    name = name,
    help = ("The %s of the coordinates of a model of several degrees of freedom, as so many values."):format(words),
    style = "arguments",
    positional = { "count" },
    fields = { { "count", types.integer { min = 1, max = 100000 }, required = true, help = "number of coordinates" } },
    returns = "expressions",
    example = ("local %s1, %s2 = lunid.%s(2)"):format(letter, letter, name),
  }, function(given)
    local all = {}
    for i = 1, given.count do all[i] = core.channel(letter .. i) end
    return table.unpack(all)
  end)
end
numbered("displacements", "y", "displacements")
numbered("velocities", "v", "velocities")
numbered("accelerations", "a", "accelerations")
numbered("forces", "F", "forces")

symbols.parameter = schema.define({
  name = "parameter",
  help = "An unknown number to fit. It stands in expressions as a symbol.",
  positional = { "name", "value" },
  fields = {
    { "name", types.string, required = true, help = "how it is written in equations and results" },
    { "value", types.number(), help = "first guess; lunid.discover reads one off the data where there is none, and regress and fit_curve search between min and max; runs and fits on the trajectory need one" },
    { "min", types.number(), help = "least admissible value" },
    { "max", types.number(), help = "largest admissible value" },
    { "unit", types.string, default = "", help = "SI unit, such as \"N/m\"; one of another size, such as kN/m, is refused" },
    { "fixed", types.boolean, default = false, help = "held at its value" },
    { "std", types.number { min = 0 }, help = "standard deviation, in a saved model" },
  },
  returns = "expression",
  example = [[local k = lunid.parameter { "k", 2e4, min = 0, unit = "N/m" }]],
}, function(given)
  schema.check_name("parameter", given.name)
  schema.check_bounds("parameter: " .. given.name, given)
  local problem = units.problem(given.unit)
  if problem then schema.fail("parameter: " .. given.name .. ": unit", problem) end
  local value = given.value
  if value and (value < (given.min or value) or value > (given.max or value)) then
    schema.fail("parameter: " .. given.name, ("value: expected within %g to %g, got %g"):format(
      given.min or -math.huge, given.max or math.huge, value))
  end
  given.place = core.place()
  return core.parameter(given)
end)

symbols.state = schema.define({
  name = "state",
  help = "An internal state z with a rate of its own. Held at a bound while its rate pushes outward.",
  positional = { "name" },
  fields = {
    { "name", types.string, required = true, help = "how it is written in equations and results" },
    { "rate", types.either(types.expression, types.callable), required = true,
      help = "dz/dt; function(z) return ... end where the rate holds z itself" },
    { "initial", types.number(), default = 0, help = "value at the start of a run" },
    { "min", types.expression, help = "lower bound; may follow the motion" },
    { "max", types.expression, help = "upper bound; may follow the motion" },
    { "anchored", types.boolean, default = false,
      help = "a fit takes it to be `initial` where the first record begins: for a state that only adds up, such as a path" },
  },
  returns = "expression",
  example = [[local z = lunid.state { "z", rate = function(z) return v - 40*lunid.abs(v)*z end }]],
}, function(given)
  schema.check_name("state", given.name)
  if type(given.rate) == "function" then
    given.rate = given.rate(core.state_symbol(given.name))
    if not types.expression.check(given.rate) then
      schema.fail("state: " .. given.name,
        "rate: expected the function to return an expression, got " .. core.describe(given.rate))
    end
  end
  given.place = core.place()
  return core.state(given)
end)

return symbols

-- What is known about the coefficients of a regression.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local function constraint(given, text)
  given.place = core.place()
  return schema.object("constraint", given, nil, function() return text end)
end

local feature = { "feature", types.expression, required = true, help = "the feature whose coefficient is meant" }
local bound = types.either(types.number(), types.expression)

local function against(name, help, word)
  return schema.define({
    name = name,
    help = help,
    style = "arguments",
    positional = { "feature", "bound" },
    fields = { feature, { "bound", bound, required = true, help = "a number, or another feature, whose coefficient is meant" } },
    returns = "constraint",
    example = ("lunid.%s(v, 10)"):format(name),
  }, function(given)
    given.kind = name
    return constraint(given, ("%s %s %s"):format(given.feature, word, given.bound))
  end)
end

return {
  at_least = against("at_least", "The coefficient is at least a bound.", ">="),
  at_most = against("at_most", "The coefficient is at most a bound.", "<="),
  fixed = schema.define({
    name = "fixed",
    help = "The coefficient has a known value.",
    style = "arguments",
    positional = { "feature", "value" },
    fields = { feature, { "value", types.number(), required = true, help = "its value" } },
    returns = "constraint",
    example = "lunid.fixed(v, 10)",
  }, function(given)
    given.kind = "fixed"
    return constraint(given, ("%s = %s"):format(given.feature, given.value))
  end),
  between = schema.define({
    name = "between",
    help = "The coefficient lies between two values.",
    style = "arguments",
    positional = { "feature", "lower", "upper" },
    fields = { feature, { "lower", types.number(), required = true, help = "least value" },
      { "upper", types.number(), required = true, help = "largest value" } },
    returns = "constraint",
    example = "lunid.between(y^3, 0, 2e6)",
  }, function(given)
    if given.lower > given.upper then
      schema.fail("between", ("upper: expected >= %g, got %g"):format(given.lower, given.upper))
    end
    given.kind = "between"
    return constraint(given, ("%s <= %s <= %s"):format(given.lower, given.feature, given.upper))
  end),
}

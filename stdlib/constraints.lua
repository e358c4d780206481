-- What is known about the coefficients of a regression: bounds and linear relations, choices, passivity.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local constraints = {}

-- ---- coefficients, and sums of them ----

local sum_type

local function is_sum(value) return getmetatable(value) == "lunid.coefficient" end

--- terms: list of { feature =, weight = }, each feature once; constant: what is added.
local function new_sum(terms, constant) return setmetatable({ terms = terms, constant = constant or 0 }, sum_type) end

local function as_sum(value)
  if is_sum(value) then return value end
  if type(value) == "number" then return new_sum({}, value) end
  schema.fail("coefficient", "expected a coefficient or a number beside a coefficient, got " .. core.describe(value)
    .. "; write lunid.coefficient(feature)")
end

local function scaled(sum, factor)
  local terms = {}
  for i, term in ipairs(sum.terms) do terms[i] = { feature = term.feature, weight = factor * term.weight } end
  return new_sum(terms, factor * sum.constant)
end

local function added(a, b)
  a, b = as_sum(a), as_sum(b)
  local terms, place = {}, {}
  for _, sum in ipairs { a, b } do
    for _, term in ipairs(sum.terms) do
      local key = tostring(term.feature)
      if place[key] then
        place[key].weight = place[key].weight + term.weight
      else
        place[key] = { feature = term.feature, weight = term.weight }
        terms[#terms + 1] = place[key]
      end
    end
  end
  local kept = {}
  for _, term in ipairs(terms) do
    if term.weight ~= 0 then kept[#kept + 1] = term end
  end
  return new_sum(kept, a.constant + b.constant)
end

local function number_beside(a, b, operation)
  local sum, factor = a, b
  if type(a) == "number" then sum, factor = b, a end
  if type(factor) ~= "number" or not is_sum(sum) then
    schema.fail("coefficient", ("a constraint is linear: expected a coefficient %s a number"):format(operation))
  end
  return sum, factor
end

local function text_of(sum)
  local text = ""
  for _, term in ipairs(sum.terms) do
    local size = math.abs(term.weight)
    text = text .. (text == "" and (term.weight < 0 and "-" or "") or term.weight < 0 and " - " or " + ")
      .. (size == 1 and "" or ("%g*"):format(size)) .. ("[%s]"):format(term.feature)
  end
  if sum.constant ~= 0 or text == "" then text = text .. (text == "" and "" or " + ") .. ("%g"):format(sum.constant) end
  return text
end

sum_type = {
  __metatable = "lunid.coefficient",
  __words = "a coefficient",
  __add = added,
  __sub = function(a, b) return added(a, scaled(as_sum(b), -1)) end,
  __unm = function(a) return scaled(a, -1) end,
  __mul = function(a, b)
    local sum, factor = number_beside(a, b, "times")
    return scaled(sum, factor)
  end,
  __div = function(a, b)
    if not is_sum(a) then number_beside(nil, nil, "over") end
    local sum, factor = number_beside(a, b, "over")
    return scaled(sum, 1 / factor)
  end,
  __tostring = text_of,
}

constraints.coefficient = schema.define({
  name = "coefficient",
  help = "The coefficient of a feature, for linear relations between coefficients; sums, differences and multiples of them "
    .. "may stand where a feature may.",
  style = "arguments",
  positional = { "feature" },
  fields = { { "feature", types.expression, required = true, help = "the feature whose coefficient is meant" } },
  returns = "coefficient",
  example = "local k1, k3 = lunid.coefficient(y), lunid.coefficient(y^3)\nlunid.at_most(2*k1 + k3, 5)",
}, function(given) return new_sum { { feature = given.feature, weight = 1 } } end)

-- ---- bounds and relations ----

local side = types.either(types.expression, types.is("coefficient", "lunid.coefficient"))

local function side_sum(value)
  if is_sum(value) then return value end
  if core.is_expression(value) then return new_sum { { feature = value, weight = 1 } } end
  return new_sum({}, value)
end

local function constraint(given, text)
  given.kind, given.place = given.kind or "bound", core.place()
  return schema.object("constraint", given, nil, function() return text end)
end

--- left - right within the bounds, the numbers moved to them.
local function relation(name, left, right, lower, upper, text)
  local sum = added(side_sum(left), scaled(side_sum(right), -1))
  if #sum.terms == 0 then schema.fail(name, "expected a feature or a coefficient on one side at least") end
  return constraint({ terms = sum.terms, lower = lower and lower - sum.constant, upper = upper and upper - sum.constant },
    text)
end

local feature = { "feature", side, required = true, help = "a feature, whose coefficient is meant, or a sum of coefficients" }

local function against(name, help, word, lower, upper)
  return schema.define({
    name = name,
    help = help,
    style = "arguments",
    positional = { "feature", "bound" },
    fields = { feature, { "bound", side, required = true, help = "a number, another feature, or a sum of coefficients" } },
    returns = "constraint",
    example = ("lunid.%s(v, 10)"):format(name),
  }, function(given)
    return relation(name, given.feature, given.bound, lower, upper,
      ("%s %s %s"):format(given.feature, word, given.bound))
  end)
end

constraints.at_least = against("at_least", "The coefficient is at least a bound.", ">=", 0, nil)
constraints.at_most = against("at_most", "The coefficient is at most a bound.", "<=", nil, 0)

constraints.fixed = schema.define({
  name = "fixed",
  help = "The coefficient has a known value.",
  style = "arguments",
  positional = { "feature", "value" },
  fields = { feature, { "value", types.number(), required = true, help = "its value" } },
  returns = "constraint",
  example = "lunid.fixed(v, 10)",
}, function(given)
  return relation("fixed", given.feature, 0, given.value, given.value, ("%s = %s"):format(given.feature, given.value))
end)

constraints.between = schema.define({
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
  return relation("between", given.feature, 0, given.lower, given.upper,
    ("%s <= %s <= %s"):format(given.lower, given.feature, given.upper))
end)

-- ---- choices and passivity ----

constraints.one_of = schema.define({
  name = "one_of",
  help = "At most one of these features, or `at_most` of them, has a coefficient; every choice is tried and the one of "
    .. "least BIC is taken.",
  style = "arguments",
  positional = { "features", "at_most" },
  fields = { { "features", types.list(types.expression, 2), required = true, help = "features of the regression" },
    { "at_most", types.integer { min = 1 }, default = 1, help = "how many of them" } },
  returns = "constraint",
  example = "lunid.one_of { y^3, y^5, lunid.tanh(80*y) }",
}, function(given)
  given.kind = "group"
  return constraint(given, ("at most %d of %d features"):format(given.at_most, #given.features))
end)

constraints.passive = schema.define({
  name = "passive",
  help = "The force creates no energy: v*(f(y, v) - f(y, 0)) >= 0 at the points of a grid over the range of the data.",
  fields = {
    { "points", types.list(types.integer { min = 2, max = 100 }, 2), default = { 9, 8 }, help = "along displacement and velocity" },
    { "impose", types.boolean, default = true, help = "false: it is looked at and reported only" },
  },
  returns = "constraint",
  example = "constraints = { lunid.passive { points = { 21, 10 } } }",
}, function(given)
  given.kind, given.points_y, given.points_v = "passive", given.points[1], given.points[2]
  return constraint(given, given.impose and "passive" or "passivity looked at")
end)

return constraints

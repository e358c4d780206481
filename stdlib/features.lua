-- Sets of features. A set remembers the file and line where it was made; the product of two sets is the set of all
-- products. Sets that need the range of the data are made when a regression gives it.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local features = { public = {} }
local public = features.public

local new_set

--- The entries of a set, or an expression as a list of one.
local function entries(value, range)
  if getmetatable(value) ~= "lunid.features" then return { value } end
  return value.build and value.build(range) or value
end

local function product(a, b)
  local function build(range)
    local list = {}
    for _, first in ipairs(entries(a, range)) do
      for _, second in ipairs(entries(b, range)) do list[#list + 1] = core.product(first, second) end
    end
    return list
  end
  local late = type(a) == "table" and a.build or type(b) == "table" and b.build
  return late and new_set(nil, build) or new_set(build())
end

local set_type = {
  __metatable = "lunid.features",
  __words = "a features",
  __mul = function(a, b)
    for _, each in ipairs { a, b } do
      if getmetatable(each) ~= "lunid.features" and not types.expression.check(each) then
        schema.fail("features", "expected a set, an expression or a number as factor, got " .. core.describe(each))
      end
    end
    return product(a, b)
  end,
  __tostring = function(self)
    return self.build and "features over the range of the data" or ("%d features"):format(#self)
  end,
}

--- A set from its list, or from what makes it of the range of each variable.
function new_set(list, build)
  list = list or {}
  list.place, list.build = core.place(), build
  return setmetatable(list, set_type)
end

--- The features of a list of expressions and sets, laid flat, each once: the features, their places, and what is said
--- of those given twice. `range(variable)` gives least and largest value.
function features.flat(list, range, place)
  local flat, places, first, notes = {}, {}, {}, {}
  for _, entry in ipairs(list) do
    local is_set = getmetatable(entry) == "lunid.features"
    local where = is_set and entry.place or place
    for _, feature in ipairs(entries(entry, range)) do
      local key = tostring(feature)
      if first[key] then
        notes[#notes + 1] = ("the feature '%s' of %s is given again at %s: it is taken once"):format(key, first[key], where)
      else
        first[key] = where
        flat[#flat + 1], places[#places + 1] = feature, where
      end
    end
  end
  return flat, places, notes
end

--- A symbol's power, product by product: all exponents whose sum and size `fits`, by falling first exponents.
local function monomials(variables, order, fits)
  local list = {}
  local function add(variable, left, term, powers)
    if variable > #variables then
      if term and left == 0 and fits(powers) then list[#list + 1] = term end
      return
    end
    for power = math.min(left, order), 0, -1 do
      local factor = power > 0 and variables[variable] ^ power or nil
      powers[variable] = power
      add(variable + 1, left - power, factor and (term and term * factor or factor) or term, powers)
    end
  end
  return list, add
end

local function sum_of(powers)
  local sum = 0
  for _, power in ipairs(powers) do sum = sum + power end
  return sum
end

local polynomial_options = {
  name = "polynomials: options",
  fields = {
    { name = "constant", type = types.boolean, default = false },
    { name = "keep", type = types.choice { "all", "odd", "even" }, default = "all" },
    { name = "degree", type = types.choice { "total", "tensor" }, default = "total" },
  },
}

local variables_field = { "variables", types.list(types.expression, 1), required = true, help = "such as { y, v }" }

public.polynomials = schema.define({
  name = "polynomials",
  help = "All products of powers of the variables up to an order, without the constant unless asked for.",
  style = "arguments",
  positional = { "variables", "order", "options" },
  fields = {
    variables_field,
    { "order", types.integer { min = 1, max = 20 }, required = true, help = "largest sum of the powers" },
    { "options", types.either(types.boolean, types.table), default = false,
      help = "true: the constant 1 first; or a table: constant = true, keep = \"odd\" or \"even\" (sum of the powers), "
        .. "degree = \"tensor\" (each power up to the order)" },
  },
  returns = "features",
  example = [[features = { lunid.polynomials({ y, v }, 5), lunid.polynomials({ y }, 9, { keep = "odd" }) }]],
}, function(given)
  local options = type(given.options) == "table" and schema.validate(polynomial_options, given.options)
    or { constant = given.options, keep = "all", degree = "total" }
  local parity = options.keep == "odd" and 1 or options.keep == "even" and 0
  local list, add = monomials(given.variables, given.order, function(powers)
    return not parity or sum_of(powers) % 2 == parity
  end)
  if options.constant then list[1] = 1 end
  local largest = options.degree == "tensor" and given.order * #given.variables or given.order
  for sum = 1, largest do add(1, sum, nil, {}) end
  return new_set(list)
end)

--- Coefficients of T_n or U_n in powers of x, lowest first.
local function chebyshev_coefficients(n, second)
  local before, now = { 1 }, { 0, second and 2 or 1 }
  if n == 0 then return before end
  for _ = 2, n do
    local next_one = { 0 }
    for i, c in ipairs(now) do next_one[i + 1] = 2 * c end
    for i, c in ipairs(before) do next_one[i] = next_one[i] - c end
    before, now = now, next_one
  end
  return now
end

local function polynomial(coefficients, x)
  local sum
  for power = #coefficients - 1, 0, -1 do
    local c = coefficients[power + 1]
    if c ~= 0 then
      local term = power == 0 and c or power == 1 and c * x or c * x ^ power
      sum = sum and sum + term or term
    end
  end
  return sum
end

--- Normalised variables of all sets so far, each once: they are numbers without a unit.
features.numbers = {}
local known_numbers = {}

--- (x - middle) / half, which runs over -1 .. 1 in the range.
local function normalised(variable, low, high)
  local middle, half = (low + high) / 2, (high - low) / 2
  local moved = middle == 0 and variable or variable - middle
  local number = moved / half
  local key = tostring(number)
  if half ~= 1 and not known_numbers[key] then
    known_numbers[key] = true
    features.numbers[#features.numbers + 1] = number
  end
  return number
end

local range_type = types.list(types.list(types.number(), 2), 1)

local function check_ranges(where, given)
  if not given.range then return end
  if #given.range ~= #given.variables then
    schema.fail(where, ("range: expected %d pairs, one for each variable, got %d"):format(#given.variables, #given.range))
  end
  for i, pair in ipairs(given.range) do
    if #pair ~= 2 or not (pair[1] < pair[2]) then
      schema.fail(where, ("range: entry %d: expected { least, largest }"):format(i))
    end
  end
end

--- Makes a set at once where the ranges are given, else over the data's.
local function ranged(given, make)
  if given.range then return new_set(make(function(i) return given.range[i][1], given.range[i][2] end)) end
  return new_set(nil, function(range) return make(function(i) return range(given.variables[i]) end) end)
end

local range_field = { "range", range_type, help = "{ { least, largest }, ... } of each variable; else that of the data" }

public.chebyshev = schema.define({
  name = "chebyshev",
  help = "Products of Chebyshev polynomials of the variables, each normalised to -1 to 1 over its range; without the constant.",
  style = "arguments",
  positional = { "variables", "order", "kind", "range" },
  fields = {
    variables_field,
    { "order", types.integer { min = 1, max = 12 }, required = true, help = "largest sum of the orders" },
    { "kind", types.choice { "T", "U" }, default = "T", help = "first or second kind" },
    range_field,
  },
  returns = "features",
  example = [[features = { lunid.chebyshev({ y, v }, 4) }]],
}, function(given)
  check_ranges("chebyshev", given)
  return ranged(given, function(range)
    local basis = {}
    for i, variable in ipairs(given.variables) do
      local x = normalised(variable, range(i))
      basis[i] = function(n) return polynomial(chebyshev_coefficients(n, given.kind == "U"), x) end
    end
    local list = {}
    local function add(variable, left, term)
      if variable > #basis then
        if left == 0 then list[#list + 1] = term end
        return
      end
      for order = left, 0, -1 do
        local factor = order > 0 and basis[variable](order) or nil
        add(variable + 1, left - order, factor and (term and term * factor or factor) or term)
      end
    end
    for order = 1, given.order do add(1, order, nil) end
    return list
  end)
end)

--- A set of functions of one variable, one for each number of a list.
local function family(definition, make)
  definition.style = "arguments"
  definition.returns = "features"
  return schema.define(definition, function(given) return new_set(make(given)) end)
end

local variable_field = { "variable", types.expression, required = true, help = "such as y" }

local function each(list, make)
  local all = {}
  for i, value in ipairs(list) do all[i] = make(value) end
  return all
end

local factor_list = types.list(types.expression, 1)

public.fourier = family({
  name = "fourier",
  help = "sin(k*w*x) and cos(k*w*x) for k from 1 to the order.",
  positional = { "variable", "order", "wave" },
  fields = { variable_field,
    { "order", types.integer { min = 1, max = 50 }, required = true, help = "number of harmonics" },
    { "wave", types.expression, required = true, help = "w: a number, or a parameter to be searched for" } },
  example = [[features = { lunid.fourier(y, 2, lunid.parameter { "A", 800, min = 100, max = 3000 }) }]],
}, function(given)
  local all = {}
  for k = 1, given.order do
    local phase = (k == 1 and given.wave or k * given.wave) * given.variable
    all[#all + 1], all[#all + 2] = core.functions.sin(phase), core.functions.cos(phase)
  end
  return all
end)

public.tanhs = family({
  name = "tanhs",
  help = "tanh(s*x) for each s: springs that yield, smoothed friction.",
  positional = { "variable", "slopes" },
  fields = { variable_field, { "slopes", factor_list, required = true, help = "numbers, or parameters to be searched for" } },
  example = [[features = { y, v, lunid.tanhs(y, { 50, 200 }) }]],
}, function(given)
  return each(given.slopes, function(s) return core.functions.tanh(s * given.variable) end)
end)

public.exponentials = family({
  name = "exponentials",
  help = "exp(r*x) for each r.",
  positional = { "variable", "rates" },
  fields = { variable_field, { "rates", factor_list, required = true, help = "numbers, or parameters to be searched for" } },
  example = [[features = { y, lunid.exponentials(y, { -100, 100 }) }]],
}, function(given)
  return each(given.rates, function(r) return core.functions.exp(r * given.variable) end)
end)

public.powers = family({
  name = "powers",
  help = "sign(x)*abs(x)^p for each exponent p: odd powers that need not be whole.",
  positional = { "variable", "exponents" },
  fields = { variable_field,
    { "exponents", types.list(types.number { above = 0 }, 1), required = true, help = "such as { 0.5, 1.5 }" } },
  example = [[features = { y, v, lunid.powers(v, { 0.5, 1.5 }) }]],
}, function(given)
  return each(given.exponents, function(p)
    return core.functions.sign(given.variable) * core.functions.abs(given.variable) ^ p
  end)
end)

public.piecewise = family({
  name = "piecewise",
  help = "What bends, or jumps, at each knot: max(x - knot, 0)^degree, or for degree 0 a step. Clearances and stops.",
  positional = { "variable", "knots", "degree" },
  fields = { variable_field,
    { "knots", types.list(types.number(), 1), required = true, help = "places in units of the variable" },
    { "degree", types.integer { min = 0, max = 5 }, default = 1, help = "1: the slope changes; 0: the value jumps" } },
  example = [[features = { y, v, lunid.piecewise(y, { -1e-3, 1e-3 }) }]],
}, function(given)
  return each(given.knots, function(knot)
    local beyond = knot == 0 and given.variable or given.variable - knot
    if given.degree == 0 then return core.functions.where(core.functions.greater(beyond, 0), 1, 0) end
    return core.functions.max(beyond, 0) ^ given.degree
  end)
end)

public.radial = schema.define({
  name = "radial",
  help = "Gaussian bumps on an even grid over the range of the variables, as wide as their distance times the width.",
  style = "arguments",
  positional = { "variables", "count", "width", "range" },
  fields = {
    variables_field,
    { "count", types.integer { min = 2, max = 30 }, required = true, help = "bumps along each variable" },
    { "width", types.number { above = 0 }, default = 1, help = "in distances between neighbours" },
    range_field,
  },
  returns = "features",
  example = [[features = { y, v, lunid.radial({ y }, 7) }]],
}, function(given)
  check_ranges("radial", given)
  return ranged(given, function(range)
    local list = {}
    local function add(variable, exponent)
      if variable > #given.variables then
        list[#list + 1] = core.functions.exp(-exponent)
        return
      end
      local low, high = range(variable)
      local step = (high - low) / (given.count - 1)
      for k = 0, given.count - 1 do
        local distance = (given.variables[variable] - (low + k * step)) / (given.width * step)
        add(variable + 1, exponent and exponent + distance ^ 2 or distance ^ 2)
      end
    end
    add(1, nil)
    return list
  end)
end)

public.lags = family({
  name = "lags",
  help = "A signal as it was so many samples ago: the features y_lag1, y_lag2 ... of a sampled regression. A regression that "
    .. "keeps one has no continuous model.",
  positional = { "variable", "samples" },
  fields = { { "variable", types.expression, required = true, help = "a signal: y, v, a or the force F" },
    { "samples", types.list(types.integer { min = 1 }, 1), required = true, help = "such as { 1, 2, 3 }" } },
  example = [[features = { lunid.lags(y, { 1, 2 }), lunid.lags(lunid.force, { 1 }) }]],
}, function(given)
  return each(given.samples, function(samples) return core.lag(given.variable, samples) end)
end)

public.features = schema.define({
  name = "features",
  help = "Your own expressions as a set, which remembers its line and can be multiplied.",
  style = "arguments",
  positional = { "list" },
  fields = { { "list", types.list(types.expression, 1), required = true, help = "expressions" } },
  returns = "features",
  example = [[features = { lunid.features { y, v, lunid.abs(v)*v } * lunid.polynomials({ y }, 2, true) }]],
}, function(given) return new_set(given.list) end)

return features

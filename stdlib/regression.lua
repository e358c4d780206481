-- Regressions: F - m*a = sum of coefficient * feature.
local core = require "lunid.core"
local features = require "lunid.features"
local record_list = require "lunid.record_list"
local schema = require "lunid.schema"
local types = schema.types

local regression = { public = {} }
local public = regression.public

public.weak_form = schema.define({
  name = "weak_form",
  help = "Integrates the equation against bumps of short support, so that no derivative of the data is needed.",
  fields = {
    { "half_width", types.number { min = 0 }, default = 0, unit = "s", help = "of the bumps; 0: from the dominant frequency" },
    { "order", types.integer { min = 3, max = 16 }, default = 8, help = "of the bumps (1 - (t/half_width)^2)^order" },
    { "spacing", types.number { above = 0, max = 1 }, default = 0.25, help = "from bump to bump, in half widths" },
  },
  returns = "form",
  example = "local fit = lunid.regress { record = train, mass = 49, features = { y, v, y^3 }, form = lunid.weak_form {} }",
}, function(given)
  return schema.object("form", given, nil, function() return "weak form" end)
end)

--- Least and largest value of an expression over the records.
local function range_over(records)
  return function(variable)
    local name = tostring(variable)
    local low, high = math.huge, -math.huge
    for _, each in ipairs(records) do
      local symbols = core.is_expression(variable) and variable:symbols() or {}
      if #symbols ~= 1 or symbols[1].kind ~= "channel" or symbols[1].name ~= name then
        schema.fail("regress", ("features: the range of '%s' is not known: give it (range = ...) to the set of features"):format(
          name))
      end
      local least, most
      if getmetatable(each) == "lunid.stream" then
        least, most = core.stream_range(each, name)
      else
        local column = each:column(name)
        least, most = column:min(), column:max()
      end
      low, high = math.min(low, least), math.max(high, most)
    end
    if not (low < high) then schema.fail("regress", ("features: '%s' is constant on these data: it has no range"):format(name)) end
    return low, high
  end
end

local searches = { "slsqp", "lbfgs", "mlsl", "direct", "esch", "crs", "isres", "stogo", "annealing", "particle_swarm",
  "puddle_jumping", "monte_carlo", "stochastic_gradient" }

public.search = schema.define({
  name = "search",
  help = "How parameters inside features are searched for between their bounds. Whatever the method, it ends with a local "
    .. "descent along the exact gradient.",
  positional = { "method" },
  fields = {
    { "method", types.choice(searches), default = "slsqp",
      help = "local from several starts: slsqp, lbfgs; of NLopt: mlsl, direct, esch, crs, isres, stogo; Lunid's own: "
        .. "annealing, particle_swarm, puddle_jumping, monte_carlo, stochastic_gradient" },
    { "starts", types.integer { min = 1 }, default = 4, help = "of the local methods, the first guess among them" },
    { "evaluations", types.integer { min = 10 }, default = 500, help = "passes over the data of the other methods" },
    { "seed", types.integer { min = 0 }, help = "of the methods that draw random numbers; else that of the run" },
  },
  returns = "search",
  example = [[search = lunid.search { "mlsl", evaluations = 300 }]],
}, function(given)
  return schema.object("search", given, nil, function(self) return "search by " .. self.method end)
end)

local function check_objective(objective)
  for key in pairs(objective or {}) do
    if key ~= "mean_force" then
      schema.fail("regress: objective", ("unknown field '%s' (fields: mean_force)"):format(key))
    end
  end
end

--- Constraints by what they are.
local function sorted(list)
  local bounds, groups, passive = {}, {}, nil
  for _, each in ipairs(list) do
    if each.kind == "group" then groups[#groups + 1] = each
    elseif each.kind == "passive" then passive = each
    else bounds[#bounds + 1] = each end
  end
  return bounds, groups, passive
end

local record = types.either(types.is("record", "lunid.read"), types.is("stream", "lunid.stream"))

public.regress = schema.define({
  name = "regress",
  help = "Fits the coefficients of features to the restoring force F - m*a along the measured motion.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
    { "mass", types.expression, unit = "kg", help = "without it the target is F itself" },
    { "features", types.list(types.either(types.expression, types.is("features", "lunid.polynomials and its kin")), 1),
      required = true, help = "functions of displacement, velocity, time; sets of them are laid flat" },
    { "known", types.expression, unit = "N", help = "part of the restoring force that is known" },
    { "constraints", types.list(types.is("constraint", "lunid.at_least and its kin")), default = {},
      help = "what is known about the coefficients" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "solver", types.is("solver", "lunid.least_squares and its kin"), help = "least squares by default" },
    { "objective", types.table, help = "{ mean_force = 0.25 }: so much of what is minimised is the square of the mean "
      .. "residual in each block of time, which keeps the force from shifting; the rest is the mean square" },
    { "search", types.is("search", "lunid.search"), help = "for parameters inside features; local from 4 starts by default" },
    { "form", types.is("form", "lunid.weak_form"), help = "integrals in place of the rows themselves" },
    { "blocks", types.integer { min = 1, max = 1000 },
      help = "blocks of time in each record, for cross-validation and standard errors; 8, or 32 for the bootstrap" },
    { "bootstrap", types.integer { min = 20 }, help = "intervals from so many resamplings of the blocks" },
  },
  returns = "regression",
  example = [[local fit = lunid.regress { record = train, mass = 49, features = { lunid.polynomials({ y, v }, 3) } }]],
}, function(given)
  local list = record_list(given.record, given.window)
  given.blocks = given.blocks or given.bootstrap and 32 or 8
  given.features, given.places, given.notes = features.flat(given.features, range_over(list), core.place())
  given.constraints, given.groups, given.passive = sorted(given.constraints)
  check_objective(given.objective)
  given.numbers = features.numbers
  return core.regress(list, given)
end)

--- The features of a list of expressions and sets, laid flat; sets that need the range of the data take it from records.
function regression.flat(list, records) return (features.flat(list, range_over(records or {}), core.place())) end

return regression

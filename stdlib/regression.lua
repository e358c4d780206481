-- Regressions: F - m*a = sum of coefficient * feature, and their solvers.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local function solver(definition)
  definition.returns = "solver"
  return schema.define(definition, function(given)
    given.kind = definition.name
    given.place = core.place()
    if given.lambda ~= "cross-validate" then given.lambda_value = given.lambda end
    return schema.object("solver", given, nil, function() return definition.name end)
  end)
end

local regression = {}

regression.solver_names = { "least_squares", "ridge", "stlsq", "lasso" }

local public = {}
regression.public = public

public.least_squares = solver {
  name = "least_squares",
  help = "Ordinary least squares, by a streaming QR factorisation.",
  fields = {},
  example = "solver = lunid.least_squares {}",
}

public.ridge = solver {
  name = "ridge",
  help = "Least squares with a penalty on the squares of the coefficients, each in units of its feature's size.",
  fields = { { "lambda", types.number { above = 0 }, default = 1e-3, help = "weight of the penalty, dimensionless" } },
  example = "solver = lunid.ridge { lambda = 1e-3 }",
}

public.stlsq = solver {
  name = "stlsq",
  help = "Sequentially thresholded least squares: drops features that contribute less than a threshold.",
  fields = {
    { "threshold", types.number { above = 0, below = 1 }, default = 0.02,
      help = "least rms of coefficient * feature over the rms of the target" },
    { "ridge", types.number { min = 0 }, default = 0, help = "lambda of the ridge regression in each pass" },
    { "max_passes", types.integer { min = 1 }, default = 50, help = "at most so many passes" },
  },
  example = "solver = lunid.stlsq { threshold = 0.02 }",
}

public.lasso = solver {
  name = "lasso",
  help = "Least squares with a penalty on the absolute coefficients: keeps few features.",
  fields = {
    { "lambda", types.either(types.number { above = 0 }, types.choice { "cross-validate" }), default = "cross-validate",
      help = "weight of the penalty, dimensionless; or chosen over left-out blocks of time" },
    { "path", types.integer { min = 2 }, default = 100, help = "values of lambda that are tried" },
    { "refit", types.boolean, default = false, help = "refit what was kept by least squares" },
  },
  example = [[solver = lunid.lasso { lambda = "cross-validate" }]],
}

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

--- Features, with sets of features (lunid.polynomials) laid flat, each once.
local function flat(list)
  local features, seen = {}, {}
  local function add(feature)
    local key = tostring(feature)
    if not seen[key] then
      seen[key] = true
      features[#features + 1] = feature
    end
  end
  for _, entry in ipairs(list) do
    if getmetatable(entry) == "lunid.features" then
      for _, feature in ipairs(entry) do add(feature) end
    else
      add(entry)
    end
  end
  return features
end

regression.flat = flat

local record = types.is("record", "lunid.read")

public.regress = schema.define({
  name = "regress",
  help = "Fits the coefficients of features to the restoring force F - m*a along the measured motion.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
    { "mass", types.expression, unit = "kg", help = "without it the target is F itself" },
    { "features", types.list(types.either(types.expression, types.is("features", "lunid.polynomials")), 1),
      required = true, help = "functions of displacement, velocity, time; sets of them are laid flat" },
    { "known", types.expression, unit = "N", help = "part of the restoring force that is known" },
    { "constraints", types.list(types.is("constraint", "lunid.at_least and its kin")), default = {},
      help = "what is known about the coefficients" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "solver", types.is("solver", "lunid.least_squares, ridge, stlsq or lasso"), help = "least squares by default" },
    { "objective", types.table, help = "{ mean_force = 0.25 }: so much of what is minimised is the square of the mean "
      .. "residual in each block of time, which keeps the force from shifting; the rest is the mean square" },
    { "search", types.is("search", "lunid.search"), help = "for parameters inside features; local from 4 starts by default" },
    { "blocks", types.integer { min = 1, max = 1000 }, default = 8,
      help = "blocks of time, for cross-validation and standard errors" },
  },
  returns = "regression",
  example = [[local fit = lunid.regress { record = train, mass = 49, features = { lunid.polynomials({ y, v }, 3) } }]],
}, function(given)
  local list = type(given.record) == "table" and given.record or { given.record }
  for i, each in ipairs(list) do
    list[i] = given.window and each:window(given.window.from, given.window.to) or each
  end
  given.features = flat(given.features)
  check_objective(given.objective)
  return core.regress(list, given)
end)

regression.flat = flat

return regression

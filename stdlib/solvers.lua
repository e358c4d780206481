-- The solvers of a regression.
local core = require "lunid.core"
local schema = require "lunid.schema"
local types = schema.types

local solvers = { public = {} }
local public = solvers.public

--- In the order in which lists show them.
solvers.names = {}

local function solver(definition)
  definition.returns = "solver"
  solvers.names[#solvers.names + 1] = definition.name
  public[definition.name] = schema.define(definition, function(given)
    given.kind = definition.name
    given.place = core.place()
    if given.lambda ~= "cross-validate" then given.lambda_value = given.lambda end
    return schema.object("solver", given, nil, function() return definition.name end)
  end)
end

solver {
  name = "least_squares",
  help = "Ordinary least squares, by a streaming QR factorisation.",
  fields = {},
  example = "solver = lunid.least_squares {}",
}

solver {
  name = "ridge",
  help = "Least squares with a penalty on the squares of the coefficients, each in units of its feature's size.",
  fields = { { "lambda", types.number { above = 0 }, default = 1e-3, help = "weight of the penalty, dimensionless" } },
  example = "solver = lunid.ridge { lambda = 1e-3 }",
}

solver {
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

local lambda = { "lambda", types.either(types.number { above = 0 }, types.choice { "cross-validate" }),
  default = "cross-validate", help = "weight of the penalty, dimensionless; or chosen over left-out blocks of time" }
local path = { "path", types.integer { min = 2 }, default = 100, help = "values of lambda that are tried" }
local refit = { "refit", types.boolean, default = false, help = "refit what was kept by least squares" }

solver {
  name = "lasso",
  help = "Least squares with a penalty on the absolute coefficients: keeps few features.",
  fields = { lambda, path, refit },
  example = [[solver = lunid.lasso { lambda = "cross-validate" }]],
}

solver {
  name = "elastic_net",
  help = "Least squares with a penalty on absolute coefficients and on squares: keeps features that resemble one another "
    .. "together.",
  fields = {
    { "mixture", types.number { above = 0, max = 1 }, default = 0.5, help = "share of the penalty on absolute values; 1 is the lasso" },
    lambda, path, refit,
  },
  example = [[solver = lunid.elastic_net { mixture = 0.5 }]],
}

solver {
  name = "non_negative",
  help = "Least squares with every coefficient >= 0.",
  fields = {},
  example = "solver = lunid.non_negative {}",
}

solver {
  name = "sr3",
  help = "Sparse relaxed regularised regression: a sparse copy of the coefficients is kept near them.",
  fields = {
    { "threshold", types.number { above = 0 }, default = 0.02, help = "contribution at which a coefficient is cut" },
    { "relaxation", types.number { above = 0 }, default = 0.1, help = "how far the sparse copy may be from the coefficients" },
    { "absolute", types.boolean, default = false, help = "shrink by the threshold (l1) in place of cutting (l0)" },
    { "refit", types.boolean, default = true, help = "refit what was kept by least squares" },
  },
  example = "solver = lunid.sr3 { threshold = 0.05 }",
}

solver {
  name = "frols",
  help = "Forward regression by orthogonal least squares: takes up the feature of largest error reduction ratio, one after "
    .. "another.",
  fields = {
    { "threshold", types.number { min = 0, below = 1 }, default = 1e-3, help = "least error reduction ratio of a term" },
    { "max_terms", types.integer { min = 0 }, default = 0, help = "at most so many; 0: all" },
  },
  example = "solver = lunid.frols { threshold = 1e-3 }",
}

local criterion = { "criterion", types.choice { "bic", "aicc" }, default = "bic", help = "what is to be least" }

solver {
  name = "stepwise",
  help = "Adds or drops one feature at a time while that lowers an information criterion.",
  fields = { criterion, { "max_terms", types.integer { min = 0 }, default = 0, help = "at most so many; 0: all" } },
  example = [[solver = lunid.stepwise { criterion = "aicc" }]],
}

solver {
  name = "best_subset",
  help = "The best of all subsets of up to 30 features, by branch and bound; fit.steps holds the best of each size.",
  fields = { { "terms", types.integer { min = 0 }, default = 0, help = "how many; 0: by the criterion" }, criterion },
  example = "solver = lunid.best_subset { terms = 3 }",
}

solver {
  name = "spike_slab",
  help = "Bayesian selection: the probability of each feature to belong to the model, and the features above a cut.",
  fields = {
    { "prior", types.number { above = 0, below = 1 }, default = 0.5, help = "probability of a feature before the data" },
    { "cut", types.number { above = 0, below = 1 }, default = 0.5, help = "least probability of a feature that is kept" },
    { "sweeps", types.integer { min = 1 }, default = 2000, help = "of the sampler, with more than 15 features" },
  },
  example = "solver = lunid.spike_slab { prior = 0.2 }",
}

local members = {}
for _, name in ipairs(solvers.names) do members[#members + 1] = name end

solver {
  name = "ensemble_of",
  help = "Solves many times on blocks of time drawn with replacement, and keeps what most members keep.",
  fields = {
    { "solver", types.is("solver", "lunid.stlsq and its kin"), help = "of each member; stlsq by default" },
    { "members", types.integer { min = 2 }, default = 100, help = "how many" },
    { "features", types.number { above = 0, max = 1 }, default = 1, help = "share of the features that a member sees" },
    { "inclusion", types.number { above = 0, max = 1 }, default = 0.5, help = "least share of members that keep a feature" },
  },
  example = "solver = lunid.ensemble_of { solver = lunid.stlsq { threshold = 0.05 }, members = 200 }",
}

--- A member that needs the rows again cannot stand in an ensemble.
local ensemble_of = public.ensemble_of
function public.ensemble_of(given, ...)
  local member = type(given) == "table" and given.solver
  if getmetatable(member) == "lunid.solver" then
    local known = false
    for _, name in ipairs(members) do known = known or name == member.kind end
    if not known then
      schema.fail("ensemble_of", ("solver: %s works on the rows or on blocks itself, expected one of: %s"):format(member.kind,
        table.concat(members, " ")))
    end
  elseif type(given) == "table" and given.solver == nil then
    given.solver = public.stlsq {}
  end
  return ensemble_of(given, ...)
end

solver {
  name = "total_least_squares",
  help = "Counts the noise of the features as that of the target: errors in variables, from the noise of the channels.",
  fields = { { "noise", types.table, default = {}, help = "standard deviations, such as { y = 1e-5, F = 2 }; else as estimated" } },
  example = "solver = lunid.total_least_squares { noise = { y = 2e-5, v = 1e-3, F = 5 } }",
}

solver {
  name = "instrumental_variables",
  help = "Two-stage least squares: noise that enters the features linearly leaves no bias where the instruments are "
    .. "functions of signals that it does not enter, such as the reference of a controller.",
  fields = {
    { "instruments", types.list(types.expression, 1), required = true,
      help = "one or more for each coefficient, as the features are made but of the reference" },
  },
  example = "solver = lunid.instrumental_variables { instruments = { lunid.channel \"vr\", lunid.sign(lunid.channel \"vr\"), 1 } }",
}

solver {
  name = "huber",
  help = "Robust regression: residuals beyond a threshold count linearly; outliers are reported. Several passes over the data.",
  fields = {
    { "threshold", types.number { above = 0 }, default = 1.345, help = "in deviations of the residual" },
    { "outlier", types.number { above = 0 }, default = 4, help = "residuals beyond so many deviations are reported" },
  },
  example = "solver = lunid.huber {}",
}

return solvers

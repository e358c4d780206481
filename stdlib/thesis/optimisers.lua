-- Constraints between coefficients, and parameters inside features (thesis, appendix I): b1 >= 0; b2, b3, b4 <= 0; b4 <= b1, by each
-- solver, which honours them or refuses; the search for p of tanh(p*y) by each optimiser of the appendix, Lunid's and NLopt's;
-- the objectives that the thesis tried.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Optimisers and constraints" }
local system = lunid.systems.duffing {}
local train = lunid.thesis_record { system = system, frequency = 20, seed = 10*seed }

-- ---- constraints ----

local terms = { y, y^3, y^5, y*v^2, v }  -- b1 ... b4, and the damping
local constraints = { lunid.at_least(y, 0), lunid.at_most(y^3, 0), lunid.at_most(y^5, 0), lunid.at_most(y*v^2, 0), lunid.at_most(y*v^2, y) }
local solvers = { { "least squares", lunid.least_squares {} }, { "ridge", lunid.ridge {} }, { "lasso", lunid.lasso {} },
  { "elastic net", lunid.elastic_net {} }, { "stlsq", lunid.stlsq {} }, { "sr3", lunid.sr3 {} }, { "frols", lunid.frols {} },
  { "stepwise", lunid.stepwise {} }, { "best subset", lunid.best_subset {} }, { "non-negative", lunid.non_negative {} },
  { "spike and slab", lunid.spike_slab {} }, { "ensemble", lunid.ensemble_of {} }, { "total", lunid.total_least_squares {} },
  { "huber", lunid.huber {} } }
local rows, runs = {}, {}
for i, each in ipairs(solvers) do
  local good, fit = pcall(lunid.regress, { record = train, mass = 1, features = terms, solver = each[2], constraints = constraints })
  if good then
    local b = {}
    for k, term in ipairs(fit.terms) do b[k] = term.value end
    local held = b[1] >= -1e-6 and b[2] <= 1e-6 and b[3] <= 1e-6 and b[4] <= 1e-6 and b[4] <= b[1] + 1e-6
    rows[i] = { each[1], b[1], b[2], b[3], b[4], b[5], held and "honoured" or "broken" }
  else
    rows[i] = { each[1], nil, nil, nil, nil, nil, "refused: " .. tostring(fit):gsub("^.-:%d+: ", ""):gsub("\n.*", "") }
  end
  runs[i] = { solver = each[1], constraints = rows[i][7] }
end
report:table { head = { "solver", "b1 (y)", "b2 (y^3)", "b3 (y^5)", "b4 (y*v^2)", "v", "constraints" }, rows = rows,
  caption = "b1 >= 0; b2, b3, b4 <= 0; b4 <= b1: against the truth on purpose, so that they bind" }

-- ---- a parameter inside a feature ----

local yielding = lunid.systems.tanh_yield {}
local shaken = lunid.thesis_record { system = yielding, frequency = 20, seed = 10*seed }
local p = lunid.parameter { "p", 20, min = 1, max = 500 }
local searches, found = { "lbfgs", "slsqp", "stochastic_gradient", "annealing", "particle_swarm", "monte_carlo", "puddle_jumping", "esch",
  "isres", "crs", "mlsl", "direct", "stogo" }, {}
for i, method in ipairs(searches) do
  local began = os.clock()
  local fit = lunid.regress { record = shaken, mass = 1, features = { v, lunid.tanh(p*y) },
    search = lunid.search { method, evaluations = quick and 60 or 300, seed = seed, starts = 4 } }
  found[i] = { method, fit.implicit.p.value, 100*(fit.implicit.p.value/80 - 1), fit.rmse, os.clock() - began }
  runs[#runs + 1] = { search = method, p = fit.implicit.p.value }
end
report:table { head = { "search", "p [1/m]", "off [%]", "RMSE [N]", "seconds" }, rows = found,
  caption = "p of tanh(p*y) by least squares on the force; the thesis: L-BFGS-B; genetic: esch and isres of NLopt. Each ends with a local "
    .. "descent, so all stand at one minimum: what is off is the bias of noisy regressors, which only the trajectory removes" }
local start = lunid.regress { record = shaken, mass = 1, features = { v, lunid.tanh(p*y) } }
local refined = lunid.fit_trajectory { model = start.model, record = shaken, channels = { "y", "v" } }
report:text(("On the trajectory p = %.4g +- %.2g."):format(refined.model.parameters.p.value, refined.model.parameters.p.std))

-- ---- objectives ----

local objectives = {}
for i, share in ipairs { 0, 0.1, 0.25, 0.5 } do
  local fit = lunid.regress { record = train, mass = 1, features = { y, y^3, v }, objective = { mean_force = share } }
  objectives[i] = { ("mean force %.0f %%"):format(100*share), fit.terms.y.value, fit.terms["y^3"].value, fit.terms.v.value, fit.r2 }
end
for _, lambda in ipairs { 1e-4, 1e-2, 1 } do
  local fit = lunid.regress { record = train, mass = 1, features = { y, y^3, v }, solver = lunid.ridge { lambda = lambda } }
  objectives[#objectives + 1] = { ("ridge, lambda = %g (I.2)"):format(lambda), fit.terms.y.value, fit.terms["y^3"].value, fit.terms.v.value, fit.r2 }
end
report:table { head = { "objective", "y", "y^3", "v", "R2" }, rows = objectives,
  caption = "Objectives. R2 has the same minimum as the mean square; a share of the squared mean force keeps the force from shifting, and "
    .. "changes little where it does not shift. A penalty on number and place of peaks was found useless by the thesis, and is not offered" }
report:results { case = "optimisers", variant = "I", runs = runs }
report:save()

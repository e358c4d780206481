-- lunid.regress: sets of features, constraints, solvers, and every fault on its full text.
local lunid = require "lunid"
local spec = require "spec"
local y, v = lunid.displacement, lunid.velocity

local record = lunid.read "../data/spring_multisine.csv"

local function fit(given)
  given.record, given.mass = given.record or record, given.mass or 49
  return lunid.regress(given)
end

local function names(set)
  local all = {}
  for i, feature in ipairs(set) do all[i] = tostring(feature) end
  return table.concat(all, "  ")
end

spec.case("sets of features", function()
  spec.equal(names(lunid.polynomials({ y, v }, 3, { keep = "odd" })), "y  v  y^3  y^2*v  y*v^2  v^3")
  spec.equal(names(lunid.polynomials({ y, v }, 2, { keep = "even" })), "y^2  y*v  v^2")
  spec.equal(#lunid.polynomials({ y, v }, 3, { degree = "tensor" }), 15)  -- 4 * 4 - 1
  spec.equal(#lunid.polynomials({ y, v }, 3, { constant = true }), 10)
  spec.equal(names(lunid.chebyshev({ y }, 3, "T", { { -1, 1 } })), "y  2*y^2 - 1  4*y^3 - 3*y")
  spec.equal(names(lunid.chebyshev({ y }, 2, "U", { { -1, 1 } })), "2*y  4*y^2 - 1")
  spec.equal(names(lunid.fourier(y, 2, 3)), "sin(3*y)  cos(3*y)  sin(6*y)  cos(6*y)")
  spec.equal(names(lunid.tanhs(y, { 50 })), "tanh(50*y)")
  spec.equal(names(lunid.exponentials(y, { -2 })), "exp(-2*y)")
  spec.equal(names(lunid.powers(v, { 0.5 })), "sign(v)*abs(v)^0.5")
  spec.equal(names(lunid.piecewise(y, { 0, 0.5 })), "max(y, 0)  max(y - 0.5, 0)")
  spec.equal(names(lunid.piecewise(y, { 0 }, 0)), "where(y > 0, 1, 0)")
  spec.equal(names(lunid.lags(y, { 1, 3 })), "y_lag1  y_lag3")
  spec.equal(names(lunid.features { y, v } * lunid.features { y, lunid.sign(v) }), "y^2  y*sign(v)  v*y  v*sign(v)")
  spec.equal(names(lunid.features { y, y^2, v^0.5 } * lunid.features { y, v^0.5 }), "y^2  y*v^0.5  y^3  y^2*v^0.5  v^0.5*y  (v^0.5)^2")
  spec.equal(names(lunid.polynomials({ y, v }, 2) * lunid.features { y }), "y^2  v*y  y^3  y^2*v  v^2*y")
  spec.equal(names(lunid.features { y } * v), "y*v")
end)

spec.case("Chebyshev polynomials and bumps over the data's range", function()
  -- with the constant they span what the monomials span
  local chebyshev = fit { features = { lunid.features { 1 }, lunid.chebyshev({ y, v }, 5) } }
  local plain = fit { features = { lunid.polynomials({ y, v }, 5, true) } }
  spec.equal(#chebyshev.terms, 21)
  spec.near(chebyshev.rmse/plain.rmse, 1, 1e-9)
  spec.equal(#fit { features = { lunid.radial({ y, v }, 3) } }.terms, 9)
end)

spec.case("every solver ends with one kind of result", function()
  for _, name in ipairs { "least_squares", "ridge", "stlsq", "lasso", "elastic_net", "non_negative", "sr3", "frols",
    "stepwise", "best_subset", "spike_slab", "ensemble_of", "total_least_squares", "huber" } do
    local found = fit { features = { lunid.polynomials({ y }, 3), v }, solver = lunid[name] {} }
    assert(found.converged, name)
    assert(math.abs(found.terms.y.value/7.7e5 - 1) < 0.2, name)
    spec.equal(found.terms.y.unit, "N/m")
    assert(found.terms.y.lower < found.terms.y.value and found.terms.y.vif >= 1, name)
    assert(found.kkt < 1e-8, name)
  end
end)

spec.case("what searches and probabilities tell", function()
  local steps = fit { features = { lunid.polynomials({ y, v }, 3) }, solver = lunid.frols { max_terms = 2 } }.steps
  spec.equal(#steps, 2)
  assert(steps[1].error_reduction > steps[2].error_reduction and steps[1].feature)
  local ensemble = fit { features = { lunid.polynomials({ y }, 3), v }, solver = lunid.ensemble_of { members = 20 } }
  spec.equal(ensemble.terms.y.inclusion, 1)
  local drawn = fit { features = { y, v, y^3 }, bootstrap = 200 }
  spec.equal(drawn.interval, "95 %, 200 replicates of 32 blocks")
  spec.equal(#drawn.covariance, 3)
  assert(fit { features = { y, v, y^3 }, solver = lunid.huber {} }.outliers.count > 0)
end)

spec.case("the weak form comes nearer to the truth than the derived acceleration", function()
  -- tests/data/README: k = 7.7412e5, k3 = 1.1607e10; the acceleration comes from the displacement
  local strong, weak = fit { features = { y, v, y^3 } }, fit { features = { y, v, y^3 }, form = lunid.weak_form {} }
  assert(math.abs(weak.terms["y^3"].value/1.1607e10 - 1) < 0.05)
  assert(math.abs(strong.terms["y^3"].value/1.1607e10 - 1) > 0.2)
  spec.contains(weak.form, "weak form, T = ")
end)

spec.case("relations between coefficients", function()
  local k1, k3 = lunid.coefficient(y), lunid.coefficient(y^3)
  spec.equal(tostring(lunid.at_most(2*k1 + k3/2 - 1, 5)), "2*[y] + 0.5*[y^3] + -1 <= 5")
  local bound = fit { features = { y, v, y^3 }, constraints = { lunid.at_least(k3 - 1e4*k1, 1e8), lunid.at_least(v, 0) } }
  spec.near((bound.terms["y^3"].value - 1e4*bound.terms.y.value)/1e8, 1, 1e-6)
  spec.equal(bound.active[1], "y^3 - 10000*y >= 1e+08")
  local one = fit { features = { y, v, y^3, y^5 }, constraints = { lunid.one_of { y^3, y^5 } } }
  assert((one.terms["y^3"].value == 0) ~= (one.terms["y^5"].value == 0))
  local passive = fit { features = { y, v, v^2, v^3 }, constraints = { lunid.passive {} } }
  assert(passive.passivity.imposed and passive.passivity.least_power > -1)
  spec.contains(tostring(passive), "passivity imposed: least dissipated power ")
end)

spec.case("a feature given twice is said, with both places", function()
  local twice = fit { features = { lunid.polynomials({ y }, 3), y, v } }
  spec.equal(#twice.terms, 4)
  spec.contains(twice.warnings[1], "the feature 'y' of ")
  spec.contains(twice.warnings[1], ": it is taken once")
end)

-- ---- faults ----

local head = ([[
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local record = lunid.read "%s/tests/data/spring_multisine.csv"
]]):format(io.popen("pwd"):read "l")

local function line_4(line, expected)
  local said = spec.study(head .. line .. "\n")
  spec.contains(said, expected)
end

spec.case("faults, with their lines", function()
  line_4("lunid.sr3 { threshold = -1 }", "study.lua:4: sr3: threshold: expected > 0, got -1")
  line_4("lunid.elastic_net { lambda = -1 }", "study.lua:4: elastic_net: lambda: expected > 0, got -1")
  line_4("lunid.ensemble_of { solver = lunid.huber {} }", "study.lua:4: ensemble_of: solver: huber works on the rows or "
    .. "on blocks itself, expected one of: least_squares ridge stlsq lasso elastic_net non_negative sr3 frols stepwise "
    .. "best_subset spike_slab")
  line_4("lunid.polynomials({ y }, 2, { keep = 'od' })", "study.lua:4: polynomials: options: keep: expected 'all', 'odd' or "
    .. "'even', got the string 'od', did you mean 'odd'?")
  line_4("lunid.chebyshev({ y, v }, 2, 'T', { { 0, 1 } })",
    "study.lua:4: chebyshev: range: expected 2 pairs, one for each variable, got 1")
  line_4("lunid.regress { record = record, features = { lunid.chebyshev({ y*v }, 2) } }",
    "study.lua:4: regress: features: the range of 'y*v' is not known: give it (range = ...) to the set of features")
  line_4("lunid.at_most(lunid.coefficient(y)*lunid.coefficient(v), 1)",
    "study.lua:4: coefficient: a constraint is linear: expected a coefficient times a number")
  line_4("lunid.at_most(1, 2)", "study.lua:4: at_most: expected a feature or a coefficient on one side at least")
  line_4("lunid.regress { record = record, features = { y, v }, window = lunid.window { from = 20, to = 30 } }",
    "spring_multisine.csv: window 20 to 30 s: expected at least 6 rows, the record has t = 0 to 8 s in steps of 0.00125 s\n"
    .. "  asked for at study.lua:4\n")
end)

spec.case("constraints that cannot be", function()
  local study = [[
local low = lunid.at_least(y, 2)
local fine = lunid.at_least(v, 0)
local high = lunid.at_most(y, 1)
lunid.regress { record = record, mass = 49, features = { y, v }, constraints = { low, fine, high }, solver = lunid.%s {} }
]]
  spec.contains(spec.study(head .. study:format "lasso"),
    "study.lua:6: constraint 'y <= 1' contradicts 'y >= 2' (study.lua:4)\n")
  spec.contains(spec.study(head .. study:format "spike_slab"), "study.lua:4: spike_slab: cannot honour the constraint "
    .. "'y >= 2', only fixed coefficients: leave it out or take another solver\n")
end)

spec.case("a lag has no continuous model", function()
  local said = spec.study(head .. [[
local fit = lunid.regress { record = record, features = { y, v, lunid.lags(y, { 1 }) } }
print(fit.model)
]])
  spec.contains(said, "study.lua:5: the regression has no model: its term 'y_lag1' (study.lua:4) is a lag, which holds at the "
    .. "samples of this record only; leave lags out, or use the terms and the coefficients themselves\n")
end)

spec.case("too few rows, constant channels", function()
  spec.write("short.csv", "t,F,y,v,a\n0,1,1,2,3\n1,2,1,3,5\n2,4,1,1,8\n3,3,1,0,2\n4,0,1,2,7\n5,1,1,9,4\n")
  local short = lunid.read(spec.folder .. "/short.csv")
  spec.equal(spec.message_of(function()
    lunid.regress { record = short, features = { lunid.polynomials({ v, lunid.acceleration }, 3) } }
  end), "9 features need at least as many rows, got 6: take fewer features or more of the record")
  local constant = lunid.regress { record = short, features = { y, v } }
  spec.equal(constant.warnings[1], "'y' is constant on these rows: its coefficient is that of a constant force")
  spec.equal(spec.message_of(function() lunid.regress { record = short, features = { lunid.chebyshev({ y }, 2) } } end),
    "regress: features: 'y' is constant on these data: it has no range")
end)

-- ---- instrumental variables ----

--- F = m*a + c*v at every row, measured with noise that the force answers, as that of a loop does.
local function loop(seed)
  local rows = 4000
  local noise = lunid.excitation.white_noise { rms = 1, dt = 0.01, duration = rows * 0.01, seed = seed }:column "F"
  local columns = { F = {}, v = {}, a = {}, vr = {}, ar = {} }
  for i = 1, rows do
    local n, t = noise[i], 0.01 * i
    local vr, ar = math.sin(3 * t) + math.sin(7.3 * t), 3 * math.cos(3 * t) + 7.3 * math.cos(7.3 * t)
    local v, a = 0.9 * vr, 0.9 * ar - 2 * n
    columns.F[i], columns.v[i], columns.a[i], columns.vr[i], columns.ar[i] = 5 * a + 3 * v, v + 0.3 * n, a + 2 * n, vr, ar
  end
  local channels = {}
  for _, name in ipairs { "F", "v", "a", "vr", "ar" } do channels[#channels + 1] = { name, columns[name] } end
  return lunid.record { channels = channels, dt = 0.01 }
end

local vr, ar = lunid.channel "vr", lunid.channel "ar"

spec.case("noise that the force answers leaves no bias with the reference as instrument", function()
  local a, v = lunid.acceleration, lunid.velocity
  local record = loop(3)
  local plain = lunid.regress { record = record, features = { a, v } }
  local two = lunid.regress { record = record, features = { a, v },
    solver = lunid.instrumental_variables { instruments = { ar, vr } } }
  assert(math.abs(plain.terms.v.value - 3) > 10 * plain.terms.v.std, tostring(plain))
  for name, truth in pairs { a = 5, v = 3 } do
    local term = two.terms[name]
    assert(math.abs(term.value - truth) < 4 * term.std and term.std < 0.1 * truth, tostring(two))
    assert(term.lower < truth and truth < term.upper, tostring(two))
  end
  spec.contains(tostring(two), "two-stage least squares, 2 instruments")
  local more = lunid.regress { record = record, features = { a, v }, constraints = { lunid.fixed(a, 5) },
    solver = lunid.instrumental_variables { instruments = { vr, 2 * vr, ar } } }
  spec.equal(more.terms.a.value, 5)
  spec.contains(tostring(more), "two-stage least squares, 2 instruments")  -- 2*vr says nothing more
end)

spec.case("faults of instruments", function()
  local a, v = lunid.acceleration, lunid.velocity
  local function refused(message, given)
    given.record, given.features = loop(1), { a, v }
    local good, said = pcall(lunid.regress, given)
    assert(not good)
    spec.contains(tostring(said), message)
  end
  refused("the instruments tell 1 of 2 coefficients apart",
    { solver = lunid.instrumental_variables { instruments = { vr, 3 * vr } } })
  refused("parameter 'p' in instrument 'vr^p' has no value: fix it",
    { solver = lunid.instrumental_variables { instruments = { ar, vr ^ lunid.parameter { "p", min = 1, max = 2 } } } })
  refused("bootstrap: not with instrumental_variables", { bootstrap = 20,
    solver = lunid.instrumental_variables { instruments = { ar, vr } } })
  local good, said = pcall(lunid.instrumental_variables, {})
  assert(not good and tostring(said):find("instruments", 1, true), said)
end)

spec.clean()
spec.finish()

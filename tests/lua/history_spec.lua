-- History models: what they tell, predict and save; searches inside features; their faults.
local lunid = require "lunid"
local spec = require "spec"

-- An oscillator of 2 kg, 3 N s/m, 800 N/m under a random force, straight between samples, from the simulator.
local y, v = lunid.displacement, lunid.velocity
local model = lunid.model { mass = 2, restoring = 800*y + 3*v }
local force = lunid.excitation.white_noise { rms = 10, dt = 0.01, duration = 10, seed = 3 }
local record = lunid.simulate { model = model, excitation = force, interpolation = "linear" }:record()

spec.case("an ARX model of an oscillator gives its mass, damping and stiffness", function()
  local found = lunid.arx { record = record, outputs = 2, inputs = 3, delay = 0 }
  local equation = found:equation()
  spec.near(equation.mass, 2, 1e-4)
  spec.near(equation.damping, 3, 1e-3)
  spec.near(equation.stiffness, 800, 1e-2)
  local poles = found:poles()
  spec.equal(#poles, 2)
  spec.near(poles[1].real, -0.75, 1e-3)
  spec.near(math.abs(poles[1].imaginary), math.sqrt(400 - 0.75^2), 1e-3)
  assert(found:free_run(record).fit > 99.99)
  spec.contains(tostring(found), "\n  y_1 = ")
end)

spec.case("saved and loaded it is the same", function()
  local noisy = record:with_noise { seed = 1, y = 0.02 }
  local found = lunid.armax { record = noisy, outputs = 2, inputs = 3, delay = 0, noise = 1 }
  spec.equal(#found.terms, 6)
  local tests = found:residual_tests(noisy, 20)
  spec.equal(#tests, 2)
  spec.near(tests[1].bound, 1.96 / math.sqrt(noisy.rows - 2), 1e-12)
  local path = spec.folder .. "/armax.lua"
  found:save(path)
  local again = lunid.load(path)
  for i, term in ipairs(found.terms) do spec.equal(again.terms[i].value, term.value) end
  spec.equal(again:predict(noisy, 3).rmse, found:predict(noisy, 3).rmse)
end)

spec.case("orders and nonlinear terms", function()
  local orders = lunid.history_orders { record = record:with_noise { seed = 1, y = 1e-4 }, outputs = 3, inputs = 3, delay = 0 }
  spec.equal(#orders, 9)
  spec.contains(tostring(orders), "outputs  inputs  residual std")
  local narx = lunid.narx { record = record, outputs = 2, inputs = 1, degree = 2 }
  spec.equal(#narx.terms, 9)
  local own = lunid.narx { record = record, features = { lunid.channel "y_1", lunid.channel "y_2", lunid.channel "F_1" } }
  spec.equal(own.terms[3].name, "F_1")
end)

spec.case("faults", function()
  local function fault(run, message) spec.equal(spec.message_of(run), message) end
  spec.contains(spec.message_of(function() lunid.arx { record = record, output = "x" } end),
    "no channel 'x': the record has ")
  fault(function() lunid.narx { record = record, features = { v } } end,
    "history model: feature of 'v': expected y_1 ... (past outputs), F_0 ... (inputs) or e_1 ... (past errors)")
  fault(function() lunid.arx { record = record }:predict(record, 0) end, "predict: steps: expected a whole number >= 1, got 0")
  fault(function() lunid.arx { record = record }:predict { steps = 3 } end, "predict: expected a record from lunid.read, got a table")
  fault(function() lunid.arx { record = record }:free_run() end, "free_run: expected a record from lunid.read, got nothing")
  fault(function() lunid.search { "annealling" } end,
    "search: method: expected 'slsqp', 'lbfgs', 'mlsl', 'direct', 'esch', 'crs', 'isres', 'stogo', 'annealing', "
    .. "'particle_swarm', 'puddle_jumping', 'monte_carlo' or 'stochastic_gradient', got the string 'annealling', did you "
    .. "mean 'annealing'?")
  fault(function() lunid.regress { record = record, features = { y }, objective = { mean = 1 } } end,
    "regress: objective: unknown field 'mean' (fields: mean_force)")
end)

spec.case("a parameter inside a feature, by a search of choice", function()
  local p = lunid.parameter { "p", 5, min = 1, max = 500 }
  local truth = lunid.model { mass = 2, restoring = 60*lunid.tanh(30*y) + 3*v }
  local made = lunid.simulate { model = truth, excitation = force, interpolation = "linear" }:record()
  for _, method in ipairs { "slsqp", "particle_swarm" } do
    local fit = lunid.regress { record = made, mass = 2, features = { lunid.tanh(p*y), v }, objective = { mean_force = 0.25 },
      search = lunid.search { method, evaluations = 60, seed = 1 } }
    spec.near(fit.implicit.p.value, 30, 0.01)
    spec.contains(fit.solver, "around " .. method)
  end
end)

spec.clean()
spec.finish()

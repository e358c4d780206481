-- Sensitivities of a run, and the methods of a fit.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", 400 }
local c = lunid.parameter { "c", 0, min = 0 }
local model = lunid.model { mass = 1, restoring = k*y + c*v }

local function fault(run, message)
  local good, said = pcall(run)
  assert(not good, "no error")
  spec.contains(tostring(said), message)
end

-- y = 0.1 cos(w t), w = sqrt(k): dy/dk = -0.1 t sin(w t) / (2 w); dy/dy(0) = cos(w t)
spec.case("sensitivities of a run are the closed form's by each solver that carries them", function()
  for _, solver in ipairs { "auto", "fixed", "bdf", "adams" } do
    local run = lunid.simulate { model = model, excitation = 0, from = { 0.1, 0 }, duration = 1, dt = 0.01,
      solver = solver, sensitivities = true }
    local by_k, by_y = run:sensitivity("y", "k"), run:sensitivity("y", "y(0)")
    for i, t in ipairs { 0.25, 0.5, 1 } do
      local row = math.floor(t / 0.01 + 0.5) + 1
      assert(math.abs(by_k[row] + 0.1*t*math.sin(20*t) / 40) < 1e-8, solver .. i)
      assert(math.abs(by_y[row] - math.cos(20*t)) < 1e-5, solver .. i)
      -- a = -k y
      spec.near(run:sensitivity("a", "k")[row], -run:column("y")[row] - 400*by_k[row], 1e-12)
    end
  end
end)

spec.case("faults of sensitivities", function()
  local run = { model = model, excitation = 0, from = { 0.1, 0 }, duration = 1, dt = 0.01 }
  fault(function() lunid.simulate(run):sensitivity("y", "k") end,
    "sensitivity: the run has none; simulate with sensitivities = true")
  run.sensitivities = true
  fault(function() lunid.simulate(run):sensitivity("y", "kk") end,
    "sensitivity: to: expected one of k c y(0) v(0), got 'kk'")
  fault(function() lunid.simulate(run):sensitivity("F", "k") end, "sensitivity: of: expected one of y v a, got 'F'")
  run.solver = "rk45"
  fault(function() lunid.simulate(run) end,
    "simulate_sensitivities: solver: 'fixed', 'bdf' and 'adams' carry sensitivities, 'rk45' does not")
  run.solver, run.stop_when = "bdf", y - 1
  fault(function() lunid.simulate(run) end,
    "simulate: sensitivities: not of a run that stop_when ends, whose end would move with them")
end)

local record = lunid.read "../data/spring_multisine.csv"
local measured = lunid.model { mass = 49, restoring = lunid.parameter { "ks", 7e5, min = 0 }*y
  + lunid.parameter { "cs", 300, min = 0 }*v + lunid.parameter { "k3", 9e9 }*y^3 }

spec.case("a fit by each gradient and solver finds the same, and says which it took", function()
  local function fit(options)
    options.model, options.record, options.interpolation = measured, record:window(0, 0.5), "cubic"
    return lunid.fit_trajectory(options)
  end
  local forward, adjoint, bdf = fit {}, fit { gradient = "adjoint" }, fit { solver = "bdf", max_iterations = 8 }
  spec.equal(forward.summary.gradient, "forward")
  spec.contains(forward.summary.solver, "fixed DP5, ")
  spec.equal(adjoint.summary.gradient, "adjoint")
  spec.equal(bdf.summary.solver, "CVODE BDF")
  for name, row in pairs { ks = true, cs = true, k3 = true } do
    row = forward.model.parameters[name]
    assert(math.abs(adjoint.model.parameters[name].value - row.value) < 0.2*row.std, name)
    assert(math.abs(bdf.model.parameters[name].value - row.value) < 0.2*row.std, name)
  end
  fault(function() fit { gradient = "adjoint", solver = "bdf" } end,
    "fit_trajectory: gradient: 'adjoint' is that of the fixed path; take 'forward' with solver 'bdf'")
end)

spec.clean()
spec.finish()

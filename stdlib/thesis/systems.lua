-- The ten systems of table 2.1 and chapter 2, each run by the thesis' protocol; the linear one against Duhamel's integral; and one run
-- by each solver that stands for one of SciPy's (appendix H). Table 2.1 prints van der Pol's damping with its sign turned, which
-- is unstable beyond |y| = 1; the harsh yield is one-sided and jumps at 0.001 m.
local lunid = require "lunid"
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Systems and solvers" }
local systems = lunid.systems
local list = {
  { "linear", systems.linear {} }, { "Duffing", systems.duffing {} }, { "softening Duffing", systems.softening_duffing {} },
  { "modified Duffing, y^3 v^2", systems.modified_duffing {} }, { "modified Duffing, y^3 v^3 as printed", systems.modified_duffing { velocity_power = 3, e = 1 } },
  { "tanh yield", systems.tanh_yield {} }, { "harsh yield", systems.harsh_yield {} }, { "van der Pol", systems.van_der_pol {} },
  { "van der Pol as printed", systems.van_der_pol { sign = "printed" } }, { "two masses", systems.chain {} },
  { "velocity-dependent mass", systems.velocity_mass {} }, { "pile", systems.pile {} },
}

local rows = {}
for i, each in ipairs(list) do
  local model = each[2]
  local force = lunid.excitation.harmonic { amplitude = 2000, frequency = 20, dt = 0.00125, duration = quick and 1 or 5 }
  local run = lunid.simulate { model = model, excitation = force }
  local name = model.degrees > 1 and "1" or ""
  local completed = run.summary.completed
  rows[i] = { each[1], tostring(model:equation()):gsub("\n", "; "):sub(1, 90), completed and 1e3*run:column("y" .. name):max() or nil,
    completed and "runs" or ("stops at %.3g s"):format(run.summary.stopped_at), run.summary.solver }
  if completed then
    report:figure("phase_" .. i, lunid.figure.lines { x = "displacement [m]", y = "velocity [m/s]", title = each[1],
      series = { lunid.figure.series { run:column("y" .. name), run:column("v" .. name) } } }, "Phase portrait from rest: " .. each[1])
  end
end
report:table { head = { "system", "equation", "largest y [mm]", "", "integrated by" }, rows = rows, caption = "2000 N at 20 Hz, from rest" }

-- ---- Duhamel's integral ----

local k, c, force, w = 2e4, 10, 2000, 2*math.pi*20
local wn, zeta = math.sqrt(k), c/(2*math.sqrt(k))
local wd = wn*math.sqrt(1 - zeta^2)
--- y(t) of the integral of F(s) exp(-zeta wn (t - s)) sin(wd (t - s))/wd for F = force*cos(w s), in closed form.
local function duhamel(t)
  local d = (k - w^2)^2 + (c*w)^2
  local A, B = force*(k - w^2)/d, force*c*w/d  -- of the steady cos and sin
  local p = -A
  local q = (zeta*wn*p - B*w)/wd
  return math.exp(-zeta*wn*t)*(p*math.cos(wd*t) + q*math.sin(wd*t)) + A*math.cos(w*t) + B*math.sin(w*t)
end
local push = lunid.excitation.harmonic { amplitude = force, frequency = 20, dt = 0.00125, duration = 1 }
local solvers, names = {}, { { "RK23", "rk23" }, { "RK45", "rk45" }, { "DOP853", "rk78" }, { "LSODA", "auto" }, { "BDF", "bdf" },
  { "LSODA's Adams part", "adams" }, { "Radau", "esdirk" }, { "(Lunid's own)", "fixed" } }
local runs = {}
for i, each in ipairs(names) do
  local began = os.clock()
  local run = lunid.simulate { model = systems.linear { k = k, c = c }, excitation = push, solver = each[2] }
  local seconds, worst, most = os.clock() - began, 0, 0
  local t, y = run:column "t", run:column "y"
  for r = 1, #t do
    worst, most = math.max(worst, math.abs(y[r] - duhamel(t[r]))), math.max(most, math.abs(y[r]))
  end
  solvers[i] = { each[1], each[2], run.summary.solver, run.summary.evaluations, ("%.1e"):format(worst/most), ("%.2g"):format(1e3*seconds) }
  runs[i] = { solver = each[2], error = worst/most }
end
report:table { head = { "SciPy", "Lunid", "method", "evaluations", "error over the largest y", "ms" }, rows = solvers,
  caption = "The linear system against Duhamel's integral, by each solver of appendix H" }
report:results { case = "systems", variant = "2.1", runs = runs }
report:save()

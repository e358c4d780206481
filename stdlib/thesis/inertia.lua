-- A mass that depends on the motion (thesis, section 2.7): (m + A*v) a + k*y + c*v = F, and one that depends on the displacement.
-- The text gives neither values nor a result; A is chosen so that the mass changes by some per cent.
local lunid = require "lunid"
local y, v, a = lunid.displacement, lunid.velocity, lunid.acceleration
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Inertia: a mass that depends on the motion" }
local k, c = lunid.parameter { "k", 2e4, unit = "N/m" }, lunid.parameter { "c", 10, unit = "N s/m" }
local A = lunid.parameter { "A", 5e-3, unit = "kg s/m" }
local B = lunid.parameter { "B", 20, unit = "kg/m^2" }
local systems = {
  { "velocity", "A", lunid.systems.velocity_mass {}, lunid.model { mass = 1 + A*v, restoring = k*y + c*v } },
  { "displacement", "B", lunid.model { mass = 1 + B*y^2, restoring = k*y + c*v + B*y*v^2 },
    lunid.model { mass = 1 + B*y^2, restoring = k*y + c*v + B*y*v^2 } },
}

local rows, runs = {}, {}
for _, each in ipairs(systems) do
  local name, parameter, system, start = table.unpack(each)
  for number = seed, seed + (quick and 0 or 4) do
    local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, seed = 10*number }
    local test = lunid.thesis_validation { system = system, from = train[1] }
    local guess = lunid.regress { record = train, features = { a, y, v, parameter == "A" and v*a or y^2*a + y*v^2 } }
    local first = { k = guess.terms.y.value, c = guess.terms.v.value }
    first[parameter] = guess.terms[parameter == "A" and "v*a" or "y^2*a + y*v^2"].value
    local fit = lunid.fit_trajectory { model = start:with(first), record = train, channels = { "y", "v" } }
    local constant = lunid.fit_trajectory { model = lunid.model { mass = 1, restoring = k*y + c*v }, record = train, channels = { "y", "v" } }
    local run = lunid.compare { model = fit.model, record = test }
    local without = lunid.compare { model = constant.model, record = test }
    if number == seed then
      local early = test:window(test.start, test.start + 0.4)
      local curves = { lunid.figure.series { early:column "t", early:column "y", label = "measured", role = "measured" } }
      for _, way in ipairs { { "a mass of the " .. name, fit.model, "final" }, { "a constant mass", constant.model, "baseline" } } do
        local free = lunid.simulate { model = way[2], excitation = early, from = "record" }
        curves[#curves + 1] = lunid.figure.series { free:column "t", free:column "y", label = way[1], role = way[3], style = "dashed" }
      end
      report:figure("free_run_" .. name, lunid.figure.lines { series = curves, x = "time [s]", y = "displacement [m]" },
        ("Validation, its beginning: free runs with and without a mass of the %s"):format(name))
    end
    local terms = {}
    for _, row in ipairs(fit.model.parameters) do
      local truth = system.parameters[row.name]
      if truth and not row.fixed then terms[row.name] = { value = row.value, std = row.std, truth = truth.value } end
    end
    local own = terms[parameter]
    rows[#rows + 1] = { name, number, parameter, own.truth, first[parameter], ("%.4g +- %.2g"):format(own.value, own.std), run.nrmse, without.nrmse }
    runs[#runs + 1] = { seed = number, equation = 1, system = name, terms = terms, free_run = { r2 = run.r2, nrmse = run.nrmse } }
  end
  report:progress("systems", #runs, quick and 2 or 10)
end
report:table { head = { "mass depends on", "seed", "", "truth", "by least squares", "on the trajectory", "run error", "with a constant mass" },
  rows = rows, caption = "m*a + A*v*a and m*a + B*(y^2*a + y*v^2): the second term of B comes from the kinetic energy, B*y^2*v^2/2" }
report:results { case = "inertia", variant = "2.7", runs = runs }
report:save()

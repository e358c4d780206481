-- Records that others measured, beside what is published of them: scripts/bench measured [DIR], DIR with the folders emps,
-- silverbox and friction_damper. The short form is tests/lua/measured_spec.lua.
local lunid = require "lunid"

local data = lunid.option { "data", default = "../../../shared/data" }
local y, v, a = lunid.displacement, lunid.velocity, lunid.acceleration
local k, c = lunid.parameter { "k", unit = "N/m" }, lunid.parameter { "c", unit = "N s/m" }

local function row(...) print((("%-34s"):rep(select("#", ...))):format(...)) end
local function told(p) return p and p.value and ("%.5g +- %.2g"):format(p.value, p.std or 0) or "" end

--- The answer in the words of the command line, and how long it took.
local function answer(title, found)
  print(("\n%s, %.0f s"):format(title, found.seconds))
  print("verdict  " .. found.verdict .. ": " .. found.data.sentence)
  print(("gap      train %.4g -> %.4g   test %.4g -> %.4g   (noise alone: %.2g, %.2g)"):format(found.data.baseline.gap_train,
    found.data.final.gap_train, found.data.baseline.gap_test, found.data.final.gap_test, found.data.noise_floor.gap_train,
    found.data.noise_floor.gap_test))
end

-- ---- EMPS: a drive under a controller (Janot, Gautier and Brunot 2019) ----

do
  local record = lunid.read(data .. "/emps/emps.csv")
  local friction, offset = lunid.parameter { "Fc", unit = "N" }, lunid.parameter { "F0", unit = "N" }
  local found = lunid.discover { model = lunid.model { mass = 95.11, restoring = c*v }, train = record }
  answer("EMPS, mass and c*v known", found)
  local known = lunid.discover { model = lunid.model { mass = 95.11, restoring = c*v + friction*lunid.sign(v) + offset }, train = record }
  answer("EMPS, the structure known", known)

  --- The velocity and acceleration of a displacement.
  local function motion_of(channel)
    local alone = lunid.record { channels = { { "y", record:column(channel) } }, dt = record.dt }:derive {}
    return alone:column "v", alone:column "a"
  end
  local own_v, own_a = motion_of "y"
  local reference_v, reference_a = motion_of "y_reference"
  local both = lunid.record { dt = record.dt, channels = { { "F", record:column "F" }, { "v", own_v }, { "a", own_a },
    { "vr", reference_v }, { "ar", reference_a } } }
  local vr, ar = lunid.channel "vr", lunid.channel "ar"
  local features = { a, v, lunid.sign(v), 1 }
  local plain = lunid.regress { record = both, features = features }
  local two = lunid.regress { record = both, features = features,
    solver = lunid.instrumental_variables { instruments = { ar, vr, lunid.sign(vr), 1 } } }
  local function of(fit, name)
    local term = fit.terms[name]
    return told { value = term.value, std = math.max(term.std, term.block_std) }
  end
  local named = {}
  for _, each in ipairs(found.data.effects) do for name, p in pairs(each.parameters) do named[name] = p end end
  local final, structure = found.data.final.parameters, known.data.final.parameters
  print()
  row("", "discovered", "structure known", "y_reference as instrument", "least squares", "published")
  row("mass [kg]", "given", "given", of(two, "a"), of(plain, "a"), "95.11")
  row("viscous [N s/m]", told(final.c), told(structure.c), of(two, "v"), of(plain, "v"), "203.5")
  row("Coulomb [N]", told(named.Fc), told(structure.Fc), of(two, "sign(v)"), of(plain, "sign(v)"), "20.39")
  row("offset [N]", told(named.F0), told(structure.F0), of(two, "1"), of(plain, "1"), "-3.16")
end

-- ---- Silverbox: the split of the benchmark, in volts (Wigren and Schoukens 2013) ----

do
  local rate, file = 610.35, data .. "/silverbox/snls80mv.csv"
  --- Rows [first, past) as the benchmark counts them, from 0.
  local function rows(first, past)
    return lunid.read(file, { window = lunid.window { (first - 0.5)/rate, (past - 0.5)/rate } })
  end
  local m = lunid.parameter { "m", min = 0, unit = "kg" }
  local found = lunid.discover { model = lunid.model { mass = m, restoring = k*y + c*v }, train = rows(40650, 105712),
    test = { rows(105712, 127400), rows(100, 40575) } }
  answer("Silverbox, m, k and c unknown, trained on the multisine", found)
  print(tostring(found):match "(equation.-)\ngap")
  for _, each in ipairs(found.rivals) do print(("  rival %-60s %.4g  %s"):format(each.name, each.gap, each.remark)) end

  --- RMSE [mV] after the 50 rows that tell the first state; rows up to `past`.
  local function rmse(comparison, past)
    local baseline, final, count = 0, 0, 0
    for i = 51, math.min(past or math.huge, #comparison.t) do
      baseline = baseline + (comparison.measured[i] - comparison.baseline[i])^2
      final = final + (comparison.measured[i] - comparison.final[i])^2
      count = count + 1
    end
    return ("%.3g"):format(1e3*math.sqrt(baseline/count)), ("%.3g"):format(1e3*math.sqrt(final/count))
  end
  local tests = {}
  for _, each in ipairs(found.comparisons) do if each.role == "test" then tests[#tests + 1] = each end end
  print()
  row("RMSE of the free run [mV]", "linear baseline", "discovered")
  row("multisine, held out", rmse(tests[1]))
  row("arrow, to the training amplitude", rmse(tests[2], 32000))
  row("arrow, whole (extrapolation)", rmse(tests[2]))
  print "published for the whole arrow: polynomial state space 0.26 (Paduart et al. 2010), least-squares support vectors 0.32"
  print "(Espinoza et al. 2004), physical blocks 0.96 (Hjalmarsson and Schoukens 2004), local linear models 1.3 (Verdult 2004)"
end

-- ---- A friction damper with backlash, its motion imposed ----

do
  local folder = data .. "/friction_damper/"
  local found = lunid.discover { model = lunid.model { mass = 0, restoring = k*y + c*v, motion = "imposed" },
    train = { lunid.read(folder .. "train_0.5Hz_1in.csv"), lunid.read(folder .. "train_0.5Hz_0.5in.csv") },
    test = lunid.read(folder .. "test_0.25Hz_1.5in.csv") }
  answer("friction damper, k*y + c*v", found)
  print(tostring(found):match "\n(named .-)\nequation")
end

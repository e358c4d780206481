-- Fifty rows: what is missing is named with its value, and nothing is where nothing is missing.
local lunid = require "lunid"
local spec = require "spec"
local y, v = lunid.displacement, lunid.velocity

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local baseline = lunid.model { mass = 2, restoring = k*y + c*v }

--- 50 rows at five a period of the highest frequency that drives; the test is another draw.
local function fifty(nature, seed)
  local push = lunid.excitation.multisine { from = 1, to = 4, rms = 30, dt = 1/20, duration = 49/20, seed = seed }
  local run = lunid.simulate { model = lunid.model { mass = 2, restoring = nature }, excitation = push, interpolation = "cubic" }
    :record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local function discovered(nature)
  local train = fifty(nature, 1)
  spec.equal(#train:column "y", 50)
  return lunid.discover { model = baseline, train = train, test = fifty(nature, 2) }
end

spec.case("a cubic spring in 50 rows", function()
  local found = discovered(600*y + 4*v + 4e4*y^3)
  spec.equal(found.verdict, "explained")
  spec.equal(spec.names_of(found), "cubic_stiffness")
  local interval = found.effects[1].parameters.k3.interval
  spec.near(found.effects[1].parameters.k3.value / 4e4, 1, 0.03)  -- four deviations of the fit
  assert(interval[1] < 4e4 and interval[2] > 4e4)
end)

spec.case("nothing is missing in 50 rows: no name, and it is said", function()
  local found = discovered(600*y + 4*v)
  spec.equal(found.verdict, "nothing-missing")
  spec.equal(spec.names_of(found), "")
  spec.contains(found.sentence, "lowers the left-out gap beyond chance")
  spec.near(found.model.parameters.k.value / 600, 1, 0.002)
end)

spec.clean()
spec.finish()

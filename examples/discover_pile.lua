-- A pile under a vibrator, two tests on fresh soil: the acceleration of the pile and the force on it, its weight included. The
-- model knows the damping of the ground alone. What holds the pile? "Nature" stands for the site: it is used for nothing but
-- the records. Where the pile sinks measure accelerations: beside a metre of penetration millimetres of vibration are nothing.
local lunid = require "lunid"
local v, t = lunid.velocity, lunid.time
local mass, weight, moment = 3000, 35e3, 6  -- kg that move; N: all that hangs in the soil; kg m of the eccentrics

local shaft = lunid.effects.smith_shaft { Ru = 70e3, q = 1e-3, J = 0.2 }
local nature = lunid.model { mass = mass, restoring = 9e3*v + shaft }

local function drive(from, to, seed)  -- the vibrator turns faster, or slower: Hz
  local seconds, w = 4, 2*lunid.pi*from
  local rate = 2*lunid.pi*(to - from)/seconds
  local force = weight + moment*(w + rate*t)^2*lunid.sin(w*t + rate*t^2/2)
  local run = lunid.simulate { model = nature, excitation = force, duration = seconds, dt = 1/800 }
  print(("%d to %d Hz: %.2f m of penetration"):format(from, to, run:column("y"):max()))
  return lunid.record { dt = run.dt, channels = { { "F", run:column "F", unit = "N" }, { "a", run:column "a", unit = "m/s^2" } } }
    :with_noise { F = 0.002, a = 0.01, seed = seed }
end

local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = mass, restoring = c*v },
  train = drive(20, 32, 1), test = drive(36, 24, 2) }
print(found)
found.model:save "pile.lua"

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "smith_shaft")
for name, value in pairs { Ru = 70e3, q = 1e-3, J = 0.2 } do
  assert(math.abs(named.parameters[name].value/value - 1) < 0.1, name)
end

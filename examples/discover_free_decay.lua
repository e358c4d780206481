-- Pull, let go, and measure the displacement until it rests: no force at all. The mass has to be known, since all forces scale
-- with it. A second release serves as the test. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 12, restoring = 2.4e4*y + 18*v + 5*lunid.sign(v) }

local function release(from, seed)
  local run = lunid.simulate { model = nature, excitation = 0, from = { from, 0 }, duration = 6, dt = 1/400 }
    :record():with_noise { y = lunid.noise.gaussian { std = 2e-5 }, seed = seed }
  return lunid.record { channels = { { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 12, restoring = k*y + c*v },
  train = { release(0.010, 1), release(0.006, 2) }, test = release(0.008, 3) }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "coulomb_friction")
assert(math.abs(named.parameters.Fc.value/5 - 1) < 0.05)

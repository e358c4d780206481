-- An instrument on a shaker's table, with an accelerometer on either: nothing else was measured, no force and no
-- displacement. The model knows a linear mount. What does the mount do besides? "Nature" stands for the rig: it is used
-- for nothing but the records.
local lunid = require "lunid"
local y, v, yb, vb = lunid.displacement, lunid.velocity, lunid.base_displacement, lunid.base_velocity
local mass = 3.2  -- kg; no force shows it: with 1 all values would be per kilogram

local nature = lunid.model { mass = mass, restoring = 5e4*(y - yb) + 16*(v - vb) + 9*lunid.sign(v - vb) }

local function measure(seed)
  local table_moves, of_time = 0, lunid.time
  for i = 1, 24 do
    local w = 2*math.pi*(8 + 1.1*i)
    table_moves = table_moves + 2.5/w^2*lunid.sin(w*of_time + (seed*i*i) % 6.28)
  end
  local run = lunid.simulate { model = nature, excitation = { yb = table_moves }, duration = 4, dt = 1/1000 }
  local acceleration, ab = table_moves:derivative(of_time):derivative(of_time), {}
  for row = 1, run.rows do ab[row] = acceleration:at { t = (row - 1)/1000 } end
  return lunid.record { dt = 1/1000, channels = { { "a", run:column "a", unit = "m/s^2" }, { "ab", ab, unit = "m/s^2" } } }
    :with_noise { a = 0.01, ab = 0.01, seed = seed }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = mass, restoring = k*(y - yb) + c*(v - vb) },
  train = measure(1), test = measure(2) }
print(found)
found.model:save "mount.lua"

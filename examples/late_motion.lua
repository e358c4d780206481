-- Two loggers whose clocks differ by three rows: the motion's channel comes late, which at any one frequency looks like
-- negative damping. Nothing is missing in the model; the delay is named, taken into it, and k and c come out as they are.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local nature = lunid.model { mass = 2.1, restoring = 3.3e4*y + 40*v }
local rate, late = 800, 3  -- rows

local function measure(seed)
  local push = lunid.excitation.multisine { from = 8, to = 45, rms = 9, dt = 1/rate, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = push }:record():with_noise { y = 0.01, seed = seed }
  local motion, force, shown, drive = run:column "y", run:column "F", {}, {}
  for i = 1, run.rows - late do shown[i], drive[i] = motion[i], force[i + late] end
  return lunid.record { channels = { { "F", drive }, { "y", shown } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", 3e4, unit = "N/m" }, lunid.parameter { "c", 30, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2.1, restoring = k*y + c*v },
  train = measure(1), test = measure(2) }
print(found)

-- Where a delay is known to be there it is a field of the model: fitted here on the trajectory, from 2 ms. Straight lines
-- between the samples of this force would bias c by 0.2 %.
local late_model = lunid.model { mass = 2.1, restoring = k*y + c*v,
  delay = lunid.parameter { "tau", 0.002, min = 0, unit = "s" } }
print(lunid.fit_trajectory { model = late_model, record = measure(3), interpolation = "band_limited" })

-- A beam between two magnets (Moon & Holmes 1979) leaps from one well to the other at no period: a run over the whole
-- record is lost to noise, even that of the true model. The names are found by short runs. "Nature" stands for the rig:
-- it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 0.2, restoring = 0.25*v - 20*y + 2e5*y^3 } -- wells at 10 mm

local function measure(seed)
  local force = lunid.excitation.multisine { from = 0.5, to = 4, rms = 0.08, dt = 1/80, duration = 30, seed = seed }
  local run = lunid.simulate { model = nature, excitation = force }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local model = lunid.model { mass = 0.2, restoring = k*y + c*v }

local found = lunid.discover { model = model, train = measure(1), test = measure(2) }
print(found)
for _, record in ipairs(found.data.records) do print(record.role .. ": " .. record.runs .. " runs") end

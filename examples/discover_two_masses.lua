-- Two masses in a row, the first tied to the wall: both are measured, the first is shaken. The model knows linear
-- springs and dashpots. Which effect is missing, and where? "Nature" stands for the rig: it is used for nothing but the
-- records.
local lunid = require "lunid"

--- Both masses with the same link before each; `joint` is what else acts between the two.
local function two_masses(k, c, joint)
  return lunid.chain { masses = { 1.2, 0.8 }, ends = "left", forces = { 1 },
    element = function(d, w, index) return k*d + c*w + (index == 2 and joint(d, w) or 0) end }
end

local nature = two_masses(2e4, 6, function(d) return 4e9*d^3 end)

local function measure(seed)
  local force = lunid.excitation.multisine { from = 4, to = 45, rms = 12, dt = 1/1000, duration = 4, seed = seed }
  local push = lunid.record { channels = { { "F1", force:column "F" } }, dt = force.dt }
  local run = lunid.simulate { model = nature, excitation = push }:record():with_noise { y1 = 0.01, y2 = 0.01, seed = seed }
  return lunid.record { channels = { { "F1", run:column "F1" }, { "y1", run:column "y1" }, { "y2", run:column "y2" } },
    dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local model, train = two_masses(k, c, function() return 0 end), measure(1)
print(lunid.locate { model = model, record = train })  -- where most is left; place = "y2" looks there
local found = lunid.discover { model = model, train = train, test = measure(2) }
print(found)
for _, effect in ipairs(found.effects) do print(effect.name .. " of " .. effect.place) end
found.model:save "two_masses.lua"

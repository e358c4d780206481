-- Four elements of the soil round a pile, each driven by the same motion: a vibration that grows while the pile sinks. Their
-- loops tell them apart: the shaft slips on both sides, the toe resists downward only and lets go, Masing's soil softens from
-- the start, and the degrading shaft becomes weaker with the work done in it.
local lunid = require "lunid"
local t = lunid.time

-- Six cycles at 20 Hz that grow from 0.4 to 2.5 mm, on a penetration of 15 mm/s; y is positive downward.
local w, duration, dt = 2*lunid.pi*20, 0.3, 1e-4
local y = (0.2e-3 + 3.5e-3*t)*(1 - lunid.cos(w*t)) + 15e-3*t
local motion = lunid.simulate { model = lunid.model { mass = 1, restoring = 0 }, excitation = y:derivative(t):derivative(t),
  from = { 0, 15e-3 }, duration = duration, dt = dt }:record()

local soil = {
  { "shaft", lunid.effects.smith_shaft { Ru = 2000, q = 0.4e-3, J = 0.3 } },
  { "toe", lunid.effects.smith_toe { Ru = 5000, q = 0.8e-3, J = 0.3 } },
  { "masing", lunid.effects.masing_soil { k = 6e6, yr = 0.5e-3 } },
  { "degrading", lunid.effects.degrading_resistance { Ru = 3000, q = 0.4e-3, rinf = 0.2, Nc = 15 } },
}

local v = motion:column "v"
for _, row in ipairs(soil) do
  local name, element = row[1], row[2]
  local force = lunid.model { mass = 0, restoring = element, motion = "imposed" }:force(motion)
  local work = 0
  for i = 1, #force - 1 do work = work + (force[i]*v[i] + force[i + 1]*v[i + 1])/2*dt end
  print(("%-10s %5.0f N at most, %6.0f N at least, takes up %4.1f J"):format(name, force:max(), force:min(), work))
  lunid.figure.lines { title = name, series = { lunid.figure.series { motion:column "y", force } },
    x = "penetration [m]", y = "force [N]" }:save(name .. ".png")
end

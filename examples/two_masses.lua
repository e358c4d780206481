-- Two masses between three springs, the middle one hardening: the first mass is pushed near the second resonance, and
-- both move.
local lunid = require "lunid"
local t = lunid.time

local model = lunid.chain {
  masses = { 1, 1 },
  element = function(d, w, index) return 2e4*d + 3*w + (index == 2 and 1e9*d^3 or 0) end,
  forces = { 1 },
}
print(model)

local run = lunid.simulate { model = model, excitation = 40*lunid.sin(240*t), duration = 1, dt = 0.0005 }
print(run)
run:save "two_masses.csv"

local chart = lunid.figure.lines {
  series = {
    lunid.figure.series { run:column "t", run:column "y1", label = "first mass" },
    lunid.figure.series { run:column "t", run:column "y2", label = "second mass" },
  },
  x = "time [s]",
  y = "displacement [m]",
}
chart:save "two_masses.png"

-- A block on a rough table, pushed by a force that grows and fades: it sticks, slips and stays. Friction is an event
-- here, not a steep curve.
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time

local model = lunid.model { mass = 2, restoring = 50*y + 4*lunid.sign(v) }
local push = 10*t*lunid.exp(-t)*lunid.sin(3*t)

local run = lunid.simulate { model = model, excitation = push, from = { 0, 0 }, duration = 10, dt = 0.01 }
print(run)
run:save "block.csv"

local chart = lunid.figure.lines {
  series = { lunid.figure.series { run:column "t", run:column "y", label = "displacement" } },
  x = "time [s]",
  y = "displacement [m]",
}
chart:save "block.png"

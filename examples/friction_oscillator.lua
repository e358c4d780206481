-- A block with dry friction on a spring, pushed slowly to and fro by a force that grows and fades: it sticks, slips and
-- sticks again. Force over displacement is a loop with upright sides, where it sticks, that leans by the spring. Sticking
-- is exact here, not a steep curve; the sensors' faults come afterwards.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local Fc, k = lunid.parameter { "Fc", 8, unit = "N" }, lunid.parameter { "k", 200, unit = "N/m" }
local model = lunid.model { mass = 1, restoring = k*y + Fc*lunid.sign(v) + 2*v }

local push = lunid.excitation.harmonic { amplitude = 20, frequency = 0.5, dt = 0.005, duration = 20, taper = 1 }
local run = lunid.simulate { model = model, excitation = push }
print(run)
print(("it sticks for %.1f of 20 s, in %d switches"):format(run.summary.stuck, run.summary.events))

local record = run:record():with_noise { y = 0.002, F = lunid.noise.quantised { bits = 12 }, seed = 1 }
record:save "block.csv"

lunid.figure.lines {
  title = "dry friction under a slow force",
  series = { lunid.figure.series { record:column "y", record:column "F", label = "measured" } },
  x = "displacement [m]",
  y = "force [N]",
}:save "loop.png"

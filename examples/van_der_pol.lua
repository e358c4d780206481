-- An oscillator that swings by itself: whatever the first state, the motion ends on one closed loop of the phase plane.
-- The stronger the damping, the longer it creeps and the faster it jumps.
local lunid = require "lunid"

local model = lunid.systems.van_der_pol { k = 1, c = 3 } -- a + 3*(y^2 - 1)*v + y = F
local quiet = lunid.excitation.formula { force = 0, dt = 0.01, duration = 40 }

local series = {}
for _, from in ipairs { { 0.1, 0 }, { -1, 5 }, { 3, -2 } } do
  local run = lunid.simulate { model = model, excitation = quiet, from = from }
  print(run)
  series[#series + 1] = lunid.figure.series { run:column "y", run:column "v", label = ("from %g, %g"):format(from[1], from[2]) }
end

lunid.figure.lines {
  title = "van der Pol's oscillator",
  series = series,
  x = "displacement [m]",
  y = "velocity [m/s]",
}:save "phase_plane.png"

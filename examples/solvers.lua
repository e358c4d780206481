-- Which method for which model. Van der Pol's oscillator at mu = 1000 creeps for hundreds of seconds and then jumps within a
-- millisecond: explicit methods take steps of a millisecond throughout, or stop and say what to take; implicit ones pass.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local mu = lunid.parameter { "mu", 1000 }
local stiff = lunid.model { mass = 1, restoring = y - mu*(1 - y^2)*v }
for _, solver in ipairs { "auto", "bdf", "esdirk", "rk45" } do
  print(lunid.simulate { model = stiff, excitation = 0, from = { 2, 0 }, duration = 2000, dt = 20, solver = solver })
end

-- Its published period is 1614.29 s: from the top, half of it ends where y falls to -2. A condition of your own ends the run.
local half = lunid.simulate { model = stiff, excitation = 0, from = { 2, 0 }, duration = 2000, dt = 1, solver = "bdf",
  rtol = 1e-9, stop_when = -y - 1.99 }
print(("y falls below -1.99 at %.2f s"):format(half.summary.ended_at))

-- Between the rows: a mass on a spring, pushed at 11 rad/s, sampled ten times a second.
local model = lunid.model { mass = 1, restoring = 400*y + 2*v }
local run = lunid.simulate { model = model, excitation = 30*lunid.sin(11*lunid.time), duration = 3, dt = 0.1 }
local there = run:at(1.2345)
print(("at 1.2345 s: y = %.6f m, v = %.4f m/s, a = %.3f m/s^2"):format(there.y, there.v, there.a))

-- How the motion hangs on a parameter, exactly, by the fixed path and by CVODES.
local k = lunid.parameter { "k", 400 }
for _, solver in ipairs { "fixed", "adams" } do
  local slopes = lunid.simulate { model = lunid.model { mass = 1, restoring = k*y + 2*v + lunid.sign(v) },
    excitation = 30*lunid.sin(11*lunid.time), duration = 3, dt = 0.01, solver = solver, sensitivities = true }
  print(("%-6s dy/dk at 3 s: %.6e m per N/m"):format(solver, slopes:sensitivity("y", "k")[301]))
end

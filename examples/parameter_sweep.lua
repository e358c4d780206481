-- How the resonance of a hardening spring moves with the force and with the scatter of its stiffness. The same study runs
-- on several machines or cores: mpirun -n 4 lunid run parameter_sweep.lua
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time

local k, c = lunid.parameter { "k", 2e4, unit = "N/m" }, lunid.parameter { "c", 10, unit = "N s/m" }
local model = lunid.model { mass = 1, restoring = k*y + c*v + 1e6*y^3 }

-- A frequency response by simulation: the amplitude over the last tenth of 100 periods.
local f, A = lunid.parameter { "f", 20, unit = "Hz" }, lunid.parameter { "A", 10, unit = "N" }
local push = A*lunid.sin(2*math.pi*f*t)
local response = lunid.ensemble {
  model = model,
  vary = { f = lunid.range(10, 40, 60), A = { 5, 20 } },
  excitation = push, dt = 1/(64*f), duration = 100/f,
  outputs = { "amplitude_y" }, settled = 0.9,
}
print(response)
response:save "response.csv"

-- The scatter of the amplitude at 20 Hz: k within 10 %, c about 10 N s/m, spread by Sobol's sequence.
local scatter = lunid.ensemble {
  model = model,
  draw = { k = lunid.uniform(1.8e4, 2.2e4), c = lunid.normal(10, 1) }, samples = 256, method = "sobol",
  excitation = push, dt = 1/1280, duration = 5,
  outputs = { "amplitude_y" }, settled = 0.9,
}
print(("amplitude at 20 Hz: %.3g +- %.2g mm"):format(1e3*scatter:column("amplitude_y"):mean(),
  1e3*scatter:column("amplitude_y"):std()))

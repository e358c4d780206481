-- A drive that a controller holds to a reference: its force answers the noise of its own sensor. Discovery says so, and
-- gives the parameters with the reference as instrument beside those of the fit.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local mass, friction, viscous = 95, 20, 200  -- kg, N, N s/m: "nature"
local stiff, damped, dt, rows, finer = 4e4, 2e3, 5e-3, 3000, 40

--- Where the drive is to go, m.
local function reference(t, shift) return 0.04*(math.sin(2*t + shift) + math.sin(4.7*t + 1) + 0.4*math.sin(11*t + 2)) end

local function measure(shift, seed)
  local noise = lunid.excitation.white_noise { rms = 2e-5, dt = dt, duration = rows*dt, seed = seed }:column "F"
  local at, speed, before, columns = reference(0, shift), 0, nil, { y = {}, F = {}, y_reference = {} }
  for i = 1, rows do
    local measured, wanted = at + noise[i], reference((i - 1)*dt, shift)
    local force = stiff*(wanted - measured) - damped*(before and (measured - before)/dt or 0)  -- held until the next sample
    before = measured
    columns.y[i], columns.F[i], columns.y_reference[i] = measured, force, wanted
    for _ = 1, finer do
      speed = speed + (force - viscous*speed - friction*math.max(-1, math.min(1, speed/1e-4)))/mass*dt/finer
      at = at + speed*dt/finer
    end
  end
  return lunid.record { dt = dt, channels = { { "y", columns.y, unit = "m" }, { "F", columns.F, unit = "N" },
    { "y_reference", columns.y_reference, unit = "m" } } }
end

local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = mass, restoring = c*v }, train = measure(0, 1), test = measure(2, 2) }
print(found)
print(("truth: c = %g N s/m, Fc = %g N"):format(viscous, friction))

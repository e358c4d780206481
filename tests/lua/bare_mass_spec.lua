-- A baseline that knows the mass and nothing else. The fourth-order Runge-Kutta method at 10 steps a sample.
local lunid = require "lunid"
local spec = require "spec"

local mass, stiffness, damping, size = 3, 1200, 4, 5e-3  -- kg, N/m, N s/m, m
local omega = math.sqrt(stiffness / mass)
local rows, dt, finer = 1600, 2*math.pi/omega/36, 10

local function measure(seed)
  local function force(t)
    local sum = 0
    for i = 1, 18 do sum = sum + math.cos((0.4 + 0.07*i)*omega*t + (seed*i*i) % 6.28) end
    return 0.05*stiffness*size * sum
  end
  local function slope(t, y, v)
    return (force(t) - stiffness*y*(1 + 0.4*(y/size)^2) - damping*v) / mass
  end
  local noise = lunid.excitation.white_noise { rms = 0.01*size, dt = dt, duration = rows*dt, seed = seed }:column "F"
  local y, v, h, shown, F = 0, 0, dt/finer, {}, {}
  for row = 1, rows do
    local t = (row - 1)*dt
    shown[row], F[row] = y + noise[row], force(t)
    for step = 0, finer - 1 do
      local s = t + step*h
      local a1 = slope(s, y, v)
      local v2 = v + h/2*a1
      local a2 = slope(s + h/2, y + h/2*v, v2)
      local v3 = v + h/2*a2
      local a3 = slope(s + h/2, y + h/2*v2, v3)
      local v4 = v + h*a3
      local a4 = slope(s + h, y + h*v3, v4)
      y, v = y + h/6*(v + 2*v2 + 2*v3 + v4), v + h/6*(a1 + 2*a2 + 2*a3 + a4)
    end
  end
  return lunid.record { channels = { { "y", shown, unit = "m" }, { "F", F, unit = "N" } }, dt = dt }
end

-- A spring that gives way, a hysteresis and a clearance without a gap do most of what a spring does: beside a damping
-- they end at their limits, where a plain spring is meant.
spec.case("spring, damping and what the spring is besides are named together", function()
  local found = lunid.discover { model = lunid.model { mass = mass, restoring = 0 }, train = measure(1), test = measure(2),
    catalogue = { "linear_stiffness", "viscous_damping", "cubic_stiffness", "coulomb_friction", "bouc_wen", "clearance" } }
  spec.equal(found.verdict, "explained")
  spec.equal(spec.names_of(found), "cubic_stiffness linear_stiffness viscous_damping")
  local values = found.model.parameters
  spec.near(values.linear_stiffness_k.value, stiffness, 0.01*stiffness)
  spec.near(values.viscous_damping_c.value, damping, 0.05*damping)
end)

spec.finish()

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
  local function slopes(t, state)
    local y, v = state[1], state[2]
    return { v, (force(t) - stiffness*y*(1 + 0.4*(y/size)^2) - damping*v) / mass }
  end
  local noise = lunid.excitation.white_noise { rms = 0.01*size, dt = dt, duration = rows*dt, seed = seed }:column "F"
  local state, h, shown, F = { 0, 0 }, dt/finer, {}, {}
  for row = 1, rows do
    local t = (row - 1)*dt
    shown[row], F[row] = state[1] + noise[row], force(t)
    for step = 0, finer - 1 do state = spec.runge_kutta(slopes, t + step*h, state, h) end
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

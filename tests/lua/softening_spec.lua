-- A peak resistance and the path that was slipped before the record take each other's place: (Ru - Rr)*exp(-s/sr) with
-- s from s0 on is one force for all Ru*exp(-s0/sr). The path is anchored: it counts from the record's first row. Heun's
-- method at 30 steps a sample.
local lunid = require "lunid"
local spec = require "spec"

local mass, omega, size = 49, 2*math.pi*20, 2e-3  -- kg, rad/s, m
local stiffness, damping = mass*omega^2, 0.06*mass*omega
local rows, dt, finer = 1400, 1/800, 30
local quake, peak, residual, path = 0.25*size, 0.5*stiffness*size, 0.05*stiffness*size, 200*size

local function measure(from, to, level, seed)
  local duration = rows*dt
  local function force(t) return level*stiffness*size*math.sin(2*math.pi*t*(from + (to - from)*t/duration/2)) end
  local noise = lunid.excitation.white_noise { rms = 0.01*size, dt = dt, duration = duration, seed = seed }:column "F"
  local y, v, z, slipped, h, shown, F = 0, 0, 0, 0, dt/finer, {}, {}
  local function acceleration(t, a, b)
    return (force(t) - stiffness*a - damping*b - (residual + (peak - residual)*math.exp(-slipped/path))*z) / mass
  end
  for row = 1, rows do
    local t = (row - 1)*dt
    shown[row], F[row] = y + noise[row], force(t)
    for step = 0, finer - 1 do
      local s = t + step*h
      local first = acceleration(s, y, v)
      local speed = v + h*first
      local moved = h*(v + speed)/2
      local stretched = z + moved/quake
      z = math.max(-1, math.min(1, stretched))
      slipped = slipped + math.abs(stretched - z)*quake
      v = v + h/2*(first + acceleration(s + h, y + moved, speed))
      y = y + moved
    end
  end
  return lunid.record { channels = { { "y", shown, unit = "m" }, { "F", F, unit = "N" } }, dt = dt }
end

spec.case("a resistance that softens is named, with its peak as the record begins", function()
  local k, c = lunid.parameter { "k", unit = "N/m" }, lunid.parameter { "c", unit = "N s/m" }
  local y, v = lunid.displacement, lunid.velocity
  local found = lunid.discover { model = lunid.model { mass = mass, restoring = k*y + c*v },
    train = measure(8, 40, 0.6, 1), test = measure(36, 10, 0.5, 2),
    catalogue = { "shaft_softening", "elastic_slip", "cubic_stiffness", "coulomb_friction" } }
  spec.equal(found.verdict, "explained")
  spec.equal(found.effects[1].name, "shaft_softening")
  spec.near(found.effects[1].parameters.q.value, quake, 0.05*quake)
  local Ru = found.effects[1].parameters.Ru
  spec.near(Ru.value, peak, 4*Ru.std)
  assert(Ru.std > 0 and Ru.std < 0.05*peak, Ru.std)
  spec.near(found.model.parameters.k.value, stiffness, 0.02*stiffness)
end)

spec.finish()

-- A damper in a testing machine: the machine prescribes the motion, a load cell measures the force. No mass is needed, there
-- is no free run, and the gap is that of the force. The model knows oil; what else resists? "Nature" stands for the damper: it
-- is used for nothing but the records.
local lunid = require "lunid"
local v = lunid.velocity

local seal = lunid.effects.elastic_slip { k = 9e4, Fs = 55 }
local nature = lunid.model { mass = 0, restoring = 420*v + seal, motion = "imposed" }

--- What the machine writes: the position that it drove, and the force.
local function measure(stroke, frequency, seed)
  local rows, dt, position = 1600, 1/400, {}
  for i = 1, rows do
    local angle = 2*math.pi*frequency*(i - 1)*dt
    position[i] = stroke*(math.sin(angle) + 0.4*math.sin(2.7*angle))
  end
  local driven = lunid.record { channels = { { "y", position } }, dt = dt }
  return lunid.record { channels = { { "y", position }, { "F", nature:force(driven) } }, dt = dt }
    :with_noise { F = 0.01, seed = seed }
end

local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local model = lunid.model { mass = 0, restoring = c*v, motion = "imposed" }  -- on the command line: --imposed-motion
local found = lunid.discover { model = model, train = { measure(6e-3, 0.7, 1), measure(2e-3, 2, 2) },
  test = measure(4e-3, 1.2, 3) }
print(found)

local named = found.effects[1]
assert(found.verdict == "explained" and found.output == "F" and named.name == "elastic_slip")
assert(math.abs(named.parameters.Fs.value/55 - 1) < 0.02 and math.abs(found.model.parameters.c.value/420 - 1) < 0.02)

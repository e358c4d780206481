-- Records from a closed loop: a controller's force answers the noise of its sensor. Heun's method at 24 steps a sample.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local mass, frequency, size = 20, 6, 2e-3  -- kg, Hz, m
local omega = 2 * math.pi * frequency
local stiffness, damping = mass * omega^2, 0.06 * mass * omega
local rows, dt, finer = 1500, 1 / (40 * frequency), 24

--- Several tones, of rms about 1.
local function tones(t, seed)
  local sum = 0
  for i = 1, 24 do sum = sum + math.cos((0.15 + 0.06*i) * omega * t + (seed * i * i) % 6.28) end
  return 0.29 * sum
end

--- A sweep through the resonance, of rms about 1.
local function sweep(t)
  local part = t / (rows * dt)
  return 1.4 * math.sin(omega * t * (0.3 + 0.7*part))
end

local function noise(std, seed, count)
  return lunid.excitation.white_noise { rms = std, dt = dt, duration = (count or rows)*dt, seed = seed }:column "F"
end

--- Displacement and velocity a row later under a held force: Heun's method in steps of h, `slope` the acceleration.
local function over_a_row(slope, at, speed, h)
  for _ = 1, finer do
    local first = slope(at, speed)
    local second = slope(at + h*speed, speed + h*first)
    at, speed = at + h*(speed + h/2*first), speed + h/2*(first + second)
  end
  return at, speed
end

--- What a proportional-differential controller does, `gain` 0: an open loop. `law`: force beside k*y + c*v, in units of
--- k times the size. The reference is a channel where `follows`; `level`: of the sensor's noise; `hidden`: of a force
--- that no channel holds, both in those units. `shape_of`: of the reference over time and seed, in sizes.
local function record(gain, law, seed, follows, level, hidden, shape_of)
  local of_y, of_F, n = noise(level * size, seed), noise(1, seed + 10), { y = {}, F = {}, y_reference = {} }
  local other = 0
  local at, speed, before, filtered = 0, 0, 0, 0
  for i = 1, rows do
    local measured, shape = at + of_y[i], (shape_of or tones)((i - 1)*dt, seed) * size
    filtered = 0.6*filtered + 0.4*(i > 1 and (measured - before)/dt or 0)
    before = measured
    local force = stiffness * (gain * (shape - measured) - 0.3 * gain / omega * filtered)
    if gain == 0 then force = 0.5 * stiffness * shape end
    n.y[i], n.F[i], n.y_reference[i] = measured, force, shape
    other = 0.9*other + 0.44 * (hidden or 0) * stiffness * size * of_F[i]
    local function slope(a, b) return (force + other - stiffness * (a + size * law(a/size, b/(omega*size))) - damping * b) / mass end
    at, speed = over_a_row(slope, at, speed, dt / finer)
  end
  local channels = { { "y", n.y, unit = "m" }, { "F", n.F, unit = "N" } }
  if follows then channels[3] = { "y_reference", n.y_reference, unit = "m" } end
  return lunid.record { channels = channels, dt = dt }
end

local function none() return 0 end
local function friction(_, b) return 0.15 * math.max(-1, math.min(1, b / 2e-3)) end

local function discover(gain, law, follows, catalogue, level, hidden)
  level = level or 0.01
  return lunid.discover { model = lunid.model { mass = mass, restoring = k*y + c*v }, catalogue = catalogue,
    train = record(gain, law, 1, follows, level, hidden), test = record(gain, law, 2, follows, level, hidden) }
end

spec.case("a force that answers the noise is said to, and the reference gives the parameters", function()
  local found = discover(1.5, none, true, { "coulomb_friction", "cubic_stiffness" })
  spec.equal(found.verdict, "nothing-missing")
  local loop = found.data.closed_loop
  if not (loop.answer > 0.3) then error(("answer %g"):format(loop.answer)) end
  spec.contains(loop.sentence, "of what is new in the force follows what the model leaves")
  spec.equal(loop.reference, "y_reference")
  local by = loop.by_instruments
  spec.near(by.k.value, stiffness, 4 * by.k.std)
  spec.near(by.c.value, damping, 4 * by.c.std)
  if not (by.k.std < 0.01 * stiffness and by.c.std < 0.1 * damping) then error(("stds %g %g"):format(by.k.std, by.c.std)) end
  spec.contains(tostring(found), "with y_reference as instrument: k = ")
end)

spec.case("without a reference it is said too, and what would help", function()
  local found = discover(1.5, friction, false, nil, 1e-3)
  spec.equal(spec.names_of(found), "coulomb_friction")
  -- Noise that the force answers has a fifth to a quarter of the resamples choose the more general form.
  local rivals = found.effects[1].indistinguishable
  assert(found.verdict == "explained" or (#rivals == 1 and rivals[1] == "stribeck_friction"), found.sentence)
  local loop = found.data.closed_loop
  spec.equal(loop.by_instruments, nil)
  spec.contains(loop.sentence, "y_reference")
  local force, step = loop.force.test, loop.one_step.test
  if not (force.after < 0.8 * force.before and step.after < 0.9 * step.before) then
    error(("force %g -> %g, one step %g -> %g"):format(force.before, force.after, step.before, step.after))
  end
end)

spec.case("an instrument that disagrees with the fit is a note", function()
  local found = discover(1.5, none, true, { "cubic_stiffness" }, 0.01, 0.5)
  local fit, by = found.data.final.parameters.c, found.data.closed_loop.by_instruments.c
  spec.near(by.value, damping, 4 * by.std)
  if not (fit.value > 3 * damping) then error(("the fit's c is %g"):format(fit.value)) end
  spec.contains(table.concat(found.data.warnings, "\n"), "with y_reference as instrument: the loop has biased the fit, or the model lacks")
end)

spec.case("an open loop is none, whatever the model lacks", function()
  spec.equal(discover(0, none, false, { "coulomb_friction" }).data.closed_loop, nil)
  spec.equal(discover(0, friction, false, { "cubic_stiffness" }).data.closed_loop, nil)
end)

-- A held force is half a sample late, which looks like negative damping: beside a baseline that lacks a drag the damper
-- takes both, and the force looks smooth.
spec.case("how a smooth force was held is asked beside what is missing, too", function()
  local function drag(_, b) return 0.1 * math.abs(b) * b end
  local found = lunid.discover { model = lunid.model { mass = mass, restoring = k*y + c*v },
    catalogue = { "quadratic_drag", "coulomb_friction", "cubic_stiffness", "damping_drift" },
    train = record(0.5, drag, 1, false, 0.01, 0, sweep), test = record(0.5, drag, 2, false, 0.01, 0, tones) }
  spec.equal(found.verdict, "explained")
  spec.equal(spec.names_of(found), "quadratic_drag")
  spec.near(found.effects[1].parameters.c2.value, 0.1 * stiffness * size / (omega*size)^2, 0.1 * stiffness * size / (omega*size)^2 * 0.1)
end)

--- 20 s of an axis of 0.3 kg m^2 without a spring under a digital controller and a constant load, that cogs 24 times a turn.
local function axis(seed, speed)
  local inertia, drag, cogging, teeth, load, step = 0.3, 0.63, 0.884, 24, 0.4, 1/250
  local count = 5000
  local of_y, n = noise(2.18e-4, seed, count), { y = {}, F = {}, y_reference = {} }
  local function wanted(t) return 0.327*math.sin(2*speed*t + seed) + 0.164*math.sin(4.7*speed*t + 2*seed) + 0.087*math.sin(11*speed*t + 3*seed) end
  local at, rate, before = wanted(0), 0, nil
  for i = 1, count do
    local t, measured = (i - 1)*step, at + of_y[i]
    local speed_seen = before and (measured - before)/step or 0
    before = measured
    local force = 120*(wanted(t) - measured) + 7*((wanted(t) - wanted(t - step))/step - speed_seen)
    n.y[i], n.F[i], n.y_reference[i] = measured, force, wanted(t)
    local function slope(a, b) return (force - drag*b - cogging*math.sin(teeth*a) - load) / inertia end
    at, rate = over_a_row(slope, at, rate, step / finer)
  end
  return lunid.record { channels = { { "y", n.y, unit = "rad" }, { "F", n.F, unit = "N m" }, { "y_reference", n.y_reference, unit = "rad" } },
    dt = step }
end

-- No run of the baseline holds a free mass, and one name (the load) comes a little nearer. Short runs find both.
spec.case("the cogging of an axis without a spring, whose runs follow nothing", function()
  local found = lunid.discover { model = lunid.model { mass = 0.3, interpolation = "hold",
      restoring = lunid.parameter { "c", min = 0 }*v },
    catalogue = { "constant_force", "sinusoidal_stiffness" }, train = axis(3, 1), test = axis(23, 0.8) }
  spec.equal(found.verdict, "explained")
  spec.equal(#found.effects, 2)
  local load, cogging = found.effects[1], found.effects[2]
  spec.equal(load.name .. " + " .. cogging.name, "constant_force + sinusoidal_stiffness")
  spec.near(load.parameters.F0.value, 0.4, 4 * load.parameters.F0.std)
  spec.near(cogging.parameters.k.value, 0.884, 4 * cogging.parameters.k.std)
  spec.near(cogging.parameters.p.value, 24, 4 * cogging.parameters.p.std)
  spec.contains(table.concat(found.warnings, "\n"), "runs over whole records are lost to noise")
end)

spec.finish()

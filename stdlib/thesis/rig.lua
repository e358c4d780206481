-- A virtual test rig for vibratory pile driving (thesis, chapter 3): an elastic pile hung from a crane, a vibrator on its head, soil
-- along its shaft and at its toe. Written on its own, not of Lunid's catalogue: a study sees what gauges would have measured, and
-- nothing of what is in here. y and v are positive downward. SI units.
local lunid = require "lunid"

local rig = {}

local g, steel, steel_density = 9.81, 2.1e11, 7850
local dt, inner, soil_every = 0.00125, 40, 10  -- sample time; steps of the pile in a sample; of these, one of the soil each
local segments, slices, elements = 6, 24, 20

--- Random numbers of its own: splitmix64 (Steele, Lea and Flood 2014), whose neighbouring seeds have nothing in common.
local function random(seed)
  local state = seed
  return function(low, high)
    state = state + 0x9E3779B97F4A7C15
    local z = (state ~ (state >> 30)) * 0xBF58476D1CE4E5B9
    z = (z ~ (z >> 27)) * 0x94D049BB133111EB
    return low + (high - low) * ((z ~ (z >> 31)) >> 11) * 2.0^-53
  end
end

--- A soil and a pile, drawn within the ranges of published practice; whether the pile goes in is another matter.
local function drawn(draw)
  local length, diameter, vibrator = draw(1.5, 2.5), draw(0.1, 0.2), draw(8, 15)
  local mass, top, bottom = 49, draw(2e3, 8e3), draw(8e3, 20e3)
  local toe_pressure = 10^draw(math.log(0.3e6, 10), math.log(5e6, 10))
  return { mass = mass, length = length, diameter = diameter, vibrator = vibrator, unbalance = draw(2e-3, 9e-3) / 2 * (mass + vibrator),
    shaft = top, shaft_growth = (bottom - top) / length, quake = draw(0.5e-3, 2.5e-3), J = draw(0.16, 0.65),
    residual = draw(0.1, 0.5), soften = draw(5e-3, 3e-2), wear = draw(0.6, 1), wear_work = draw(40, 400), shaking = draw(0, 0.02),
    toe = toe_pressure * 0.3 * math.pi * diameter^2 / 4, toe_quake = diameter / draw(60, 120), toe_J = draw(0.16, 0.5),  -- 0.3: its ring
    plug = draw(0.03, 0.3), plug_grip = draw(200, 1200), embedded = draw(0.5, 0.9), gain = draw(0.97, 1.03), drift = draw(-20, 20) }
end

-- ---- the soil ----

--- Slices of soil at fixed depths, each of parallel slip elements whose limits are spread about their mean.
local function new_slices(site)
  local list = {}
  for i = 1, slices do
    local depth = (i - 0.5) / slices * (site.length + 0.2)
    local area = math.pi * site.diameter * (site.length + 0.2) / slices
    local limit = (site.shaft + site.shaft_growth * depth) * area
    local slice = { depth = depth, limit = limit, stiffness = limit / site.quake, work = 0, path = 0, force = 0, at = {}, share = {} }
    local sum = 0
    for k = 1, elements do
      slice.at[k], slice.share[k] = 0, 0.2 + 1.6 * (k - 0.5) / elements
      sum = sum + slice.share[k]
    end
    for k = 1, elements do slice.share[k] = slice.share[k] / sum end
    list[i] = slice
  end
  return list
end

--- Friction of a slice on the pile at displacement y and velocity v, accelerating with amplitude `shake`; moves its elements.
local function friction(site, slice, y, v, shake, h)
  local peak = site.residual + (1 - site.residual) * math.exp(-slice.path / site.soften)
  local worn = site.wear + (1 - site.wear) * math.exp(-slice.work / site.wear_work)
  local scale = math.max(peak, site.residual) * worn * math.exp(-site.shaking * shake / g) * slice.limit
  local sum, stiffness, at, share = 0, slice.stiffness / elements, slice.at, slice.share
  for k = 1, elements do
    local limit, force = scale * share[k], stiffness * (y - at[k])
    if force > limit then
      at[k], force = y - limit / stiffness, limit
    elseif force < -limit then
      at[k], force = y + limit / stiffness, -limit
    end
    sum = sum + force
  end
  slice.path = slice.path + math.abs(v) * h * (math.abs(sum) > 0.5 * scale and 0.02 or 0)
  slice.work = slice.work + math.abs(sum * v) * h * 0.02
  return sum + site.J * math.abs(sum) * v
end

--- Resistance under the toe: elastic to its quake, yields, lets go, and meets the soil again where it left it.
local function toe_force(site, toe, y, v)
  local stiffness = site.toe / site.toe_quake
  local limit = site.toe * (1 + 0.4 * math.max(y, 0) / site.length)  -- denser with depth
  local force = stiffness * (y - toe.at)
  if force > limit then toe.at, force = y - limit / stiffness, limit end
  if force < 0 then return 0 end
  return math.max(0, force * (1 + site.toe_J * v))
end

--- All of the soil before a test: slices, toe, plug, and their forces: on each segment of the shaft, under the toe, from the plug.
local function new_ground(site)
  local ground = { slices = new_slices(site), toe = { at = 0 }, plug_y = 0, plug_v = 0, plug_at = 0, shaft = {}, under_toe = 0, plug = 0 }
  for i = 1, segments do ground.shaft[i] = 0 end
  return ground
end

--- Moves the soil by h seconds along a pile whose segments stand at y and move at v.
local function step_ground(site, ground, y, v, shake, h)
  local n, shaft = segments, ground.shaft
  for i = 1, n do shaft[i] = 0 end
  for i = 1, slices do
    local slice = ground.slices[i]
    -- the slice meets the segment that stands beside it; below the toe there is no pile
    local from_head = slice.depth - site.embedded - y[n] + site.length
    if slice.depth < site.embedded + y[n] and from_head > 0 then
      local segment = math.min(n, math.max(1, math.ceil(from_head / site.length * n)))
      shaft[segment] = shaft[segment] + friction(site, slice, y[segment] - (slice.base or 0), v[segment], shake, h)
    else
      slice.base = y[n]
    end
  end
  ground.under_toe = toe_force(site, ground.toe, y[n], v[n])
  local grip = site.plug_grip / 0.5e-3 * (y[n] - ground.plug_y - ground.plug_at)
  if math.abs(grip) > site.plug_grip then
    ground.plug_at = y[n] - ground.plug_y - (grip > 0 and 0.5e-3 or -0.5e-3)
    grip = grip > 0 and site.plug_grip or -site.plug_grip
  end
  ground.plug = grip + 200 * (v[n] - ground.plug_v)
end

local function step_plug(site, ground, h)
  ground.plug_v = ground.plug_v + h * (ground.plug / (site.plug * site.mass))
  ground.plug_y = ground.plug_y + h * ground.plug_v
end

-- ---- the test ----

--- Rotation of the unbalance: a run-up over `rise` seconds, then a steady frequency.
local function phase_of(t, frequency, rise)
  local w = 2 * math.pi * frequency
  if t < rise then return 0.5 * w / rise * t * t, w / rise * t end
  return 0.5 * w * rise + w * (t - rise), w
end

--- Runs a test { frequency [Hz], lowering [m/s], duration [s] }; gives what the channels would hold without any sensor.
local function motion(site, test)
  local n, h = segments, dt / inner
  local m = site.mass / n
  local area = site.mass / (site.length * steel_density)
  local k = steel * area / (site.length / n)
  local c = 2 * 0.1 * math.sqrt(k * m)  -- also that of the joints
  local rope = 2e5
  local mass = { [0] = site.vibrator }
  for i = 1, n do mass[i] = m end
  local y, v, ground = {}, {}, new_ground(site)
  local shaft = ground.shaft
  for i = 0, n do y[i], v[i] = 0, 0 end
  local total = (site.vibrator + site.mass) * g
  local hang = total / rope  -- the rope holds all at the start
  local out = { t = {}, head = {}, tip = {}, a = {}, y = {}, v = {}, shaft = {}, toe = {} }
  local shake, rows = 0, math.floor(test.duration / dt + 0.5)
  local a = {}
  for i = 0, n do a[i] = 0 end
  for row = 0, rows do
    local sum = { a = 0, y = 0, v = 0, head = 0, tip = 0, shaft = 0, toe = 0 }
    for step = 0, inner - 1 do
      local t = row * dt + step * h
      if step % soil_every == 0 then
        step_ground(site, ground, y, v, shake, soil_every * h)
      end
      local theta, w = phase_of(t, test.frequency, test.rise)
      local push = site.unbalance * w * w * math.sin(theta)
      local held = math.max(0, rope * (hang + y[0] - test.lowering * t) + 400 * (v[0] - test.lowering))
      a[0] = (push + mass[0] * g - held - k * (y[0] - y[1]) - c * (v[0] - v[1])) / mass[0]
      for i = 1, n do
        local force = mass[i] * g + k * (y[i - 1] - y[i]) + c * (v[i - 1] - v[i]) - shaft[i]
        if i < n then force = force - k * (y[i] - y[i + 1]) - c * (v[i] - v[i + 1]) end
        if i == n then force = force - ground.under_toe - ground.plug end
        a[i] = force / mass[i]
      end
      -- Channels are means over a sample, as after a filter against aliasing.
      sum.a, sum.y, sum.v = sum.a + a[1], sum.y + y[1], sum.v + v[1]
      sum.head = sum.head + k * (y[0] - y[1]) + c * (v[0] - v[1])
      sum.tip = sum.tip + k * (y[n - 1] - y[n]) + c * (v[n - 1] - v[n])
      for i = 1, n - 1 do sum.shaft = sum.shaft + shaft[i] end
      sum.toe = sum.toe + ground.under_toe + ground.plug + shaft[n]
      for i = 0, n do
        v[i] = v[i] + h * a[i]
        y[i] = y[i] + h * v[i]
      end
      step_plug(site, ground, h)
    end
    out.t[row + 1] = row * dt
    for name, value in pairs(sum) do out[name][row + 1] = value / inner end
    shake = 0.98 * shake + 0.02 * 1.57 * math.abs(sum.a / inner)
  end
  out.between_gauges = m * (n - 1)
  out.below_tip_gauge = m
  return out
end

--- What one who knows the soil to the last number makes of a measured motion: its shaft's and tip's force along it. The limit of what any
--- model can make of these gauges; not for a study.
function rig.oracle(site, gauges)
  local ground, shaft, toe, shake = new_ground(site), {}, {}, 0
  local y, v, parts = {}, {}, inner // soil_every
  for row = 1, #gauges.t do
    local next_row = math.min(row + 1, #gauges.t)
    shaft[row], toe[row] = 0, 0
    for part = 0, parts - 1 do
      local share = part / parts
      for i = 1, segments do
        y[i] = gauges.y[row] + share * (gauges.y[next_row] - gauges.y[row])
        v[i] = gauges.v[row] + share * (gauges.v[next_row] - gauges.v[row])
      end
      step_ground(site, ground, y, v, shake, dt / parts)
      for _ = 1, soil_every do step_plug(site, ground, dt / inner) end
      for i = 1, segments - 1 do shaft[row] = shaft[row] + ground.shaft[i] / parts end
      toe[row] = toe[row] + (ground.under_toe + ground.plug + ground.shaft[segments]) / parts
    end
    shake = 0.98 * shake + 0.02 * 1.57 * math.abs(gauges.a[row])
  end
  return { shaft = shaft, tip = toe }
end

local function gaussian(draw) return math.sqrt(-2 * math.log(draw(1e-12, 1))) * math.cos(2 * math.pi * draw(0, 1)) end

--- A channel as its sensor gives it: a gain, a delay in samples, a drift over the test, noise over its deviation.
local function sensed(values, draw, gain, delay, drift, noise)
  local sum, squares, n = 0, 0, #values
  for i = 1, n do sum, squares = sum + values[i], squares + values[i]^2 end
  local deviation, out = math.sqrt(math.max(squares/n - (sum/n)^2, 0)), {}
  for i = 1, n do out[i] = gain * values[math.max(1, i - delay)] + drift * i/n + noise * deviation * gaussian(draw) end
  return out
end

--- Does the pile go in under both frequencies, by at least half of what the crane lowers, with 2 to 10 mm of double amplitude?
local function is_driven(site)
  for _, frequency in ipairs { 25, 33.1 } do
    local run = motion(site, { frequency = frequency, lowering = 0.01, duration = 4, rise = 1.5 })
    local n, low, high = #run.y, math.huge, -math.huge
    for i = n - math.floor(1 / frequency / dt), n do low, high = math.min(low, run.y[i]), math.max(high, run.y[i]) end
    if high - low < 2e-3 or high - low > 10e-3 or run.y[n] < 0.5 * 0.01 * 4 then return false end
  end
  return true
end

--- A site where the pile can be driven: drawn until it can. `seed` is all that a study knows of it, and what one would read off the
--- pile and its vibrator before the test: masses, length and how deep it stands.
function rig.site(seed)
  local draw = random(seed)
  while true do
    local site = drawn(draw)
    if is_driven(site) then
      site.seed = seed
      return site
    end
  end
end

--- What the gauges of a test give: columns t, head, tip [N], a, v, y, and `exact`, the same without sensors, which a study may
--- only use to judge.
function rig.test(site, test)
  local exact = motion(site, { frequency = test.frequency, lowering = test.lowering, duration = test.duration, rise = test.rise or 1.5 })
  local draw = random(site.seed * 1000 + test.number)
  return { dt = dt, exact = exact, embedded = site.embedded, vibrator = site.vibrator, t = exact.t, head = sensed(exact.head, draw, site.gain, 2, site.drift, 0.003),
    tip = sensed(exact.tip, draw, 1, 2, 0.5 * site.drift, 0.003), a = sensed(exact.a, draw, 1, 0, 0, 0.01),
    v = sensed(exact.v, draw, 1, 0, 0, 0.005), y = sensed(exact.y, draw, 1, 0, 0, 0.0005) }
end

return rig

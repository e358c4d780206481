-- The catalogue's entries: what each carries, its guesses at three scales, its units, and its formula written out again.
local lunid = require "lunid"
local samples = require "effect_samples"
local spec = require "spec"

local effects = lunid.effects

local names, is_entry = {}, {}
for name in pairs(effects) do
  names[#names + 1] = name
  is_entry[name] = true
end

-- ---- what an entry carries ----

spec.case("there is an entry for each row, in the list's order", function()
  spec.equal(#names, 62)
  spec.equal(names[1], "linear_stiffness")
  spec.equal(names[53], "force_delay")
  spec.equal(names[55], "base_motion")
  spec.equal(names[62], "clipping")
  for _, name in ipairs(names) do
    spec.equal(effects[name].name, name)
    assert(samples[name], "no sample of " .. name)
  end
end)

spec.case("every entry carries what the catalogue promises", function()
  for _, name in ipairs(names) do
    local entry = effects[name]
    for _, field in ipairs { "family", "formula", "signature", "sentence", "source" } do
      assert(type(entry[field]) == "string" and #entry[field] > 1, name .. " has no " .. field)
    end
    assert(entry.source:match "%d%d%d%d" or entry.source:match "chapter", name .. ": a source with a year")
    assert(entry.passive ~= nil, name .. " does not say whether it is passive")
    assert(entry.passive ~= "" and (type(entry.passive) == "boolean" or entry.passive:match "^where "), name)
    assert(#entry.confusers > 0, name .. " has no confusers")
    for _, list in ipairs { "confusers", "special_case_of", "acts_on" } do
      for _, other in ipairs(entry[list]) do
        assert(is_entry[other], ("%s: %s: no entry '%s'"):format(name, list, other))
        assert(other ~= name, name .. " names itself")
      end
    end
  end
end)

--- Whether the text has one of the words.
local function says(text, words)
  for _, word in ipairs(words) do
    if text:find("%f[%a]" .. word) then return true end
  end
  return false
end

spec.case("a signature tells parity, harmonics, loop and on what it depends", function()
  local depends = { "amplitude", "frequenc", "resonance", "velocity", "speed", "faster", "time", "motion", "displace", "acceleration", "gap",
    "penetration", "slip", "cycle", "side", "work", "y0", "limit", "first moment", "past", "trend", "law" }
  for _, name in ipairs(names) do
    local entry = effects[name]
    local function has(what, words) assert(says(entry.signature, words), ("%s: its signature lacks %s"):format(name, what)) end
    has("on what it depends", depends)
    if not entry.maps[1].field then  -- a force; what a sensor makes of the motion has no loop
      has("its parity", { "odd", "even", "does not depend on the motion" })
      has("its harmonics", { "harmonic", "fundamental", "the mean", "a mean", "line of the spectrum", "side bands", "frequencies" })
      has("its loop", { "loop", "parallelogram" })
    end
  end
end)

-- Sizes as a record of 10 periods at that scale gives them.
local function scale(length, frequency, mass)
  local w = 2 * math.pi * frequency
  local force = mass * w ^ 2 * length
  return { y_max = 1.3 * length, y_min = -1.1 * length, y_std = 0.7 * length, v_max = 1.2 * w * length,
    v_std = 0.7 * w * length, force_std = 0.7 * force, residual_std = 0.1 * force, omega = w, stiffness = mass * w ^ 2,
    interval = 0.02 / frequency, duration = 10 / frequency, lines = { 0.4 * w, 3 * w },
    modulations = { 1.7 * w, 1e-6 * w } }
end
local scales = { scale(2e-6, 3000, 0.01), scale(3e-3, 25, 40), scale(0.8, 0.3, 9000) }

spec.case("guesses lie within bounds, ranges and conditions at every scale", function()
  for _, name in ipairs(names) do
    local entry = effects[name]
    for variant = 1, #entry.variants do
      for _, each in ipairs(scales) do
        local range = entry.range and entry.range(each, variant) or {}
        for key, ends in pairs(range) do assert(ends[1] < ends[2], name .. ": range of " .. key) end
        for _, guess in ipairs(entry.guess and entry.guess(each, variant) or {}) do
          for _, row in ipairs(entry.parameters) do
            local value, ends = guess[row[1]], range[row[1]]
            if value then
              local where = ("%s: %s = %g"):format(name, row[1], value)
              assert(value >= (row.min or value) and value <= (row.max or value), where .. " is out of bounds")
              assert(not ends or (value >= ends[1] and value <= ends[2]), where .. " is out of range")
            end
          end
          local Fs, Fc = guess.Fs or guess.Rs or guess.Ru, guess.Fs and guess.Fc or guess.Rl or guess.Rr
          assert(not (Fs and Fc) or Fs >= Fc, name .. ": a guess against its condition")
        end
      end
    end
  end
end)

spec.case("a parameter without a guess is linear, in every form", function()
  for _, name in ipairs(names) do
    local entry = effects[name]
    for number, variant in ipairs(entry.variants) do
      local guess = entry.guess and entry.guess(scales[2], number)[1] or {}
      local open = {}
      for i, row in ipairs(entry.parameters) do
        if guess[row[1]] == nil then open[entry.rows[i].name] = true end
      end
      local function holds_open(expression)
        for _, symbol in ipairs(type(expression) == "number" and {} or expression:symbols()) do
          if open[symbol.name] then return symbol.name end
        end
        return nil
      end
      for _, symbol in ipairs(variant:symbols()) do
        if open[symbol.name] then
          local held = holds_open(variant:derivative(lunid.parameter { symbol.name }))
          assert(not held, ("%s: %s is not linear, and has no guess"):format(name, symbol.name))
        end
      end
      for _, state in ipairs(entry.states) do
        for _, part in ipairs { state.rate, state.min or 0, state.max or 0 } do
          assert(not holds_open(part), ("%s: %s has no guess"):format(name, tostring(holds_open(part))))
        end
      end
    end
  end
end)

-- ---- units ----

-- Of entries whose forms do not all have the same parameters: a value of each.
local further_samples = { coulomb_friction = { Fc = 1.5, vr = 0.3 }, sinusoidal_stiffness = { k = 5, p = 60, kc = 2 },
  position_dependent_friction = samples.position_dependent_friction }

--- A unit such as "N s^p/m" in other units of length, time and force, by the language itself.
local function size_of(unit, base, at)
  if unit == "" then return 1 end
  local text = unit:gsub(" ", "*")
  local rows, seen = {}, {}
  for name in text:gmatch "%a+" do
    if not seen[name] then rows[#rows + 1] = { name } end
    seen[name] = true
  end
  local form = lunid.effect { name = "unit_text", family = "sensor", contribution = text, parameters = rows }
  local values = { unit_text_N = base.N, unit_text_m = base.m, unit_text_s = base.s, unit_text_rad = 1,
    unit_text_kg = base.N * base.s ^ 2 / base.m, unit_text_n = at.n or 0, unit_text_p = at.p or 0 }
  return form.variants[1]:at(values)
end

spec.case("every parameter has its unit: in other units of length, time and force the law is the same", function()
  for _, name in ipairs(names) do
    local entry, given = effects[name], further_samples[name] or samples[name]
    local base = { N = 7, m = 3, s = 0.6 }
    if name == "vibro_liquefaction" then base.m = base.s ^ 2 end  -- the acceleration of gravity keeps its value
    local one = { y = 0.031, v = 0.4, a = 5, t = 0.7, ab = 2, F = 11, force_rate = 90, shaft_angle = 0.8, shaft_speed = 30,
      shaft_rate = 70 }
    local other = { y = one.y * base.m, v = one.v * base.m / base.s, a = one.a * base.m / base.s ^ 2, t = one.t * base.s,
      ab = one.ab * base.m / base.s ^ 2, F = one.F * base.N, force_rate = one.force_rate * base.N / base.s,
      shaft_angle = one.shaft_angle, shaft_speed = one.shaft_speed / base.s, shaft_rate = one.shaft_rate / base.s ^ 2 }
    for i, row in ipairs(entry.parameters) do
      one[entry.rows[i].name] = given[row[1]]
      other[entry.rows[i].name] = given[row[1]] * size_of(row.unit or "", base, given)
    end
    for i, state in ipairs(entry.states) do
      one[state.name] = 0.002 + 0.0013 * i
      other[state.name] = one[state.name] * size_of(state.unit, base, given)
    end
    local function check(words, expression, factor)
      local expected = expression:at(one) * factor
      assert(math.abs(expression:at(other) / expected - 1) < 1e-9 or expected == 0 and expression:at(other) == 0,
        ("%s: %s: %g is not %g"):format(name, words, expression:at(other), expected))
    end
    for i, variant in ipairs(entry.variants) do
      local channel = entry.maps[i].channel
      local delays = entry.maps[i].field == "delay"
      check(delays and "the delay" or channel or "the force", variant, delays and base.s or channel == "y" and base.m or base.N)
    end
    for _, state in ipairs(entry.states) do
      local unit = size_of(state.unit, base, given)
      check(state.own, state.rate, unit / base.s)
      if state.min then check(state.own .. " min", state.min, unit) end
      if state.max then check(state.own .. " max", state.max, unit) end
    end
  end
end)

-- ---- formulas without memory, written out again ----

local function sgn(x) return x > 0 and 1 or x < 0 and -1 or 0 end
local by_hand = {
  linear_stiffness = function(p, m) return p.k * m.y end,
  quadratic_stiffness = function(p, m) return p.k2 * m.y ^ 2 end,
  cubic_stiffness = function(p, m) return p.k3 * m.y ^ 3 end,
  quintic_stiffness = function(p, m) return p.k5 * m.y ^ 5 end,
  clearance = function(p, m) return math.abs(m.y) > p.g and p.k * (m.y - p.g * sgn(m.y)) or 0 end,
  one_sided_stop = function(p, m) return m.y > p.g and p.k * (m.y - p.g) or 0 end,
  bilinear_stiffness = function(p, m) return m.y > p.y0 and p.dk * (m.y - p.y0) or 0 end,
  saturating_stiffness = function(p, m)
    local e = math.exp(2 * p.k * m.y / p.Fy)
    return p.Fy * (e - 1) / (e + 1)
  end,
  preload = function(p, m) return p.F0 * sgn(m.y) end,
  constant_force = function(p) return p.F0 end,
  sinusoidal_stiffness = function(p, m) return p.k * math.sin(p.p * m.y) end,
  odd_quadratic_stiffness = function(p, m) return p.k2 * m.y ^ 2 * sgn(m.y) end,
  impact_hunt_crossley = function(p, m)
    return m.y > p.g and p.k * (m.y - p.g) ^ p.n * math.max(1 + p.c * m.v, 0) or 0
  end,
  viscous_damping = function(p, m) return p.c * m.v end,
  quadratic_drag = function(p, m) return p.c2 * m.v ^ 2 * sgn(m.v) end,
  cubic_damping = function(p, m) return p.c3 * m.v ^ 3 end,
  power_law_damping = function(p, m) return p.c * math.abs(m.v) ^ p.p * sgn(m.v) end,
  van_der_pol_damping = function(p, m) return (-p.mu + p.beta * m.y ^ 2) * m.v end,
  asymmetric_damping = function(p, m) return m.v > 0 and p.dc * m.v or 0 end,
  coulomb_friction = function(p, m) return p.Fc * sgn(m.v) end,
  position_dependent_friction = function(p, m) return (p.Fc + p.alpha * math.abs(m.y)) * sgn(m.v) end,
  stribeck_friction = function(p, m) return (p.Fc + (p.Fs - p.Fc) * math.exp(-(m.v / p.vs) ^ 2)) * sgn(m.v) end,
  hyperbolic_soil = function(p, m) return p.k * m.y / (1 + math.abs(m.y) / p.yr) end,
  radiation_damping = function(p, m) return p.c * m.v end,
  crane_lowering = function(p, m) return p.kc * math.max(m.y - (p.yc0 + p.Vc * m.t), 0) end,
  added_mass = function(p, m) return p.ma * m.a end,
  velocity_dependent_mass = function(p, m) return p.m1 * m.v * m.a end,
  displacement_dependent_mass = function(p, m) return p.m1 * (m.y ^ 2 * m.a + m.y * m.v ^ 2) end,
  stiffness_drift = function(p, m) return p.k1 * m.t * m.y end,
  damping_drift = function(p, m) return p.c1 * m.t * m.v end,
  parametric_stiffness = function(p, m) return (p.ac * math.cos(p.w * m.t) + p.as * math.sin(p.w * m.t)) * m.y end,
  force_delay = function(p) return p.tau end,
  missing_harmonic = function(p, m) return p.Ac * math.cos(p.w * m.t) + p.As * math.sin(p.w * m.t) end,
  base_motion = function(p, m) return p.mb * m.ab end,
  rotating_unbalance = function(p, m)  -- the centre of gravity goes round: x = e cos(th), its second derivative by hand
    local th = m.shaft_angle + p.phi
    return p.me * (-m.shaft_speed ^ 2 * math.cos(th) - m.shaft_rate * math.sin(th))
  end,
  force_gain = function(p, m) return p.g * m.F end,
  displacement_offset = function(p, m) return m.y + p.b end,
  sensor_drift = function(p, m) return m.y + p.b + (p.d + p.q * m.t) * m.t end,
  sensor_gain = function(p, m) return p.g * m.y end,
  clipping = function(p, m) return math.abs(m.y) > p.level and p.level * sgn(m.y) or m.y end,
}

spec.case("every entry without memory is its formula", function()
  for _, name in ipairs(names) do
    local entry = effects[name]
    assert(#entry.states > 0 or by_hand[name], name .. " is not written out")
    if by_hand[name] then
      local force = entry(samples[name])
      force = entry.maps[1].field == "delay" and force.delay or entry.maps[1].channel and force[entry.maps[1].channel] or force
      for i = 1, 60 do  -- all signs of y and v
        local m = { y = 0.05 * math.sin(2.1 * i), v = math.cos(1.3 * i), a = 9 * math.sin(0.7 * i), t = 0.1 * i,
          ab = math.cos(i), F = 3 * math.cos(2 * i), shaft_angle = 0.9 * i, shaft_speed = 5 + math.sin(i),
          shaft_rate = math.cos(i) }
        local expected = by_hand[name](samples[name], m)
        spec.near(force:at(m), expected, 1e-12 * (1 + math.abs(expected)))
        if #entry.variants > 1 and not further_samples[name] and not entry.maps[1].channel then  -- the mirror image: f(-y, -v) = -f(y, v)
          local given = { variant = 2 }
          for key, value in pairs(samples[name]) do given[key] = value end
          local mirrored = entry(given)
          spec.near(mirrored:at { y = -m.y, v = -m.v }, -expected, 1e-12 * (1 + math.abs(expected)))
        end
      end
    end
  end
end)

spec.case("friction that is rounded at rest is the second form, whose speed the first refuses", function()
  local rounded = effects.coulomb_friction { Fc = 2, vr = 0.3, variant = 2 }
  for _, v in ipairs { -2, -0.1, 0, 0.2, 1 } do
    local e = math.exp(2 * v / 0.3)
    spec.near(rounded:at { v = v }, 2 * (e - 1) / (e + 1), 1e-12)
  end
  spec.equal(tostring(effects.coulomb_friction { Fc = 2 }), "coulomb_friction_Fc*sign(v)")
  spec.contains(spec.message_of(function() effects.coulomb_friction { Fc = 2, vr = 0.3 } end),
    "effects.coulomb_friction: vr: variant 1, Fc*sign(v), has no vr")
end)

spec.case("friction that grows from nothing with the displacement is the second form, which has no Fc", function()
  local hysteretic = effects.position_dependent_friction { alpha = 20, variant = 2 }
  for _, y in ipairs { -0.05, 0, 0.03 } do
    for _, v in ipairs { -2, 0, 0.1 } do
      spec.near(hysteretic:at { y = y, v = v }, v == 0 and 0 or 20 * math.abs(y) * v / math.abs(v), 1e-12)
    end
  end
end)

spec.case("a force that repeats over the displacement is a sine, a cosine or both", function()
  local cosine = effects.sinusoidal_stiffness { k = 5, p = 60, variant = 2 }
  local both = effects.sinusoidal_stiffness { k = 3, kc = -4, p = 60, variant = 3 }
  for _, y in ipairs { -0.05, 0, 0.01, 0.03 } do
    spec.near(cosine:at { y = y }, 5 * math.cos(60 * y), 1e-12)
    spec.near(both:at { y = y }, 5 * math.sin(60 * y - math.atan(4, 3)), 1e-12)
  end
end)

spec.case("the further forms of a faulty channel", function()
  local above, below = effects.clipping { level = 0.03, variant = 2 }.y, effects.clipping { level = 0.03, variant = 3 }.y
  for _, y in ipairs { -0.05, -0.02, 0, 0.02, 0.05 } do
    spec.equal(above:at { y = y }, math.min(y, 0.03))
    spec.equal(below:at { y = y }, math.max(y, -0.03))
  end
  spec.equal(effects.sensor_lag { tau = 0.5, variant = 2 }.F:at { F = 3, force_rate = 4 }, 5.0)
end)

spec.case("an entry says what it is of a channel, or is refused", function()
  local function refused(text, fields)
    fields.name, fields.family, fields.parameters = "odd", "sensor", { { "b" } }
    spec.equal(spec.message_of(function() lunid.effect(fields) end), "effect: odd: " .. text)
  end
  refused("expected a contribution, a channel that measures or acts, or a delay", {})
  refused("measures: expected { y = ... }, or a list of them, got 'F'", { measures = { F = "b*F" } })
  refused("acts: expected { F = ... }, or a list of them, got 'y'", { acts = { y = "b*y" } })
  refused("measures: y: expected a string or an expression or a number, got true", { measures = { y = true } })
  spec.equal(lunid.effect({ name = "odd", family = "sensor", measures = { y = "y + b" }, parameters = { { "b" } } }).formula,
    "y -> y + b")
end)

spec.clean()
spec.finish()

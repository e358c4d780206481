-- The systems of the thesis against integrators written out by hand, and the numbers of its data protocol.
local lunid = require "lunid"
local spec = require "spec"

local pi, systems = math.pi, lunid.systems

local function refused(text, body) spec.equal(spec.message_of(body), text) end

--- The classical Runge-Kutta method for y'' = acceleration(y, v, t), steps of h; y and v at the end.
local function by_hand(acceleration, y, v, duration, h)
  local state = { y, v }
  local function slopes(t, s) return { s[2], acceleration(s[1], s[2], t) } end
  for i = 0, math.floor(duration / h + 0.5) - 1 do state = spec.runge_kutta(slopes, i*h, state, h) end
  return state[1], state[2]
end

--- A run from { 0.02, 0 } under 2000 cos(2 pi 20 t) for half a second, by the named system and by hand.
local function expect(model, acceleration, tolerance)
  local force = lunid.excitation.harmonic { amplitude = 2000, frequency = 20, dt = 0.00125, duration = 0.5 }
  local run = lunid.simulate { model = model, excitation = force, from = { 0.02, 0 }, solver = "fixed", substeps = 16 }
  spec.equal(run.summary.completed, true)
  local y, v = by_hand(function(y, v, t) return acceleration(y, v, 2000*math.cos(2*pi*20*t)) end, 0.02, 0, 0.5, 2e-5)
  spec.near(run:column "y"[401], y, tolerance or 1e-7)
  spec.near(run:column "v"[401], v, (tolerance or 1e-7) * 150)
end

spec.case("linear", function()
  expect(systems.linear {}, function(y, v, F) return F - 2e4*y - 10*v end)
  expect(systems.linear { mass = 2, k = 1e4, c = 3 }, function(y, v, F) return (F - 1e4*y - 3*v) / 2 end)
end)

spec.case("Duffing oscillators", function()
  expect(systems.duffing {}, function(y, v, F) return F - 2e4*y - 1e6*y^3 - 10*v end)
  expect(systems.softening_duffing {}, function(y, v, F) return F - 2e4*y + 1e4*y^3 - 10*v end)
  expect(systems.modified_duffing {},
    function(y, v, F) return F - 1e4*y - 1e5*y^3 - 5e6*y^5 - 2000*y^3*v^2 - 10*v end)
  expect(systems.modified_duffing { velocity_power = 3, e = 2 },
    function(y, v, F) return F - 1e4*y - 1e5*y^3 - 5e6*y^5 - 2*y^3*v^3 - 10*v end)
end)

spec.case("yield", function()
  expect(systems.tanh_yield {}, function(y, v, F)
    local e = math.exp(2*80*y)
    return F - 3000*(e - 1)/(e + 1) - 10*v
  end)
  -- by hand a step across the jump is off by its force times the step squared: 500 N, 20 crossings, 2e-5 s
  expect(systems.harsh_yield {}, function(y, v, F) return F - (y > 1e-3 and 500 or 2e4*y) - 10*v end, 2e-4)
end)

spec.case("van der Pol, both signs", function()
  expect(systems.van_der_pol {}, function(y, v, F) return F - 2e4*y - 10*(y^2 - 1)*v end)
  expect(systems.van_der_pol { sign = "printed" }, function(y, v, F) return F - 2e4*y - 10*(1 - y^2)*v end)
end)

spec.case("van der Pol's period and amplitude", function()
  -- y'' - 5 (1 - y^2) y' + y = 0: amplitude 2.0215, period 11.6122 (Andersen & Geer 1982, SIAM J. Appl. Math. 42, 678)
  local quiet = lunid.excitation.formula { force = 0, dt = 0.005, duration = 120 }
  local run = lunid.simulate { model = systems.van_der_pol { k = 1, c = 5 }, excitation = quiet, from = { 1, 0 } }
  local y, crossings = run:column "y", {}
  for i = 12001, #y - 1 do
    if y[i] < 0 and y[i + 1] >= 0 then crossings[#crossings + 1] = (i - 1 + y[i] / (y[i] - y[i + 1])) * 0.005 end
  end
  spec.near((crossings[#crossings] - crossings[1]) / (#crossings - 1), 11.6122, 1e-3)
  spec.near(y:max(), 2.0215, 1e-3)
end)

spec.case("a mass that depends on the velocity", function()
  local model = systems.velocity_mass {}
  spec.equal(tostring(model.mass), "m + A*v")
  expect(model, function(y, v, F) return (F - 2e4*y - 10*v) / (1 + 5e-3*v) end)
end)

spec.case("the pile, against a return mapping in small steps", function()
  local duration, amplitude, frequency = 0.4, 5330, 30
  local run = lunid.simulate { model = systems.pile {}, excitation = lunid.excitation.harmonic { amplitude = amplitude,
    frequency = frequency, dt = 0.00125, duration = duration }, from = { 0, 0 } }
  spec.equal(run.summary.completed, true)
  local y, v, slip, toe_at, h = 0, 0, 0, 0, 2e-6
  for i = 0, math.floor(duration / h + 0.5) - 1 do
    local smith = 1 + 0.2*math.abs(v)
    local resistance = 2000*slip/1e-3*smith + 5000*math.max(0, y - toe_at)/2e-3*smith
    v = v + h*(amplitude*math.cos(2*pi*frequency*(i + 0.5)*h) + 480 - resistance)/49
    y = y + h*v
    slip = math.max(-1e-3, math.min(1e-3, slip + h*v))
    toe_at = math.max(toe_at, y - 2e-3)
  end
  spec.near(run:column "y"[321], y, 1e-5)  -- of some millimetres; the steps by hand are of first order
  spec.near(run:column "slip"[321], slip, 1e-5)
  spec.near(run:column "toe_at"[321], toe_at, 1e-5)
  assert(run:column("y"):max() > 2e-3, "the toe never yields")
end)

spec.case("the chain of two masses, against the implicit midpoint rule in small steps", function()
  -- appendix J: m1 a1 + (c1 + c2) v1 - c2 v2 + (k1 + k2) y1 - k2 y2 + k3 y1^3 = F1; the same for the second mass
  local m1, m2, k1, k2, c1, c2, cubic = 1, 2, 2e4, 3e4, 10, 5, 1e6
  local model = systems.chain { masses = { m1, m2 }, k = { k1, k2 }, c = { c1, c2 }, cubic = cubic }
  local F = lunid.excitation.harmonic { amplitude = 500, frequency = 20, dt = 0.00125, duration = 0.5 }
  local run = lunid.simulate { model = model, excitation = F, from = { 0.01, 0, 0, 0 }, solver = "fixed", substeps = 8 }
  local y1, v1, y2, v2, h = 0.01, 0, 0, 0, 1e-5
  for i = 0, 49999 do  -- solved by iteration
    local force, d1, d2, w1, w2 = 500*math.cos(2*pi*20*(i + 0.5)*h), v1, v2, 0, 0
    for _ = 1, 4 do
      local p1, p2, q1, q2 = y1 + h/2*d1, y2 + h/2*d2, v1 + h/2*w1, v2 + h/2*w2
      w1 = (force - (k1 + k2)*p1 + k2*p2 - (c1 + c2)*q1 + c2*q2 - cubic*p1^3)/m1
      w2 = (k2*p1 - k2*p2 + c2*q1 - c2*q2)/m2
      d1, d2 = q1, q2
    end
    y1, v1, y2, v2 = y1 + h*d1, v1 + h*w1, y2 + h*d2, v2 + h*w2
  end
  local tolerance = 2e-5 * run:column("y1"):std()  -- (w h)^2/12 of the phase, over the time
  spec.near(run:column "y1"[401], y1, 20 * tolerance)
  spec.near(run:column "y2"[401], y2, 20 * tolerance)
  spec.equal(model.parameters.k2.value, 3e4)
  spec.equal(model.parameters.m2.fixed, true)
end)

spec.case("the chain through the protocol", function()
  local train = lunid.thesis_record { system = systems.chain {}, frequency = 20, seed = 1 }
  spec.equal(tostring(train):match "^[^\n]*", "record thesis, 2000 N at 20 Hz: 2401 rows, 3 s at 800 Hz; channels F1 F2 y1 v1 y2 v2 a1* a2*")
  local test = lunid.thesis_validation { system = systems.chain {}, from = train }
  spec.equal(test:column "y2"[1], train:column "y2"[1])
  spec.equal(test:column("F2"):max(), 0.0)
  refused("systems.chain: cubic_at: expected 1 to 2, got 3", function() systems.chain { cubic_at = 3 } end)
  refused("systems.chain: k: expected 2, one for each mass, got 3", function() systems.chain { k = { 1, 2, 3 } } end)
end)

spec.case("every system has known parameters with units, and runs through the protocol", function()
  for _, name in ipairs { "linear", "duffing", "softening_duffing", "modified_duffing", "tanh_yield", "harsh_yield",
    "van_der_pol", "velocity_mass" } do
    local model = systems[name] {}
    assert(model.parameters.m.fixed and model.parameters.m.value == 1, name)
    for _, row in ipairs(model.parameters) do assert(row.value and (row.unit ~= "" or row.name == "e"), row.name) end
    local records = lunid.thesis_record { system = model, frequency = { 20, 30 }, seed = 1 }
    spec.equal(#records, 2)
    for _, record in ipairs(records) do assert(record:column("y"):max() < 3, name) end
    lunid.thesis_validation { system = model, from = records[1] }
  end
end)

-- ---- the data protocol ----

local duffing = systems.duffing {}

local function std_of_difference(a, b, channel)
  local x, z, square = a:column(channel), b:column(channel), 0
  for i = 1, #x do square = square + (x[i] - z[i]) ^ 2 / #x end
  return math.sqrt(square)
end

spec.case("rows, channels and noise are those of section 2.1", function()
  local whole = { system = duffing, frequency = 20, seed = 1, trim = 0 }
  local noisy = lunid.thesis_record(whole)
  spec.equal(noisy.rows, 4001)  -- t = 0, 0.00125 ... 5
  whole.noise = 0
  local clean = lunid.thesis_record(whole)
  for _, channel in ipairs { "y", "v" } do
    local part = std_of_difference(noisy, clean, channel) / clean:column(channel):std()
    spec.near(part, 0.05, 0.05 * 4 / math.sqrt(2 * 4001))
  end
  local force, time, largest, square = clean:column "F", clean:column "t", 0, 0
  for i = 1, 4001 do
    local e = force[i] - 2000 * math.cos(2 * pi * 20 * time[i])
    largest, square = math.max(largest, math.abs(e)), square + e * e / 4001
  end
  assert(largest <= 100 and largest > 99)  -- 0.05 * 2000 * U(-1, 1)
  spec.near(math.sqrt(square), 100 / math.sqrt(3), 2)
  local record = lunid.thesis_record { system = duffing, frequency = 20, seed = 1 }
  spec.equal(record.rows, 2401)
  spec.near(record.start, 2, 1e-12)
  spec.equal(record.name, "thesis, 2000 N at 20 Hz")
  for i = 1, 2401, 100 do spec.equal(record:column "y"[i], noisy:column "y"[i + 1600]) end
  spec.equal(record.channels.a.derived, true)
  spec.equal(record.channels.y.derived, false)
end)

spec.case("the system feels the noise of the force", function()
  local function y_end(force_noise)
    return lunid.thesis_record { system = duffing, frequency = 20, noise = 0, force_noise = force_noise, seed = 1 }
      :column "y"[2401]
  end
  assert(math.abs(y_end(0) - y_end(0.05)) > 1e-4)
end)

spec.case("a seed is the same bits; the frequencies of a list have noise of their own", function()
  local function y_of(seed, frequency) return lunid.thesis_record { system = duffing, frequency = frequency, seed = seed } end
  spec.equal(std_of_difference(y_of(7, 20), y_of(7, 20), "y"), 0.0)
  assert(std_of_difference(y_of(7, 20), y_of(8, 20), "y") > 1e-3)
  local pair = y_of(7, { 20, 20 })
  spec.equal(std_of_difference(pair[1], y_of(7, 20), "y"), 0.0)
  assert(std_of_difference(pair[1], pair[2], "y") > 1e-3)
end)

spec.case("the validation record: quiet up to 2.2 s, then three sines, from the trimmed record's first state", function()
  local train = lunid.thesis_record { system = duffing, frequency = 20, seed = 1 }
  local test = lunid.thesis_validation { system = duffing, from = train }
  spec.equal(test.rows, 4001)
  spec.equal(test:column "y"[1], train:column "y"[1])
  spec.equal(test:column "v"[1], train:column "v"[1])
  local w = 2 * pi * 30
  for i = 1, 4001, 7 do
    local t = (i - 1) * 0.00125
    spec.near(test:column "F"[i], t <= 2.2 and 0 or 75 * (math.sin(w*t) + math.sin(2*w*t) + math.sin(3*w*t)), 1e-9)
  end
  local y, v = by_hand(function(y, v) return -2e4*y - 1e6*y^3 - 10*v end, train:column "y"[1], train:column "v"[1], 2, 2e-5)
  spec.near(test:column "y"[1601], y, 1e-8)
  spec.near(test:column "v"[1601], v, 1e-6)
end)

spec.case("messages", function()
  refused("lunid.systems has no 'dufing', did you mean 'duffing'?", function() return systems.dufing end)
  refused("systems.duffing: unknown field 'k_3', did you mean 'k3'?", function() systems.duffing { k_3 = 1 } end)
  refused("systems.modified_duffing: velocity_power: expected 2 to 3, got 4",
    function() systems.modified_duffing { velocity_power = 4 } end)
  refused("systems.pile: toe_quake: expected > 0, got 0", function() systems.pile { toe_quake = 0 } end)
  refused("thesis_record: missing field 'system': a model from lunid.systems or lunid.model",
    function() lunid.thesis_record { frequency = 20 } end)
  refused("thesis_record: trim: expected < duration, which is 5 s, got 6",
    function() lunid.thesis_record { system = duffing, frequency = 20, trim = 6 } end)
  refused("excitation.harmonic: frequency: expected < 400 Hz, the Nyquist frequency of dt = 0.00125 s, got 500",
    function() lunid.thesis_record { system = duffing, frequency = 500 } end)
  local message = spec.message_of(function()
    lunid.thesis_record { system = systems.softening_duffing { k3 = 1e5 }, frequency = 20, seed = 1 }
  end)
  spec.contains(message, "thesis_record: the system's run stopped at t = ")
  spec.contains(message, "the restoring force grows without bound beyond |y| = 0.447 m (term -k3*y^3)")
end)

spec.case("help and lists", function()
  local said, code = spec.lunid "help systems duffing"
  spec.equal(code, 0)
  spec.equal(said:match "^[^\n]*", "lunid.systems.duffing { mass =, k =, k3 =, c = }")
  spec.equal(spec.lunid "help systems.duffing", said)
  spec.contains(spec.lunid "help systems", "  van_der_pol          Damping that changes its sign at |y| = 1:")
  spec.contains(spec.lunid "list excitations", "multisine            A sum of cosines of equal amplitude")
  spec.equal(spec.lunid "help systems dufing", "no help on 'systems.dufing', did you mean 'systems.duffing'?\n")
end)

spec.clean()
spec.finish()

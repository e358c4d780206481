-- Frequency responses, backbones and Poincare sections as a study sees them.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local duffing = lunid.model { mass = 1, restoring = 10*v + 2e4*y + 1e6*y^3 }

spec.case("a response of two amplitudes has a curve for each", function()
  local response = lunid.frequency_response { model = duffing, amplitude = { 300, 1000 }, from = 10, to = 60 }
  spec.equal(#response.curves, 2)
  spec.equal(#response:column "frequency", response.curves[1].rows)
  spec.equal(#response:column("amplitude", 2), response.curves[2].rows)
  spec.equal(response.curves[1].complete, true)
  spec.equal(response.curves[1].stopped[1], "reached 60 Hz")
  local folds = {}
  for _, point in ipairs(response.curves[1].special) do
    if point.kind == "fold" then folds[#folds + 1] = point.frequency end
  end
  spec.equal(#folds, 2)
  local frequency, stable = response:column "frequency", response:column "stable"
  for row = 1, #frequency do
    local between = frequency[row] < folds[1] - 1e-9 and frequency[row] > folds[2] + 1e-9
    assert(stable[row] == 1 or between or math.abs(frequency[row] - folds[1]) < 1e-6
      or math.abs(frequency[row] - folds[2]) < 1e-6, "unstable outside the folds")
  end
end)

spec.case("its printed text", function()
  local linear = lunid.model { mass = 1, restoring = 4*v + 400*y }
  local text = tostring(lunid.frequency_response { model = linear, amplitude = 2, from = 1, to = 8, max_step = 0.5 })
  spec.contains(text, "frequency response, 1 to 8 Hz\n2 N: ")
  spec.contains(text, " points by harmonic balance, ")
  spec.contains(text, "\n  peak            3.1511 Hz   0.02513 m\n  reached 8 Hz")
  spec.contains(tostring(lunid.frequency_response { model = duffing, amplitude = 300, from = 10, to = 60 }),
    "\n  fold            31.041 Hz   0.1562 m\n  fold            26.358 Hz   0.05968 m\n"
    .. "  unstable        26.358 to 31.041 Hz\n  reached 60 Hz")
end)

spec.case("harmonics have amplitudes and unwrapped phases", function()
  local response = lunid.frequency_response { model = duffing, amplitude = 1000, from = 5, to = 80 }
  local first, third, phase = response:column "amplitude_1", response:column "amplitude_3", response:column "phase_1"
  assert(third:max() > 0.01*first:max(), "no third harmonic")
  local last = phase[#phase]
  spec.near(last, -math.pi, 0.05)  -- far above the resonance the mass moves against the force
  for row = 2, #phase do assert(math.abs(phase[row] - phase[row - 1]) < 1, "the phase jumps") end
  spec.near(response:column("amplitude_1", 1, "v")[1], 2*math.pi*5*first[1], 1e-9)
end)

spec.case("shooting and stepped runs agree with the series", function()
  local by = {}
  for _, method in ipairs { "harmonic_balance", "shooting" } do
    by[method] = lunid.frequency_response { model = duffing, amplitude = 300, from = 24, to = 34, method = method }
  end
  spec.equal(by.shooting.curves[1].method, "shooting")
  for i, point in ipairs(by.shooting.curves[1].special) do
    spec.equal(point.kind, by.harmonic_balance.curves[1].special[i].kind)
    spec.near(point.frequency, by.harmonic_balance.curves[1].special[i].frequency, 1e-3)
  end
  local up = lunid.frequency_response { model = duffing, amplitude = 300, from = 24, to = 34, method = "stepped_up", points = 11 }
  spec.equal(up.curves[1].rows, 11)
  spec.equal(up:column "periods":max(), 1)
  local swept = lunid.frequency_response { model = duffing, amplitude = 300, from = 24, to = 34, method = "swept_up", rate = 2 }
  spec.near(swept:column "amplitude":max(), 0.155, 0.005)
end)

spec.case("several coordinates, and a moving base", function()
  local chain = lunid.chain { masses = { 1, 1 }, forces = { 1 },
    element = function(d, w, index) return 2e4*d + 2*w end }
  local response = lunid.frequency_response { model = chain, amplitude = 10, from = 5, to = 60 }
  local peaks = {}
  for _, point in ipairs(response.curves[1].special) do peaks[#peaks + 1] = point.frequency end
  spec.equal(#peaks, 2)
  spec.near(peaks[1], math.sqrt(2e4)/(2*math.pi), 0.05)
  spec.near(peaks[2], math.sqrt(6e4)/(2*math.pi), 0.2)
  spec.equal(#response:column("amplitude", 1, "y2"), response.curves[1].rows)

  local yb, vb = lunid.base_displacement, lunid.base_velocity
  local shaken = lunid.model { mass = 1, restoring = 400*(y - yb) + 4*(v - vb) }
  local answer = lunid.frequency_response { model = shaken, amplitude = 0.01, input = "base", from = 1, to = 10 }
  local frequency, amplitude = answer:column "frequency", answer:column "amplitude"
  for row = 1, #frequency, 7 do
    local w = 2*math.pi*frequency[row]
    spec.near(amplitude[row], 0.01*math.sqrt((400^2 + (4*w)^2)/((400 - w^2)^2 + (4*w)^2)), 1e-9)
  end
  spec.contains(tostring(answer), "\n0.01 m: ")
end)

spec.case("a backbone", function()
  local free = lunid.backbone { model = duffing, from = 1e-3, to = 0.3 }
  spec.near(free:column "frequency"[1], math.sqrt(2e4)/(2*math.pi), 1e-3)
  spec.near(free:column "damping"[1], 10/(2*math.sqrt(2e4)), 1e-6)
  spec.near(free:column "amplitude"[free.rows], 0.3, 1e-6)
  spec.equal(free.complete, true)
  spec.equal(free.state, "y")
end)

spec.case("a Poincare section of a limit cycle is one point, of chaos many, all within bounds", function()
  local linear = lunid.model { mass = 1, restoring = 4*v + 400*y }
  local section = lunid.poincare { model = linear, excitation = 2*lunid.cos(10*t), period = 2*math.pi/10, points = 5 }
  local exact = 2*(400 - 100)/((400 - 100)^2 + 40^2)  -- Re of 2/(400 - w^2 + 4 i w)
  spec.equal(section.rows, 5)
  for i = 1, 5 do spec.near(section:column "y"[i], exact, 1e-8) end
  spec.near(section:column "t"[2] - section:column "t"[1], 2*math.pi/10, 1e-12)

  -- Guckenheimer & Holmes 1983, section 2.2: y'' + 0.25 y' - y + y^3 = 0.3 cos t
  local double_well = lunid.model { mass = 1, restoring = 0.25*v - y + y^3 }
  local chaos = lunid.poincare { model = double_well, excitation = 0.3*lunid.cos(t), period = 2*math.pi,
    from = { 0.1, 0 }, points = 400, transient = 50 }
  local places = chaos:column "y"
  assert(places:max() < 2 and places:min() > -2, "the attractor is not bounded")
  assert(places:std() > 0.3, "no chaos")
  local quarter = lunid.poincare { model = linear, excitation = 2*lunid.cos(10*t), period = 2*math.pi/10, points = 1, phase = 0.25 }
  spec.near(quarter:column "y"[1], 2*40/((400 - 100)^2 + 40^2), 1e-8)
end)

-- ---- errors, on their full text ----

local head = [[
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local model = lunid.model { mass = 1, restoring = 10*v + 2e4*y }
]]

local function line_4(line, expected)
  local said, code = spec.study(head .. line .. "\n")
  spec.equal(said, expected .. "\n  nothing was written\n")
  spec.equal(code, 1)
end

spec.case("fields that cannot be", function()
  line_4("lunid.frequency_response { model = model, amplitude = 0, from = 1, to = 2 }",
    "study.lua:4: frequency_response: amplitude: expected a list of numbers > 0 (1 or more), got 0")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 0, to = 2 }",
    "study.lua:4: frequency_response: from: expected > 0, got 0")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 3, to = 2 }",
    "study.lua:4: frequency_response: to: expected > from, which is 3 Hz, got 2")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 1, to = 2, harmonics = 0 }",
    "study.lua:4: frequency_response: harmonics: expected 1 to 500, got 0")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 1, to = 2, method = 'steped_up' }",
    "study.lua:4: frequency_response: method: expected 'auto', 'harmonic_balance', 'shooting', 'stepped_up', 'stepped_down', "
    .. "'swept_up' or 'swept_down', got the string 'steped_up', did you mean 'stepped_up'?")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 1, to = 2, method = 'swept_up' }",
    "study.lua:4: frequency_response: rate: a swept run needs a rate > 0 Hz/s, got 0")
  line_4("lunid.frequency_response { model = model, amplitude = 1, from = 1, to = 2, input = 'F2' }",
    "study.lua:4: frequency_response: input: expected 'base' or one of the model's forces, got 'F2' (the model is driven by F)")
  line_4("lunid.backbone { model = model, from = 2, to = 1 }",
    "study.lua:4: backbone: to: expected > from, which is 2 m, got 1")
  line_4("lunid.backbone { model = model, from = 1, to = 2, mode = 2 }",
    "study.lua:4: backbone: mode: the model has 1 oscillating mode at rest, got 2")
  line_4("lunid.poincare { model = model, excitation = lunid.cos(t), period = 0 }",
    "study.lua:4: poincare: period: expected > 0, got 0")
  line_4("lunid.poincare { model = model, excitation = lunid.cos(t), period = 1, phase = 1 }",
    "study.lua:4: poincare: phase: expected >= 0 and < 1, got 1")
end)

spec.case("models that have no answer", function()
  line_4("lunid.frequency_response { model = lunid.model { mass = 0, restoring = y, motion = 'imposed' }, amplitude = 1, from = 1, to = 2 }",
    "study.lua:4: frequency_response: the motion of this model is imposed: nothing is free to answer a force")
  line_4("lunid.frequency_response { model = lunid.model { mass = 1, restoring = y*(1 + 0.1*lunid.sin(t)) }, amplitude = 1, from = 1, to = 2 }",
    "study.lua:4: frequency_response: the model holds the time t itself, so its answers do not repeat with the excitation; use "
    .. "simulate and poincare")
  line_4("lunid.frequency_response { model = lunid.model { mass = 1, restoring = lunid.parameter { 'k' }*y }, amplitude = 1, from = 1, to = 2 }",
    "study.lua:4: frequency_response: parameter 'k' has no value: model:with { k = ... }, or fit it first")
  line_4("lunid.backbone { model = lunid.model { mass = 1, restoring = lunid.state { 'z', rate = v, min = -1, max = 1 } }, from = 1, to = 2 }",
    "study.lua:4: backbone: the state 'z' is held at a bound, which harmonic balance cannot follow")
  local said = spec.study(head .. "lunid.poincare { model = lunid.model { mass = 1, restoring = -y^3 }, "
    .. "excitation = lunid.cos(t), period = 6, from = { 1, 0 } }\n")
  spec.contains(said, "study.lua:4: poincare: the run stopped at t = 1.688 s: the restoring force drives y away from rest at any displacement (term -y^3)")
end)

spec.case("columns that there are not", function()
  local response = lunid.frequency_response { model = duffing, amplitude = 300, from = 10, to = 12 }
  spec.equal(spec.message_of(function() return response:column "frequncy" end), "a response has no column 'frequncy'; it has "
    .. "frequency stable branch harmonics periods multiplier amplitude min max mean amplitude_1 phase_1 amplitude_2 ...")
  spec.equal(spec.message_of(function() return response:column("amplitude", 2) end), "column: curve: expected 1 to 1, got 2")
  spec.equal(spec.message_of(function() return response:column("amplitude", 1, "y2") end),
    "a response has no state 'y2'; it has y v")
end)

spec.case("its figure has stable and unstable branches, and the folds", function()
  local said, code = spec.study([[
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local response = lunid.frequency_response { model = lunid.model { mass = 1, restoring = 10*v + 2e4*y + 1e6*y^3 },
  amplitude = 300, from = 10, to = 60 }
lunid.figure.response(response):export "frf.csv"
response:save "response.csv"
lunid.figure.response { response, quantity = "amplitude_9x" }
]])
  spec.contains(said, "study.lua:7: a response has no column 'amplitude_9x'; it has ")
  spec.equal(code, 1)
  said, code = spec.study([[
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local response = lunid.frequency_response { model = lunid.model { mass = 1, restoring = 10*v + 2e4*y + 1e6*y^3 },
  amplitude = 300, from = 10, to = 60 }
lunid.figure.response(response):export "frf.csv"
response:save "response.csv"
]])
  spec.equal(code, 0)
  local figure = spec.shell "cat study-out/frf.csv"
  spec.contains(figure, '300 N')
  spec.contains(figure, '300 N, unstable')
  local folds = 0
  for line in figure:gmatch "[^\n]+" do
    if line:find("fold", 1, true) and line:find("31.041", 1, true) then folds = folds + 1 end
  end
  spec.equal(folds, 1)
  local table_of = spec.shell "head -2 study-out/response.csv"
  spec.contains(table_of, "excitation,frequency,branch,stable,multiplier,harmonics,y_amplitude,y_mean,y_amplitude_1,y_phase_1,")
  spec.contains(table_of, "\n300,10,1,1,")
end)

spec.clean()
spec.finish()

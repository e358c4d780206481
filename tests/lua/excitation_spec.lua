-- Every excitation has the spectrum, the peak and the rms that it promises, and drives a model exactly.
local lunid = require "lunid"
local spec = require "spec"

local e, pi = lunid.excitation, math.pi
local y, v, t = lunid.displacement, lunid.velocity, lunid.time

local function with(base, fields)
  local all = {}
  for key, value in pairs(base) do all[key] = value end
  for key, value in pairs(fields) do all[key] = value end
  return all
end

local base = { dt = 0.002, duration = 4 }

--- Amplitude of the line at a frequency over the first n rows: 2/n |sum x exp(-i w t)|.
local function line(x, n, dt, frequency)
  local c, s = 0, 0
  for i = 1, n do
    local angle = 2 * pi * frequency * dt * (i - 1)
    c, s = c + x[i] * math.cos(angle), s + x[i] * math.sin(angle)
  end
  return 2 / n * math.sqrt(c * c + s * s)
end

local function rms(x, n)
  local sum = 0
  for i = 1, n do sum = sum + x[i] ^ 2 end
  return math.sqrt(sum / n)
end

local function same(a, b)
  local x, z = a:column "F", b:column "F"
  for i = 1, #x do
    if x[i] ~= z[i] then return false end
  end
  return true
end

spec.case("a harmonic is its cosine, on its time base", function()
  local record = e.harmonic { amplitude = 3, frequency = 7, phase = 0.4, dt = 0.01, duration = 2, start = 1.5 }
  spec.equal(tostring(record):match "^[^\n]*", "record harmonic, 3 N at 7 Hz: 201 rows, 2 s at 100 Hz; channels F")
  spec.equal(record.start, 1.5)
  local force, time = record:column "F", record:column "t"
  for i = 1, record.rows, 17 do spec.near(force[i], 3 * math.cos(2 * pi * 7 * time[i] + 0.4), 1e-13) end
  spec.equal(record.channels.F.unit, "N")
  spec.equal(record.channels.F.source, "harmonic, 3 N at 7 Hz")
end)

spec.case("a multisine has its lines, its rms and nothing else", function()
  local record = e.multisine(with(base, { from = 5, to = 40, rms = 12, period = 2, seed = 3 }))
  local x, n = record:column "F", 1000
  local lines = 71  -- 5.0, 5.5 ... 40.0 Hz
  spec.near(rms(x, n), 12, 1e-9)
  for frequency = 0.5, 60, 0.5 do
    local inside = frequency >= 5 and frequency <= 40
    spec.near(line(x, n, 0.002, frequency), inside and 12 * math.sqrt(2 / lines) or 0, 1e-9)
  end
  for i = 1, 1000, 37 do spec.near(x[i + 1000], x[i], 1e-9) end  -- it repeats
  spec.near(line(e.multisine(with(base, { from = 5, to = 6, amplitude = 2 })):column "F", 2000, 0.002, 5.25), 2, 1e-9)
end)

spec.case("an odd multisine has no even lines", function()
  local x = e.multisine(with(base, { from = 1, to = 30, rms = 5, period = 2, odd = true, seed = 8 })):column "F"
  for k = 1, 80 do
    local even = k % 2 == 0 or k > 60 or k < 2
    local amplitude = line(x, 1000, 0.002, k / 2)
    if even then spec.near(amplitude, 0, 1e-10) else assert(amplitude > 0.1) end
  end
end)

spec.case("Schroeder's phases have a low crest factor, random ones a high one", function()
  local function crest(fields)
    local x = e.multisine(with({ dt = 1 / 2048, duration = 1, from = 1, to = 100, rms = 1 }, fields)):column "F"
    return math.max(x:max(), -x:min())
  end
  local schroeder = crest { phases = "schroeder" }
  assert(schroeder < 1.8, schroeder)  -- Schroeder 1970: about 1.7; sqrt(2) is a single sine
  local least, most = math.huge, 0
  for seed = 1, 10 do
    local each = crest { seed = seed }
    least, most = math.min(least, each), math.max(most, each)
  end
  assert(least > 2.4 and most < 5, ("random phases: %g to %g"):format(least, most))
end)

--- Instantaneous frequency [Hz] by the zeros of the force: one over the time of two half periods.
local function frequencies(record)
  local x, time, zeros, found = record:column "F", record:column "t", {}, {}
  for i = 1, #x - 1 do
    if x[i] * x[i + 1] < 0 then zeros[#zeros + 1] = time[i] + (time[i + 1] - time[i]) * x[i] / (x[i] - x[i + 1]) end
  end
  for i = 1, #zeros - 2 do found[i] = { at = zeros[i + 1], frequency = 1 / (zeros[i + 2] - zeros[i]) } end
  return found
end

spec.case("a swept sine runs through its frequencies", function()
  local sweep = { amplitude = 2, from = 3, to = 30, dt = 0.0005, duration = 10, start = 1 }
  for _, each in ipairs(frequencies(e.swept_sine(sweep))) do
    spec.near(each.frequency, 3 + 27 * (each.at - 1) / 10, 0.1)
  end
  for _, each in ipairs(frequencies(e.swept_sine(with(sweep, { law = "logarithmic" })))) do
    local promised = 3 * 10 ^ ((each.at - 1) / 10)
    spec.near(each.frequency, promised, 0.015 * promised)
  end
  local down = frequencies(e.swept_sine(with(sweep, { from = 30, to = 3 })))
  spec.near(down[1].frequency, 30, 0.5)
  spec.near(down[#down].frequency, 3, 0.6)
end)

spec.case("a stepped sine dwells, and its phase does not jump", function()
  local record = e.stepped_sine { amplitude = 1, frequencies = { 5, 8, 6.5 }, dt = 0.001, duration = 9 }
  for _, each in ipairs(frequencies(record)) do
    local promised = each.at < 3 and 5 or each.at < 6 and 8 or 6.5
    local edge = math.min(math.abs(each.at - 3), math.abs(each.at - 6))
    if edge > 0.2 then spec.near(each.frequency, promised, 0.02) end
  end
  local x, steepest = record:column "F", 0
  for i = 1, #x - 1 do steepest = math.max(steepest, math.abs(x[i + 1] - x[i])) end
  assert(steepest <= 2 * pi * 8 * 0.001)
end)

spec.case("step, pulses and impulse have their heights, widths and areas", function()
  local step = e.step { height = 3, at = 0.1004, dt = 0.001, duration = 0.5 }:column "F"
  spec.equal(step[100], 0.0)
  spec.equal(step[101], 3.0)
  spec.equal(step[501], 3.0)
  local pulse = e.pulse { height = 5, width = 0.02, at = 0.1, dt = 0.001, duration = 0.5 }
  local count = 0
  for _, value in ipairs(pulse:column("F"):list()) do count = count + (value == 5 and 1 or 0) end
  spec.equal(count, 20)
  spec.equal(pulse.channels.F.between, "hold")
  local half = e.pulse { height = 5, width = 0.02, at = 0.1, shape = "half_sine", dt = 0.0001, duration = 0.5 }
  spec.near(half:column("F"):max(), 5, 1e-12)
  spec.near(half:column("F"):mean() * 5001 * 0.0001, 5 * 0.02 * 2 / pi, 2e-6)  -- a sum of 200 rows: 1/(6*200^2) of pi^2/2
  spec.near(e.impulse { impulse = 2, at = 0.3, dt = 0.001, duration = 0.5 }:column("F"):mean() * 501 * 0.001, 2, 1e-12)
end)

spec.case("white noise has its rms and no colour, by its seed", function()
  local time = { dt = 0.001, duration = 50 }
  local gauss = e.white_noise(with(time, { rms = 4, seed = 1 }))
  spec.near(gauss:column("F"):std(), 4, 4 * 4 / math.sqrt(2 * 50001))
  local x, product = gauss:column("F"):list(), 0
  for i = 1, #x - 1 do product = product + x[i] * x[i + 1] / 16 end
  spec.near(product / #x, 0, 4 / math.sqrt(#x))
  local even = e.white_noise(with(time, { rms = 4, distribution = "uniform", seed = 1 })):column "F"
  spec.near(even:std(), 4, 0.05)
  assert(even:max() <= 4 * math.sqrt(3) and even:max() > 4 * math.sqrt(3) * 0.999)
  assert(same(gauss, e.white_noise(with(time, { rms = 4, seed = 1 }))))
  assert(not same(gauss, e.white_noise(with(time, { rms = 4, seed = 2 }))))
end)

spec.case("band-limited and coloured noise have their rms and place", function()
  local band = e.band_limited_noise { from = 20, to = 50, rms = 3, dt = 0.002, duration = 20, seed = 5 }:column "F"
  spec.near(band:rms(), 3, 1e-12)
  local inside, outside = 0, 0
  for k = 1, 190 do
    local power = line(band, 10000, 0.002, k) ^ 2
    if k > 20 and k < 50 then inside = inside + power / 29 elseif k < 19 or k > 51 then outside = outside + power / 160 end
  end
  assert(outside < 2e-3 * inside, outside / inside)
  local brown = e.coloured_noise { exponent = 2, rms = 3, dt = 0.002, duration = 20, seed = 5 }:column "F"
  spec.near(brown:rms(), 3, 1e-12)
end)

spec.case("a taper rises and falls as a cosine, noise and formulas alike", function()
  local time = { dt = 0.001, duration = 2, start = 0.5, taper = 0.5 }
  local function weight(i)  -- Tukey's window (Harris 1978)
    local edge = math.min(i, 2000 - i) / 500
    return edge < 1 and 0.5 - 0.5 * math.cos(pi * edge) or 1
  end
  local sine = { amplitude = 3, frequency = 11 }
  local tapered, plain = e.harmonic(with(time, sine)):column "F", e.harmonic(with(with(time, sine), { taper = 0 })):column "F"
  local rough = e.white_noise(with(time, { rms = 1, seed = 4 })):column "F"
  local clean = e.white_noise(with(time, { rms = 1, seed = 4, taper = 0 })):column "F"
  for i = 0, 2000, 13 do
    spec.near(tapered[i + 1], weight(i) * plain[i + 1], 1e-12)
    spec.near(rough[i + 1], weight(i) * clean[i + 1], 1e-12)
  end
  local hann = e.formula { force = 1, dt = 0.001, duration = 2, taper = 1 }:column "F"
  for i = 0, 2000, 13 do spec.near(hann[i + 1], math.sin(pi * i / 2000) ^ 2, 1e-12) end
end)

spec.case("sums add samples and formulas", function()
  local a = e.harmonic(with(base, { amplitude = 3, frequency = 7 }))
  local b = e.swept_sine(with(base, { amplitude = 2, from = 3, to = 9 }))
  local c = e.step(with(base, { height = 5, at = 1 }))
  local sum = e.sum { a, b, c }
  spec.equal(sum.name, "harmonic, 3 N at 7 Hz + swept sine, 2 N, 3 to 9 Hz, linear + step, 5 N at 1 s")
  for i = 1, sum.rows, 31 do
    spec.near(sum:column "F"[i], a:column "F"[i] + b:column "F"[i] + c:column "F"[i], 1e-12)
  end
  spec.equal(sum.channels.F.between, "linear")  -- a step beside a formula is a ramp of one sample
  spec.equal(e.sum { c, c }.channels.F.between, "hold")
  spec.equal(e.sum { parts = { c, c }, interpolation = "cubic" }.channels.F.between, "cubic")
  spec.near(e.sum { a, b }.channels.F.formula:at { t = 0.12345 },
    a.channels.F.formula:at { t = 0.12345 } + b.channels.F.formula:at { t = 0.12345 }, 1e-13)
end)

-- ---- what they do to a linear oscillator, against Duhamel's integral ----

local m, k, c = 2, 800, 4
local model = lunid.model { mass = m, restoring = k*y + c*v }
local decay = c / (2 * m)
local wd = math.sqrt(k / m - decay ^ 2)

--- y(T) = 1/(m wd) * integral of F(s) exp(-decay (T - s)) sin(wd (T - s)) ds, by Gauss-Legendre's three points on
--- pieces of 1/8000 s that begin and end with the samples.
local function duhamel(force, T)
  local sum, pieces = 0, math.floor(T * 8000 + 0.5)
  local h = T / pieces
  for i = 0, pieces - 1 do
    for _, node in ipairs { { -math.sqrt(0.6), 5 / 18 }, { 0, 8 / 18 }, { math.sqrt(0.6), 5 / 18 } } do
      local s = (i + 0.5 + 0.5 * node[1]) * h
      sum = sum + h * node[2] * force(s) * math.exp(-decay * (T - s)) * math.sin(wd * (T - s))
    end
  end
  return sum / (m * wd)
end

local function expect_response(excitation, force)
  local run = lunid.simulate { model = model, excitation = excitation, solver = "fixed", substeps = 8 }
  local scale = run:column("y"):std()
  for _, row in ipairs { 101, 251, 501 } do spec.near(run:column "y"[row], duhamel(force, (row - 1) * 0.004), 1e-8 * scale) end
end

local time = { dt = 0.004, duration = 2 }

spec.case("the response to formulas is exact between coarse samples", function()
  local sine = e.harmonic(with(time, { amplitude = 30, frequency = 60, phase = 0.3 }))  -- four samples a period
  expect_response(sine, function(s) return 30 * math.cos(2 * pi * 60 * s + 0.3) end)
  expect_response(e.swept_sine(with(time, { amplitude = 30, from = 1, to = 50 })),
    function(s) return 30 * math.cos(2 * pi * (s + 49 / 4 * s * s)) end)
  local linear = lunid.simulate { model = model, excitation = sine, interpolation = "linear", solver = "fixed", substeps = 8 }
  local wrong = math.abs(linear:column "y"[501] - duhamel(function(s) return 30 * math.cos(2 * pi * 60 * s + 0.3) end, 2))
  assert(wrong > 1e-2 * linear:column("y"):std(), "straight lines between the samples are another force")
end)

spec.case("the response to jumps is exact", function()
  expect_response(e.step(with(time, { height = 7, at = 0.2 })), function(s) return s < 0.2 and 0 or 7 end)
  expect_response(e.pulse(with(time, { height = 7, at = 0.2, width = 0.04 })),
    function(s) return s < 0.2 and 0 or s < 0.24 and 7 or 0 end)
  expect_response(e.pulse(with(time, { height = 7, at = 0.2, width = 0.04, shape = "half_sine" })),
    function(s) return s < 0.2 and 0 or s < 0.24 and 7 * math.sin(pi * (s - 0.2) / 0.04) or 0 end)
  expect_response(e.impulse(with(time, { impulse = 3, at = 0.2 })),
    function(s) return s < 0.2 and 0 or s < 0.204 and 750 or 0 end)
end)

spec.case("SUNDIALS sees the same force", function()
  local force = e.sum { e.harmonic(with(time, { amplitude = 30, frequency = 60 })),
    e.white_noise(with(time, { rms = 5, seed = 2 })) }
  local fixed = lunid.simulate { model = model, excitation = force, solver = "fixed", substeps = 8 }
  local adams = lunid.simulate { model = model, excitation = force, solver = "adams", rtol = 1e-9 }
  local scale = fixed:column("y"):std()
  for _, row in ipairs { 101, 251, 501 } do spec.near(adams:column "y"[row], fixed:column "y"[row], 1e-5 * scale) end
end)

spec.case("a part of an excitation and a saved one are the same force", function()
  local whole = e.harmonic(with(time, { amplitude = 30, frequency = 20 }))
  local part = lunid.simulate { model = model, excitation = whole:window(1, 2), substeps = 4 }
  local shifted = lunid.simulate { model = model, substeps = 4,
    excitation = e.harmonic { amplitude = 30, frequency = 20, dt = 0.004, start = 1, duration = 1 } }
  spec.near(part:column "y"[201], shifted:column "y"[201], 1e-12)
  local path = spec.folder .. "/force.csv"
  whole:save(path)
  assert(same(lunid.read(path), whole))
end)

-- ---- messages ----

local function refused(text, body) spec.equal(spec.message_of(body), text) end

spec.case("a misspelt field", function()
  refused("excitation.harmonic: unknown field 'amplitud', did you mean 'amplitude'?",
    function() e.harmonic(with(base, { amplitud = 1, frequency = 2 })) end)
  refused("lunid.excitation has no 'multisin', did you mean 'multisine'?", function() return e.multisin end)
  refused("excitation.swept_sine: law: expected 'linear' or 'logarithmic', got the string 'logaritmic', did you mean "
    .. "'logarithmic'?", function() e.swept_sine(with(base, { amplitude = 1, from = 1, to = 2, law = "logaritmic" })) end)
end)

spec.case("values that cannot be", function()
  refused("excitation.harmonic: frequency: expected < 250 Hz, the Nyquist frequency of dt = 0.002 s, got 300",
    function() e.harmonic(with(base, { amplitude = 1, frequency = 300 })) end)
  refused("excitation.multisine: to: expected > from, which is 30, got 20",
    function() e.multisine(with(base, { from = 30, to = 20, rms = 1 })) end)
  refused("excitation.multisine: to: expected < 250 Hz, the Nyquist frequency of dt = 0.002 s, got 400",
    function() e.multisine(with(base, { from = 30, to = 400, rms = 1 })) end)
  refused("excitation.multisine: rms: expected > 0, got 0",
    function() e.multisine(with(base, { from = 3, to = 4, rms = 0 })) end)
  refused("excitation.multisine: rms: give either rms, of the whole force, or amplitude, of each cosine",
    function() e.multisine(with(base, { from = 3, to = 4 })) end)
  refused("excitation.multisine: duration: expected at least one period, 5 s, got 4",
    function() e.multisine(with(base, { from = 3, to = 4, rms = 1, period = 5 })) end)
  refused("excitation.multisine: period: no odd line k/period, 1 Hz apart, lies within 3.5 to 4.5 Hz; expected a longer "
    .. "period", function() e.multisine(with(base, { from = 3.5, to = 4.5, rms = 1, period = 1, odd = true })) end)
  refused("excitation.swept_sine: to: expected another frequency than from, 5 Hz",
    function() e.swept_sine(with(base, { amplitude = 1, from = 5, to = 5 })) end)
  refused("excitation.stepped_sine: frequencies: entry 2: expected < 250 Hz, the Nyquist frequency of dt = 0.002 s, got 260",
    function() e.stepped_sine(with(base, { amplitude = 1, frequencies = { 5, 260 } })) end)
  refused("excitation.band_limited_noise: to: expected a band of at least 1/duration = 0.249875 Hz, got 0.1",
    function() e.band_limited_noise(with(base, { from = 5, to = 5.1, rms = 1 })) end)
  refused("excitation.coloured_noise: exponent: expected -4 to 4, got 7",
    function() e.coloured_noise(with(base, { exponent = 7, rms = 1 })) end)
  refused("excitation.step: at: expected within 0 to 4 s, got 9",
    function() e.step(with(base, { height = 1, at = 9 })) end)
  refused("excitation.pulse: width: expected at least one sample, dt = 0.002 s, got 0.001",
    function() e.pulse(with(base, { height = 1, width = 0.001 })) end)
  refused("excitation.formula: force: expected an expression of lunid.time alone, got one with 'y'",
    function() e.formula(with(base, { force = t*y })) end)
end)

spec.case("a time base that cannot be", function()
  refused("excitation.step: missing field 'dt': a number > 0", function() e.step { height = 1, duration = 3 } end)
  refused("excitation.step: dt: expected at most a fifth of the duration, 0.2 s, got 0.5",
    function() e.step { height = 1, dt = 0.5, duration = 1 } end)
  refused("excitation.step: dt: 1e+06 s in steps of 0.001 s are 1e+09 rows, 8 GB a channel; take a larger step or a part of "
    .. "the time", function() e.step { height = 1, dt = 0.001, duration = 1e6 } end)
  refused("excitation.step: taper: expected 0 to 1, got 2",
    function() e.step { height = 1, dt = 0.001, duration = 1, taper = 2 } end)
end)

spec.case("sums of what does not fit", function()
  local a, b = e.step { height = 1, dt = 0.01, duration = 1 }, e.step { height = 1, dt = 0.01, duration = 2 }
  refused("excitation.sum: parts: entry 2: expected 101 rows of 0.01 s from 0 s as entry 1, got 201 rows of 0.01 s from 0 s",
    function() e.sum { a, b } end)
  refused("excitation.sum: parts: entry 2: expected a record from lunid.excitation, got 3", function() e.sum { a, 3 } end)
  refused("excitation.sum: unknown field 'interpolate', did you mean 'interpolation'?",
    function() e.sum { a, a, interpolate = "hold" } end)
end)

spec.clean()
spec.finish()

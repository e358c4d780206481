-- Derivatives, filters, rates, delays, integrals and spectra in the language: what they give, remember and refuse.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local run = lunid.simulate {
  model = lunid.model { mass = 1, restoring = 400*y + 2*v },
  excitation = lunid.excitation.multisine { from = 0.5, to = 8, rms = 30, dt = 0.005, duration = 20 },
}:record()
local noisy = run:with_noise { y = 0.05, seed = 3 }

--- rms difference of a channel from the run's, over its deviation there.
local function error_of(record, channel)
  local a, b, sum = record:column(channel), run:column(channel), 0
  for i = 1, #a do sum = sum + (a[i] - b[i]) ^ 2 / #a end
  return math.sqrt(sum) / b:std()
end

local measured = noisy:derive { channels = { "v", "a" }, from = "y" }  -- so that v and a count as derived

spec.case("every method derives v and a, and the channels remember how", function()
  local limits = { finite_differences = 1, savitzky_golay = 0.25, fourier = 0.15, spline = 0.25, smoothed_differences = 1,
    kalman = 0.25 }
  for _, name in ipairs { "finite_differences", "savitzky_golay", "fourier", "spline", "smoothed_differences", "kalman" } do
    local derived = measured:derive { method = lunid.derivative[name] {} }
    assert(error_of(derived, "a") < limits[name], ("%s: %g"):format(name, error_of(derived, "a")))
    assert(derived.channels.a.derived and derived.channels.a.derivation:match "^of y by ", derived.channels.a.derivation)
    spec.equal(#derived.history, 2)
    spec.equal(derived.channels.a.unit, "m/s^2")
  end
  spec.equal(measured:derive().channels.v.derivation, "of y by Fourier with Wiener's gain from the noise")
  spec.equal(measured:derive { method = lunid.derivative.savitzky_golay { rows = 21, order = 3 } }.channels.v.derivation,
    "of y by Savitzky-Golay of order 3 over 21 rows")
  local part = measured:window(1, 4):derive { method = lunid.derivative.total_variation { order = 2, weight = 0.01 } }
  spec.contains(part.history[2], "derive: v, a of y by total variation of order 2, weight 0.01, ")
end)

spec.case("filters, trends and rates are methods with a history", function()
  local record = measured:filter { to = 15, channels = { "y" } }:detrend { degree = 1, channels = { "y" } }:decimate(2)
    :resample(80)
  spec.equal(table.concat(record.history, "\n", 2),
    "filter: y below 15 Hz, Butterworth of order 4 forwards and backwards\n"
      .. "detrend: y less a line\n"
      .. "decimate: every row of 2, without what lies above 50 Hz\n"
      .. "resample: from 100 to 80 Hz")
  spec.near(record.dt, 1 / 80, 1e-15)
  assert(tostring(record):find("\n  detrend: y less a line\n", 1, true), tostring(record))
  assert(error_of(measured:filter { to = 15 }, "y") < 0.5 * error_of(measured, "y"))
end)

spec.case("a delay is found and taken off", function()
  local late = measured:window(2.005, 18)
  local moved, delay, correlation = late:align { with = measured, channel = "y" }
  spec.near(delay, 0, 1e-4)
  assert(correlation > 0.999)
  spec.near(moved.dt, measured.dt, 1e-15)
end)

spec.case("an acceleration is integrated without drift", function()
  local t, a, lines = run:column "t", run:column "a", { "t,a" }
  for i = 1, #t do lines[#lines + 1] = ("%.17g,%.17g"):format(t[i], a[i]) end
  spec.write("acceleration.csv", table.concat(lines, "\n") .. "\n")
  local from_a = lunid.read(spec.folder .. "/acceleration.csv")
  local motion = from_a:integrate { from = "a", below = 0.2 }
  assert(error_of(motion, "v") < 0.05, tostring(error_of(motion, "v")))
  spec.equal(motion.channels.y.derivation, "of a by integration, less all below 0.2 Hz")
end)

spec.case("spectra are columns to draw and save", function()
  local s = measured:spectrum "y"
  spec.equal(#s.frequency, #s.density)
  local path = spec.folder .. "/spectrum.csv"
  s:save(path)
  local file = assert(io.open(path))
  spec.equal(file:read "l", "frequency,density,low,high")
  file:close()
  lunid.figure.series { s:column "frequency", s:column "density" }
  local h = measured:transfer { input = "F", output = "y", length = 512 }
  local at = 0  -- the static answer 1/k, below the resonance of 3.2 Hz
  for i = 1, #h.frequency do
    if h.frequency[i] <= 1 then at = i end
  end
  spec.near(h.magnitude[at], 1 / (400 - (2*math.pi*h.frequency[at])^2), 0.1 / 400)
  assert(h.magnitude_low[at] < h.magnitude[at] and h.magnitude[at] < h.magnitude_high[at])
  spec.contains(tostring(h), "H1 from F to y: ")
  local g = measured:spectrogram { channel = "y", length = 256 }
  spec.equal(#g.time, #g.ridge)
  spec.equal(#g:at(1), #g.frequency)
end)

spec.case("a decay's envelope and cycles tell its frequency and damping", function()
  local decay = lunid.simulate {
    model = lunid.model { mass = 1, restoring = 400*y + 0.8*v },
    excitation = 0, from = { 0.1, 0 }, dt = 0.005, duration = 6,
  }:record():with_noise { y = lunid.noise.gaussian { std = 5e-4 }, seed = 1 }
  local c = decay:cycles "y"
  spec.near(c.frequency:mean(), 20 / (2*math.pi), 0.03)
  spec.near(math.log(c.amplitude[1] / c.amplitude[11]) / (c.time[11] - c.time[1]), 0.4, 0.03)
  local e = decay:envelope "y"
  spec.near(math.log(e.amplitude[101] / e.amplitude[601]) / 2.5, 0.4, 0.03)
end)

spec.case("noise and summary say what a channel is like", function()
  local n = measured:noise "y"
  spec.near(n.white / (0.05 * run:column("y"):std()), 1, 0.1)
  spec.near(n.robust / (0.05 * run:column("y"):std()), 1, 0.1)
  local summary = measured:summary()
  spec.equal(summary.rows, 4001)
  spec.equal(summary.channels.y.missing, 0)
  spec.near(summary.channels.y.std, measured:column("y"):std(), 1e-12)
  spec.equal(tostring(summary), tostring(measured))
  spec.contains(tostring(measured), "\n  v  ")
end)

local head = [[
local lunid = require "lunid"
local record = lunid.excitation.harmonic { amplitude = 1, frequency = 3, dt = 0.01, duration = 2 }
]]

local function line_3(line, expected)
  local said, code = spec.study(head .. line .. "\n")
  spec.equal(said, expected .. "\n  nothing was written\n")
  spec.equal(code, 1)
end

spec.case("what cannot be done is refused with the user's line", function()
  line_3("record:filter { to = 60 }", "study.lua:3: filter: to: expected < 50 Hz, the Nyquist frequency, got 60")
  line_3("record:filter { to = 10, order = 13 }", "study.lua:3: filter: order: expected 1 to 12, got 13")
  line_3("record:filter { below = 10 }",
    "study.lua:3: filter: unknown field 'below' (fields: from, to, stop, order, channels)")
  line_3("record.filter { to = 10 }", "study.lua:3: filter: expected record:filter { ... }, with a colon")
  line_3("record:derive {}", "study.lua:3: derive: expected a displacement y or a velocity v to derive the motion from")
  line_3("record:derive { method = 'kalman' }",
    "study.lua:3: derive: method: expected a derivative from lunid.derivative, got the string 'kalman'")
  line_3("lunid.derivative.spline { degree = 7 }", "study.lua:3: derivative.spline: degree: expected 3 to 5, got 7")
  line_3("lunid.derivative.kalmann {}",
    "study.lua:3: lunid.derivative has no 'kalmann', did you mean 'kalman'?")
  line_3("record:spectrum 'y'", "study.lua:3: spectrum: the record has no channel 'y' (it has F)")
  line_3("record:spectrum { channel = 'F', length = 100 }",
    "study.lua:3: spectrum: length: expected a power of two from 16 to the record's 201 rows, got 100")
  line_3("record:resample(-1)", "study.lua:3: resample: rate: expected > 0, got -1")
  line_3("record:decimate()", "study.lua:3: decimate: missing field 'factor': a whole number >= 1")
  line_3("record:spectrum('F'):column 'frequenzy'",
    "study.lua:3: column: a spectrum has no column 'frequenzy', did you mean 'frequency'?")
end)

spec.case("rows that are no numbers are named with their time", function()
  local gap = run:with_noise { y = lunid.noise.dropped { fraction = 0.001, fill = "gap" }, seed = 5 }
  local message = spec.message_of(function() gap:derive { channels = { "y" }, smooth = true } end)
  assert(message:match "^derive: channel 'y' is not a number at t = [%d.]+ s %(%d+ rows? of 4001%); cut the record there",
    message)
end)

spec.clean()
spec.finish()

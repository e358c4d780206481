-- lunid.stream: the regressions of a record that stays in its file, and what refuses one by name.
local lunid = require "lunid"
local spec = require "spec"
local y, v = lunid.displacement, lunid.velocity

local path = "../data/spring_multisine.csv"
local record, stream = lunid.read(path), lunid.stream(path)

local function fit(given)
  given.mass = 49
  given.features = given.features or { lunid.polynomials({ y, v }, 3) }
  return lunid.regress(given)
end

spec.case("a stream has the fields of its record", function()
  for _, field in ipairs { "name", "rows", "dt", "start", "duration" } do spec.equal(stream[field], record[field]) end
  spec.equal(#stream.channels, #record.channels)
  for _, channel in ipairs(record.channels) do
    spec.equal(stream.channels[channel.name].noise, channel.noise)
    spec.equal(stream.channels[channel.name].derivation, channel.derivation)
  end
  spec.equal(tostring(stream):match "^stream .-spring_multisine.csv: %d+ rows, .- at 800 Hz; channels F y v%* a%*" ~= nil, true)
  spec.equal(stream:window(1, 7).rows, record:window(1, 7).rows)
  spec.equal(lunid.stream(path, { window = lunid.window(1, 7) }).rows, record:window(1, 7).rows)
end)

spec.case("regressions are those of the record to the last bit", function()
  for _, solver in ipairs { lunid.stlsq { threshold = 0.05 }, lunid.lasso {}, lunid.huber {} } do
    local whole, part = fit { record = record, solver = solver }, fit { record = stream, solver = solver }
    for i, term in ipairs(whole.terms) do
      spec.equal(part.terms[i].value, term.value)
      spec.equal(part.terms[i].block_std, term.block_std)
      spec.equal(part.terms[i].unit, term.unit)
    end
    spec.equal(tostring(part), tostring(whole))
  end
  local window = lunid.window(1, 7)
  spec.equal(fit { record = { stream, record }, window = window }.r2, fit { record = { record, record }, window = window }.r2)
  local chebyshev = { lunid.chebyshev({ y, v }, 3) }  -- needs the range of the data
  spec.equal(fit { record = stream, features = chebyshev }.rmse, fit { record = record, features = chebyshev }.rmse)
end)

spec.case("derivatives of few rows are as asked for", function()
  local method = lunid.derivative.savitzky_golay { rows = 31, order = 4 }
  local derived = record:derive { method = method, channels = { "y", "v", "a" }, from = "y", smooth = true }
  local small = lunid.stream(path, { derivative = method, smooth = true })
  spec.equal(small.channels.y.derivation, "smoothed by Savitzky-Golay of order 4 over 31 rows")
  spec.equal(fit { record = small }.terms.y.value, fit { record = derived }.terms.y.value)
end)

spec.case("a spline and a Kalman smoother reach over the ends of blocks", function()
  for _, method in ipairs { lunid.derivative.spline {}, lunid.derivative.kalman {} } do
    local derived = record:derive { method = method }
    local small = lunid.stream(path, { derivative = method })
    spec.equal(small.channels.a.derivation, derived.channels.a.derivation)
    local whole, part = fit { record = derived }, fit { record = small }
    for i, term in ipairs(whole.terms) do spec.near(part.terms[i].value, term.value, 1e-6*term.std) end
  end
end)

spec.case("filters, trends, rates and integrals are those of the record", function()
  local function treated(what)
    return what:filter { to = 120 }:detrend { degree = 1, channels = { "y" } }:decimate(2)
  end
  local whole, part = treated(record), treated(stream)
  spec.equal(table.concat(part.history, "; "), table.concat(whole.history, "; "))
  spec.equal(part.rows, whole.rows)
  local window = lunid.window(1, 7)  -- away from the ends, where the record is continued
  local a, b = fit { record = whole, window = window }, fit { record = part, window = window }
  for i, term in ipairs(a.terms) do spec.near(b.terms[i].value, term.value, 1e-6*term.std) end
  spec.equal(stream:resample(500).rows, record:resample(500).rows)
  spec.equal(stream:integrate { from = "a", below = 2 }.channels.v.derivation,
    record:integrate { from = "a", below = 2 }.channels.v.derivation)
  spec.equal(spec.message_of(function() stream:filter { to = 500 } end),
    spec.message_of(function() record:filter { to = 500 } end))
  spec.equal(spec.message_of(function() stream.filter { to = 5 } end), "filter: expected stream:filter { ... }, with a colon")
end)

spec.case("what needs the whole record refuses a stream by name", function()
  spec.equal(spec.message_of(function() lunid.stream(path, { derivative = lunid.derivative.fourier {} }) end),
    "stream: derivative: fourier: its weights have no end: take savitzky_golay, spline or kalman, which a stream makes "
      .. "block by block, or the whole record by lunid.read")
  spec.equal(spec.message_of(function() lunid.stream(path, { resample = true }) end):match "^stream: unknown field 'resample'",
    "stream: unknown field 'resample'")
  spec.equal(spec.message_of(function() lunid.rfs { record = stream, mass = 49 } end),
    "rfs: record: expected a record from lunid.read or a list of records from lunid.read (1 or more), got a stream")
  local model = lunid.model { mass = 49, restoring = 2e4*y + 10*v }
  spec.contains(spec.message_of(function() lunid.simulate { model = model, excitation = stream } end), "got a stream")
  spec.contains(spec.message_of(function() lunid.fit_trajectory { model = model, record = stream } end), "got a stream")
  spec.contains(spec.message_of(function() lunid.discover { model = model, train = stream } end), "got a stream")
  spec.equal(spec.message_of(function() return stream.align end),
    "a stream has no 'align' (fields: name rows dt start duration channels warnings history; methods: window filter "
      .. "detrend decimate resample integrate); what needs all rows at once takes a record from lunid.read")
  spec.contains(spec.message_of(function() fit { record = stream, form = lunid.weak_form {} } end),
    "weak_form: half_width: 0 takes it from the whole of a record, and ")
end)

spec.case("faults say the line of the file", function()
  local file = spec.folder .. "/bad.csv"
  local out = assert(io.open(file, "w"))
  out:write "t,F,y\n"
  for i = 0, 20000 do out:write(("%.3f,%d,%s\n"):format(i/1000, i % 7, i == 18000 and "n/a" or ("%g"):format(i % 11))) end
  out:close()
  spec.contains(spec.message_of(function() lunid.stream(file) end),
    file .. ":18002: column 'y': expected a number, got 'n/a'; mend it, or delete the line and use lunid.read, "
      .. "whose resample = true interpolates missing rows\n  asked for at ")
end)

spec.finish()

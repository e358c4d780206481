-- Acceleration from noisy data (thesis, appendices K and L): the errors of all methods at 5 % noise, on the velocity of case 1 as
-- the thesis differentiates it. Each method chooses its parameters by the noise of the channel.
local lunid = require "lunid"
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Derivatives: acceleration from a noisy velocity" }
local system = lunid.systems.duffing {}
local clean = lunid.thesis_record { system = system, frequency = 20, noise = 0, force_noise = 0, seed = seed }
local exact = lunid.simulate { model = system, excitation = clean, from = "record" }:record()

local function error_of(record, channel)
  return 100*lunid.statistics.rmse(exact:column(channel), record:column(channel)) / exact:column(channel):std()
end

local d = lunid.derivative
local methods = {
  { "finite differences, neighbouring rows", d.finite_differences { accuracy = 2, step = 1 } },
  { "finite differences of order 6", d.finite_differences { accuracy = 6, step = 1 } },
  { "finite differences, step by the noise", d.finite_differences {} },
  { "smoothed differences", d.smoothed_differences {} },
  { "Savitzky-Golay", d.savitzky_golay {} },
  { "cubic smoothing spline", d.spline { degree = 3 } },
  { "quintic smoothing spline", d.spline {} },
  { "total variation", d.total_variation {} },
  { "Fourier", d.fourier {} },
  { "Kalman smoother", d.kalman {} },
}

local noisy = lunid.thesis_record { system = system, frequency = 20, force_noise = 0, seed = seed }
local rows, results, first = {}, {}, nil
for i, each in ipairs(methods) do
  local from_v = noisy:derive { method = each[2], channels = { "a" }, from = "v" }
  local from_y = noisy:derive { method = each[2], channels = { "a" }, from = "y" }
  rows[i] = { each[1], error_of(from_v, "a"), error_of(from_y, "a") }
  results[i] = { method = each[1], from_v = rows[i][2], from_y = rows[i][3] }
  first = first or from_v
end
report:table { head = { "method", "from v [%]", "from y, twice [%]" }, rows = rows,
  caption = "Error of the acceleration over its own deviation, 5 % noise. The thesis saw more than 100 % with finite differences" }

local both = noisy:derive { method = d.kalman {}, channels = { "a" }, smooth = true }
report:table { head = { "Kalman smoother of y and v together", "error [%]" }, rows = { { "velocity", error_of(both, "v") }, { "acceleration", error_of(both, "a") } } }

--- The first periods of an acceleration.
local function shown(record, label, role, style)
  local part = record:window(exact.start, exact.start + 0.15)
  return lunid.figure.series { part:column "t", part:column "a", label = label, role = role, style = style }
end
report:figure("noise_magnified", lunid.figure.lines { x = "time [s]", y = "acceleration [m/s^2]", series = {
  shown(first, "finite differences of v with 5 % noise", "noise"), shown(both, "Kalman smoother", "final", "dashed"),
  shown(exact, "truth", "measured") } }, "Noise magnified by differentiation (figure L.1)")
report:results { case = "derivatives", variant = "L", runs = results }
report:save()

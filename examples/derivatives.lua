-- Velocity and acceleration from a displacement with 5 % noise: the errors of all methods against the truth (thesis,
-- appendix L). Case 1 of the thesis, a cubic spring under a multisine; each method chooses its parameters by the noise.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local truth = lunid.simulate {
  model = lunid.model { mass = 1, restoring = 2e4*y + 1e6*y^3 + 10*v },
  excitation = lunid.excitation.multisine { from = 5, to = 60, rms = 1000, dt = 0.00125, duration = 2.5 },
  solver = "rk78",
}:record():window(0.5, 2.5)

local function error_of(record, channel)
  local got, true_values, sum = record:column(channel), truth:column(channel), 0
  for i = 1, #got do sum = sum + (got[i] - true_values[i])^2 / #got end
  return 100 * math.sqrt(sum) / true_values:std()
end

local d = lunid.derivative
local measured = truth:with_noise { y = 0.05, seed = 1 }

print "errors in % of the truth's standard deviation: y with 5 % noise alone"
print "                                              v         a"
for _, row in ipairs {
  { "finite differences, neighbouring rows", d.finite_differences { accuracy = 2, step = 1 } },
  { "finite differences, step by the noise", d.finite_differences {} },
  { "smoothed differences", d.smoothed_differences {} },
  { "Savitzky-Golay", d.savitzky_golay {} },
  { "smoothing spline, cubic", d.spline { degree = 3 } },
  { "smoothing spline, quintic", d.spline {} },
  { "the same by cross-validation", d.spline { by = "cross_validation" } },
  { "total variation of the jerk", d.total_variation {} },
  { "Kalman smoother", d.kalman {} },
  { "Fourier (the default)", d.fourier {} },
} do
  local derived = measured:derive { method = row[2], channels = { "v", "a" }, from = "y" }
  print(("%-40s%7.1f %%%8.1f %%"):format(row[1], error_of(derived, "v"), error_of(derived, "a")))
end

-- With a noisy velocity beside the displacement the Kalman smoother takes both.
local both = truth:with_noise { y = 0.05, v = 0.05, seed = 1 }:derive { channels = { "a" }, from = "v" }
local fused = both:derive { method = d.kalman {}, smooth = true }
print "\ny and v with 5 % noise each"
print(("%-40s%7.1f %%%8.1f %%"):format("Fourier from v", error_of(both, "v"), error_of(both, "a")))
print(("%-40s%7.1f %%%8.1f %%"):format("Kalman smoother of y and v", error_of(fused, "v"), error_of(fused, "a")))

print("\n" .. tostring(fused))
fused:save "smoothed.csv"

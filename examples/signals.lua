-- From two noisy recorders to a record that can be regressed: noise, delay, filters, rates, drift, spectra, cycles. The
-- truth is simulated; a second recorder started late and measures the acceleration of the same motion.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local model = lunid.model { mass = 2, restoring = 5e3*y + 6*v }
local sweep = lunid.excitation.swept_sine { from = 2, to = 20, amplitude = 40, dt = 1e-3, duration = 8 }
local truth = lunid.simulate { model = model, excitation = sweep }:record()
local first = truth:with_noise { y = 0.02, F = 0.02, seed = 1 }
local late = lunid.record { name = "second recorder", dt = truth.dt, start = -0.1234,
  channels = { { "F", truth:column "F" }, { "a", truth:with_noise { a = 0.05, seed = 2 }:column "a" } } }

print(first:summary())
print(first:noise "y")

-- One clock: the delay by the force that both recorders have.
local moved, delay, correlation = late:align { with = first, channel = "F" }
print(("delay %.4f s, correlation %.4f"):format(delay, correlation))

-- An acceleration becomes a motion; what lies below 1 Hz is drift.
local motion = moved:integrate { from = "a", below = 1 }
print(motion.channels.y.derivation)

-- Filters leave no delay, and every record remembers what was done to it.
local smooth = first:filter { to = 60, channels = { "y" } }:detrend { degree = 1, channels = { "y" } }
print(smooth:decimate(4))
print(("resampled to %g Hz: %d rows"):format(500, smooth:resample(500).rows))

local h = first:transfer { input = "F", output = "y", estimator = "h1" }
local top = 1
for i = 1, #h.frequency do
  if h.magnitude[i] > h.magnitude[top] then top = i end
end
print(("%s; peak at %.3g Hz with coherence %.2f"):format(h, h.frequency[top], h.coherence[top]))
print(first:spectrum "y")
print(first:spectrogram { channel = "F", length = 1024 }.ridge:list()[1])

-- A decay tells frequency and damping, cycle by cycle.
local decay = lunid.simulate { model = model, excitation = 0, from = { 0.01, 0 }, duration = 2, dt = 1e-3 }:record()
  :with_noise { y = 0.01, seed = 3 }
local cycles = decay:cycles "y"
print(("%d cycles of %.4g Hz; the envelope falls from %.3g to %.3g m"):format(#cycles.time, cycles.frequency:mean(),
  decay:envelope("y").amplitude[100], decay:envelope("y").amplitude[1500]))

-- The motion fused from what was measured, ready for a regression; and kept.
local ready = first:derive { method = lunid.derivative.kalman {}, smooth = true }
print(lunid.regress { record = ready, mass = 2, features = { y, v } })
ready:save "ready.h5"

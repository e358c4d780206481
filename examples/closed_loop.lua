-- A drive under a controller: its force answers the noise of its own sensors, so that least squares finds too small a mass.
-- The reference, which no noise enters, is the instrument (Janot, Vandanjon & Gautier 2014).
local lunid = require "lunid"
local v, a = lunid.velocity, lunid.acceleration

local mass, c = 95, 200  -- kg, N s/m
local gain, dt, rows, finer = 1500, 1e-3, 8000, 20

--- A smooth reference of several tones, m/s.
local function reference(t) return 0.05*(math.sin(3*t) + math.sin(7.3*t + 1) + math.sin(23*t + 2)) end

--- White noise of that deviation.
local function noise(std, seed)
  return lunid.excitation.white_noise { rms = std, dt = dt, duration = rows*dt, seed = seed }:column "F"
end

local of_v, of_a = noise(4e-3, 1), noise(0.15, 2)
local speed, columns = 0, { F = {}, v = {}, a = {}, vr = {}, ar = {} }
for i = 1, rows do
  local t = (i - 1)*dt
  local measured = speed + of_v[i]
  local force = gain*(reference(t) - measured)  -- held until the next sample
  local slope = function(at) return (force - c*at)/mass end
  columns.F[i], columns.v[i], columns.a[i] = force, measured, slope(speed) + of_a[i]
  columns.vr[i], columns.ar[i] = reference(t), (reference(t + 1e-6) - reference(t - 1e-6))/2e-6
  for _ = 1, finer do speed = speed + slope(speed)*dt/finer end
end

local channels = {}
for _, name in ipairs { "F", "v", "a", "vr", "ar" } do channels[#channels + 1] = { name, columns[name] } end
local record = lunid.record { channels = channels, dt = dt }
local vr, ar = lunid.channel "vr", lunid.channel "ar"
local features = { a, v }  -- the mass is a coefficient too

local plain = lunid.regress { record = record, features = features }
local instrumental = lunid.regress { record = record, features = features,
  solver = lunid.instrumental_variables { instruments = { ar, vr } } }
print(plain)
print(instrumental)
print(("truth: %g kg, %g N s/m"):format(mass, c))

-- Duffing's oscillator (case 1 of the thesis) under a harmonic force: its answers over frequency, the unstable branch
-- between the folds included, beside the closed form of one harmonic (thesis, B.10) and its backbone.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local m, c, k, k3 = 1, 10, 2e4, 1e6
local model = lunid.model { mass = m, restoring = c*v + k*y + k3*y^3 }
local forces = { 300, 1000 }

local response = lunid.frequency_response { model = model, amplitude = forces, from = 0.5, to = 150 }
print(response)
response:save "frf.csv"

--- Frequencies at which one harmonic of amplitude a balances the force: a quadratic in w^2.
local function one_harmonic(force, label)
  local frequencies, amplitudes = {}, {}
  local function add(a, square)
    if square > 0 and square < (2*math.pi*150)^2 then
      frequencies[#frequencies + 1], amplitudes[#amplitudes + 1] = math.sqrt(square)/(2*math.pi), a
    end
  end
  for i = 1, 50 do
    local a = 0.33*i/50
    local spring = k + 0.75*k3*a^2
    local middle = spring/m - c^2/(2*m^2)
    local rest = middle^2 - (spring/m)^2 + (force/(m*a))^2
    if rest >= 0 then
      add(a, middle - math.sqrt(rest))
      add(a, middle + math.sqrt(rest))
    end
  end
  return lunid.figure.series { frequencies, amplitudes, label = label, style = "points" }
end

local free = lunid.backbone { model = model, from = 1e-3, to = 0.33 }
print(free)

local chart = lunid.figure.response {
  response,
  title = "Duffing's oscillator, case 1",
  series = {
    one_harmonic(300, "closed form of one harmonic"),
    one_harmonic(1000, ""),
    lunid.figure.series { free:column "frequency", free:column "amplitude", label = "backbone", style = "dotted" },
  },
}
chart:save "frf.png"

-- The same at 300 N up to 1400 Hz, where the motion is that of a free mass.
local wide = lunid.frequency_response { model = model, amplitude = 300, from = 0.5, to = 1400 }
lunid.figure.response { wide, log = true }:save "frf_wide.png"

-- The elements follow the backbone k y (1 + abs(k y/Fs)^n)^(-1/n): its tangents of slopes c[i] k meet at the displacements
-- where the elements slip. The slopes cos(i pi/40)^4 make the error even over a hyperbola, n = 1.
local count = 20

local function slope(i) return ("%.17g"):format(i < count and math.cos(i * math.pi / (2 * count)) ^ 4 or 0) end

--- Where the tangent at the slope c[i] meets y = 0, over Fs.
local function intercept(i)
  if i == 0 then return "0" end
  if i == count then return "1" end
  local c = slope(i)
  return ("(%s^(-n/(1 + n)) - 1)^(1/n)*(%s^(1/(1 + n)) - %s)"):format(c, c, c)
end

return function(effect)
  local sum, states = {}, {}
  for i = 1, count do
    local share = slope(i - 1) - slope(i)
    local reach = ("Fs*(%s - %s)/%.17g"):format(intercept(i), intercept(i - 1), share)
    sum[i] = ("%.17g*z%d"):format(share, i)
    states["z" .. i] = { rate = "k*v", min = "-" .. reach, max = reach, unit = "N" }
  end
  return effect {
    name = "iwan",
    family = "hysteresis",
    contribution = table.concat(sum, " + "),
    formula = "sum of twenty elastic_slip, whose backbone is k*y*(1 + abs(k*y/Fs)^n)^(-1/n)",
    parameters = { { "k", min = 0, unit = "N/m" }, { "Fs", min = 0, unit = "N" }, { "n", min = 0.7, max = 50 } },
    states = states,
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.06, 0.15, 0.4 } do  -- Fs/k over the motion
        for _, n in ipairs { 1, 4 } do
          local Fs = 0.6 * scale.force_std
          guesses[#guesses + 1] = { Fs = Fs, k = Fs / (part * (scale.y_max - scale.y_min)), n = n }
        end
      end
      return guesses
    end,
    range = function(scale)
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness }, n = { 0.71, 40 },
        Fs = { 1e-4 * scale.force_std, 30 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a pointed loop, the same at any speed; stiffness falls and loss grows with amplitude",
    sentence = "a joint whose parts slip one after another as the force grows",
    note = "the backbone of the twenty elements lies above the smooth one by at most 0.6 % of its force at n = 1, 1.4 % at "
      .. "0.7, 0.3 % at 2; stiffness at rest and final force are exact; n -> infinity is elastic_slip",
    confusers = { "masing_soil", "bouc_wen", "elastic_slip", "dahl_friction" },
    source = "Iwan 1966, Journal of Applied Mechanics 33, 893-900; Iwan 1967, Journal of Applied Mechanics 34, 612-617; "
      .. "Richard and Abbott 1975, Journal of the Engineering Mechanics Division ASCE 101, 511-515 (backbone)",
  }
end

-- Parallel elastic_slip elements follow Masing's rules by themselves (Iwan 1966), the closing of inner loops included.
-- Tangents of the hyperbola, of slopes cos(i pi/40)^4, meet where the elements slip: the error is even over y.
local count = 20

--- 1/(1 + y/yr) where the i-th tangent touches.
local function touch(i) return i < count and math.cos(i * math.pi / (2 * count)) ^ 2 or 0 end

return function(effect)
  local sum, states = {}, {}
  for i = 1, count do
    local reach = ("yr*%.17g"):format(2 / (touch(i - 1) + touch(i)) - 1)
    sum[i] = ("%.17g*z%d"):format(touch(i - 1) ^ 2 - touch(i) ^ 2, i)
    states["z" .. i] = { rate = "v", min = "-" .. reach, max = reach, unit = "m" }
  end
  return effect {
    name = "masing_soil",
    family = "soil",
    contribution = ("k*(%s)"):format(table.concat(sum, " + ")),
    formula = "from each reversal (yrev, frev): frev + k*(y - yrev)/(1 + abs(y - yrev)/(2*yr)), back on the backbone "
      .. "k*y/(1 + abs(y)/yr) and on outer loops where they are crossed",
    parameters = { { "k", min = 0, unit = "N/m" }, { "yr", min = 0, unit = "m" } },
    states = states,
    guess = function(scale)
      local reach = math.max(scale.y_max, -scale.y_min)
      return { { yr = 0.1 * reach }, { yr = 0.4 * reach }, { yr = 1.5 * reach } }
    end,
    range = function(scale)  -- k and yr are both seen only where abs(y) > 0.3 yr; else linear_stiffness
      local reach = math.max(scale.y_max, -scale.y_min)
      return { yr = { 1e-4 * reach, reach / 0.3 } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a pointed loop, the same at any speed; stiffness falls and loss grows with amplitude",
    sentence = "the soil softens along a hyperbola and unloads stiffly: each reversal starts the curve anew",
    note = "twenty elements in parallel: the backbone lies above the hyperbola by at most 0.6 % of its force, stiffness at "
      .. "rest and final force k*yr are exact",
    confusers = { "hyperbolic_soil", "iwan", "bouc_wen", "elastic_slip" },
    special_case_of = { "iwan" },
    source = "Masing 1926, Proceedings of the 2nd International Congress of Applied Mechanics, 332-335; "
      .. "Pyke 1979, Journal of the Geotechnical Engineering Division ASCE 105, 715-726; "
      .. "Iwan 1966, Journal of Applied Mechanics 33, 893-900",
  }
end

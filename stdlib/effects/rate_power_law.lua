return function(effect)
  return effect {
    name = "rate_power_law",
    family = "soil",
    contribution = "Ru*(z + J*abs(z)*abs(v)^n*sign(v))",
    formula = "Rs + J*abs(Rs)*abs(v)^n*sign(v), Rs = Ru*z, dz/dt = v/q, held within -1 <= z <= 1",
    parameters = { { "Ru", min = 0, unit = "N" }, { "q", min = 0, unit = "m" }, { "J", min = 0, unit = "(s/m)^n" },
      { "n", min = 0, max = 2 } },
    states = { z = { rate = "v/q", min = "-1", max = "1" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.1, 0.3 } do
        guesses[#guesses + 1] = { q = part * (scale.y_max - scale.y_min), J = 0.5 / scale.v_max ^ 0.2, n = 0.2 }
      end
      return guesses
    end,
    range = function(scale)
      local range = scale.y_max - scale.y_min
      return { q = { 1e-4 * range, range }, n = { 0.02, 1.9 } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram with rounded shoulders; grows slowly with the velocity",
    sentence = "soil resistance that grows with a small power of the velocity, as in clay",
    note = "Rs*(1 + J*abs(v)^n) while it is pushed; where the soil springs back the rate part opposes the motion too, so "
      .. "that it never creates energy",
    confusers = { "smith_shaft", "elastic_slip", "power_law_damping" },
    source = "Coyle and Gibson 1970, Journal of the Soil Mechanics and Foundations Division ASCE 96, 949-965",
  }
end

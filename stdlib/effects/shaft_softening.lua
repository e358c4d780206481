return function(effect)
  return effect {
    name = "shaft_softening",
    family = "soil",
    contribution = "(Rr + (Ru - Rr)*exp(-(d - q*z^2/2)/sr))*z",
    formula = "R*z, R = Rr + (Ru - Rr)*exp(-s/sr) with s the slipped path; dz/dt = v/q, held within -1 <= z <= 1",
    parameters = { { "Ru", min = 0, unit = "N" }, { "Rr", min = 0, unit = "N" }, { "q", min = 0, unit = "m" },
      { "sr", min = 0, unit = "m" } },
    requires = { "Ru >= Rr" },
    states = {
      z = { rate = "v/q", min = "-1", max = "1" },
      d = { rate = "z*v", unit = "m", anchored = true },  -- work done over Ru; less what is stored: the slipped path
    },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.15 } do
        for _, path in ipairs { 3, 30 } do
          local range = scale.y_max - scale.y_min
          guesses[#guesses + 1] = { q = part * range, sr = path * range }
        end
      end
      return guesses
    end,
    range = function(scale)  -- softens at once or never: smith_shaft without J
      local range = scale.y_max - scale.y_min
      return { q = { 1e-4 * range, range }, sr = { 1e-2 * range, 1e5 * range } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram that becomes lower with the path slipped, and stays so",
    sentence = "the shaft's friction falls from its peak to a residual value as the pile slips along the soil",
    note = "the quake q stays, so that the stiffness falls with the limit",
    confusers = { "degrading_resistance", "smith_shaft", "vibro_liquefaction", "elastic_slip" },
    acts_on = { "elastic_slip" },
    source = "Kraft, Ray and Kagawa 1981, Journal of the Geotechnical Engineering Division ASCE 107, 1543-1561",
  }
end

return function(effect)
  return effect {
    name = "dahl_friction",
    family = "hysteresis",
    contribution = "s*z",
    formula = "s*z, dz/dt = v - s*abs(v)*z/Fc",
    parameters = { { "s", min = 0, unit = "N/m" }, { "Fc", min = 0, unit = "N" } },
    states = { z = { rate = "v - s*abs(v)*z/Fc", unit = "m" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.02, 0.07, 0.25 } do
        for _, force in ipairs { 0.2, 0.6 } do
          local Fc = force * scale.force_std
          guesses[#guesses + 1] = { Fc = Fc, s = Fc / (part * (scale.y_max - scale.y_min)) }
        end
      end
      return guesses
    end,
    range = function(scale)  -- s -> infinity: coulomb_friction; Fc -> infinity: linear_stiffness
      return { s = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness },
        Fc = { 1e-4 * scale.force_std, 30 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a loop with rounded corners, the same at any speed; slides before it slips",
    sentence = "friction that gives way gradually: after each reversal it has to be wound up again",
    confusers = { "coulomb_friction", "bouc_wen", "elastic_slip", "lugre_friction" },
    special_case_of = { "bouc_wen", "lugre_friction" },
    source = "Dahl 1976, AIAA Journal 14, 1675-1682",
  }
end

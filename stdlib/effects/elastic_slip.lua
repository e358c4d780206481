return function(effect)
  return effect {
    name = "elastic_slip",
    family = "hysteresis",
    contribution = "z",
    formula = "z, dz/dt = k*v, held within -Fs <= z <= Fs",
    parameters = { { "k", min = 0, unit = "N/m" }, { "Fs", min = 0, unit = "N" } },
    states = { z = { rate = "k*v", min = "-Fs", max = "Fs", unit = "N" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.1, 0.3 } do  -- of the motion, until it slips
        for _, force in ipairs { 0.2, 0.6 } do
          local Fs = force * scale.force_std
          guesses[#guesses + 1] = { Fs = Fs, k = Fs / (part * (scale.y_max - scale.y_min)) }
        end
      end
      return guesses
    end,
    range = function(scale)  -- never slips: linear_stiffness; at once: coulomb_friction
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness },
        Fs = { 1e-4 * scale.force_std, 30 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram, the same at any speed; a spring at small amplitude",
    sentence = "a spring in series with dry friction: it is drawn along elastically and slips at Fs",
    confusers = { "coulomb_friction", "bouc_wen", "dahl_friction", "smith_shaft", "masing_soil", "saturating_stiffness" },
    special_case_of = { "iwan", "smith_shaft", "rate_power_law", "friction_lift_off", "backlash_play",
      "depth_resistance", "degrading_resistance", "setup_recovery", "shaft_softening", "vibro_liquefaction" },
    source = "Jenkins 1962, British Journal of Applied Physics 13, 30-32; "
      .. "Iwan 1966, Journal of Applied Mechanics 33, 893-900",
  }
end

return function(effect)
  local limit = "(R0 + (Ri - R0)*m)"
  return effect {
    name = "setup_recovery",
    family = "soil",
    contribution = "z",
    formula = "z, dz/dt = k*v, held within -R <= z <= R, dR/dt = (R0 - R)/tau from R = Ri at the start",
    parameters = { { "k", min = 0, unit = "N/m" }, { "R0", min = 0, unit = "N" }, { "Ri", min = 0, unit = "N" },
      { "tau", min = 0, unit = "s" } },
    states = {
      z = { rate = "k*v", min = "-" .. limit, max = limit, unit = "N" },
      m = { rate = "-m/tau", initial = 1, anchored = true },  -- what is still to recover
    },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.2 } do
        for _, periods in ipairs { 3, 30 } do
          local R0 = 0.5 * scale.force_std
          guesses[#guesses + 1] = { k = R0 / (part * (scale.y_max - scale.y_min)), R0 = R0, Ri = 0.3 * R0,
            tau = periods * 2 * math.pi / scale.omega }
        end
      end
      return guesses
    end,
    range = function(scale)  -- recovers at once or never: elastic_slip
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness }, tau = { 1 / scale.omega, 1e5 / scale.omega },
        R0 = { 1e-4 * scale.force_std, 100 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram whose height changes with the time since the start alone",
    sentence = "the soil regains its resistance with time after it was disturbed",
    confusers = { "elastic_slip", "stiffness_drift", "damping_drift", "depth_resistance" },
    acts_on = { "elastic_slip" },
    source = "Skov and Denver 1988, Application of Stress-Wave Theory to Piles, Ottawa, 879-888",
  }
end

return function(effect)
  local limit = "max(Ru0 + b*zd, 0)"
  return effect {
    name = "depth_resistance",
    family = "soil",
    contribution = "z",
    formula = "z, dz/dt = k*v, held within -Ru <= z <= Ru, Ru = max(Ru0 + b*zd, 0), zd the slow part of y",
    parameters = { { "k", min = 0, unit = "N/m" }, { "Ru0", min = 0, unit = "N" }, { "b", min = 0, unit = "N/m" },
      { "tau", min = 0, unit = "s" } },
    states = {
      z = { rate = "k*v", min = "-" .. limit, max = limit, unit = "N" },
      zd = { rate = "(y - zd)/tau", unit = "m" },
    },
    guess = function(scale)
      local guesses = {}
      local range, Ru0 = scale.y_max - scale.y_min, 0.4 * scale.force_std
      for _, part in ipairs { 0.03, 0.2 } do
        for _, growth in ipairs { 0.5, 3 } do
          guesses[#guesses + 1] = { k = Ru0 / (part * range), Ru0 = Ru0, b = growth * Ru0 / range,
            tau = 2 * 2 * math.pi / scale.omega }
        end
      end
      return guesses
    end,
    range = function(scale)  -- without growth: elastic_slip
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness }, b = { 0, 10 * scale.stiffness },
        tau = { 0.1 / scale.omega, 1e4 / scale.omega } }
    end,
    passive = true,
    signature = "odd about a slow drift; odd harmonics; a parallelogram whose height grows with the penetration",
    sentence = "the deeper the pile, the more friction it meets",
    note = "y is positive downward; zd follows y with the time constant tau, from 0 at the start",
    confusers = { "elastic_slip", "setup_recovery", "stiffness_drift", "friction_lift_off" },
    acts_on = { "elastic_slip" },
    source = "Fleming, Weltman, Randolph and Elson 2009, Piling Engineering, chapter 4",
  }
end

return function(effect)
  return effect {
    name = "bouc_wen",
    family = "hysteresis",
    contribution = "k*z",
    formula = "k*z, dz/dt = v - beta*abs(v)*abs(z)^(n-1)*z - gamma*v*abs(z)^n",
    parameters = {
      { "k", min = 0, unit = "N/m" },
      { "beta", min = 0, unit = "1/m^n" },
      { "gamma", unit = "1/m^n" },
      { "n", min = 1, max = 4 },
    },
    states = { z = { rate = "v - beta*abs(v)*abs(z)^(n - 1)*z - gamma*v*abs(z)^n", initial = 0 } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.05, 0.15, 0.4 } do  -- of the range of y: the displacement zy at yield
        local zy = part * (scale.y_max - scale.y_min)
        for n = 1, 2 do
          local rate = zy ^ -n  -- beta + gamma = zy^-n
          guesses[#guesses + 1] = { beta = 0.5 * rate, gamma = 0.5 * rate, n = n }
          guesses[#guesses + 1] = { beta = 0.9 * rate, gamma = 0.1 * rate, n = n }
        end
      end
      return guesses
    end,
    signature = "odd; odd harmonics; a loop even in slow motion; at equal (y, v) the force depends on the past",
    sentence = "a part of the structure yields and remembers: its force depends on the path that the motion took",
    confusers = { "coulomb_friction", "elastic_slip", "dahl_friction", "viscous_damping" },
    source = "Wen 1976, Journal of the Engineering Mechanics Division ASCE 102, 249-263; "
      .. "Ikhouane and Rodellar 2007, Systems with Hysteresis",
  }
end

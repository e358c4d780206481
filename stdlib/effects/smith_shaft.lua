return function(effect)
  return effect {
    name = "smith_shaft",
    family = "soil",
    contribution = "Ru*(z + J*abs(z)*v)",
    formula = "Rs + J*abs(Rs)*v, Rs = Ru*z, dz/dt = v/q, held within -1 <= z <= 1",
    parameters = { { "Ru", min = 0, unit = "N" }, { "q", min = 0, unit = "m" }, { "J", min = 0, unit = "s/m" } },
    states = { z = { rate = "v/q", min = "-1", max = "1" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.1, 0.3 } do
        for _, damping in ipairs { 0.1, 1 } do
          guesses[#guesses + 1] = { q = part * (scale.y_max - scale.y_min), J = damping / scale.v_max }
        end
      end
      return guesses
    end,
    range = function(scale)  -- never slips: linear_stiffness; at once: coulomb_friction; without J: elastic_slip
      local range = scale.y_max - scale.y_min
      return { q = { 1e-4 * range, range }, J = { 0, 10 / scale.v_max } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram whose roof bulges with the velocity",
    sentence = "friction along the shaft: the soil is drawn along up to the quake q, slips at Ru, and resists speed too",
    confusers = { "elastic_slip", "rate_power_law", "coulomb_friction", "masing_soil" },
    special_case_of = { "rate_power_law" },
    source = "Smith 1960, Journal of the Soil Mechanics and Foundations Division ASCE 86, 35-61",
  }
end

return function(effect)
  return effect {
    name = "smith_toe",
    family = "soil",
    contribution = "Ru/q*max(y - ys, 0)*max(1 + J*v, 0)",
    formula = "R + J*R*v, R = Ru/q*max(y - ys, 0), never in tension; ys rests, and y - q carries it along where R = Ru",
    parameters = { { "Ru", min = 0, unit = "N" }, { "q", min = 0, unit = "m" }, { "J", min = 0, unit = "s/m" } },
    states = { ys = { rate = "0", min = "y - q", unit = "m" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.1, 0.3 } do
        for _, damping in ipairs { 0.1, 1 } do
          guesses[#guesses + 1] = { q = part * (scale.y_max - scale.y_min), J = damping / scale.v_max }
        end
      end
      return guesses
    end,
    range = function(scale)  -- never yields: one_sided_stop
      local range = scale.y_max - scale.y_min
      return { q = { 1e-4 * range, range }, J = { 0, 10 / scale.v_max } }
    end,
    passive = true,
    signature = "neither odd nor even: one side only; all harmonics and a mean; a loop of each stroke, and no force "
      .. "while the gap is open",
    sentence = "the soil under the toe yields at Ru, springs back by the quake q and lets the pile lift off",
    note = "y is positive downward, and the soil begins at y = 0; a pile pulled up faster than 1/J feels no force",
    confusers = { "one_sided_stop", "impact_hunt_crossley", "smith_shaft" },
    source = "Smith 1960, Journal of the Soil Mechanics and Foundations Division ASCE 86, 35-61",
  }
end

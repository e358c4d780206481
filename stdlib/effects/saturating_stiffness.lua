return function(effect)
  return effect {
    name = "saturating_stiffness",
    family = "stiffness",
    contribution = "Fy*tanh(k*y/Fy)",
    parameters = { { "k", min = 0, unit = "N/m" }, { "Fy", min = 0, unit = "N" } },
    guess = function(scale)
      local guesses = {}
      for _, stiffer in ipairs { 0.3, 1, 3 } do
        for _, part in ipairs { 0.3, 1, 3 } do
          guesses[#guesses + 1] = { k = stiffer * scale.stiffness, Fy = part * scale.force_std }
        end
      end
      return guesses
    end,
    range = function(scale)  -- never yields: linear_stiffness; at once: preload
      return { k = { 1e-3 * scale.stiffness, 1e3 * scale.stiffness },
        Fy = { 1e-3 * scale.force_std, 30 * scale.force_std } }
    end,
    passive = true,
    signature = "odd in y, even in v; odd harmonics, the third in phase with the first; no loop; softens to a limit Fy",
    sentence = "the spring gives way: its force rises up to Fy and no further, and comes back the same way",
    confusers = { "cubic_stiffness", "hyperbolic_soil", "elastic_slip", "preload", "sinusoidal_stiffness" },
    source = "O'Neill and Murchison 1983, An Evaluation of p-y Relationships in Sands, report to the API (p-y curves)",
  }
end

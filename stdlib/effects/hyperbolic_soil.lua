return function(effect)
  return effect {
    name = "hyperbolic_soil",
    family = "soil",
    contribution = "k*y/(1 + abs(y)/yr)",
    parameters = { { "k", min = 0, unit = "N/m" }, { "yr", min = 0, unit = "m" } },
    guess = function(scale)
      local reach = math.max(scale.y_max, -scale.y_min)
      return { { yr = 0.1 * reach }, { yr = 0.4 * reach }, { yr = 1.5 * reach } }
    end,
    range = function(scale)  -- k and yr are both seen only where abs(y) > 0.3 yr; else linear_stiffness
      local reach = math.max(scale.y_max, -scale.y_min)
      return { yr = { 1e-4 * reach, reach / 0.3 } }
    end,
    passive = true,
    signature = "odd in y, even in v; odd harmonics; no loop; softens from the first moment on, towards k*yr",
    sentence = "the soil softens with displacement along a hyperbola, and comes back the same way",
    confusers = { "saturating_stiffness", "cubic_stiffness", "masing_soil", "odd_quadratic_stiffness" },
    source = "Hardin and Drnevich 1972, Journal of the Soil Mechanics and Foundations Division ASCE 98, 667-692",
  }
end

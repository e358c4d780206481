return function(effect)
  return effect {
    name = "clearance",
    family = "stiffness",
    contribution = "k*sign(y)*max(abs(y) - g, 0)",
    parameters = { { "k", min = 0, unit = "N/m" }, { "g", min = 0, unit = "m" } },
    guess = function(scale)
      local reach = math.max(scale.y_max, -scale.y_min)
      return { { g = 0.3 * reach }, { g = 0.6 * reach }, { g = 0.85 * reach } }
    end,
    range = function(scale)  -- without a gap: linear_stiffness
      return { g = { 0, math.max(scale.y_max, -scale.y_min) } }
    end,
    passive = true,
    signature = "odd in y, even in v; odd harmonics; no loop; nothing below the gap, stiff beyond it",
    sentence = "a stop on both sides comes into contact beyond a gap g",
    confusers = { "cubic_stiffness", "one_sided_stop" },
    source = "Worden and Tomlinson 2001, Nonlinearity in Structural Dynamics, section 2.2",
  }
end

return function(effect)
  return effect {
    name = "backlash_play",
    family = "hysteresis",
    contribution = "k*(y - z)",
    formula = "k*(y - z), z rests while abs(y - z) < g and is carried along otherwise",
    parameters = { { "k", min = 0, unit = "N/m" }, { "g", min = 0, unit = "m" } },
    states = { z = { rate = "0", min = "y - g", max = "y + g", unit = "m" } },
    guess = function(scale)
      local guesses = {}
      for i, part in ipairs { 0.03, 0.1, 0.3 } do guesses[i] = { g = part * (scale.y_max - scale.y_min) } end
      return guesses
    end,
    range = function(scale)  -- never carried along: linear_stiffness
      local range = scale.y_max - scale.y_min
      return { g = { 1e-4 * range, range } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram, the same at any speed; a spring at small amplitude",
    sentence = "a part is pushed along through a play: it follows the motion late, by g, and stays where it was left",
    note = "the force of a play is that of elastic_slip with Fs = k*g: one law in two words, which no record tells apart",
    confusers = { "elastic_slip", "coulomb_friction", "clearance", "dahl_friction" },
    special_case_of = { "elastic_slip" },
    source = "Krasnosel'skii and Pokrovskii 1989, Systems with Hysteresis, chapter 1; "
      .. "Nordin and Gutman 2002, Automatica 38, 1633-1649",
  }
end

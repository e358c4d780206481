return function(effect)
  return effect {
    name = "one_sided_stop",
    family = "stiffness",
    contribution = { "k*max(y - g, 0)", "k*min(y + g, 0)" },
    parameters = { { "k", min = 0, unit = "N/m" }, { "g", unit = "m" } },
    guess = function(scale)
      local middle, half = (scale.y_max + scale.y_min) / 2, (scale.y_max - scale.y_min) / 2
      local guesses = {}
      for _, part in ipairs { 0, 0.3, 0.6, 0.85 } do
        guesses[#guesses + 1] = { g = middle + part * half }
        if middle ~= 0 then guesses[#guesses + 1] = { g = -middle + part * half } end
      end
      return guesses
    end,
    signature = "neither odd nor even in y, even in v; all harmonics and a mean; no loop; one side only",
    sentence = "a stop on one side comes into contact beyond a gap g",
    confusers = { "quadratic_stiffness", "bilinear_stiffness", "clearance" },
    special_case_of = { "bilinear_stiffness", "impact_hunt_crossley" },
    source = "Shaw and Holmes 1983, Journal of Sound and Vibration 90, 129-155",
  }
end

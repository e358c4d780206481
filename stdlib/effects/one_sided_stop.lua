return function(effect)
  --- The motion as the stop sees it: the second form is the mirror image of the first.
  local function reach(scale, variant)
    if variant == 1 then return scale.y_min, scale.y_max end
    return -scale.y_max, -scale.y_min
  end
  return effect {
    name = "one_sided_stop",
    family = "stiffness",
    contribution = { "k*max(y - g, 0)", "k*min(y + g, 0)" },
    parameters = { { "k", min = 0, unit = "N/m" }, { "g", unit = "m" } },
    guess = function(scale, variant)
      local low, high = reach(scale, variant)
      local guesses = {}
      for _, part in ipairs { 0.5, 0.65, 0.8, 0.92 } do
        guesses[#guesses + 1] = { g = low + part * (high - low) }
      end
      return guesses
    end,
    range = function(scale, variant)  -- always in contact: linear_stiffness and constant_force
      local low, high = reach(scale, variant)
      return { g = { low, high } }
    end,
    repeats = true,
    passive = true,
    signature = "neither odd nor even in y, even in v; all harmonics and a mean; no loop; one side only",
    sentence = "a stop on one side comes into contact beyond a gap g",
    confusers = { "quadratic_stiffness", "bilinear_stiffness", "clearance" },
    special_case_of = { "bilinear_stiffness", "impact_hunt_crossley", "crane_lowering" },
    source = "Shaw and Holmes 1983, Journal of Sound and Vibration 90, 129-155",
  }
end

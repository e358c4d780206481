return function(effect)
  local function reach(scale, variant)
    if variant == 1 then return scale.y_min, scale.y_max end
    return -scale.y_max, -scale.y_min
  end
  return effect {
    name = "impact_hunt_crossley",
    family = "stiffness",
    contribution = { "k*max(y - g, 0)^n*max(1 + c*v, 0)", "-k*max(-y - g, 0)^n*max(1 - c*v, 0)" },
    formula = { "k*d^n*max(1 + c*dd/dt, 0), d = max(y - g, 0)", "-k*d^n*max(1 + c*dd/dt, 0), d = max(-y - g, 0)" },
    parameters = { { "k", min = 0, unit = "N/m^n" }, { "c", min = 0, unit = "s/m" }, { "n", min = 1, max = 4 },
      { "g", unit = "m" } },
    guess = function(scale, variant)
      local low, high = reach(scale, variant)
      local guesses = {}
      for _, part in ipairs { 0.5, 0.75, 0.9 } do
        for _, n in ipairs { 1, 1.5 } do
          guesses[#guesses + 1] = { c = 0.2 / scale.v_max, n = n, g = low + part * (high - low) }
        end
      end
      return guesses
    end,
    -- Never in contact, or always; without damping: one_sided_stop. No contact is as steep as n = 4.
    range = function(scale, variant)
      local low, high = reach(scale, variant)
      return { g = { low, high }, c = { 0, 10 / scale.v_max }, n = { 0, 4 } }
    end,
    passive = true,
    signature = "neither odd nor even in y and v; all harmonics and a mean; a loop in contact, wider the faster the impact",
    sentence = "an impact on one side: the contact is stiffer the deeper it goes, and loses energy by its velocity",
    confusers = { "one_sided_stop", "bilinear_stiffness", "smith_toe", "quadratic_stiffness" },
    source = "Hunt and Crossley 1975, Journal of Applied Mechanics 42, 440-445",
  }
end

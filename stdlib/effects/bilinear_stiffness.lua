return function(effect)
  --- The motion as the kink sees it: the second form is the mirror image of the first.
  local function reach(scale, variant)
    if variant == 1 then return scale.y_min, scale.y_max end
    return -scale.y_max, -scale.y_min
  end
  return effect {
    name = "bilinear_stiffness",
    family = "stiffness",
    contribution = { "dk*max(y - y0, 0)", "dk*min(y + y0, 0)" },
    parameters = { { "dk", unit = "N/m" }, { "y0", unit = "m" } },
    guess = function(scale, variant)
      local low, high = reach(scale, variant)
      local guesses = {}
      for i, part in ipairs { 0.3, 0.5, 0.7, 0.85 } do guesses[i] = { y0 = low + part * (high - low) } end
      return guesses
    end,
    range = function(scale, variant)  -- a kink that the motion never meets: linear_stiffness and constant_force
      local low, high = reach(scale, variant)
      return { y0 = { low, high } }
    end,
    passive = true,
    signature = "neither odd nor even in y, even in v; all harmonics and a mean; no loop; the slope changes at y0",
    sentence = "the stiffness is another one beyond y0: a crack that closes, a cable that goes slack, a contact",
    confusers = { "one_sided_stop", "quadratic_stiffness", "clearance", "asymmetric_damping" },
    source = "Shaw and Holmes 1983, Journal of Sound and Vibration 90, 129-155",
  }
end

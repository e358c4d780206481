return function(effect)
  return effect {
    name = "asymmetric_damping",
    family = "damping",
    contribution = "dc*max(v, 0)",
    parameters = { { "dc", unit = "N s/m" } },
    passive = "where dc >= 0",
    signature = "neither odd nor even in v, even in y; a mean and even harmonics that grow with the velocity; half of "
      .. "an elliptic loop",
    sentence = "the damper resists differently in either direction, as a shock absorber in bump and rebound",
    note = "where dc < 0 it takes away from the viscous damping beside it, which has to stay the larger",
    confusers = { "quadratic_stiffness", "constant_force", "bilinear_stiffness" },
    source = "Wallaschek 1990, International Journal of Non-Linear Mechanics 25, 299-308",
  }
end

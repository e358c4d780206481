return function(effect)
  return effect {
    name = "viscous_damping",
    family = "damping",
    contribution = "c*v",
    parameters = { { "c", min = 0, unit = "N s/m" } },
    passive = true,
    signature = "odd in v, even in y; feeds the fundamental only; an elliptic loop; does not depend on amplitude",
    sentence = "a damper in parallel that the model does not have",
    confusers = { "quadratic_drag", "coulomb_friction", "radiation_damping" },
    special_case_of = { "power_law_damping", "radiation_damping" },
    source = "Rayleigh 1877, The Theory of Sound, section 45",
  }
end

return function(effect)
  return effect {
    name = "quadratic_drag",
    family = "damping",
    contribution = "c2*abs(v)*v",
    parameters = { { "c2", min = 0, unit = "N s^2/m^2" } },
    passive = true,
    signature = "odd in v, even in y; odd harmonics; a rounded loop; damping grows with the velocity",
    sentence = "the surrounding fluid resists with the square of the velocity",
    confusers = { "cubic_damping", "viscous_damping", "coulomb_friction" },
    special_case_of = { "power_law_damping" },
    source = "Morison, O'Brien, Johnson and Schaaf 1950, Journal of Petroleum Technology 2, 149-154",
  }
end

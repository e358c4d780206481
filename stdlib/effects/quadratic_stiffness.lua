return function(effect)
  return effect {
    name = "quadratic_stiffness",
    family = "stiffness",
    contribution = "k2*y^2",
    parameters = { { "k2", unit = "N/m^2" } },
    passive = true,
    signature = "even in y, even in v; feeds the mean and the second harmonic; no loop; grows with the amplitude",
    sentence = "the spring is stiffer on one side than on the other",
    confusers = { "one_sided_stop", "constant_force" },
    source = "Nayfeh and Mook 1979, Nonlinear Oscillations, section 4.2",
  }
end

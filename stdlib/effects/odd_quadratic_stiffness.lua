return function(effect)
  return effect {
    name = "odd_quadratic_stiffness",
    family = "stiffness",
    contribution = "k2*abs(y)*y",
    parameters = { { "k2", unit = "N/m^2" } },
    passive = true,
    signature = "odd in y, even in v; odd harmonics, the third first; no loop; grows with the amplitude",
    sentence = "the spring hardens in proportion to the displacement, the same on both sides",
    confusers = { "cubic_stiffness", "clearance", "hyperbolic_soil" },
    source = "Mickens 2010, Truly Nonlinear Oscillations",
  }
end

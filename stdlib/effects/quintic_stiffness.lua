return function(effect)
  return effect {
    name = "quintic_stiffness",
    family = "stiffness",
    contribution = "k5*y^5",
    parameters = { { "k5", unit = "N/m^5" } },
    passive = true,
    signature = "odd in y, even in v; feeds the third and fifth harmonics; no loop; grows with amplitude to the fourth",
    sentence = "the spring hardens or softens more abruptly than a cubic one: it is straight up to large displacements",
    confusers = { "cubic_stiffness", "clearance", "sinusoidal_stiffness" },
    source = "Kovacic and Brennan 2011, The Duffing Equation: Nonlinear Oscillators and their Behaviour",
  }
end

return function(effect)
  return effect {
    name = "cubic_stiffness",
    family = "stiffness",
    contribution = "k3*y^3",
    parameters = { { "k3", unit = "N/m^3" } },
    passive = true,
    signature = "odd in y, even in v; feeds the third harmonic; no loop; grows with the square of the amplitude",
    sentence = "the spring hardens (k3 > 0) or softens (k3 < 0) as it is displaced",
    confusers = { "quintic_stiffness", "sinusoidal_stiffness", "saturating_stiffness", "clearance" },
    source = "Duffing 1918, Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz",
  }
end

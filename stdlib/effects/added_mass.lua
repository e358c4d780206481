return function(effect)
  return effect {
    name = "added_mass",
    family = "inertia",
    contribution = "ma*a",
    parameters = { { "ma", unit = "kg" } },
    passive = true,
    signature = "odd in a; feeds the fundamental only; no loop; grows with the square of the frequency",
    sentence = "mass that the model does not have: entrained fluid, a soil plug, or what lies beyond the force gauge",
    note = "of either sign, as long as m + ma > 0",
    confusers = { "linear_stiffness", "hidden_mode", "soil_plug" },
    source = "Lamb 1932, Hydrodynamics, chapter VI",
  }
end

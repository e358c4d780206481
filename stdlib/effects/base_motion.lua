return function(effect)
  return effect {
    name = "base_motion",
    family = "input",
    contribution = "mb*ab",
    formula = "mb*ab, ab the acceleration of the support; mb = m where y is measured from it",
    parameters = { { "mb", unit = "kg" } },
    passive = false,
    signature = "does not depend on the motion: no loop of its own; follows the acceleration of the support, at all its "
      .. "frequencies",
    sentence = "the support moves, and the mass feels it",
    confusers = { "missing_harmonic", "added_mass" },
    channels = { "ab" },
    source = "Den Hartog 1956, Mechanical Vibrations, chapter 2",
  }
end

return function(effect)
  return effect {
    name = "preload",
    family = "stiffness",
    contribution = "F0*sign(y)",
    parameters = { { "F0", min = 0, unit = "N" } },
    passive = true,
    signature = "odd in y, even in v; odd harmonics; no loop; a jump at y = 0 that weighs less the larger the amplitude",
    sentence = "a preloaded spring on either side: nothing moves off its seat below F0",
    confusers = { "saturating_stiffness", "coulomb_friction", "clearance" },
    source = "Den Hartog 1956, Mechanical Vibrations, chapter 8 (set-up springs)",
  }
end

return function(effect)
  return effect {
    name = "cubic_damping",
    family = "damping",
    contribution = "c3*v^3",
    parameters = { { "c3", min = 0, unit = "N s^3/m^3" } },
    passive = true,
    signature = "odd in v, even in y; first and third harmonics; a rounded loop; damping grows with velocity squared",
    sentence = "the damper is progressive: it hardly damps slow motion and strongly damps fast motion",
    confusers = { "quadratic_drag", "power_law_damping", "van_der_pol_damping" },
    special_case_of = { "power_law_damping" },
    source = "Ravindra and Mallik 1994, Journal of Sound and Vibration 170, 325-337",
  }
end

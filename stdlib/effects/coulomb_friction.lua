return function(effect)
  return effect {
    name = "coulomb_friction",
    family = "friction",
    contribution = "Fc*sign(v)",
    parameters = { { "Fc", min = 0, unit = "N" } },
    passive = true,
    signature = "odd in v; odd harmonics; a rectangular loop; weighs less the larger the amplitude; sticks",
    sentence = "dry friction of constant size opposes the motion, and holds the body at rest while it can",
    confusers = { "stribeck_friction", "quadratic_drag", "bouc_wen", "viscous_damping" },
    special_case_of = { "stribeck_friction", "power_law_damping", "position_dependent_friction" },
    source = "Coulomb 1785; Den Hartog 1931, Transactions of the ASME 53, APM-107",
  }
end

return function(effect)
  return effect {
    name = "radiation_damping",
    family = "soil",
    contribution = "c*v",
    parameters = { { "c", min = 0, unit = "N s/m" } },
    passive = true,
    signature = "odd in v, even in y; feeds the fundamental only; an elliptic loop; does not depend on amplitude",
    sentence = "waves carry energy from the contact away into the soil",
    note = "it acts on the soil contact only: in a model of several coordinates give the contact's displacement. On one "
      .. "mass it cannot be told from viscous_damping",
    confusers = { "viscous_damping", "smith_shaft" },
    source = "Novak, Nogami and Aboul-Ella 1978, Journal of the Engineering Mechanics Division ASCE 104, 953-959",
  }
end

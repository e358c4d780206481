return function(effect)
  return effect {
    name = "linear_stiffness",
    family = "stiffness",
    contribution = "k*y",
    parameters = { { "k", min = 0, unit = "N/m" } },
    passive = true,
    signature = "odd in y, even in v; feeds the fundamental only; no loop; does not depend on amplitude",
    sentence = "a spring in parallel that the model does not have",
    confusers = { "added_mass" },
    special_case_of = { "clearance" },
    source = "Worden and Tomlinson 2001, Nonlinearity in Structural Dynamics, chapter 1",
  }
end

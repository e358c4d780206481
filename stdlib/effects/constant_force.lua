return function(effect)
  return effect {
    name = "constant_force",
    family = "stiffness",
    contribution = "F0",
    parameters = { { "F0", unit = "N" } },
    passive = true,
    signature = "even in y, even in v; feeds the mean only; no loop; does not depend on the motion",
    sentence = "a static load, such as gravity or an offset of the force gauge, acts all the time",
    confusers = { "displacement_offset", "quadratic_stiffness" },
    source = "Janot, Gautier and Brunot 2019, Data set and reference models of EMPS (the offset)",
  }
end

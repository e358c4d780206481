return function(effect)
  return effect {
    name = "displacement_offset",
    family = "sensor",
    measures = { y = "y + b" },
    formula = "y measured = y + b",
    parameters = { { "b", unit = "m" } },
    guess = function() return { { b = 0 } } end,
    passive = true,
    signature = "a constant in y; under a linear spring that of constant_force, k*b; else the law is the same about another zero",
    sentence = "the displacement is measured from another zero than that of the springs",
    note = "where the stiffness is linear no record tells it from constant_force: both are then given",
    confusers = { "constant_force", "quadratic_stiffness", "sensor_drift" },
    special_case_of = { "sensor_drift" },
    source = "Doebelin 2003, Measurement Systems, chapter 3 (zero error of a transducer)",
  }
end

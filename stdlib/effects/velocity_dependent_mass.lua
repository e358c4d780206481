return function(effect)
  return effect {
    name = "velocity_dependent_mass",
    family = "inertia",
    contribution = "m1*v*a",
    parameters = { { "m1", unit = "kg s/m" } },
    passive = "where m + m1*v > 0",
    signature = "odd in v, odd in a; the second harmonic, no mean; a loop like a lying eight, which keeps the energy; "
      .. "grows with the square of the amplitude and the cube of the frequency",
    sentence = "the moving mass grows with the velocity in one direction and falls in the other",
    note = "its energy is m1*v^3/3",
    confusers = { "asymmetric_damping", "quadratic_stiffness", "displacement_dependent_mass" },
    source = "Cveticanin 2016, Dynamics of Bodies with Time-Variable Mass",
  }
end

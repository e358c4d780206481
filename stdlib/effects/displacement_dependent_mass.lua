return function(effect)
  return effect {
    name = "displacement_dependent_mass",
    family = "inertia",
    contribution = "m1*(y^2*a + y*v^2)",
    parameters = { { "m1", unit = "kg/m^2" } },
    passive = true,
    signature = "odd; first and third harmonics; no loop; softens, and more so at high frequency",
    sentence = "the inertia grows away from the middle, as of a beam that shortens when it bends, or of a mechanism",
    note = "as long as m + m1*y^2 > 0; its energy is m1*y^2*v^2/2",
    confusers = { "cubic_stiffness", "van_der_pol_damping", "added_mass" },
    source = "Crespo da Silva and Glynn 1978, Journal of Structural Mechanics 6, 437-448",
  }
end

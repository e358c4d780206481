return function(effect)
  return effect {
    name = "van_der_pol_damping",
    family = "damping",
    contribution = "(beta*y^2 - mu)*v",
    parameters = { { "mu", unit = "N s/m" }, { "beta", unit = "N s/m^3" } },
    passive = "where mu <= 0 and beta >= 0",
    signature = "odd in v, even in y; first and third harmonics; a loop that is widest away from the middle "
      .. "and at large amplitude; swings by itself where mu > 0",
    sentence = "the damping depends on where the motion is: small or negative in the middle, large outside",
    note = "where the model knows a viscous damper c*v, mu and c are one number: give mu = 0, or fix c. Discovery leaves mu "
      .. "out there: the c that it prints is c - mu, and negative where the system swings by itself",
    confusers = { "cubic_damping", "position_dependent_friction", "viscous_damping" },
    source = "van der Pol 1926, Philosophical Magazine 2, 978-992",
  }
end

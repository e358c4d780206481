return function(effect)
  return effect {
    name = "power_law_damping",
    family = "damping",
    contribution = "c*abs(v)^p*sign(v)",
    parameters = { { "c", min = 0, unit = "N (s/m)^p" }, { "p", min = 0, max = 6 } },
    guess = function() return { { p = 0.3 }, { p = 0.7 }, { p = 1.5 }, { p = 2.5 } } end,
    range = function() return { p = { 0.01, 5 } } end,  -- p -> 0: coulomb_friction
    passive = true,
    signature = "odd in v, even in y; odd harmonics; a loop between a rectangle (p -> 0) and a lens; grows as velocity^p",
    sentence = "the damper's force grows with a power of the velocity, as of an orifice or a creeping material",
    confusers = { "quadratic_drag", "cubic_damping", "coulomb_friction", "stribeck_friction", "viscous_damping" },
    source = "Ravindra and Mallik 1994, Journal of Sound and Vibration 170, 325-337",
  }
end

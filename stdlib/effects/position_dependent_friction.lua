return function(effect)
  return effect {
    name = "position_dependent_friction",
    family = "friction",
    contribution = { "(Fc + alpha*abs(y))*sign(v)", "alpha*abs(y)*sign(v)" },
    parameters = { { "Fc", min = 0, unit = "N" }, { "alpha", unit = "N/m" } },
    passive = "where Fc + alpha*abs(y) >= 0",
    signature = "odd in v, even in y; odd harmonics; a loop like a bow tie or a barrel, the more so the larger the "
      .. "amplitude; sticks",
    sentence = "dry friction grows as the part is displaced, as where the normal load comes from the spring itself",
    note = "the second form is hysteretic (structural) damping: a loss in each cycle that does not depend on the frequency",
    confusers = { "coulomb_friction", "van_der_pol_damping", "friction_lift_off" },
    source = "Ferri and Bindemann 1992, Journal of Vibration and Acoustics 114, 289-296; Reid 1956, Journal of the Royal "
      .. "Aeronautical Society 60, 283",
  }
end

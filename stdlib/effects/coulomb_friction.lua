return function(effect)
  return effect {
    name = "coulomb_friction",
    family = "friction",
    contribution = { "Fc*sign(v)", "Fc*tanh(v/vr)" },
    parameters = { { "Fc", min = 0, unit = "N" }, { "vr", min = 0, unit = "m/s" } },
    guess = function(scale, variant)
      if variant == 1 then return {} end
      return { { vr = 0.01 * scale.v_max }, { vr = 0.05 * scale.v_max }, { vr = 0.2 * scale.v_max } }
    end,
    range = function(scale, variant)  -- never seen: the first form; always: viscous_damping
      return variant == 2 and { vr = { 2e-3 * scale.v_max, 0.5 * scale.v_max } } or {}
    end,
    passive = true,
    signature = "odd in v, even in y; odd harmonics; a rectangular loop; weighs less the larger the amplitude; sticks",
    sentence = "dry friction of constant size opposes the motion, and holds the body at rest while it can",
    note = "the second form is friction that a lubricant, a flexible contact or a simulation has rounded at rest: it creeps "
      .. "in place of sticking",
    confusers = { "stribeck_friction", "quadratic_drag", "bouc_wen", "viscous_damping" },
    special_case_of = { "stribeck_friction", "power_law_damping", "position_dependent_friction", "elastic_slip" },
    source = "Coulomb 1785; Den Hartog 1931, Transactions of the ASME 53, APM-107",
  }
end

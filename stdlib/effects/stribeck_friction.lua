return function(effect)
  return effect {
    name = "stribeck_friction",
    family = "friction",
    contribution = "(Fc + (Fs - Fc)*exp(-(v/vs)^2))*sign(v)",
    parameters = { { "Fc", min = 0, unit = "N" }, { "Fs", min = 0, unit = "N" }, { "vs", min = 0, unit = "m/s" } },
    requires = { "Fs >= Fc" },
    guess = function(scale)
      return { { vs = 0.03 * scale.v_max }, { vs = 0.1 * scale.v_max }, { vs = 0.3 * scale.v_max } }
    end,
    range = function(scale) return { vs = { 1e-3 * scale.v_max, scale.v_max } } end,  -- never seen: coulomb_friction
    passive = true,
    signature = "odd in v, even in y; odd harmonics; a rectangular loop with horns at slow motion; stick-slip",
    sentence = "dry friction is larger at rest and at creeping speed than in motion",
    confusers = { "coulomb_friction", "lugre_friction", "power_law_damping" },
    source = "Armstrong-Helouvry, Dupont and Canudas de Wit 1994, Automatica 30, 1083-1138; "
      .. "Stribeck 1902, Zeitschrift des VDI 46, 1341-1348",
  }
end

return function(effect)
  return effect {
    name = "soil_plug",
    family = "soil",
    contribution = "z",
    formula = "z, dz/dt = k*(v - u), held within -Fs <= z <= Fs; mp*du/dt = z",
    parameters = { { "mp", min = 0, unit = "kg" }, { "k", min = 0, unit = "N/m" }, { "Fs", min = 0, unit = "N" } },
    states = {
      z = { rate = "k*(v - u)", min = "-Fs", max = "Fs", unit = "N" },
      u = { rate = "z/mp", unit = "m/s", absolute = true },
    },
    guess = function(scale)
      local guesses = {}
      for _, heavier in ipairs { 0.1, 0.5 } do
        for _, stiffer in ipairs { 1, 10 } do
          guesses[#guesses + 1] = { mp = heavier * scale.stiffness / scale.omega ^ 2, k = stiffer * scale.stiffness,
            Fs = 0.3 * scale.force_std }
        end
      end
      return guesses
    end,
    range = function(scale)  -- never slips: added_mass; very heavy: elastic_slip
      local mass = scale.stiffness / scale.omega ^ 2
      return { mp = { 1e-4 * mass, 1e4 * mass }, k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness },
        Fs = { 1e-4 * scale.force_std, 100 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; a mass without a loop at small accelerations, the fundamental only; at large ones odd harmonics "
      .. "and the rectangular loop of a friction, when the plug stays behind",
    sentence = "soil inside the pile moves along with it until the acceleration tears it loose",
    note = "the plug is at rest at the start; its weight is a constant_force",
    confusers = { "added_mass", "hidden_mode", "elastic_slip" },
    source = "Heerema and de Jong 1980, Numerical Methods in Offshore Piling, Institution of Civil Engineers, 37-42",
  }
end

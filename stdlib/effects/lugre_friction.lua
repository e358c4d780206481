return function(effect)
  local slip = "abs(v)*z*s0/(Fc + (Fs - Fc)*exp(-(v/vs)^2))"
  return effect {
    name = "lugre_friction",
    family = "hysteresis",
    contribution = ("s0*z + s1*(v - %s)"):format(slip),
    formula = "s0*z + s1*dz/dt, dz/dt = v - s0*abs(v)*z/g, g = Fc + (Fs - Fc)*exp(-(v/vs)^2)",
    parameters = { { "s0", min = 0, unit = "N/m" }, { "s1", min = 0, unit = "N s/m" }, { "Fc", min = 0, unit = "N" },
      { "Fs", min = 0, unit = "N" }, { "vs", min = 0, unit = "m/s" } },
    requires = { "Fs >= Fc" },
    states = { z = { rate = "v - " .. slip, unit = "m" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.01, 0.03, 0.1 } do
        for _, slow in ipairs { 0.03, 0.1, 0.3 } do
          local Fc = 0.4 * scale.force_std
          local s0 = Fc / (part * (scale.y_max - scale.y_min))
          guesses[#guesses + 1] = { s0 = s0, s1 = 0.1 * s0 / scale.omega, Fc = Fc, Fs = 1.6 * Fc,
            vs = slow * scale.v_max }
        end
      end
      return guesses
    end,
    range = function(scale)  -- s0 -> infinity: stribeck_friction; vs -> 0 or infinity: dahl_friction
      return { s0 = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness }, vs = { 1e-3 * scale.v_max, scale.v_max },
        Fc = { 1e-4 * scale.force_std, 30 * scale.force_std }, Fs = { 1e-4 * scale.force_std, 30 * scale.force_std } }
    end,
    passive = "where s1*(Fs - Fc) <= c*Fc, c the viscous damping beside it",
    signature = "odd; odd harmonics; a loop with rounded corners and horns at slow motion; stick-slip, frictional lag",
    sentence = "friction of bristles that bend before they slip, and that grip more firmly at creeping speed",
    note = "its viscous part is viscous_damping; where the amplitude is far above Fc/s0, s0 and s1 cannot be seen and "
      .. "stribeck_friction says the same",
    confusers = { "stribeck_friction", "dahl_friction", "bouc_wen", "coulomb_friction" },
    source = "Canudas de Wit, Olsson, Astrom and Lischinsky 1995, IEEE Transactions on Automatic Control 40, 419-425; "
      .. "Barabanov and Ortega 2000, the same 45, 830-832 (passivity)",
  }
end

return function(effect)
  local limit = "(Rl + (Rs - Rl)*exp(-sqrt(2*m + 1e-8)))"
  return effect {
    name = "vibro_liquefaction",
    family = "soil",
    contribution = "z",
    formula = "z, dz/dt = k*v, held within the limit Rl + (Rs - Rl)*exp(-alpha), alpha the acceleration amplitude over g",
    parameters = { { "k", min = 0, unit = "N/m" }, { "Rs", min = 0, unit = "N" }, { "Rl", min = 0, unit = "N" },
      { "tau", min = 0, unit = "s" } },
    requires = { "Rs >= Rl" },
    states = {
      z = { rate = "k*v", min = "-" .. limit, max = limit, unit = "N" },
      m = { rate = "((a/9.80665)^2 - m)/tau" },
    },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.2 } do
        for _, periods in ipairs { 1, 5 } do
          local Rl = 0.2 * scale.force_std
          guesses[#guesses + 1] = { k = 3 * Rl / (part * (scale.y_max - scale.y_min)), Rs = 3 * Rl, Rl = Rl,
            tau = periods * 2 * math.pi / scale.omega }
        end
      end
      return guesses
    end,
    range = function(scale)
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness }, tau = { 0.1 / scale.omega, 1e4 / scale.omega },
        Rs = { 1e-4 * scale.force_std, 100 * scale.force_std } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram that becomes lower as the acceleration's "
      .. "amplitude grows, and recovers when it ends",
    sentence = "shaking makes the sand flow: the stronger the vibration, the less of the friction is left",
    note = "for the acceleration amplitude stands sqrt(2) times the rms of a over the last tau seconds, which it is in a "
      .. "harmonic motion; at rest before the start",
    confusers = { "shaft_softening", "degrading_resistance", "elastic_slip" },
    acts_on = { "elastic_slip" },
    source = "Holeyman 2002, Soil behavior under vibratory driving, Proceedings of TransVib 2002, 3-19",
  }
end

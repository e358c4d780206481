return function(effect)
  local limit = "max(fN + kf*y, 0)"
  return effect {
    name = "friction_lift_off",
    family = "hysteresis",
    contribution = "z",
    formula = "z, dz/dt = k*v, held within -max(fN + kf*y, 0) <= z <= max(fN + kf*y, 0)",
    parameters = { { "k", min = 0, unit = "N/m" }, { "fN", min = 0, unit = "N" }, { "kf", unit = "N/m" } },
    states = { z = { rate = "k*v", min = "-" .. limit, max = limit, unit = "N" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.03, 0.2 } do
        for _, load in ipairs { -0.5, 0, 0.5, 1.5 } do  -- change of the limit over the motion
          local fN = 0.4 * scale.force_std
          local range = scale.y_max - scale.y_min
          guesses[#guesses + 1] = { fN = fN, k = fN / (part * range), kf = load * fN / range }
        end
      end
      return guesses
    end,
    range = function(scale)
      return { k = { 1e-3 * scale.stiffness, 1e5 * scale.stiffness },
        fN = { 1e-4 * scale.force_std, 30 * scale.force_std }, kf = { -1e3 * scale.stiffness, 1e3 * scale.stiffness } }
    end,
    passive = true,
    signature = "neither odd nor even; all harmonics; a parallelogram whose roof and floor lean with the "
      .. "displacement; gone while lifted off",
    sentence = "a friction contact whose normal load changes with the motion, and which lifts off",
    note = "fN = mu*N0 and kf = mu*kn: mu alone cannot be seen",
    confusers = { "elastic_slip", "position_dependent_friction", "one_sided_stop" },
    source = "Menq, Griffin and Bielak 1986, Journal of Engineering for Gas Turbines and Power 108, 300-305",
  }
end

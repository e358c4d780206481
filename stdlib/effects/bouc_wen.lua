return function(effect)
  return effect {
    name = "bouc_wen",
    family = "hysteresis",
    contribution = { "k*z", "k*zh" },
    formula = { "k*z, dz/dt = v - (abs(z)/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v)",
      "k*z, dz/dt = v - (abs(z)/zy)^n*(rho*abs(v)*sign(z) - (1 + rho)*v)" },
    parameters = {
      { "k", min = 0, unit = "N/m" },
      { "zy", min = 0, unit = "m" },
      { "rho", min = 0 },
      { "n", min = 1, max = 4 },
    },
    states = {
      z = { rate = "v - abs(z/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v)", unit = "m" },
      zh = { rate = "v - abs(zh/zy)^n*(rho*abs(v)*sign(zh) - (1 + rho)*v)", unit = "m" },
    },
    guess = function(scale, variant)
      local guesses = {}
      if variant == 2 then
        for _, part in ipairs { 0.3, 1 } do
          for _, rho in ipairs { 1, 3 } do
            guesses[#guesses + 1] = { zy = part * (scale.y_max - scale.y_min), rho = rho, n = 1 }
          end
        end
        return guesses
      end
      for _, part in ipairs { 0.03, 0.1, 0.3 } do
        for n = 1, 2 do
          for _, rho in ipairs { 0.5, 0.9 } do
            guesses[#guesses + 1] = { zy = part * (scale.y_max - scale.y_min), rho = rho, n = n }
          end
        end
      end
      return guesses
    end,
    range = function(scale, variant)  -- yields at once: coulomb_friction; never: linear_stiffness; rho = 0: a curved spring
      local range = scale.y_max - scale.y_min
      if variant == 2 then return { zy = { 0.1 * range, 10 * range }, rho = { 0.1, 100 } } end
      return { zy = { 1e-4 * range, range }, rho = { 0.1, 100 } }
    end,
    passive = "where rho >= 1/2, in the first form",  -- abs(gamma) <= beta: Baber and Wen 1981, J. Eng. Mech. Div. ASCE 107, 1069
    signature = "odd; odd harmonics; a loop even in slow motion, a spring at small amplitude; at equal (y, v) the force "
      .. "depends on the past",
    sentence = "a part of the structure yields and remembers: its force depends on the path that the motion took",
    note = "of Wen's beta and gamma: zy = abs(beta + gamma)^(-1/n), rho = beta/abs(beta + gamma); the second form where "
      .. "beta + gamma < 0, as in the benchmark of Noel and Schoukens 2016: it stiffens as it is loaded",
    confusers = { "coulomb_friction", "elastic_slip", "dahl_friction", "viscous_damping" },
    source = "Wen 1976, Journal of the Engineering Mechanics Division ASCE 102, 249-263; "
      .. "Ikhouane and Rodellar 2007, Systems with Hysteresis",
  }
end

return function(effect)
  local strength, stiffness = "(1 + dnu*e)", "(1 + deta*e)"
  local pinch = "zs*(1 - exp(-p*e))"
  local slip = ("(1 - %s*exp(-(((z/zy)*sign(v) - q*%s^(-1/n))/((psi + dpsi*e)*(lambda + %s)))^2))")
    :format(pinch, strength, pinch)
  return effect {
    name = "pinching_degrading_hysteresis",
    family = "hysteresis",
    contribution = "k*z",
    formula = "k*z, dz/dt = h/eta*(v - nu*(abs(z)/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v)); h, nu and eta of Baber and "
      .. "Noori change with the energy e = integral of z*v/zy^2",
    parameters = {
      { "k", min = 0, unit = "N/m" }, { "zy", min = 0, unit = "m" }, { "rho", min = 0 }, { "n", min = 1, max = 4 },
      { "dnu", min = 0 }, { "deta", min = 0 },                        -- loss of strength and of stiffness
      { "zs", min = 0, max = 1 }, { "q", min = 0 }, { "p", min = 0 },  -- how much, where and how soon it pinches
      { "psi", min = 0 }, { "dpsi", min = 0 }, { "lambda", min = 1e-3 },  -- how wide
    },
    states = {
      z = { rate = ("%s/%s*(v - %s*abs(z/zy)^n*(rho*abs(v)*sign(z) + (1 - rho)*v))"):format(slip, stiffness, strength),
        unit = "m" },
      e = { rate = "z*v/zy^2", anchored = true },
    },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.05, 0.2 } do
        for _, pinching in ipairs { 0.1, 0.8 } do
          guesses[#guesses + 1] = { zy = part * (scale.y_max - scale.y_min), rho = 0.7, n = 1, dnu = 0.005, deta = 0.01,
            zs = pinching, q = 0.1, p = 0.2, psi = 0.2, dpsi = 0.002, lambda = 0.5 }
        end
      end
      return guesses
    end,
    range = function(scale)
      local range = scale.y_max - scale.y_min
      return { zy = { 1e-4 * range, range }, psi = { 1e-3, 10 } }
    end,
    passive = "where rho >= 1/2 and the pinching grows little in a cycle",
    signature = "odd; odd harmonics; a loop that narrows in its middle and becomes softer and weaker from cycle to cycle",
    sentence = "a joint that wears: it loses strength and stiffness and rattles through its middle as it takes up energy",
    note = "as published, with A = 1 (one parameter of the original is redundant), z over its yield displacement zy and "
      .. "the energy over k*zy^2, so that all but k and zy are pure numbers",
    confusers = { "bouc_wen", "stiffness_drift", "clearance", "degrading_resistance" },
    source = "Baber and Noori 1985, Journal of Engineering Mechanics 111, 1010-1026; Baber and Noori 1986, Journal of "
      .. "Vibration and Acoustics 108, 411-420; Ma, Zhang, Bockstedte, Foliente and Paevere 2004, Journal of Applied "
      .. "Mechanics 71, 342-349 (redundancy)",
  }
end

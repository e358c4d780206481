return function(effect)
  --- Below that it is told from no damper, or from nothing but what the force does between its samples.
  local function shortest(scale) return scale.interval / 4 end
  return effect {
    name = "maxwell_relaxation",
    family = "hysteresis",
    contribution = "s",
    formula = "s, ds/dt = k*v - s/tau",
    parameters = { { "k", min = 0, unit = "N/m" }, { "tau", min = 0, unit = "s" } },
    states = { s = { rate = "k*v - s/tau", unit = "N" } },
    guess = function(scale)
      local guesses = {}
      for _, part in ipairs { 0.1, 1, 10 } do
        for _, stiffer in ipairs { 0.1, 1 } do
          guesses[#guesses + 1] = { k = stiffer * scale.stiffness, tau = shortest(scale) + part / scale.omega }
        end
      end
      return guesses
    end,
    range = function(scale)  -- tau -> 0: viscous_damping; tau -> infinity: linear_stiffness
      return { k = { 1e-4 * scale.stiffness, 1e5 * scale.stiffness },
        tau = { shortest(scale), shortest(scale) + 1e3 / scale.omega } }
    end,
    repeats = true,
    passive = true,
    signature = "odd, linear: the fundamental only; an elliptic loop, widest where omega*tau = 1; depends on frequency",
    sentence = "a viscoelastic part: a spring in series with a damper, stiff in fast motion and soft in slow motion",
    confusers = { "viscous_damping", "linear_stiffness", "fractional_damping", "hidden_mode" },
    source = "Maxwell 1867, Philosophical Transactions 157, 49-88; "
      .. "Christensen 1982, Theory of Viscoelasticity, chapter 1",
  }
end

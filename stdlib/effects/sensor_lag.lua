return function(effect)
  return effect {
    name = "sensor_lag",
    family = "sensor",
    measures = { y = "x" },
    any_motion = true,
    acts = { F = "F + tau*force_rate" },
    formula = "tau*dx/dt + x = u, x what the channel of u shows; u is y, or else F",
    parameters = { { "tau", min = 0, unit = "s" } },
    states = { x = { rate = "(y - x)/tau", unit = "m" } },
    guess = function(scale)
      local guesses = {}
      for i, part in ipairs { 0.05, 0.2, 0.6 } do guesses[i] = { tau = scale.interval + part / scale.omega } end
      return guesses
    end,
    range = function(scale)  -- less than half a sample is told from nothing but what the force does between its samples
      return { tau = { 0.5 * scale.interval, scale.interval + 10 / scale.omega } }
    end,
    passive = true,
    signature = "the phase falls behind and the amplitude falls as the frequency rises; looks like damping of either sign",
    sentence = "a channel lags behind, as through a filter that the other channel does not pass",
    note = "two forms: the displacement lags, or the force does; a lag of both alike does not show",
    confusers = { "viscous_damping", "maxwell_relaxation", "added_mass" },
    source = "Doebelin 2003, Measurement Systems, chapter 3 (first-order instruments)",
  }
end

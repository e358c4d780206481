return function(effect)
  return effect {
    name = "force_delay",
    family = "time_variation",
    delay = "tau",
    formula = "m*a + f = F(t - tau)",
    parameters = { { "tau", min = 0, unit = "s" } },
    guess = function(scale)
      local guesses = {}
      for i, part in ipairs { 0.3, 0.05, 1.2 } do guesses[i] = { tau = scale.interval + part / scale.omega } end
      return guesses
    end,
    range = function(scale)  -- less than half a sample is told from nothing but what the force does between its samples
      return { tau = { 0.5 * scale.interval, scale.interval + 6 / scale.omega } }
    end,
    passive = true,
    signature = "the phase falls behind in proportion to the frequency, the amplitude stays; at one frequency it is damping "
      .. "(of either sign) and stiffness",
    sentence = "the force acts later than its channel says, or the motion's channels are that much late",
    note = "the shifted force and its exact slope by tau; before the record begins the force is predicted from its rows",
    confusers = { "sensor_lag", "viscous_damping", "maxwell_relaxation" },
    source = "Doebelin 2003, Measurement Systems, chapter 3 (dead-time elements)",
  }
end

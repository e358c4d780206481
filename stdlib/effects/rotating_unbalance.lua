return function(effect)
  return effect {
    name = "rotating_unbalance",
    family = "input",
    contribution = "-me*(shaft_speed^2*cos(shaft_angle + phi) + shaft_rate*sin(shaft_angle + phi))",
    formula = "the force me*(w^2*cos(th) + dw/dt*sin(th)), th the angle of the shaft + phi, w its speed",
    parameters = { { "me", min = 0, unit = "kg m" }, { "phi", unit = "rad" } },
    guess = function()
      local guesses = {}
      for i = 1, 4 do guesses[i] = { phi = (i - 1) * math.pi / 2 } end
      return guesses
    end,
    separate = { phi = "shaft_angle" },
    passive = false,
    signature = "does not depend on the motion: no loop of its own; once per turn, the fundamental of the shaft, and "
      .. "grows with the square of the speed",
    sentence = "something that turns is out of balance and shakes the mass",
    note = "acts as F does, on the other side than the other entries; from a channel phase or shaft_angle [rad, deg; it may wrap], "
      .. "speed or shaft_speed [rad/s, rpm, Hz] of the record; phi is where its mark is; of a speed alone where it stood as the "
      .. "record began: each test record has its own then, training records begin alike",
    confusers = { "missing_harmonic", "base_motion" },
    channels = { "shaft_angle" },
    source = "Den Hartog 1956, Mechanical Vibrations, chapter 2",
  }
end

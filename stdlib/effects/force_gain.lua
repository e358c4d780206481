return function(effect)
  return effect {
    name = "force_gain",
    family = "input",
    acts = { F = "g*F" },
    formula = "m*a + f = g*F",
    parameters = { { "g", unit = "" } },
    guess = function() return { { g = 1 }, { g = -1 } } end,
    passive = true,
    signature = "F is off by one factor at all frequencies and amplitudes; g < 0: its wires are the wrong way round",
    sentence = "the force channel is off by a factor, as by a wrong calibration",
    note = "m*a + f = g*F is (m/g)*a + f/g = F: it shows only where the mass, a coefficient or a weight is known",
    confusers = { "added_mass", "sensor_gain" },
    source = "McConnell and Varoto 2008, Vibration Testing, chapter 4 (calibration of force transducers)",
  }
end

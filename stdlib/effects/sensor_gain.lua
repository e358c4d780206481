return function(effect)
  return effect {
    name = "sensor_gain",
    family = "sensor",
    measures = { y = "g*y" },
    any_motion = true,
    formula = "y measured = g*y",
    parameters = { { "g", unit = "" } },
    guess = function() return { { g = 1 }, { g = -1 } } end,
    passive = true,
    signature = "y is off by one factor at all frequencies and amplitudes; g < 0: its wires are the wrong way round",
    sentence = "the displacement channel is off by a factor, as by a wrong calibration",
    note = "with k and c free this is m/g in the equation, as force_gain and added_mass are: one name for the three",
    confusers = { "force_gain", "added_mass" },
    source = "Doebelin 2003, Measurement Systems, chapter 3 (sensitivity error of a transducer)",
  }
end

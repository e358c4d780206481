return function(effect)
  return effect {
    name = "sensor_drift",
    family = "sensor",
    measures = { y = "y + b + d*t + q*t^2" },
    any_motion = true,
    separate = true,
    formula = "y measured = y + b + d*t + q*t^2",
    parameters = { { "b", unit = "m" }, { "d", unit = "m/s" }, { "q", unit = "m/s^2" } },
    guess = function() return { { b = 0, d = 0, q = 0 } } end,
    passive = true,
    signature = "a slow trend in y, whatever the motion; no harmonics, no loop",
    sentence = "the zero of the displacement sensor wanders, as with its temperature",
    note = "t is the record's own time; training records wander alike, a test record in its own way; the trend is no more "
      .. "than a parabola",
    confusers = { "displacement_offset", "constant_force", "stiffness_drift" },
    source = "Doebelin 2003, Measurement Systems, chapter 3 (zero drift of a transducer)",
  }
end

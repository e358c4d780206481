return function(effect)
  return effect {
    name = "stiffness_drift",
    family = "time_variation",
    contribution = "k1*t*y",
    parameters = { { "k1", unit = "N/(m s)" } },
    passive = false,
    signature = "odd in y, even in v; the fundamental, whose phase drifts; no loop; depends on the time",
    sentence = "the stiffness changes steadily during the record, as of a warming or loosening part",
    note = "t is the record's time",
    confusers = { "damping_drift", "cubic_stiffness", "pinching_degrading_hysteresis" },
    source = "Farrar and Worden 2013, Structural Health Monitoring, chapter 12",
  }
end

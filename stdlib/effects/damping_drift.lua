return function(effect)
  return effect {
    name = "damping_drift",
    family = "time_variation",
    contribution = "c1*t*v",
    parameters = { { "c1", unit = "N/m" } },
    passive = "where c + c1*t >= 0, c the viscous damping beside it",
    signature = "odd in v, even in y; the fundamental, whose size drifts; an elliptic loop that widens with the time",
    sentence = "the damping changes steadily during the record, as of an oil that warms up",
    note = "t is the record's time",
    confusers = { "stiffness_drift", "viscous_damping", "setup_recovery" },
    source = "Farrar and Worden 2013, Structural Health Monitoring, chapter 12",
  }
end

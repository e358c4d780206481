return function(effect)
  return effect {
    name = "crane_lowering",
    family = "soil",
    contribution = "kc*max(y - yc0 - Vc*t, 0)",
    formula = "kc*max(y - yc, 0), yc = yc0 + Vc*t",
    parameters = { { "kc", min = 0, unit = "N/m" }, { "yc0", unit = "m" }, { "Vc", unit = "m/s" } },
    guess = function(scale)
      local guesses = {}
      local range = scale.y_max - scale.y_min
      for _, part in ipairs { 0.2, 0.5, 0.8 } do
        for _, speed in ipairs { 0, 1e-3 } do
          guesses[#guesses + 1] = { yc0 = scale.y_min + part * range, Vc = speed * scale.v_max }
        end
      end
      return guesses
    end,
    range = function(scale)  -- slack all the time, or taut: linear_stiffness and constant_force
      local range = scale.y_max - scale.y_min
      return { yc0 = { scale.y_min - 10 * range, scale.y_max }, Vc = { -scale.v_max, scale.v_max } }
    end,
    passive = "where Vc = 0",
    signature = "neither odd nor even in y, even in v: one side only; all harmonics and a mean; no loop; its edge "
      .. "wanders with the time",
    sentence = "the crane's rope holds the pile back where it runs ahead of the lowering",
    note = "y is positive downward, t is the record's time",
    confusers = { "one_sided_stop", "constant_force", "stiffness_drift" },
    source = "Viking 2002, Vibro-driveability, doctoral thesis, KTH Stockholm (the suspension force)",
  }
end

return function(effect)
  local function reach(scale) return math.max(scale.y_max, -scale.y_min) end
  return effect {
    name = "sinusoidal_stiffness",
    family = "stiffness",
    contribution = { "k*sin(p*y)", "k*cos(p*y)", "k*sin(p*y) + kc*cos(p*y)" },
    parameters = { { "k", unit = "N" }, { "p", min = 0, unit = "1/m" }, { "kc", unit = "N" } },
    guess = function(scale, variant)
      local guesses = variant == 3 and {} or { { p = 0.7 / reach(scale) } }
      for i = variant == 3 and 2 or 1, 64 do guesses[#guesses + 1] = { p = 1.5*i / reach(scale) } end  -- beyond 3 a wave is lost between two
      return guesses
    end,
    range = function(scale, variant)  -- a small part of a wave: cubic_stiffness, of the third form any smooth curve
      return { p = { (variant == 3 and 2.5 or 0.5) / reach(scale), 200 / reach(scale) } }
    end,
    passive = true,
    signature = "odd in y (the cosine even), even in v; odd harmonics; no loop; waves that repeat over the displacement",
    sentence = "the force repeats over the displacement, as of a pendulum, of magnets or of a motor's cogging",
    note = "cogging that is even about y = 0 is the cosine, of any other phase the third form",
    confusers = { "cubic_stiffness", "saturating_stiffness", "quintic_stiffness" },
    source = "Nayfeh and Mook 1979, Nonlinear Oscillations, chapter 2 (pendulum); "
      .. "Hanselman 2006, Brushless Permanent Magnet Motor Design (cogging)",
  }
end

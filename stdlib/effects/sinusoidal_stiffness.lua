return function(effect)
  local function reach(scale) return math.max(scale.y_max, -scale.y_min) end
  return effect {
    name = "sinusoidal_stiffness",
    family = "stiffness",
    contribution = { "k*sin(p*y)", "k*cos(p*y)" },
    parameters = { { "k", unit = "N" }, { "p", min = 0, unit = "1/m" } },
    guess = function(scale)
      local guesses = { { p = 0.7 / reach(scale) } }
      for i = 1, 32 do guesses[#guesses + 1] = { p = 1.5*i / reach(scale) } end  -- beyond 3 a wave is lost between two
      return guesses
    end,
    range = function(scale)  -- a small part of a wave: cubic_stiffness
      return { p = { 0.5 / reach(scale), 200 / reach(scale) } }
    end,
    passive = true,
    signature = "odd in y (the cosine even), even in v; odd harmonics; no loop; waves that repeat over the displacement",
    sentence = "the force repeats over the displacement, as of a pendulum, of magnets or of a motor's cogging",
    note = "cogging is the cosine, at any phase both",
    confusers = { "cubic_stiffness", "saturating_stiffness", "quintic_stiffness" },
    source = "Nayfeh and Mook 1979, Nonlinear Oscillations, chapter 2 (pendulum); "
      .. "Hanselman 2006, Brushless Permanent Magnet Motor Design (cogging)",
  }
end

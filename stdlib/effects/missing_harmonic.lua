--- Two rounds within the record: slower than that it is constant_force or a drift.
local function slowest(scale) return math.max(1e-3 * scale.omega, 4 * math.pi / scale.duration) end

return function(effect)
  return effect {
    name = "missing_harmonic",
    family = "input",
    contribution = "Ac*cos(w*t) + As*sin(w*t)",
    formula = "Ac*cos(w*t) + As*sin(w*t): the negative of what the recorded force lacks",
    parameters = { { "Ac", unit = "N" }, { "As", unit = "N" }, { "w", min = 0, unit = "rad/s" } },
    guess = function(scale)
      local guesses = {}
      for _, w in ipairs(scale.lines) do
        if w >= slowest(scale) then guesses[#guesses + 1] = { w = w } end
      end
      return #guesses > 0 and guesses or { { w = math.max(scale.omega, slowest(scale)) } }
    end,
    range = function(scale) return { w = { slowest(scale), 1e3 * scale.omega } } end,
    repeats = true,
    passive = false,
    signature = "does not depend on the motion: neither odd nor even, no loop of its own; one line of the spectrum, at "
      .. "any amplitude of the rest",
    sentence = "the exciter delivers a harmonic that the recorded force does not show",
    confusers = { "cubic_stiffness", "quadratic_stiffness", "base_motion", "parametric_stiffness" },
    source = "Pintelon and Schoukens 2012, System Identification: A Frequency Domain Approach",
  }
end

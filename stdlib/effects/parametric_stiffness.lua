--- Two rounds within the record: slower than that it is stiffness_drift.
local function slowest(scale) return math.max(1e-3 * scale.omega, 4 * math.pi / scale.duration) end

return function(effect)
  return effect {
    name = "parametric_stiffness",
    family = "time_variation",
    contribution = "(ac*cos(w*t) + as*sin(w*t))*y",
    parameters = { { "ac", unit = "N/m" }, { "as", unit = "N/m" }, { "w", min = 0, unit = "rad/s" } },
    guess = function(scale)  -- what stands out, and steps that a record of some twenty periods cannot step over
      local guesses = {}
      for _, w in ipairs(scale.modulations) do
        if w >= slowest(scale) then guesses[#guesses + 1] = { w = w } end
      end
      for i = 1, 80 do
        local w = i / 16 * scale.omega
        if w >= slowest(scale) then guesses[#guesses + 1] = { w = w } end
      end
      return guesses
    end,
    range = function(scale) return { w = { slowest(scale), 1e3 * scale.omega } } end,
    passive = false,
    signature = "odd in y, even in v; side bands at the sum and difference of frequencies; no loop but a line that "
      .. "swings with the time; may grow without a force",
    sentence = "the stiffness goes up and down by itself, as of gear teeth or of a rotor that is not round",
    confusers = { "stiffness_drift", "quadratic_stiffness", "missing_harmonic" },
    source = "Nayfeh and Mook 1979, Nonlinear Oscillations, chapter 5",
  }
end

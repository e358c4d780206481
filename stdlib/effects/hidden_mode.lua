return function(effect)
  return effect {
    name = "hidden_mode",
    family = "extra_dof",
    contribution = "kh*(y - x) + ch*(v - u)",
    formula = "kh*(y - x) + ch*(v - dx/dt), mh*d2x/dt2 = the same",
    parameters = { { "mh", min = 0, unit = "kg" }, { "kh", min = 0, unit = "N/m" }, { "ch", min = 0, unit = "N s/m" } },
    states = {
      x = { rate = "u", unit = "m" },
      u = { rate = "(kh*(y - x) + ch*(v - u))/mh", unit = "m/s", absolute = true },
    },
    guess = function(scale)
      local guesses, mh = {}, 0.1 * scale.stiffness / scale.omega ^ 2  -- how heavy is solved for: all scale with mh
      for i = -12, 12 do  -- as dense as its resonance is wide: beside it the force has the wrong phase
        local wh = 1.1 ^ i * scale.omega
        guesses[#guesses + 1] = { mh = mh, kh = mh * wh ^ 2, ch = 0.1 * mh * wh }
      end
      return guesses
    end,
    range = function(scale)  -- very stiff: added_mass; very heavy: linear_stiffness; very light: a line of the noise
      local mass = scale.stiffness / scale.omega ^ 2
      return { mh = { 1e-4 * mass, 1e3 * mass }, kh = { 1e-6 * scale.stiffness, 1e4 * scale.stiffness } }
    end,
    repeats = true,
    passive = true,
    signature = "odd, linear: the fundamental only; an elliptic loop, widest at another resonance; an antiresonance of "
      .. "the driven point",
    sentence = "something that is not measured swings along: a second mass on a spring",
    note = "the hidden mass is at rest at the start",
    confusers = { "added_mass", "maxwell_relaxation", "soil_plug" },
    source = "Ormondroyd and Den Hartog 1928, Transactions of the ASME 50, APM-50-7",
  }
end

-- With N the work done in slip, dN = Ru (rinf + (1 - rinf) exp(-N/Nc)) ds over the slipped path s has the solution
-- R/Ru = 1/(exp(-x) + w (1 - exp(-x))/x), w = Ru s/Nc, x = rinf w. (1 - exp(-x))/x is written by tanh(x/2), which keeps
-- its digits near x = 0; 1e-8 keeps it off 0/0, for an error of 5e-9.
return function(effect)
  local work = "(Ru*(d - q*z^2/2)/Nc)"
  local x = ("(rinf*%s + 1e-8)"):format(work)
  local half = ("tanh(%s/2)"):format(x)
  -- stored at the limit R is R^2*q/(2*Ru), with R/Ru as it would be if Ru*q/2 were
  local first = "(rinf + (1 - rinf)*exp(-(w - Ru*q/2)/Nc))"
  local limit = ("Ru*(rinf + (1 - rinf)*exp(-(w - Ru*q/2*%s^2)/Nc))"):format(first)
  return effect {
    name = "degrading_resistance",
    family = "soil",
    contribution = { ("Ru*z/(exp(-%s) + %s*2*%s/((1 + %s)*%s))"):format(x, work, half, half, x), "r" },
    formula = { "R*z, R = Ru*(rinf + (1 - rinf)*exp(-N/Nc)), N the work done in slip; dz/dt = v/q, held within -1 <= z <= 1",
      "z, dz/dt = Ru/q*v, held within -R <= z <= R, R = Ru*(rinf + (1 - rinf)*exp(-N/Nc)), N the work done in slip" },
    parameters = { { "Ru", min = 0, unit = "N" }, { "q", min = 0, unit = "m" }, { "rinf", min = 0, max = 1 },
      { "Nc", min = 0, unit = "N m" } },
    states = {
      z = { rate = "v/q", min = "-1", max = "1" },
      d = { rate = "z*v", unit = "m", anchored = true },  -- work done over Ru; less what is stored: the slipped path
      r = { rate = "Ru/q*v", min = "-" .. limit, max = limit, unit = "N" },
      w = { rate = "r*v", unit = "N m", anchored = true },  -- work done; less what is stored: N
    },
    guess = function(scale)
      local guesses = {}
      local range, Ru = scale.y_max - scale.y_min, 0.5 * scale.force_std
      for _, part in ipairs { 0.03, 0.15 } do
        for _, cycles in ipairs { 3, 30 } do
          guesses[#guesses + 1] = { Ru = Ru, q = part * range, rinf = 0.3, Nc = 2 * cycles * Ru * range }
        end
      end
      return guesses
    end,
    range = function(scale)  -- at once or never: smith_shaft without J
      local range = scale.y_max - scale.y_min
      local work = scale.force_std * range
      return { Ru = { 1e-4 * scale.force_std, 100 * scale.force_std }, q = { 1e-4 * range, range },
        Nc = { 1e-3 * work, 1e5 * work } }
    end,
    passive = true,
    signature = "odd; odd harmonics; a parallelogram that becomes lower with the work done in slip, towards a rest rinf",
    sentence = "the soil loses resistance the more work is done in it, as sand that is fluidised by driving",
    note = "variant 1: the quake q stays, so that the stiffness falls with the limit; variant 2: the stiffness Ru/q stays",
    confusers = { "shaft_softening", "vibro_liquefaction", "smith_shaft", "pinching_degrading_hysteresis" },
    acts_on = { "elastic_slip" },
    source = "Rodger and Littlejohn 1980, Geotechnique 30, 269-293",
  }
end

-- A sum of relaxations: D^p y = sin(pi p)/pi * integral of L^p u_L over ln L, du_L/dt = v - L u_L. The integral becomes a
-- sum of even steps in ln L; what lies below the slowest joins one slow relaxation, what lies above the fastest a damper.
local step, count = 1.8, 5

--- Rates of the relaxations, over the reference w.
local function place(i) return math.exp(step * (i - (count + 1) / 2)) end

local function number(x) return ("%.17g"):format(x) end

return function(effect)
  local slow, sum = number(place(1)), {}
  local states = {
    u0 = { rate = ("v - w*%s*(exp(%g*p) - 1)/(exp(%g*(1 + p)) - 1)*u0"):format(slow, step, step), unit = "m" },
  }
  for i = 1, count do
    sum[i] = ("%s^p*u%d"):format(number(place(i)), i)
    states["u" .. i] = { rate = ("v - w*%s*u%d"):format(number(place(i)), i), unit = "m" }
  end
  sum[#sum + 1] = ("%s^p/(exp(%g*p) - 1)*u0"):format(slow, step)
  sum[#sum + 1] = ("%s^(p - 1)/(exp(%g*(1 - p)) - 1)*v/w"):format(number(place(count)), step)
  return effect {
    name = "fractional_damping",
    family = "damping",
    contribution = ("c*w^p*%g*sin(pi*p)/pi*(%s)"):format(step, table.concat(sum, " + ")),
    formula = "c*D^p y",
    parameters = { { "c", min = 0, unit = "N s^p/m" }, { "p", min = 0.01, max = 0.99 },
      { "w", min = 0, unit = "rad/s", fixed = true } },
    states = states,
    guess = function(scale)  -- w below the motion's own frequency: the fastest relaxation, 37 w, has to be integrated
      local w = scale.omega / 4
      return { { p = 0.2, w = w }, { p = 0.5, w = w }, { p = 0.8, w = w } }
    end,
    range = function() return { p = { 0.02, 0.98 } } end,  -- p -> 0: linear_stiffness; p -> 1: viscous_damping
    passive = true,
    signature = "odd, linear: the fundamental only; an elliptic loop that leans; stiffness and loss grow as frequency^p",
    sentence = "a viscoelastic part, such as rubber: its stiffness and its loss both grow slowly with the frequency",
    note = "at rest before the start; a Prony sum of six relaxations and a damper about w, a frequency in the band of "
      .. "the record: its complex stiffness is that of c*(i*omega)^p within 1 % from w/10 to 10*w, 3.5 % from w/30 "
      .. "to 30*w",
    confusers = { "maxwell_relaxation", "viscous_damping", "linear_stiffness" },
    source = "Bagley and Torvik 1983, Journal of Rheology 27, 201-210; "
      .. "Yuan and Agrawal 2002, Journal of Vibration and Acoustics 124, 321-324 (as a sum)",
  }
end

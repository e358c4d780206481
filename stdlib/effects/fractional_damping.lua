-- D^p y = sin(pi p)/pi * integral over L of L^(p - 1) u_L, du_L/dt = v - L u_L. With x = (L - w)/(L + w) it becomes an
-- integral over -1 .. 1 with the weight of Jacobi, (1 + x)^(p - 1)*(1 - x)^(-p), and this a sum over the nodes of Clenshaw
-- and Curtis: its two ends are a spring and a damper, the others relaxations, and it is exact at p = 0 and at p = 1.
local nodes = 8

--- (1 + x)/2 at a node: its relaxation has the rate w*place/(1 - place).
local function place(i) return (1 + math.cos(math.pi * (nodes - i) / (nodes - 1))) / 2 end

local function number(x) return ("%.13g"):format(x) end

--- Coefficients of the polynomial in place that is 1 at node i and 0 at the others, the constant first.
local function basis(i)
  local polynomial = { 1 }
  for j = 1, nodes do
    if j ~= i then
      local over, product = place(i) - place(j), {}
      for k = 1, #polynomial + 1 do
        product[k] = ((polynomial[k - 1] or 0) - place(j) * (polynomial[k] or 0)) / over
      end
      polynomial = product
    end
  end
  return polynomial
end

--- The share of node i: place^k has the mean p*(p + 1)*...*(p + k - 1)/k! under the weight.
local function share(i)
  local polynomial = basis(i)
  local sum = number(polynomial[nodes])
  for k = nodes - 1, 1, -1 do
    sum = ("(%s + (p + %d)/%d*%s)"):format(number(polynomial[k]), k - 1, k, sum)
  end
  return sum
end

return function(effect)
  local sum, states = { share(1) .. "*y" }, {}
  for i = 2, nodes - 1 do
    local state = "u" .. i - 1
    sum[#sum + 1] = ("%s*%s"):format(number(1 / (1 - place(i))), share(i) .. "*" .. state)
    states[state] = { rate = ("v - w*%s*%s"):format(number(place(i) / (1 - place(i))), state), unit = "m" }
  end
  sum[#sum + 1] = share(nodes) .. "*v/w"
  return effect {
    name = "fractional_damping",
    family = "damping",
    contribution = ("c*w^p*(%s)"):format(table.concat(sum, " + ")),
    formula = "c*D^p y",
    parameters = { { "c", min = 0, unit = "N s^p/m" }, { "p", min = 0.01, max = 0.99 },
      { "w", min = 0, unit = "rad/s", fixed = true } },
    states = states,
    guess = function(scale)  -- w below the motion's own frequency: the fastest relaxation, 19 w, has to be integrated
      local w = scale.omega / 2
      return { { p = 0.2, w = w }, { p = 0.5, w = w }, { p = 0.8, w = w } }
    end,
    range = function() return { p = { 0.02, 0.98 } } end,  -- p -> 0: linear_stiffness; p -> 1: viscous_damping
    passive = true,
    signature = "odd, linear: the fundamental only; an elliptic loop that leans; stiffness and loss grow as frequency^p",
    sentence = "a viscoelastic part, such as rubber: its stiffness and its loss both grow slowly with the frequency",
    note = "at rest before the start; a Prony sum of a spring, six relaxations and a damper about w, a frequency in the band "
      .. "of the record: its complex stiffness is that of c*(i*omega)^p within 0.03 % from w/3 to 3*w, 0.6 % from w/10 to "
      .. "10*w. w is held, no number of the law: c and p do not hang on it",
    confusers = { "maxwell_relaxation", "viscous_damping", "linear_stiffness" },
    source = "Bagley and Torvik 1983, Journal of Rheology 27, 201-210; "
      .. "Yuan and Agrawal 2002, Journal of Vibration and Acoustics 124, 321-324 (as a sum)",
  }
end

-- SINDy as the thesis explains it (appendix C, figure C.1): the Lorenz equations from a record of their three states, and rates in noise,
-- by least squares over nine terms, cut off and repeated.
local lunid = require "lunid"
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Lorenz: SINDy on the equations of appendix C" }

-- ---- the record, by Runge and Kutta's method ----

local function rates(s) return { 10*(s[2] - s[1]), s[1]*(28 - s[3]) - s[2], s[1]*s[2] - 8/3*s[3] } end
local function moved(s, r, h) return { s[1] + h*r[1], s[2] + h*r[2], s[3] + h*r[3] } end
local state, h, path, change = { -8, 7, 27 }, 0.002, { {}, {}, {} }, { {}, {}, {} }
for i = 1, quick and 4000 or 20000 do
  local k1 = rates(state)
  for j = 1, 3 do path[j][i], change[j][i] = state[j], k1[j] end
  local k2 = rates(moved(state, k1, h/2))
  local k3 = rates(moved(state, k2, h/2))
  local k4 = rates(moved(state, k3, h))
  for j = 1, 3 do state[j] = state[j] + h/6*(k1[j] + 2*k2[j] + 2*k3[j] + k4[j]) end
end

-- ---- the equations ----

--- SINDy: least squares over a library, and again without the terms of less than 2 % of the target.
local function sindy(target, library)
  local kept = {}
  for k = 1, #library do kept[k] = k end
  while true do
    local sum, data = 0, { px = path[1], py = path[2], pz = path[3], rate = target }
    for _, k in ipairs(kept) do sum = sum + lunid.parameter { "b" .. k, 0 }*library[k][2] end
    local fit = lunid.fit_curve { data = data, response = lunid.channel "rate", formula = sum }
    local left, size = {}, 0
    for i = 1, #target do size = size + target[i]^2 end
    for _, k in ipairs(kept) do
      local part = 0
      for i = 1, #target, 10 do part = part + 10*library[k][2]:at { px = path[1][i], py = path[2][i], pz = path[3][i] }^2 end
      if math.abs(fit.parameters["b" .. k].value)*math.sqrt(part/size) > 0.02 then left[#left + 1] = k end
    end
    if #left == #kept then return fit, kept end
    kept = left
  end
end

local x, y, z = lunid.channel "px", lunid.channel "py", lunid.channel "pz"
local library = { { "x", x }, { "y", y }, { "z", z }, { "x^2", x^2 }, { "x*y", x*y }, { "x*z", x*z }, { "y^2", y^2 }, { "y*z", y*z }, { "z^2", z^2 } }
local expected = { { x = -10, y = 10 }, { x = 28, ["x*z"] = -1, y = -1 }, { ["x*y"] = 1, z = -8/3 } }
local rows, largest, wrong = {}, 0, 0
for j, name in ipairs { "dx/dt", "dy/dt", "dz/dt" } do
  local noisy = lunid.record { dt = h, channels = { { "F", change[j] } } }:with_noise { F = 0.01, seed = 10*seed + j }:column "F"
  local fit, kept = sindy(noisy:list(), library)
  for _, k in ipairs(kept) do
    local value, real = fit.parameters["b" .. k].value, expected[j][library[k][1]]
    wrong = wrong + (real and 0 or 1)
    largest = real and math.max(largest, math.abs(value/real - 1)) or largest
    rows[#rows + 1] = { name, library[k][1], value, real }
  end
end
report:table { head = { "equation", "term", "found", "truth" }, rows = rows, caption = "Least squares among nine terms, cut off at 2 % and repeated, rates in 1 % noise" }
report:figure("lorenz", lunid.figure.lines { x = "x", y = "z", series = { lunid.figure.series { path[1], path[3] } } },
  "The Lorenz attractor, from which the equations were found")

report:results { case = "lorenz", variant = "C.1", runs = {}, largest_error = largest, false_terms = wrong, terms = #rows }
report:save()

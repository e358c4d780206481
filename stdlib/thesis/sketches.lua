-- The figures of the thesis that belong to no case, each computed: 1.2, a restoring force surface of three masses with a gap; 4.1, the
-- hyperbolic tangent by Chebyshev and by Taylor; E.1, bias and variance over the number of terms. Figure 1.1 is a diagram of words, and
-- 3.1 a photograph.
local lunid = require "lunid"
local lines, series = lunid.figure.lines, lunid.figure.series
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Sketches: figures that belong to no case" }

-- ---- 1.2 ----

report:section "Figure 1.2: three masses, a gap in the first link"
local gap, stiff = 5e-3, 6e4
local chain = lunid.chain { masses = { 1, 1, 1 }, ends = "left", forces = { 1 }, element = function(d, w, i)
  return 2e4*d + 10*w + (i == 1 and stiff*(lunid.max(d - gap, 0) - lunid.max(-d - gap, 0)) or 0)
end }
local push = lunid.excitation.multisine { from = 5, to = 45, rms = 300, period = 4, dt = 0.00125, duration = quick and 4 or 12, seed = seed }
local run = lunid.simulate { model = chain, excitation = push }:record()
local inertia = run:column("a1"):list()
for i, name in ipairs { "a2", "a3" } do
  local more = run:column(name)
  for r = 1, #inertia do inertia[r] = inertia[r] + more[r] end
end
-- All that accelerates hangs on the first link: its force is F - the sum of all m*a.
local link = lunid.record { dt = run.dt, channels = { { "F", run:column(run.channels.F and "F" or "F1") }, { "y", run:column "y1" }, { "v", run:column "v1" },
  { "a", inertia } } }
local surface = lunid.rfs { record = link, mass = 1, interpolate = lunid.grid { cells = { 30, 30 } } }
report:figure("three_masses", lunid.figure.surface { surface }, "Restoring force of the first of three masses, whose link is stiffer beyond a gap")
local cut = lunid.section { surface, v = 0 }
local slope = {}
for i = 2, #cut.place do
  local middle = 0.5*(cut.place[i] + cut.place[i - 1])
  local where = math.abs(middle) < 0.6*gap and "inside" or math.abs(middle) > 1.6*gap and "beyond"
  local rise = (cut.f[i] - cut.f[i - 1])/(cut.place[i] - cut.place[i - 1])
  if where and rise == rise then
    slope[where] = slope[where] or { 0, 0 }
    slope[where][1], slope[where][2] = slope[where][1] + rise, slope[where][2] + 1
  end
end
local inside, beyond = slope.inside[1]/slope.inside[2], slope.beyond[1]/slope.beyond[2]
report:table { head = { "slope of the section at v = 0 [N/m]", "surface", "truth" }, rows = { { "within the gap", inside, 2e4 }, { "beyond it", beyond, 2e4 + stiff } } }

-- ---- 4.1 ----

report:section "Figure 4.1: tanh by Chebyshev and by Taylor"
local function tanh(x) return 1 - 2/(math.exp(2*x) + 1) end
local reach, order, nodes, chebyshev = 3, 9, 64, {}
for n = 0, order do  -- (1.4) with the factor (2 - delta)/pi, by Gauss-Chebyshev quadrature
  chebyshev[n] = 0
  for k = 1, nodes do
    local angle = math.pi*(k - 0.5)/nodes
    chebyshev[n] = chebyshev[n] + (n == 0 and 1 or 2)/nodes*tanh(reach*math.cos(angle))*math.cos(n*angle)
  end
end
local taylor = { 1, -1/3, 2/15, -17/315, 62/2835 }
local x, truth, by_chebyshev, by_taylor, worst = {}, {}, {}, {}, { 0, 0 }
for i = 1, 241 do
  x[i] = reach*(i - 121)/120
  truth[i], by_chebyshev[i], by_taylor[i] = tanh(x[i]), 0, 0
  for n = 0, order do by_chebyshev[i] = by_chebyshev[i] + chebyshev[n]*math.cos(n*math.acos(x[i]/reach)) end
  for k, c in ipairs(taylor) do by_taylor[i] = by_taylor[i] + c*x[i]^(2*k - 1) end
  worst[1], worst[2] = math.max(worst[1], math.abs(by_chebyshev[i] - truth[i])), math.max(worst[2], math.abs(by_taylor[i] - truth[i]))
  if math.abs(by_taylor[i]) > 1.5 then by_taylor[i] = 0/0 end
end
report:figure("chebyshev_tanh", lines { x = "x", y = "tanh(x)", series = { series { x, truth, label = "tanh", role = "measured" },
  series { x, by_chebyshev, label = "Chebyshev, order 9", role = "final", style = "dashed" },
  series { x, by_taylor, label = "Taylor, order 9", role = "baseline", style = "dotted" } } }, "A hyperbolic tangent by Chebyshev polynomials and by Taylor's series")
report:table { head = { "series of order 9 on -3 ... 3", "largest error" }, rows = { { "Chebyshev", worst[1] }, { "Taylor", worst[2] } } }

-- ---- E.1 ----

report:section "Figure E.1: bias and variance"
local count, most, draws = 30, 14, quick and 40 or 200
local errors = { train = {}, test = {} }
for terms = 1, most do errors.train[terms], errors.test[terms] = 0, 0 end
local grid = {}
for i = 1, count do grid[i] = -1 + 2*(i - 1)/(count - 1) end
local clean = {}
for i = 1, count do clean[i] = tanh(3*grid[i]) end
local plain = lunid.record { dt = 1, channels = { { "F", clean }, { "y", grid } } }
for draw = 1, draws do
  local seen, unseen = plain:with_noise { F = 0.3, seed = 2*draw }, plain:with_noise { F = 0.3, seed = 2*draw + 1 }
  for terms = 1, most do
    local fit = lunid.regress { record = seen, features = { lunid.polynomials({ lunid.displacement }, terms, { constant = true }) } }
    for name, record in pairs { train = seen, test = unseen } do
      local sum, force = 0, record:column "F"
      for i = 1, count do
        local value = 0
        for k, term in ipairs(fit.terms) do value = value + term.value*term.feature:at { y = grid[i] } end
        sum = sum + (force[i] - value)^2/count
      end
      errors[name][terms] = errors[name][terms] + sum/draws
    end
  end
end
local orders, best = {}, 1
for terms = 1, most do
  orders[terms] = terms
  if errors.test[terms] < errors.test[best] then best = terms end
end
report:figure("bias_variance", lines { x = "order of the polynomial", y = "mean square error", y_scale = "log", series = {
  series { orders, errors.train, label = "rows of the fit", style = "line_points" }, series { orders, errors.test, label = "rows not seen", style = "line_points" } } },
  ("Bias and variance: polynomials fitted to 30 noisy points of a tanh, mean of %d draws; the best order is %d"):format(draws, best))

report:results { case = "sketches", variant = "1.2", runs = {}, slopes = { inside = inside, beyond = beyond }, tanh = { chebyshev = worst[1], taylor = worst[2] },
  best_order = best, errors = errors }
report:save()

-- Can statistics name the terms of a force before anything is fitted (thesis, appendices F and G)? The target of the thesis' first
-- example, y1*y2 + y1^2*y2 with y1 = cos 10t + sin 10t and y2 = cos 10t - sin 10t; its second example is lost, one is made here.
local lunid = require "lunid"
local t, cos, sin, abs = lunid.time, lunid.cos, lunid.sin, lunid.abs
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Features: what statistics say of terms" }

--- The values of an expression of the time, with noise as a share of its deviation.
local function sampled(expression, noise)
  local record = lunid.excitation.formula { force = expression, dt = 0.0037, duration = quick and 4 or 8 }
  return record:with_noise { F = noise or 0, seed = seed }:column "F"
end

local function candidates(y1, y2)
  local list = {}
  for _, each in ipairs { { "y1", y1 }, { "y2", y2 }, { "y1^2", y1^2 }, { "y2^2", y2^2 }, { "y1*y2", y1*y2 }, { "y1^3", y1^3 },
    { "y2^3", y2^3 }, { "y1^2*y2", y1^2*y2 }, { "y1*y2^2", y1*y2^2 }, { "y2*|y2|", y2*abs(y2) }, { "y1^4", y1^4 } } do
    list[#list + 1] = { each[1], sampled(each[2]) }
  end
  return list
end

local drawn = 0

--- Ranks the candidates; how many of the true terms stand among as many first.
local function ranked(title, target, columns, true_terms, known)
  local ranking = lunid.rank_features { target = target, columns = columns, given_columns = known }
  local is_true, rows, among = {}, {}, 0
  for _, name in ipairs(true_terms) do is_true[name] = true end
  for i, row in ipairs(ranking) do
    rows[i] = { row.name .. (is_true[row.name] and " (true)" or ""), row.information, row.beyond, row.spearman, row.kendall }
    if i <= #true_terms and is_true[row.name] then among = among + 1 end
  end
  local names = { { "mutual information [nat]", "information" }, { "Spearman, its size", "spearman" }, { "Kendall, its size", "kendall" } }
  local panels = {}
  for k, name in ipairs(names) do
    local bars = {}
    for i, row in ipairs(ranking) do bars[i] = { rows[i][1], math.abs(row[name[2]]) } end
    panels[k] = lunid.figure.contributions { bars, axis = name[1] }
  end
  drawn = drawn + 1
  report:figure("statistics_" .. drawn, lunid.figure.grid { panels, columns = 3, width = 24 }, title)
  report:table { head = { "term", "mutual information [nat]", "beyond the first", "Spearman", "Kendall" }, rows = rows, caption = title }
  return { title = title, true_terms = #true_terms, found_among_first = among }, ranking
end

local runs = {}
local y1, y2 = cos(10*t) + sin(10*t), cos(10*t) - sin(10*t)
runs[1] = ranked("Example 1 of the thesis: y1*y2 + y1^2*y2, one frequency", sampled(y1*y2 + y1^2*y2, 0.05), candidates(y1, y2),
  { "y1*y2", "y1^2*y2" })

local function force(y, v) return y + 0.5*y^3 + 0.2*v*abs(v) end
runs[2] = ranked("Example 2, made here: y1 + y1^3/2 + y2*|y2|/5, one frequency", sampled(force(y1, y2), 0.05), candidates(y1, y2),
  { "y1", "y1^3", "y2*|y2|" })

local function both(f) return 0.7*(f(10*t) + f(17.3*t + 1)) end
local z1, z2 = both(function(x) return cos(x) + sin(x) end), both(function(x) return cos(x) - sin(x) end)
local target, columns = sampled(force(z1, z2), 0.05), candidates(z1, z2)
local third, ranking = ranked("Example 2 under two frequencies", target, columns, { "y1", "y1^3", "y2*|y2|" })
local known = {}
for _, each in ipairs(columns) do
  if each[1] == ranking[1].name then known[1] = each end
end
runs[3] = third
runs[4] = ranked("The same, beyond what the first term tells (conditional mutual information)", target, columns, { "y1", "y1^3", "y2*|y2|" }, known)

local spread = {}
for i, each in ipairs(columns) do spread[i] = each[2] end
local components = lunid.statistics.principal_components { spread }
local shares, total = {}, 0
for i = 1, 6 do
  total = total + components.shares[i]
  shares[i] = { i, 100*components.shares[i], 100*total }
end
report:table { head = { "component", "share [%]", "sum [%]" }, rows = shares,
  caption = "Principal components of the eleven candidates: few directions hold most, and none of them is a term" }
report:text("At one frequency every term is a function of the phase, and all of them tell about one another; under two frequencies the best "
  .. "term stands out. QQCC is not defined in appendix F; here it is the correlation of the points of the quantile plot.")
report:results { case = "features", variant = "G", runs = runs }
report:save()

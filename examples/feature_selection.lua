-- Can statistics name the terms of a force before anything is fitted? The two examples of the thesis' appendix G: mutual
-- information, Spearman's and Kendall's rank correlation of candidate terms with a target that holds some of them.
local lunid = require "lunid"
local t, cos, sin, abs = lunid.time, lunid.cos, lunid.sin, lunid.abs

--- The values of an expression of the time, with noise as a share of its deviation.
local function sampled(expression, noise)
  local record = lunid.excitation.formula { force = expression, dt = 0.0037, duration = 8 }
  return record:with_noise { F = noise or 0, seed = 1 }:column "F"
end

local function candidates(y1, y2)
  local list = {}
  for _, each in ipairs { { "y1", y1 }, { "y2", y2 }, { "y1^2", y1^2 }, { "y2^2", y2^2 }, { "y1*y2", y1*y2 }, { "y1^3", y1^3 },
    { "y2^3", y2^3 }, { "y1^2*y2", y1^2*y2 }, { "y1*y2^2", y1*y2^2 }, { "y2*|y2|", y2*abs(y2) }, { "y1^4", y1^4 } } do
    list[#list + 1] = { each[1], sampled(each[2]) }
  end
  return list
end

-- Example 1, of the thesis: one frequency, target y1*y2 + y1^2*y2. Neither true term leads in all three measures, and a
-- function of the phase alone tells about every other one: y1 and y1^3 are one column to them.
local y1, y2 = cos(10*t) + sin(10*t), cos(10*t) - sin(10*t)
print "example 1: target y1*y2 + y1^2*y2, one frequency"
print(lunid.rank_features { target = sampled(y1*y2 + y1^2*y2, 0.05), columns = candidates(y1, y2) })

-- Example 2: that of the thesis is lost, this one is made here. A hardening spring and quadratic damping, y1 + y1^3/2 +
-- y2*|y2|/5, with the velocity y2: at one frequency as inconclusive as the first.
local function force(y, v) return y + 0.5*y^3 + 0.2*v*abs(v) end
print "\nexample 2: target y1 + y1^3/2 + y2*|y2|/5, one frequency"
print(lunid.rank_features { target = sampled(force(y1, y2), 0.05), columns = candidates(y1, y2) })

-- The same force under two frequencies: the orbit fills the plane, and what a term tells beyond the best one counts.
local function both(f) return 0.7*(f(10*t) + f(17.3*t + 1)) end
local z1 = both(function(x) return cos(x) + sin(x) end)
local z2 = both(function(x) return cos(x) - sin(x) end)
local target, columns = sampled(force(z1, z2), 0.05), candidates(z1, z2)
print "\nexample 2, two frequencies"
local ranking = lunid.rank_features { target = target, columns = columns }
print(ranking)

local known = {}
for _, each in ipairs(columns) do
  if each[1] == ranking[1].name then known[1] = each end
end
print(("\nbeyond the first of them, %s"):format(ranking[1].name))
print(lunid.rank_features { target = target, columns = columns, given_columns = known })

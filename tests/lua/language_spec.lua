-- The language: Lua's operators build expressions; declarations travel with them into models.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time

spec.case("operators build nodes", function()
  local k = lunid.parameter { "k", 2e4, min = 0, unit = "N/m" }
  spec.equal(tostring(k*y + 3*v^2 - y/2), "k*y + 3*v^2 - y/2")
  spec.equal(tostring(-y), "-y")
  spec.equal(tostring(2^y), "2^y")
end)

spec.case("a field that is given as false is false", function()
  spec.equal(lunid.lasso { refit = false }.refit, false)
  spec.equal(lunid.lasso { refit = true }.refit, true)
  local k = lunid.parameter { "k", 3, fixed = false }
  spec.equal(lunid.model { mass = 1, restoring = k*y }.parameters.k.fixed, false)
end)

spec.case("functions fold numbers and take several arguments where that has a meaning", function()
  spec.equal(lunid.sin(0), 0)
  spec.near(lunid.exp(1), 2.718281828459045, 1e-15)
  spec.equal(lunid.max(1, 5, 3), 5)
  spec.equal(tostring(lunid.where(lunid.greater(y, 0), y, 0)), "where(y > 0, y, 0)")
  spec.equal(tostring(lunid.max(y, v, 0)), "max(max(y, v), 0)")
end)

spec.case("equal expressions are equal", function()
  spec.equal(y*v == y*v, true)
  spec.equal(y == v, false)
end)

spec.case("derivatives and values", function()
  spec.equal(tostring((y^3):derivative(y)), "3*y^2")
  local k = lunid.parameter { "k", 4 }
  spec.equal((k*y):at { y = 2 }, 8)
  spec.equal(spec.message_of(function() return (y*v):at { y = 2 } end), "at: no value for 'v'")
end)

spec.case("comparisons raise, and name what to write", function()
  local said = spec.message_of(function() return y <= 3 end)
  spec.contains(said, "lunid.at_most(a, b)")
  spec.contains(said, "lunid.greater(a, b)")
  spec.equal(spec.message_of(function() return 3 > y end), said)
end)

spec.case("polynomials", function()
  local names = {}
  for i, feature in ipairs(lunid.polynomials({ y, v }, 2)) do names[i] = tostring(feature) end
  spec.equal(table.concat(names, " "), "y v y^2 y*v v^2")
  spec.equal(#lunid.polynomials({ y, v }, 5), 20)  -- (5 + 2)! / (5! 2!) - 1
  spec.equal(#lunid.polynomials({ y, v }, 5, true), 21)
end)

spec.case("a model collects what its expressions were declared with", function()
  local c = lunid.parameter { "c", 10, min = 0, unit = "N s/m" }
  local z = lunid.state { "z", rate = function(z) return v - c*z end, initial = 0.5 }
  local model = lunid.model { mass = 49, restoring = 2e4*y + 5*z }
  spec.equal(model.parameters.c.value, 10)
  spec.equal(model.parameters[1].unit, "N s/m")
  spec.equal(model.states[1].initial, 0.5)
  spec.equal(tostring(model.states[1].rate), "v - c*z")
  spec.equal(model:with { c = 12 }.parameters.c.value, 12)
  spec.equal(model.parameters.c.value, 10)
end)

spec.case("one name declared twice, differently, is an error", function()
  local a = lunid.parameter { "stiff", 1 }
  local b = lunid.parameter { "stiff", 2 }
  spec.contains(spec.message_of(function() return a*y + b*v end), "parameter 'stiff' is declared twice, differently: at ")
end)

spec.case("columns are 1-based and refuse what is outside", function()
  local model = lunid.model { mass = 1, restoring = 4*y }
  local run = lunid.simulate { model = model, excitation = 0*t, from = { 1, 0 }, duration = 1, dt = 0.01 }
  local column = run:column "y"
  spec.equal(#column, 101)
  spec.equal(column[1], 1)
  spec.near(column[101], math.cos(2), 1e-6)  -- the fixed path's own tolerance is 1e-5 of std(y)
  spec.equal(spec.message_of(function() return column[0] end), "column: row 0 is outside 1 to 101")
  spec.equal(column[102], nil)
  spec.equal(spec.message_of(function() return column[103] end), "column: row 103 is outside 1 to 101")
  local rows, sum = 0, 0
  for i, value in ipairs(column) do rows, sum = i, sum + value end
  spec.equal(rows, 101)
  spec.near(sum / rows, column:mean(), 1e-12)
end)

spec.case("a column asked for in every row of a loop does not fill the memory", function()
  local said, code = spec.study(spec.resident "VmHWM" .. [[
local lunid = require "lunid"
local force = lunid.excitation.white_noise { rms = 1, seed = 1, dt = 1e-3, duration = 100 }
local before, sum = resident(), 0
for i = 1, 2000 do sum = sum + force:column("F")[i] end
print(("more %.0f MB"):format(resident() - before))]])
  spec.equal(code, 0)
  assert(tonumber(said:match "more (%d+) MB") < 200, said)  -- 2000 columns of 0.8 MB
end)

spec.case("metatables are locked", function()
  spec.equal(getmetatable(y), "lunid.expression")
  spec.equal(pcall(setmetatable, lunid, {}), false)
end)

spec.finish()

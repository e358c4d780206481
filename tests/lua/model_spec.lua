-- model:save writes Lua that loads again to the same model.
local lunid = require "lunid"
local spec = require "spec"

local y, v, a, t = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time

--- Everything that can be seen of a model, as text.
local function seen(model)
  local lines = { tostring(model), tostring(model.mass), tostring(model.restoring), tostring(model.imposed_motion) }
  for _, row in ipairs(model.parameters) do
    lines[#lines + 1] = ("%s %a %a %a %a %s %s"):format(row.name, row.value or 0, row.min or -1, row.max or -1,
      row.std or -1, row.unit, row.fixed)
  end
  for _, state in ipairs(model.states) do
    lines[#lines + 1] = ("%s %a %s %s %s"):format(state.name, state.initial, state.rate, state.min, state.max)
  end
  return table.concat(lines, "\n")
end

local function round_trip(model, name)
  local path = spec.folder .. "/" .. name .. ".lua"
  spec.equal(model:save(path), path)
  spec.equal(seen(lunid.load(path)), seen(model))
end

spec.case("a linear model", function()
  local k = lunid.parameter { "k", 20931.123456789, min = 0, max = 1e9, unit = "N/m", std = 0.1 }
  local m = lunid.parameter { "m", 49, min = 1, fixed = true, unit = "kg" }
  round_trip(lunid.model { mass = m, restoring = k*y + 10*v }, "linear")
end)

spec.case("every function of the language", function()
  local p = lunid.parameter { "p", 0.1 + 0.2 }
  local sum = lunid.where(lunid.greater(y, v), y, -v) + lunid.where(lunid.less_equal(y, 0.5), t, 1)
  for _, name in ipairs { "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    "abs", "sign" } do
    sum = sum + lunid[name](p*y)
  end
  round_trip(lunid.model { mass = 2, restoring = sum + lunid.min(y, v) - lunid.max(y, 1e-300)/3 + 2^-y }, "functions")
end)

spec.case("internal states with bounds that follow the motion", function()
  local k = lunid.parameter { "k", 3 }
  local z = lunid.state { "z", rate = function(z) return v - k*lunid.abs(v)*z end, initial = 0.25,
    min = -1 - lunid.abs(y), max = 2 }
  round_trip(lunid.model { mass = 1, restoring = k*z }, "states")
end)

spec.case("imposed motion, no first guess", function()
  local c = lunid.parameter { "c" }
  round_trip(lunid.model { mass = 0, restoring = c*v, motion = "imposed" }, "imposed")
end)

spec.case("terms in a", function() round_trip(lunid.model { mass = 3, restoring = 2*a + 5*y }, "inertia") end)

spec.clean()
spec.finish()

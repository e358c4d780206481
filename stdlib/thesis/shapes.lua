-- Which shape does a surface have along the displacement? Elementary shapes are fitted to its section where there are data, and
-- ranked by Schwarz's criterion. A constant is part of all of them, and each shape has its mirror: signs are free.
local lunid = require "lunid"
local x = lunid.channel "place"

local shapes = {}

--- Shapes over a reach r of the section: name, formula with parameters.
local function candidates(reach, size)
  local function free(name, guess) return lunid.parameter { name, guess } end
  local function within(name, guess) return lunid.parameter { name, guess, min = guess/50, max = guess*50 } end
  local a, b, d = free("c1", size/reach), free("c3", 0), free("c5", 0)
  local s, r = free("size", size), within("r", reach/4)
  local k, g, o = within("k", size/reach), within("g", reach/4), free("offset", 0)
  local abs, max, tanh, sign, min = lunid.abs, lunid.max, lunid.tanh, lunid.sign, lunid.min
  return {
    { "a straight line", a*x + o }, { "a cubic, a*y + b*y^3", a*x + b*x^3 + o },
    { "a quintic, a*y + b*y^3 + d*y^5", a*x + b*x^3 + d*x^5 + o },
    { "a parabola, a*y + b*y^2", a*x + b*x^2 + o },
    { "tanh(p*y)", s*tanh(x/r) + o }, { "a hyperbola, y/(1 + |y|/r)", s*x/(r + abs(x)) + o },
    { "an arctangent", s*lunid.atan(x/r) + o }, { "a sharp yield, clip(y)", s*(min(max(x/r, -1), 1)) + o },
    { "a jump, sign(y)", s*sign(x) + o }, { "a clearance", k*(max(x - g, 0) - max(-x - g, 0)) + o },
    { "two slopes", a*x + b*abs(x) + o }, { "a sine", s*lunid.sin(x/r) + o },
  }
end

--- The shapes ranked: best (the name), shapes (a list), table for a report.
function shapes.of_surface(surface)
  local cut = lunid.section { surface, v = 0, count = 120 }
  local place, force, reach, size = {}, {}, 0, 0
  for i = 1, #cut.place do
    if cut.f[i] == cut.f[i] then
      place[#place + 1], force[#force + 1] = cut.place[i], cut.f[i]
      reach, size = math.max(reach, math.abs(cut.place[i])), math.max(size, math.abs(cut.f[i]))
    end
  end
  local list = {}
  for _, each in ipairs(candidates(reach, size)) do
    local good, fit = pcall(lunid.fit_curve, { data = { place = place, force = force }, response = lunid.channel "force", formula = each[2] })
    if good then
      local n = #place
      local bic = n*math.log(math.max(fit.rmse, 1e-12*size)^2) + #fit.parameters*math.log(n)
      list[#list + 1] = { name = each[1], rmse = fit.rmse, parameters = #fit.parameters, criterion = bic }
    end
  end
  table.sort(list, function(one, other) return one.criterion < other.criterion end)
  local rows = {}
  for i, row in ipairs(list) do rows[i] = { row.name, row.parameters, row.rmse, ("%.0f"):format(row.criterion - list[1].criterion) } end
  return { best = list[1].name, shapes = list, table = { head = { "shape", "parameters", "RMSE [N]", "BIC over the best" }, rows = rows,
    caption = "Elementary shapes fitted to the section of the surface along the displacement" } }
end

return shapes

-- The figure of a frequency response: stable branches solid, unstable ones dashed, special points marked.
local core = require "lunid.core"

local response_figure = {}

local roles = { "first", "second", "third", "fourth", "fifth", "sixth" }
local words = { fold = "fold", branch_point = "branch point", period_doubling = "period doubling",
  neimark_sacker = "Neimark-Sacker point" }

--- The curve as two columns of y, NaN where the branch is of the other kind. A piece between two points is unstable
--- where either of them is, but for a special point, which belongs to both sides.
local function by_stability(curve, y)
  local stable, branch, special = curve:column "stable", curve:column "branch", {}
  for _, point in ipairs(curve.special) do special[point.row] = true end
  local solid, dashed, any = {}, {}, false
  for row = 1, #y do solid[row], dashed[row] = 0/0, 0/0 end
  local function keep(list, row) list[row], list[row + 1] = y[row], y[row + 1] end
  for row = 1, #y - 1 do
    if branch[row] == branch[row + 1] then
      local bad = stable[row] == 0 and not special[row] or stable[row + 1] == 0 and not special[row + 1]
      keep(bad and dashed or solid, row)
      any = any or bad
    end
  end
  return core.column(solid), any and core.column(dashed) or nil
end

local function marks(list, curve, y)
  local found = {}
  for _, point in ipairs(curve.special) do
    if words[point.kind] then
      local at = found[point.kind] or { x = {}, y = {} }
      found[point.kind] = at
      at.x[#at.x + 1], at.y[#at.y + 1] = point.frequency, y[point.row]
    end
  end
  for _, kind in ipairs { "fold", "branch_point", "period_doubling", "neimark_sacker" } do
    if found[kind] then
      local label = not list[kind] and words[kind] or ""
      list[kind] = true
      list[#list + 1] = { x = core.column(found[kind].x), y = core.column(found[kind].y), label = label,
        role = "measured", style = "points", width = 1.6 }
    end
  end
end

--- "amplitude_3" -> axis with its unit.
local function axis_of(given)
  local quantity, order = given.quantity:match "^(%a+)_?(%d*)$"
  local name = order and order ~= "" and ("%s of harmonic %s"):format(quantity, order) or given.quantity
  return { name = name, unit = quantity == "phase" and "rad" or "m", scale = given.log and "log" or nil }
end

function response_figure.of(given)
  local response, series, special = given.response, {}, {}
  for i, curve in ipairs(response.curves) do
    local x, y = curve:column "frequency", curve:column(given.quantity, given.state)
    local label, role = ("%.6g %s"):format(response.amplitudes[i], response.unit), roles[(i - 1) % #roles + 1]
    if curve.method:find "^stepped" then
      series[#series + 1] = { x = x, y = y, label = label .. ", " .. curve.method, role = role, style = "points" }
    else
      local solid, dashed = by_stability(curve, y)
      series[#series + 1] = { x = x, y = solid, label = label, role = role, style = "line" }
      if dashed then series[#series + 1] = { x = x, y = dashed, label = label .. ", unstable", role = role, style = "dashed" } end
      marks(special, curve, y)
    end
  end
  for _, each in ipairs(given.series) do
    each.role = each.role or "noise"
    series[#series + 1] = each
  end
  for _, each in ipairs(special) do series[#series + 1] = each end
  if given.backbone then
    series[#series + 1] = { x = given.backbone:column "frequency", y = given.backbone:column(given.quantity), role = "measured",
      style = "dash_dot", label = "backbone" }
  end
  return { panels = { { x = { name = "frequency", unit = "Hz" }, y = axis_of(given),
    series = series } } }
end

return response_figure

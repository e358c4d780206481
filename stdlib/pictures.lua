-- The figures of a discovery's report: name, caption and plain table of each.
local core = require "lunid.core"
local figures = require "lunid.figures"
local sources = require "lunid.figures.sources"

local pictures = {}

local time = { name = "time", unit = "s" }
--- The axis of a channel in the unit of the records.
local function axis(found, channel) return sources.axis(channel, found.units[channel:sub(1, 1)]) end

--- "free run", or what stands in its place where the motion is imposed.
local function run_words(found) return found.model.imposed_motion and "along the motion" or "free run" end

--- Panels side by side.
local function row_of(panels) return { columns = #panels, panels = panels, share_y = true } end

local minus = sources.minus

local function plus(a, b)
  local left, right = a:list(), b:list()
  for i = 1, #left do left[i] = left[i] + right[i] end
  return core.column(left)
end

--- Rows at either end that say nothing: the lead-in, which the runs leave out, and as many at the end, where the
--- derivative of the motion is as poor as at the start.
local function lead_in(comparison)
  local rows = #comparison.t
  local i = 1
  while i < rows and comparison.baseline[i] ~= comparison.baseline[i] and comparison.final[i] ~= comparison.final[i] do
    i = i + 1
  end
  return i < rows // 4 and i - 1 or 0
end

--- The column with NaN in place of its first and last `count` rows.
local function inner(column, count)
  local values = column:list()
  for i = 1, math.min(count, #values) do values[i], values[#values + 1 - i] = 0/0, 0/0 end
  return core.column(values)
end

-- ---- the runs over time ----

--- Baseline and final model, or the one model where nothing was added.
local function models(found, baseline, final)
  if #found.effects == 0 then return { { values = baseline, label = "baseline", role = "baseline", style = "dashed" } } end
  return { { values = baseline, label = "baseline", role = "baseline", style = "dashed" },
    { values = final, label = "final model", role = "final", style = "dotted" } }
end

local function run_panel(found, comparison, limits)
  local series = { { x = comparison.t, y = comparison.measured, label = "measured", role = "measured" } }
  for _, model in ipairs(models(found, comparison.baseline, comparison.final)) do
    series[#series + 1] = { x = comparison.t, y = model.values, label = ("%s, %s"):format(model.label, run_words(found)),
      role = model.role, style = model.style }
  end
  return { title = limits and "where the baseline is worst" or "",
    x = { name = "time", unit = "s", min = limits and limits.from, max = limits and limits.to }, y = axis(found, comparison.output),
    series = series }
end

local function error_panel(found, comparison)
  local series = { { x = comparison.t, y = comparison.measured, label = "measured", role = "measured" } }
  local errors = models(found, comparison.baseline, comparison.final)
  for _, model in ipairs(errors) do
    series[#series + 1] = { x = comparison.t, y = minus(comparison.measured, model.values),
      label = "error, " .. model.label, role = model.role }
  end
  return { title = "whole record", x = time, y = axis(found, comparison.output), series = series }
end

local function residual_panel(found, comparison)
  local series, ends = {}, lead_in(comparison)
  for _, model in ipairs(models(found, comparison.residual_before, comparison.residual_after)) do
    series[#series + 1] = { x = comparison.t, y = inner(model.values, ends), label = "left by the " .. model.label,
      role = model.role }
  end
  return { title = "force along the measured motion", x = time, y = { name = "unexplained force", unit = found.units.F },
    series = series }
end

--- How often the measured output crosses its mean upward, by more than its noise.
local function periods(measured)
  local mean, room, count, low = measured:mean(), 0.3 * measured:std(), 0, false
  for _, value in ipairs(measured:list()) do
    if value < mean - room then low = true end
    if low and value > mean + room then count, low = count + 1, false end
  end
  return count
end

local shown_periods = 8  -- in the detail: few enough to see each curve

--- The part of the record in which the baseline's error is largest; nil where the whole record is no longer than that.
local function worst_part(comparison)
  local rows, count = #comparison.t, periods(comparison.measured)
  if count < 2 * shown_periods then return nil end
  local width = math.max(20, rows * shown_periods // count)
  local squares, sum, most, at = minus(comparison.measured, comparison.baseline):list(), 0, -1, nil
  for i = 1, rows do
    squares[i] = squares[i] == squares[i] and squares[i] ^ 2 or 0
    sum = sum + squares[i] - (i > width and squares[i - width] or 0)
    if i >= width and sum > most then most, at = sum, i end
  end
  return at and { from = comparison.t[at - width + 1], to = comparison.t[at] }
end

--- With imposed motion the error over the whole record is the unexplained force already.
function pictures.history(found, comparison)
  local part = worst_part(comparison)
  local panels = part and { error_panel(found, comparison), run_panel(found, comparison, part) }
    or { run_panel(found, comparison) }
  if not (part and found.model.imposed_motion) then panels[#panels + 1] = residual_panel(found, comparison) end
  return { panels = panels }
end

--- "_y2" where the records hold several outputs.
local function of_output(comparison) return #comparison.output > 1 and "_" .. comparison.output or "" end

local function add_histories(list, found)
  local seen, length = {}, found.data.method.run_length
  local free_runs = length and ("free runs of %.3g s, some of many,"):format(length) or "free runs, never re-initialised,"
  for _, comparison in ipairs(found.comparisons) do
    local which = comparison.role .. of_output(comparison)
    seen[which] = (seen[which] or 0) + 1
    list[#list + 1] = { name = ("history_%s_%d%s"):format(comparison.role, seen[which], of_output(comparison)),
      figure = figures.make(pictures.history(found, comparison)),
      caption = ("%s (%s): measured, and the %s of %s; the force that is left unexplained along the measured motion."):format(
        comparison.record, #comparison.output > 1 and comparison.role .. ", " .. comparison.output or comparison.role,
        found.model.imposed_motion and "forces along the measured motion" or free_runs,
        #found.effects > 0 and "baseline and final model" or "the baseline") }
  end
end

-- ---- the unexplained force over displacement and velocity ----

local function largest(rows)
  local most = 0
  for _, row in ipairs(rows) do
    if row:max() == row:max() then most = math.max(most, row:max(), -row:min()) end
  end
  return most
end

local function map_panel(found, map, rows, title, most, what)
  local where = map.place ~= "" and " " .. map.place or ""
  return { title = title, x = { name = "displacement" .. where, unit = found.units.y },
    y = { name = "velocity" .. where, unit = found.units.v },
    map = { x = map.y, y = map.v, z = rows, colour = { name = what or "unexplained force", unit = found.units.F,
      min = most and -most, max = most } } }
end

--- Both maps side by side, in one range of colours; one map where nothing was added to the baseline.
function pictures.residual_map(found)
  local map = found.map
  local most = math.max(largest(map.before), largest(map.after))
  most = most > 0 and most or nil
  local panels = { map_panel(found, map, map.before, "baseline", most) }
  if #found.effects > 0 then panels[2] = map_panel(found, map, map.after, "final model", most) end
  return row_of(panels)
end

local function add_map(list, found)
  if #found.map.y < 2 or #found.map.v < 2 then return end
  list[#list + 1] = { name = "residual_map", figure = figures.make(pictures.residual_map(found)),
    caption = "Mean force that is left unexplained, over displacement and velocity" .. (found.map.place ~= "" and " of " .. found.map.place
      or "") .. ": where the baseline fails"
      .. (#found.effects > 0 and ", and what the final model leaves" or "") .. ". Hatched: no data." }
end

-- ---- where the model fails, and what noise alone makes of it ----

local noise_words = "noise, 95 %"

--- Values of one map, of the baseline and of the final model, beside the level; of means, which have signs, on both sides.
local function level_panel(name, x, quantity, before, after)
  local signed = before.value_is == "mean"
  local style = before.value_is == "amplitude" and "points" or "line"
  local series = { { x = before.x, y = before.value, label = "baseline", role = "baseline", style = style == "line" and "line_points" or style } }
  if after then series[2] = { x = after.x, y = after.value, label = "final model", role = "final", style = style } end
  series[#series + 1] = { x = before.x, y = before.level, label = noise_words, role = "noise",
    style = style == "points" and "stems" or "dashed" }
  if signed then
    local below = before.level:list()
    for i = 1, #below do below[i] = -below[i] end
    series[#series + 1] = { x = before.x, y = core.column(below), role = "noise", style = "dashed" }
  end
  return { title = name, x = x, y = quantity, series = series }
end

--- The phase plane of the baseline, its cells above the level marked.
local function plane_panel(found, plane, place)
  local v, y = plane.v:list(), plane.y:list()
  local at_y, at_v, most = {}, {}, 0
  for j = 1, #v do
    local values, levels = plane.value[j]:list(), plane.level[j]:list()
    for i = 1, #y do
      if values[i] == values[i] then most = math.max(most, math.abs(values[i])) end
      if math.abs(values[i]) > levels[i] then at_y[#at_y + 1], at_v[#at_v + 1] = y[i], v[j] end
    end
  end
  return { title = "phase plane, baseline", x = { name = "displacement" .. place, unit = found.units.y },
    y = { name = "velocity" .. place, unit = found.units.v },
    map = { x = plane.y, y = plane.v, z = plane.value, colour = { name = "mean force", unit = found.units.F,
      min = most > 0 and -most or nil, max = most > 0 and most or nil } },
    series = #at_y > 0 and { { x = core.column(at_y), y = core.column(at_v), label = "above the noise", role = "measured",
      style = "points", width = 0.7 } } or nil }
end

local part_level = 3  -- normal quantile of 0.05 over three quantities in six parts, both sides

--- Offset and slopes over parts of the records, as changes from their means in standard deviations.
local function slow_panel(slow)
  local series = {}
  for i, row in ipairs { { "constant", "offset" }, { "stiffness", "slope in y" }, { "damping", "slope in v" } } do
    local value, std = slow[row[1]].value:list(), slow[row[1]].std:list()
    local sum, weights = 0, 0
    for k = 1, #value do
      local weight = 1 / math.max(std[k] ^ 2, 1e-300)
      sum, weights = sum + weight * value[k], weights + weight
    end
    for k = 1, #value do value[k] = std[k] > 0 and (value[k] - sum / weights) / std[k] or 0/0 end
    local role, style = figures.look_of(i)
    series[i] = { x = slow.time, y = core.column(value), label = row[2], role = role, style = style }
  end
  return { title = "slow time, baseline", x = time, y = { name = "change / standard deviation", unit = "" }, series = series,
    lines = { { value = part_level, label = noise_words, role = "noise" }, { value = -part_level, role = "noise" } } }
end

--- All maps of what the baseline leaves, and the final model where something was named; nil where there are none.
function pictures.where_it_fails(found)
  local before, after = found.maps.before, found.maps.after
  if not before then return nil end
  local place = found.map.place ~= "" and " " .. found.map.place or ""
  local unit = found.units.F
  local mean, rms = { name = "mean force", unit = unit }, { name = "rms force", unit = unit }
  local function panel(over, name, x, quantity) return level_panel(name, x, quantity, before[over], after and after[over]) end
  return { columns = 2, panels = {
    panel("time", "time", time, rms), slow_panel(before.slow),
    panel("y", "displacement", { name = "displacement" .. place, unit = found.units.y }, mean),
    panel("v", "velocity", { name = "velocity" .. place, unit = found.units.v }, mean),
    panel("amplitude", "amplitude", { name = "amplitude" .. place, unit = found.units.y }, rms),
    panel("harmonic", "harmonic order", { name = "harmonic", unit = "" }, { name = "amplitude of the force", unit = unit }),
    panel("frequency", "frequency", { name = "frequency", unit = "Hz" }, { name = "root density", unit = figures.grouped(unit) .. "/Hz^0.5" }),
    plane_panel(found, before.plane, place) } }
end

local function add_where(list, found)
  local fields = pictures.where_it_fails(found)
  if not fields then return end
  list[#list + 1] = { name = "where_it_fails", section = "where", figure = figures.make(fields),
    caption = "Force that is left unexplained along the measured motion of the training records" .. (found.map.place ~= ""
      and " at " .. found.map.place or "") .. ", and what noise of its colour stays below in all bins of a map at once (95 %)." }
end

--- { name, what it says of the baseline, of the final model } for each map.
function pictures.sentences(found)
  local before, after, rows = found.maps.before, found.maps.after, {}
  if not before then return rows end
  for _, row in ipairs { { "time", "time" }, { "slow", "slow time" }, { "plane", "phase plane" }, { "y", "displacement" },
    { "v", "velocity" }, { "amplitude", "amplitude of the motion" }, { "harmonic", "harmonic order" }, { "frequency", "frequency" } } do
    rows[#rows + 1] = { row[2], before[row[1]].sentence, after and after[row[1]].sentence or nil }
  end
  return rows
end

-- ---- the force of an unknown effect ----

--- Where forces without a name follow it; else it is the map of what the baseline leaves.
local function add_unknown_force(list, found)
  local shape = found.closure and found.unknown_force
  if not shape or #shape.y < 2 or #shape.v < 2 then return end
  local most = largest(shape.force)
  list[#list + 1] = { name = "unknown_force", figure = figures.make(row_of {
      map_panel(found, { y = shape.y, v = shape.v, place = found.map.place }, shape.force, "", most > 0 and most or nil, "missing force") }),
    caption = "The force that is missing, as fitted forces without a name (closure.lua) have it along the motion of the "
      .. "training records. Hatched: no data." }
end

-- ---- the named effects against the record ----

--- What the named formulas are functions of: over these the effect is drawn.
local function variables(found, effects)
  local seen = {}
  for _, effect in ipairs(effects) do
    local formula = effect.family == "sensor" and "" or effect.formula  -- the fault of a channel is no force
    for name in formula:gmatch "%f[%w_][%a_][%w_]*" do
      seen[effect.place and name:match "^([yv])%d+$" or name] = true  -- of several coordinates: y2
    end
  end
  local hidden = seen.z  -- its force depends on the past: over displacement and velocity it is a loop
  local list = {}
  if seen.y or hidden then list[#list + 1] = { "y", axis(found, "y") } end
  if seen.v or hidden then list[#list + 1] = { "v", axis(found, "v") } end
  if seen.t or #list == 0 then list[#list + 1] = { "t", time } end
  return list
end

local function force_panel(found, x, variable, measured, named)
  return { x = variable[2], y = axis(found, "F"), series = {
    { x = x, y = measured, label = "left by the rest of the final model", role = "residual", style = "points" },
    { x = x, y = named, label = "named effect", role = "effect", style = "points" } } }
end

--- Of several coordinates: each effect over the motion at its place, which its title tells.
local function forces_at_places(found)
  local panels, ends = {}, lead_in(found.comparisons[1])
  for i, force in ipairs(found.forces) do
    local effect = found.effects[i]
    for _, variable in ipairs(largest { force.named } > 0 and variables(found, { effect }) or {}) do
      local panel = force_panel(found, force[variable[1]], variable, inner(plus(force.left, force.named), ends), force.named)
      panel.title = effect.label
      panels[#panels + 1] = panel
    end
  end
  return #panels > 0 and { columns = math.min(#panels, 2), panels = panels } or nil
end

local function first_training(found)
  for _, comparison in ipairs(found.comparisons) do
    if comparison.role == "train" then return comparison end
  end
end

--- The force of what was named, over each thing that it is a function of; nil where nothing was named that is a force.
function pictures.named_force(found)
  local train = first_training(found)
  if not train or #found.effects == 0 then return nil end
  if #found.forces > 0 then return forces_at_places(found) end
  if largest { train.named_force } == 0 then return nil end
  local measured = inner(plus(train.residual_after, train.named_force), lead_in(train))
  local panels = {}
  for _, variable in ipairs(variables(found, found.effects)) do panels[#panels + 1] = force_panel(found, train[variable[1]], variable, measured, train.named_force) end
  return row_of(panels)
end

local function add_named_force(list, found)
  local fields = pictures.named_force(found)
  if not fields then return end
  list[#list + 1] = { name = "named_force", figure = figures.make(fields),
    caption = ("The force of %s, and what the final model would leave unexplained without it, along the measured "
      .. "motion of %s."):format(#found.effects > 1 and "all that was named" or found.effects[1].label or found.effects[1].name,
      first_training(found).record) }
end

-- ---- how it was found ----

local function add_steps(list, found)
  local kinds = require("lunid.figures.all").public.figure
  if #found.effects > 0 then
    list[#list + 1] = { name = "gaps", figure = kinds.gaps(found),
      caption = "The gap of free runs after each named effect, on the training and the test record, and what noise alone leaves." }
  end
  if #found.data.rivals > 0 then
    list[#list + 1] = { name = "rivals", figure = kinds.rivals(found),
      caption = "The gap of each set that was fitted on the trajectory, over all rows of the training record, and that of "
        .. "the baseline's free run." }
  end
end

--- Name, caption and figure of each picture, in the report's order.
function pictures.of(found)
  local list = {}
  add_where(list, found)
  add_histories(list, found)
  add_map(list, found)
  add_unknown_force(list, found)
  add_named_force(list, found)
  add_steps(list, found)
  return list
end

return pictures

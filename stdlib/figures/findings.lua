-- Figures of where a model fails, and of what a discovery found.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local sources = require "lunid.figures.sources"
local types = schema.types

local time = { name = "time", unit = "s" }

local discovery = types.is("discovery", "lunid.discover")

-- ---- maps of a residual ----

--- Centres of n equal cells over the finite values.
local function cells(column, n)
  local low, high = column:min(), column:max()
  if not (high > low) then low, high = low - 0.5, high + 0.5 end
  local width, centres = (high - low)/n, {}
  for i = 1, n do centres[i] = low + (i - 0.5)*width end
  return centres, low, width
end

--- Mean of z over cells of x and y; NaN where there are fewer than `least` rows.
local function binned(x, y, z, nx, ny, least)
  local cx, x0, wx = cells(x, nx)
  local cy, y0, wy = cells(y, ny)
  local sums, counts = {}, {}
  local X, Y, Z = x:list(), y:list(), z:list()
  for i = 1, #Z do
    if Z[i] - Z[i] == 0 and X[i] - X[i] == 0 and Y[i] - Y[i] == 0 then
      local column = math.min(nx, math.floor((X[i] - x0)/wx) + 1)
      local key = (math.min(ny, math.floor((Y[i] - y0)/wy) + 1) - 1)*nx + column
      sums[key], counts[key] = (sums[key] or 0) + Z[i], (counts[key] or 0) + 1
    end
  end
  local rows = {}
  for j = 1, ny do
    rows[j] = {}
    for i = 1, nx do
      local key = (j - 1)*nx + i
      rows[j][i] = (counts[key] or 0) >= least and sums[key]/counts[key] or 0/0
    end
  end
  return { x = core.column(cx), y = core.column(cy), z = rows }
end

local function largest(panels)
  local most = 0
  for _, panel in ipairs(panels) do
    for _, row in ipairs(panel.map.z) do
      for i = 1, #row do
        if row[i] == row[i] then most = math.max(most, math.abs(row[i])) end
      end
    end
  end
  return most > 0 and most or nil
end

--- Panels with one range of colours, in the unit of the force.
local function alike(panels, unit)
  local most = largest(panels)
  for _, panel in ipairs(panels) do
    panel.map.colour = { name = "unexplained force", unit = unit, min = most and -most, max = most }
  end
  return panels
end

local function map_panel(t, y, v, residual, given, unit)
  local displacement, velocity = sources.axis("y", unit.y), sources.axis("v", unit.v)
  local over_time = given.over == "time"
  local map = over_time and binned(t, y, residual, 2*given.cells, given.cells, 1)
    or binned(y, v, residual, given.cells, given.cells, given.least_count)
  return { x = over_time and time or displacement, y = over_time and displacement or velocity, map = map }
end

--- The training record of a discovery, before and after.
local function of_discovery(found, given)
  local c = found.comparisons[1]
  local panels = { map_panel(c.t, c.y, c.v, c.residual_before, given, found.units) }
  panels[1].title = "baseline"
  if #found.effects > 0 then
    panels[2] = map_panel(c.t, c.y, c.v, c.residual_after, given, found.units)
    panels[2].title = "final model"
  end
  return panels
end

figures.define({
  name = "residual_map",
  help = "Where a model leaves force unexplained: over displacement and velocity, or over slow time. Of a discovery, the map "
    .. "before and after.",
  positional = { "discovery" },
  fields = {
    { "discovery", discovery, help = "what was found; or else record and model, or columns" },
    { "record", types.is("record", "lunid.read"), help = "a measured record" },
    { "model", types.is("model", "lunid.model"), help = "whose residual F - m*a - f(y, v, t) is shown" },
    { "residual", types.column, help = "plain columns: the residual, and displacement, velocity and time" },
    { "y", types.column, help = "displacement" },
    { "v", types.column, help = "velocity" },
    { "t", types.column, help = "time; else the rows' numbers" },
    { "over", types.choice { "phase_plane", "time" }, default = "phase_plane", help = "'time': displacement over slow time" },
    { "cells", types.integer { min = 2, max = 200 }, default = 30, help = "along each axis" },
    { "least_count", types.integer { min = 1 }, default = 1, help = "rows in a cell; others have no data" },
  },
  example = [[lunid.figure.residual_map(found):save "map.png"]],
}, function(given)
  local panels, unit
  if given.discovery then
    if given.over == "phase_plane" then return require("lunid.pictures").residual_map(given.discovery) end
    panels, unit = of_discovery(given.discovery, given), given.discovery.units
  elseif given.record and given.model then
    local record, model = given.record, given.model
    if #model.states > 0 then
      figures.fail("residual_map", "model: it has internal states, which no record shows; give the residual as a column")
    end
    local force = core.channel "F" - model.mass*core.channel "a" - model.restoring
    unit = {}
    for _, name in ipairs { "y", "v", "F" } do unit[name] = sources.unit_in(record, name) end
    panels = { map_panel(record:column "t", record:column "y", record:column "v",
      core.evaluate(record, force, "figure.residual_map"), given, unit) }
  elseif given.residual and given.y and given.v then
    local rows = {}
    for i = 1, #given.residual do rows[i] = i end
    for _, name in ipairs { "y", "v" } do
      if #given[name] ~= #given.residual then
        figures.fail("residual_map", ("%s: expected %d numbers as in residual, got %d"):format(name, #given.residual, #given[name]))
      end
    end
    panels = { map_panel(given.t or core.column(rows), given.y, given.v, given.residual, given, {}) }
  else
    figures.fail("residual_map", "expected a discovery, a record and its model, or columns residual, y and v")
  end
  return { columns = #panels, panels = alike(panels, unit and unit.F or "N"), share_y = true }
end)

-- ---- a discovery step by step ----

local found_field = { "discovery", discovery, required = true, help = "what was found" }

figures.define({
  name = "where_it_fails",
  help = "The force that a discovery's baseline leaves unexplained, over time, slow time, displacement, velocity, amplitude, "
    .. "harmonic order, frequency and the phase plane, each with the level that noise of its colour stays below (95 %), and "
    .. "what the final model leaves.",
  positional = { "discovery" },
  fields = { found_field },
  example = [[lunid.figure.where_it_fails(found):save "where.png"]],
}, function(given)
  local fields = require("lunid.pictures").where_it_fails(given.discovery)
  if not fields then figures.fail("where_it_fails", given.discovery.data.residual_maps.before_reason) end
  return fields
end)

local function gap_of(value) return value or 0/0 end

figures.define({
  name = "gaps",
  help = "The gap of free runs after each named effect, on train and test, against what noise alone leaves.",
  positional = { "discovery" },
  fields = { found_field },
  example = [[lunid.figure.gaps(found):save "gaps.png"]],
}, function(given)
  local data = given.discovery.data
  local names, train, test = { "baseline" }, { gap_of(data.baseline.gap_train) }, { gap_of(data.baseline.gap_test) }
  for _, effect in ipairs(data.effects) do
    names[#names + 1] = effect.label or effect.name
    train[#names], test[#names] = gap_of(effect.gap_train), gap_of(effect.gap_test)
  end
  names[#names + 1] = "final"
  train[#names], test[#names] = gap_of(data.final.gap_train), gap_of(data.final.gap_test)
  return { panels = { { x = { name = "gap", unit = "", min = 0 }, bars = { names = names, sets = {
    { label = "train", value = core.column(train), role = "final" },
    { label = "test", value = core.column(test), role = "baseline" } } },
    lines = { data.noise_floor.gap_train and { value = data.noise_floor.gap_train, vertical = true, role = "measured",
      label = "noise alone, train" } or nil } } } }
end)

figures.define({
  name = "rivals",
  help = "The gap of each rival's fit over the training record, beside that of what was named and the baseline's free run.",
  positional = { "discovery" },
  fields = { found_field, { "most", types.integer { min = 1 }, default = 12, help = "rivals that are shown" } },
  example = [[lunid.figure.rivals(found):save "rivals.png"]],
}, function(given)
  local data = given.discovery.data
  local names, values = {}, {}
  local function add(name, value)
    names[#names + 1], values[#values + 1] = name, gap_of(value)
  end
  local named = {}
  for i, effect in ipairs(data.effects) do named[i] = effect.label or effect.name end
  if #named > 0 then add("* " .. table.concat(named, " + "), data.final.gap_fit) end
  for i, rival in ipairs(data.rivals) do
    if i <= given.most then add(rival.name, rival.gap) end
  end
  if #names == 0 then figures.fail("rivals", "the discovery has no rivals: no effect was worth a fit") end
  local lines = {}
  if data.baseline.gap_train then
    lines[1] = { value = data.baseline.gap_train, vertical = true, role = "baseline", label = "baseline, free run" }
  end
  if data.noise_floor.gap_train then
    lines[#lines + 1] = { value = data.noise_floor.gap_train, vertical = true, role = "measured", style = "dotted",
      label = "noise alone" }
  end
  return { panels = { { x = { name = #data.effects > 0 and "gap of the fit, training record (* named)"
    or "gap of the fit, training record", unit = "", min = 0 }, lines = lines, bars = { names = names,
    sets = { { label = "", value = core.column(values), role = "first" } } } } } }
end)

figures.define({
  name = "failures",
  help = "Measured, baseline and final run over time: the errors over the whole record, the runs where the baseline is worst, "
    .. "and the force that is left.",
  positional = { "discovery" },
  fields = { found_field, { "record", types.integer { min = 1 }, default = 1,
    help = "which of the training and test records; of several coordinates each output is one" } },
  example = [[lunid.figure.failures(found):save "failures.png"]],
}, function(given)
  local comparison = given.discovery.comparisons[given.record]
  if not comparison then
    figures.fail("failures", ("record: expected 1 to %d, got %d"):format(#given.discovery.comparisons, given.record))
  end
  return require("lunid.pictures").history(given.discovery, comparison)
end)

figures.define({
  name = "named_force",
  help = "The force of what was named over what it is a function of, against what the rest of the model would leave.",
  positional = { "discovery" },
  fields = { found_field },
  example = [[lunid.figure.named_force(found):save "force.png"]],
}, function(given)
  local fields = require("lunid.pictures").named_force(given.discovery)
  if not fields then figures.fail("named_force", "nothing was named that is a force: there is none to show") end
  return fields
end)

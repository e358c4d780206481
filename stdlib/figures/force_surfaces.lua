-- Figures of restoring force surfaces: in space, from the side, cut, and from above.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local types = schema.types

local displacement = { name = "displacement", unit = "m" }
local velocity = { name = "velocity", unit = "m/s" }
local force = { name = "restoring force", unit = "N" }

local most_points = 1000  -- drawn with a surface: more would hide it

local a_surface = { "surface", types.is("surface", "lunid.rfs"), required = true, help = "what to draw" }

--- The measured points, every n-th so that at most `most` are left, and what the legend says of them.
local function points_of(surface, most)
  local points = surface.points
  local step = math.max(1, math.ceil(#points.y / most))
  return { y = points.y:every(step), v = points.v:every(step), f = points.f:every(step) },
    step == 1 and "measured" or ("measured, 1 of %d"):format(step)
end

--- The scene of a surface with its points: all of them, or some that leave it in sight.
local function scene_of(surface, given)
  local cells = surface.table
  local clouds = {}
  if given.points ~= false then
    local points, label = points_of(surface, given.all_points and math.huge or most_points)
    clouds[1] = { label = label, x = points.y, y = points.v, z = points.f, role = "measured" }
  end
  return { scene = { x = displacement, y = velocity, z = force, grid_x = cells.y, grid_y = cells.v, surface = cells.f,
    clouds = clouds, azimuth = given.azimuth, elevation = given.elevation } }
end

local force_surfaces = {}

--- All that a surface is, for its export.
function force_surfaces.whole(surface)
  return figures.make { panels = { scene_of(surface, { all_points = true }) } }
end

local view = {
  { "azimuth", types.number(), default = -130, unit = "degrees", help = "where it is seen from, about the upright axis" },
  { "elevation", types.number { min = 5, max = 85 }, default = 28, unit = "degrees",
    help = "where it is seen from, above the plane" },
}

figures.define({
  name = "surface",
  help = "A restoring force surface over displacement and velocity, with the measured points near it.",
  positional = { "surface" },
  fields = { a_surface,
    { "points", types.boolean, default = true, help = "draw the measured points too" }, view[1], view[2] },
  example = [[lunid.figure.surface(surface):save "surface.png"]],
}, function(given) return { panels = { scene_of(given.surface, given) } } end)

local rows = { words = "a list of rows of numbers", check = function(value)
  if type(value) ~= "table" or getmetatable(value) ~= nil or #value == 0 then return false, "a list of rows of numbers" end
  local kept = {}
  for i, row in ipairs(value) do
    local good, column = types.column.check(row)
    if not good then return false, ("entry %d: expected a column or a list of numbers"):format(i), nil, row end
    kept[i] = column
  end
  return true, kept
end }

--- Rows as long as x and as many as y.
local function check_grid(where, given)
  if #given.z ~= #given.y then
    figures.fail(where, ("z: expected %d rows as y has numbers, got %d"):format(#given.y, #given.z))
  end
  for i, row in ipairs(given.z) do
    if #row ~= #given.x then
      figures.fail(where, ("z: row %d: expected %d numbers as in x, got %d"):format(i, #given.x, #row))
    end
  end
end

local function grid_fields(...)
  local fields = {
    { "x", types.column, required = true, help = "increasing, one for each column of z" },
    { "y", types.column, required = true, help = "increasing, one for each row of z" },
    { "z", rows, required = true, help = "rows; what is not a number is no data" },
    { "x_axis", types.string, default = "x", help = "axis with its unit" },
    { "y_axis", types.string, default = "y", help = "axis with its unit" },
    { "z_axis", types.string, default = "z", help = "axis with its unit" },
    { "diverging", types.boolean, default = true, help = "colours on both sides of 0; else from low to high" },
  }
  for _, field in ipairs { ... } do fields[#fields + 1] = field end
  return fields
end

figures.define({
  name = "relief",
  help = "Any numbers on a grid as a surface in space.",
  fields = grid_fields(view[1], view[2]),
  example = [[lunid.figure.relief { x = { 0, 1, 2 }, y = { 0, 1 }, z = { { 0, 1, 4 }, { 1, 2, 5 } } }:save "relief.png"]],
}, function(given)
  check_grid("relief", given)
  return { panels = { { scene = { x = figures.axis(given.x_axis), y = figures.axis(given.y_axis),
    z = figures.axis(given.z_axis), grid_x = given.x, grid_y = given.y, surface = given.z, clouds = {},
    diverging = given.diverging, azimuth = given.azimuth, elevation = given.elevation } } } }
end)

figures.define({
  name = "map",
  help = "Any numbers on a grid by colour, seen from above; cells without data are hatched.",
  fields = grid_fields(
    { "contours", types.boolean, default = false, help = "lines of equal z" },
    { "numbers", types.boolean, default = false, help = "written into the cells" },
    { "z_scale", types.choice { "linear", "log" }, default = "linear", help = "of the colours" }),
  example = [[lunid.figure.map { x = { 0, 1, 2 }, y = { 0, 1 }, z = { { 0, 1, 4 }, { 1, 2, 5 } }, numbers = true }:save "map.png"]],
}, function(given)
  check_grid("map", given)
  local colour = figures.axis(given.z_axis)
  colour.scale = given.z_scale
  return { panels = { { x = figures.axis(given.x_axis), y = figures.axis(given.y_axis), map = { x = given.x, y = given.y,
    z = given.z, colour = colour, diverging = given.diverging, contours = given.contours, numbers = given.numbers } } } }
end)

figures.define({
  name = "contour",
  help = "A restoring force surface from above: lines of equal force, and hatched where there are no data.",
  positional = { "surface" },
  fields = { a_surface, { "points", types.boolean, default = false, help = "draw the measured points too" } },
  example = [[lunid.figure.contour(surface):save "contour.png"]],
}, function(given)
  local cells, points, label = given.surface.table, points_of(given.surface, most_points)
  return { panels = { { x = displacement, y = velocity, map = { x = cells.y, y = cells.v, z = cells.f, colour = force,
    contours = true }, series = given.points and { { x = points.y, y = points.v, style = "points", role = "measured",
    label = label, width = 0.6 } } or nil } } }
end)

-- ---- from the side ----

--- The envelope of the surface over one of its axes: the least and the largest force at each place of it.
local function envelope(surface, along_y)
  local cells = surface.table
  local low, high = {}, {}
  for j, row in ipairs(cells.f) do
    for i, value in ipairs(row:list()) do
      local k = along_y and i or j
      if value == value then
        low[k], high[k] = math.min(low[k] or value, value), math.max(high[k] or value, value)
      else
        low[k], high[k] = low[k] or 0/0, high[k] or 0/0
      end
      if low[k] ~= low[k] and value == value then low[k], high[k] = value, value end
    end
  end
  return { x = along_y and cells.y or cells.v, low = core.column(low), high = core.column(high), role = "effect",
    label = "surface" }
end

figures.define({
  name = "side_views",
  help = "A restoring force surface from both sides: all measured points over displacement and over velocity, coloured by the "
    .. "other, and the range of the surface behind them.",
  positional = { "surface" },
  fields = { a_surface },
  example = [[lunid.figure.side_views(surface):save "sides.png"]],
}, function(given)
  local points, label = points_of(given.surface, 20000)
  local function panel(x, x_values, colour, colour_values, along_y)
    return { x = x, y = force, colour = colour, ribbons = { envelope(given.surface, along_y) }, legend = "above",
      series = { { x = x_values, y = points.f, colour = colour_values, style = "points", label = label } } }
  end
  return { columns = 1, panels = { panel(displacement, points.y, velocity, points.v, true),
    panel(velocity, points.v, displacement, points.y, false) } }
end)

-- ---- cut ----

local function cut_panel(surface, place, given)
  local cut = core.surface_section(surface, { y = place.y, v = place.v, count = 200, half_width = given.half_width or 0 })
  local series, ribbons = {}, {}
  if #cut.points_place > 0 then
    series[1] = { x = cut.points_place, y = cut.points_f, style = "points", role = "measured", label = "measured near it" }
  end
  series[#series + 1] = { x = cut.place, y = cut.f, role = "final", label = "surface" }
  local low, high, std = cut.f:list(), cut.f:list(), cut.std:list()
  local any = false
  for i = 1, #low do
    if std[i] == std[i] and std[i] > 0 then any = true end
    low[i], high[i] = low[i] - 2*std[i], high[i] + 2*std[i]
  end
  if any then ribbons[1] = { x = cut.place, low = core.column(low), high = core.column(high), role = "final", label = "± 2 deviations" } end
  return { title = place.v and ("at v = %.3g m/s"):format(place.v) or ("at y = %.3g m"):format(place.y),
    x = place.v and displacement or velocity, y = force, series = series, ribbons = ribbons }
end

figures.define({
  name = "sections",
  help = "Cuts through a restoring force surface with the measured points near them.",
  positional = { "surface" },
  fields = { a_surface,
    { "v", types.list(types.number()), default = { 0 }, unit = "m/s", help = "cuts along displacement at these velocities" },
    { "y", types.list(types.number()), default = { 0 }, unit = "m", help = "cuts along velocity at these displacements" },
    { "half_width", types.number { above = 0 }, help = "of the band from which points come; else a twentieth of the range" } },
  example = [[lunid.figure.sections { surface, v = { -0.1, 0, 0.1 }, y = { 0 } }:save "sections.png"]],
}, function(given)
  local panels = {}
  for _, v in ipairs(given.v) do panels[#panels + 1] = cut_panel(given.surface, { v = v }, given) end
  for _, y in ipairs(given.y) do panels[#panels + 1] = cut_panel(given.surface, { y = y }, given) end
  if #panels == 0 then figures.fail("sections", "expected at least one place in v or y, got none") end
  return { columns = math.min(2, #panels), panels = panels }
end)

return force_surfaces

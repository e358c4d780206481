-- Figures: plain tables that are checked here and drawn by the figure module when they are saved.
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"
local types = schema.types

local figures = {}

local roles = { "measured", "baseline", "final", "residual", "effect", "noise", "first", "second", "third", "fourth",
  "fifth", "sixth" }
local order = { "first", "second", "third", "fourth", "fifth", "sixth" }

types.column = { words = "a column or a list of numbers", check = function(value)
  if getmetatable(value) == "lunid.column" then return true, value end
  local good, kept = types.list(types.number()).check(value)
  return good, good and core.column(kept) or "a column or a list of numbers"
end }

local methods = {}

--- Draws the figure to a file: .png, .svg or .pdf by its name (a surface: .png).
function methods.save(figure, path)
  if type(path) ~= "string" then schema.fail("save", "path: expected a string, got " .. core.describe(path)) end
  core.render_figure(figure, output.place(path))
  return output.shown(path)
end

--- Writes the numbers that the figure draws: .csv, and for a surface also .vts or .vtp.
function methods.export(figure, path)
  if type(path) ~= "string" then schema.fail("export", "path: expected a string, got " .. core.describe(path)) end
  core.export_figure(figure, output.place(path))
  return output.shown(path)
end

--- A figure from the plain table that core.render_figure reads.
function figures.make(fields) return schema.object("figure", fields, methods) end

--- "y [mm]" -> { name = "y", unit = "mm" }
local function axis(text)
  if not text then return nil end
  local name, unit = text:match "^(.-)%s*%[(.*)%]%s*$"
  return { name = name or text, unit = unit or "" }
end
figures.axis = axis

local series = schema.define({
  name = "figure.series",
  help = "A curve or a cloud of points, for figure.lines.",
  positional = { "x", "y" },
  fields = {
    { "x", types.column, required = true, help = "a column, such as record:column \"t\", or a list" },
    { "y", types.column, required = true, help = "of the same length" },
    { "label", types.string, default = "", help = "in the legend" },
    { "role", types.choice(roles), help = "what it means; decides its colour" },
    { "style", types.choice { "line", "dashed", "dotted", "dash_dot", "points", "line_points" }, default = "line",
      help = "how it is drawn" },
  },
  returns = "series",
  example = [[lunid.figure.series { record:column "t", record:column "y", label = "measured", role = "measured" }]],
}, function(given)
  if #given.x ~= #given.y then
    schema.fail("figure.series", ("y: expected %d numbers as in x, got %d"):format(#given.x, #given.y))
  end
  return schema.object("series", given)
end)

local lines = schema.define({
  name = "figure.lines",
  help = "A chart of curves over common axes.",
  fields = {
    { "series", types.list(types.is("series", "lunid.figure.series"), 1), required = true, help = "its curves" },
    { "title", types.string, default = "", help = "above the chart" },
    { "x", types.string, default = "", help = "axis with its unit: \"time [s]\"" },
    { "y", types.string, default = "", help = "axis with its unit: \"displacement [m]\"" },
    { "note", types.string, default = "", help = "one short line above the chart, on the right" },
  },
  returns = "figure",
  example = [[lunid.figure.lines { series = { measured, modelled }, x = "time [s]", y = "y [m]" }:save "fit.png"]],
}, function(given)
  for i, each in ipairs(given.series) do each.role = each.role or order[(i - 1) % #order + 1] end
  return figures.make { panels = { { title = given.title, note = given.note, x = axis(given.x), y = axis(given.y),
    series = given.series } } }
end)

local most_points = 1000  -- drawn with a surface: more would hide it

--- A surface of lunid.rfs as a figure, with the measured points near it: all of them, or some that leave it in sight.
function figures.of_surface(given, all_points)
  local surface = given.surface
  local cells, points = surface.table, surface.points
  local step = all_points and 1 or math.ceil(#points.y / most_points)
  local label = step == 1 and "measured" or ("measured, 1 of %d"):format(step)
  return figures.make { title = given.title, x = axis "displacement [m]", y = axis "velocity [m/s]",
    z = axis "restoring force [N]", grid_x = cells.y, grid_y = cells.v, surface = cells.f,
    clouds = given.points ~= false and { { label = label, x = points.y:every(step), y = points.v:every(step),
      z = points.f:every(step), role = "measured" } } or {}, azimuth = given.azimuth, elevation = given.elevation }
end

local surface = schema.define({
  name = "figure.surface",
  help = "A restoring force surface over displacement and velocity, with the measured points near it.",
  positional = { "surface" },
  fields = {
    { "surface", types.is("surface", "lunid.rfs"), required = true, help = "what to draw" },
    { "title", types.string, default = "", help = "above the figure" },
    { "points", types.boolean, default = true, help = "draw the measured points too" },
    { "azimuth", types.number(), unit = "degrees", help = "where it is seen from, about the force axis" },
    { "elevation", types.number { min = -90, max = 90 }, unit = "degrees", help = "where it is seen from, above the plane" },
  },
  returns = "figure",
  example = [[lunid.figure.surface(surface):save "surface.png"]],
}, function(given) return figures.of_surface(given) end)

local map = schema.define({
  name = "figure.residual_map",
  help = "Where baseline and final model leave force unexplained, over displacement and velocity.",
  positional = { "discovery" },
  fields = { { "discovery", types.is("discovery", "lunid.discover"), required = true, help = "what was found" } },
  returns = "figure",
  example = [[lunid.figure.residual_map(found):save "map.png"]],
}, function(given) return require("lunid.pictures").residual_map(given.discovery) end)

local response = schema.define({
  name = "figure.response",
  help = "A frequency response: stable branches solid, unstable ones dashed, folds and bifurcations marked.",
  positional = { "response" },
  fields = {
    { "response", types.is("response", "lunid.frequency_response"), required = true, help = "what to draw" },
    { "quantity", types.string, default = "amplitude", help = "a column of the response, such as \"amplitude_3\" or \"phase_1\"" },
    { "state", types.string, help = "whose motion; else the first displacement" },
    { "series", types.list(types.is("series", "lunid.figure.series")), default = {}, help = "curves to compare with" },
    { "log", types.boolean, default = false, help = "logarithmic axis of the quantity" },
    { "title", types.string, default = "", help = "above the chart" },
  },
  returns = "figure",
  example = [[lunid.figure.response(response):save "frf.png"]],
}, function(given) return require("lunid.response_figure").make(given) end)

figures.public = { figure = schema.strict_table("lunid.figure", { series = series, lines = lines, surface = surface,
  residual_map = map, response = response }) }
return figures

-- Figures: plain tables that are checked here and drawn by the figure module when they are saved. What they show is
-- made in stdlib/figures/.
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"
local types = schema.types

local figures = { public = {} }

local roles = { "measured", "baseline", "final", "residual", "effect", "noise", "first", "second", "third", "fourth",
  "fifth", "sixth" }
local styles = { "line", "dashed", "dotted", "dash_dot", "points", "line_points", "stems", "columns" }

--- What is not a number (0/0) is missing data, not an error.
types.column = { words = "a column or a list of numbers", check = function(value)
  if getmetatable(value) == "lunid.column" then return true, value end
  if type(value) ~= "table" or getmetatable(value) ~= nil and getmetatable(value) ~= "lunid.list" then
    return false, "a column or a list of numbers"
  end
  for i = 1, #value do
    if type(value[i]) ~= "number" then return false, ("entry %d: expected a number"):format(i), nil, value[i] end
  end
  return true, core.column(value)
end }

--- Role and style of the n-th curve of a panel: no two of the first 24 look alike.
function figures.look_of(n) return roles[7 + (n - 1) % 6], styles[1 + (n - 1 + (n - 1) // 6) % 4] end

local methods = {}

--- Raises unless a path is a text that ends in one of the kinds of file: "png", "svg" ...
local function check_path(method, path, kinds)
  if type(path) ~= "string" then schema.fail(method, "path: expected a string, got " .. core.describe(path)) end
  for _, kind in ipairs(kinds) do
    if path:match("%." .. kind .. "$") then return end
  end
  schema.fail(method, ("expected a path that ends in .%s, got %s"):format(table.concat(kinds, ", ."), core.describe(path)))
end

--- Draws the figure to a file: .png, .svg or .pdf by its name.
function methods.save(figure, path)
  check_path("save", path, { "png", "svg", "pdf" })
  core.render_figure(figure, output.place(path))
  return output.shown(path)
end

--- Writes the numbers that the figure draws: .csv, and of a surface also .vts, .vtp, .vtu or .vtm.
function methods.export(figure, path)
  check_path("export", path, { "csv", "vts", "vtp", "vtu", "vtm" })
  core.export_figure(figure, output.place(path))
  return output.shown(path)
end

--- A figure from the plain table that core.render_figure reads.
function figures.make(fields) return schema.object("figure", fields, methods) end

--- A unit that something is done to: "m" stays, "m/s" gets brackets.
function figures.grouped(unit) return unit:find "[ /^*]" and "(" .. unit .. ")" or unit end

figures.type = types.is("figure", "lunid.figure")

--- "y [mm]" -> { name = "y", unit = "mm" }
function figures.axis(text)
  if not text then return nil end
  local name, unit = text:match "^(.-)%s*%[(.*)%]%s*$"
  return { name = name or text, unit = unit or "" }
end

-- ---- the look, the same fields for every kind ----

local look = {
  { "title", types.string, default = "", help = "above the figure" },
  { "theme", types.choice { "light", "dark" }, default = "light", help = "of paper and ink" },
  { "width", types.number { min = 3, max = 100 }, default = 16, unit = "cm",
    help = "printed; text is legible down to half of 16 cm" },
  { "height", types.number { min = 3, max = 100 }, unit = "cm", help = "else as the panels need" },
  { "dpi", types.integer { min = 50, max = 600 }, default = 250, help = "of PNG files" },
}
for _, field in ipairs(look) do field.shared = "Look" end  -- told once in the manual

--- Puts title, theme and size on a plain table of panels; one panel has the title itself.
function figures.dress(given, fields)
  local panels = fields.panels
  if #panels == 1 and (panels[1].title or "") == "" then
    panels[1].title = given.title
  else
    fields.title = given.title ~= "" and given.title or fields.title
  end
  fields.theme, fields.width_cm, fields.height_cm, fields.dpi = given.theme, given.width, given.height, given.dpi
  return figures.make(fields)
end

--- Declares lunid.figure.<name>: its own fields, then the look. body(given) returns { columns =, panels = }.
function figures.define(definition, body)
  local name = definition.name
  definition.name = "figure." .. name
  definition.returns = "figure"
  for _, field in ipairs(look) do definition.fields[#definition.fields + 1] = field end
  figures.public[name] = schema.define(definition, function(given) return figures.dress(given, body(given)) end)
end

--- Raises `figure.<name>: message` at the user's line.
function figures.fail(name, message) schema.fail("figure." .. name, message) end

-- ---- charts of any curves ----

figures.public.series = schema.define({
  name = "figure.series",
  help = "A curve or a cloud of points.",
  positional = { "x", "y" },
  fields = {
    { "x", types.column, required = true, help = "a column, such as record:column \"t\", or a list" },
    { "y", types.column, required = true, help = "of the same length" },
    { "label", types.string, default = "", help = "in the legend" },
    { "role", types.choice(roles), help = "what it means; decides its colour" },
    { "style", types.choice(styles), default = "line", help = "how it is drawn" },
    { "colour", types.column, help = "a value for each point, shown by colour and a bar beside the chart" },
  },
  returns = "series",
  example = [[lunid.figure.series { record:column "t", record:column "y", label = "measured", role = "measured" }]],
}, function(given)
  for _, name in ipairs { "y", "colour" } do
    if given[name] and #given.x ~= #given[name] then
      schema.fail("figure.series", ("%s: expected %d numbers as in x, got %d"):format(name, #given.x, #given[name]))
    end
  end
  return schema.object("series", given)
end)
figures.series = types.is("series", "lunid.figure.series")

local scale = types.choice { "linear", "log" }

figures.define({
  name = "lines",
  help = "A chart of curves over common axes.",
  fields = {
    { "series", types.list(figures.series, 1), required = true, help = "its curves" },
    { "x", types.string, default = "", help = "axis with its unit: \"time [s]\"" },
    { "y", types.string, default = "", help = "axis with its unit: \"displacement [m]\"" },
    { "x_scale", scale, default = "linear", help = "'log' shows positive values only" },
    { "y_scale", scale, default = "linear", help = "the same" },
    { "colour", types.string, default = "", help = "what the colours of its curves stand for, with its unit" },
    { "note", types.string, default = "", help = "one short line above the chart, on the right" },
  },
  example = [[lunid.figure.lines { series = { measured, modelled }, x = "time [s]", y = "y [m]" }:save "fit.png"]],
}, function(given)
  local x, y = figures.axis(given.x), figures.axis(given.y)
  x.scale, y.scale = given.x_scale, given.y_scale
  for i, each in ipairs(given.series) do each.role = each.role or roles[7 + (i - 1) % 6] end
  return { panels = { { note = given.note, x = x, y = y, series = given.series, colour = figures.axis(given.colour) } } }
end)

figures.define({
  name = "grid",
  help = "The panels of several figures in one, row by row.",
  positional = { "figures" },
  fields = {
    { "figures", types.list(figures.type, 1), required = true, help = "whose panels it takes" },
    { "columns", types.integer { min = 1, max = 12 }, default = 2, help = "of panels" },
    { "share_x", types.boolean, default = false,
      help = "panels of one column that show the same quantity have one range, and labels under the lowest" },
    { "share_y", types.boolean, default = false, help = "the same of panels side by side" },
  },
  example = [[lunid.figure.grid { { lunid.figure.history(record), lunid.figure.loop(record) }, columns = 2 }:save "all.pdf"]],
}, function(given)
  local panels = {}
  for _, figure in ipairs(given.figures) do
    for i, panel in ipairs(figure.panels) do
      local copy = {}
      for key, value in pairs(panel) do copy[key] = value end
      copy.column_span = 1
      if i == 1 and (copy.title or "") == "" then copy.title = figure.title end
      panels[#panels + 1] = copy
    end
  end
  return { columns = given.columns, panels = panels, share_x = given.share_x, share_y = given.share_y }
end)

return figures

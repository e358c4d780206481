-- Restoring force surfaces: f(y, v) = F - m*a over the plane of displacement and velocity.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local types = schema.types

local surfaces = {}

local record = types.is("record", "lunid.read")
local pair = types.list(types.integer { min = 1 }, 2)

surfaces.grid = schema.define({
  name = "grid",
  help = "Bilinear interpolation between the corners of equal cells; cells without data stay empty.",
  fields = {
    { "cells", pair, default = { 20, 20 }, help = "number of cells along displacement and velocity" },
    { "least_count", types.integer { min = 1 }, default = 3, help = "cells with fewer points have no data" },
    { "smoothness", types.number { above = 0 }, default = 1e-3, help = "weight of the squared second differences" },
  },
  returns = "interpolator",
  example = "interpolate = lunid.grid { cells = { 30, 30 } }",
}, function(given)
  given.cells_y, given.cells_v = given.cells[1], given.cells[2]
  return schema.object("interpolator", given)
end)

surfaces.rfs = schema.define({
  name = "rfs",
  help = "The restoring force surface of a record: interpolated where asked for, and as a Chebyshev polynomial. "
    .. "surface(y, v) is an expression for models and regressions; beyond its data a grid goes on as straight as it can.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
    { "mass", types.expression, unit = "kg", help = "without it the surface is that of F itself" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "interpolate", types.is("interpolator", "lunid.grid"), help = "how it is drawn; else by the polynomial" },
    { "order", types.list(types.integer { min = 0, max = 20 }, 2), default = { 4, 4 },
      help = "of the polynomial in displacement and in velocity" },
    { "name", types.string, default = "surface", help = "how it is written in equations, where it is on a grid" },
    { "blocks", types.integer { min = 2, max = 1000 }, default = 6, help = "blocks of time left out in turn for the score" },
  },
  returns = "surface",
  example = [[local surface = lunid.rfs { record = train, mass = 49, interpolate = lunid.grid {}, order = { 4, 4 } }]],
}, function(given)
  local list = type(given.record) == "table" and given.record or { given.record }
  for i, each in ipairs(list) do
    list[i] = given.window and each:window(given.window.from, given.window.to) or each
  end
  given.order_y, given.order_v, given.grid = given.order[1], given.order[2], given.interpolate
  return core.rfs(list, given)
end)

core.add_method("lunid.surface", "export", function(surface, path)
  return figures.of_surface({ surface = surface, title = "" }, true):export(path)
end)

return surfaces

-- Restoring force surfaces: f(y, v) = F - m*a over the plane of displacement and velocity.
local core = require "lunid.core"
local record_list = require "lunid.record_list"
local schema = require "lunid.schema"
local types = schema.types

local surfaces = {}

local record = types.is("record", "lunid.read")
local pair = types.list(types.integer { min = 1 }, 2)

surfaces.grid = schema.define({
  name = "grid",
  help = "A bilinear or bicubic spline over equal cells, by least squares; cells without data stay empty.",
  fields = {
    { "cells", pair, default = { 20, 20 }, help = "number of cells along displacement and velocity" },
    { "least_count", types.integer { min = 1 }, default = 3, help = "cells with fewer points have no data" },
    { "smoothness", types.number { above = 0 }, default = 1e-3, help = "weight of the squared second differences" },
    { "between", types.choice { "linear", "cubic" }, default = "linear",
      help = "the corners of the cells: straight lines, or a spline without a jump in its first and second derivatives" },
  },
  returns = "interpolator",
  example = "interpolate = lunid.grid { cells = { 30, 30 } }",
}, function(given)
  given.kind, given.cells_y, given.cells_v = "grid", given.cells[1], given.cells[2]
  return schema.object("interpolator", given)
end)

--- An interpolator whose fields go to the runtime as they are.
local function interpolator(definition)
  definition.returns = "interpolator"
  surfaces[definition.name] = schema.define(definition, function(given)
    given.kind = definition.name
    return schema.object("interpolator", given)
  end)
end

local seed = { "seed", types.integer { min = 0 }, default = 1, help = "the same seed gives the same surface" }
local centres = { "centres", types.integer { min = 20, max = 3000 }, default = 600,
  help = "at most so many cell means; time grows with their cube" }

interpolator {
  name = "nearest",
  help = "The mean of the nearest points, weighted by one over their distance.",
  fields = { { "neighbours", types.integer { min = 1, max = 1000 }, default = 12, help = "how many points" } },
  example = "interpolate = lunid.nearest { neighbours = 12 }",
}

interpolator {
  name = "triangulation",
  help = "Planes over Delaunay triangles between cell means; no value outside their hull.",
  fields = { { "cells", types.integer { min = 2, max = 300 }, default = 40, help = "along each axis: one corner each" } },
  example = "interpolate = lunid.triangulation {}",
}

interpolator {
  name = "mlp",
  help = "A neural network: layers of tanh units, fitted to cell means by L-BFGS.",
  fields = {
    { "hidden", types.list(types.integer { min = 1, max = 500 }, 1), default = { 20, 20 },
      help = "units in each hidden layer, 1 to 4 layers" },
    { "penalty", types.number { min = 0 }, default = 1e-6, help = "weight of the mean square of the weights" },
    { "evaluations", types.integer { min = 1 }, default = 1000, help = "at most so many of the loss" },
    seed,
  },
  example = "interpolate = lunid.mlp { hidden = { 50, 50 } }",
}

interpolator {
  name = "gaussian_process",
  help = "A Gaussian process about a plane; lengths and noise by maximum likelihood. Knows its own deviation.",
  fields = { centres },
  example = "interpolate = lunid.gaussian_process {}",
}

interpolator {
  name = "support_vectors",
  help = "Support vector regression with a Gaussian kernel on cell means.",
  fields = {
    { "cost", types.number { above = 0 }, default = 10, help = "of a point outside the tube, for a force of unit variance" },
    { "epsilon", types.number { min = 0 }, default = 0.05, help = "half width of the tube, for a force of unit variance" },
    { "width", types.number { above = 0 }, help = "of the kernel, in half ranges of the data; else by cross-validation" },
    centres,
  },
  example = "interpolate = lunid.support_vectors { cost = 10 }",
}

interpolator {
  name = "random_forest",
  help = "The mean of regression trees on resampled points.",
  fields = {
    { "trees", types.integer { min = 1, max = 5000 }, default = 200, help = "how many" },
    { "least_leaf", types.integer { min = 1 }, default = 5, help = "points in a leaf" },
    seed,
  },
  example = "interpolate = lunid.random_forest {}",
}

local every_kind = { "grid", "nearest", "triangulation", "mlp", "gaussian_process", "support_vectors", "random_forest" }
local an_interpolator = types.is("interpolator", "lunid.grid and its kin")

--- The kinds that are asked for, as the runtime takes them.
local function kinds_of(given)
  local polynomial = { kind = "polynomial", order_y = given.order_y, order_v = given.order_v }
  local asked = given.interpolate
  if asked == nil then return { polynomial } end
  if getmetatable(asked) == "lunid.interpolator" then return { asked } end
  if asked ~= "all" then return asked end
  local kinds = { polynomial }
  for _, name in ipairs(every_kind) do kinds[#kinds + 1] = surfaces[name] {} end
  return kinds
end

surfaces.rfs = schema.define({
  name = "rfs",
  help = "The restoring force surface of a record: by one kind of interpolation or several side by side, and as a "
    .. "Chebyshev polynomial.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
    { "mass", types.expression, unit = "kg", help = "without it the surface is that of F itself" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "interpolate", types.either(an_interpolator, types.list(an_interpolator, 1), types.choice { "all" }),
      help = "how it is drawn: one kind, several (the best on left-out blocks is drawn) or \"all\"; else by the polynomial" },
    { "order", types.list(types.integer { min = 0, max = 20 }, 2), default = { 4, 4 },
      help = "of the polynomial in displacement and in velocity" },
    { "expand", types.choice { "regression", "quadrature" }, default = "regression",
      help = "the polynomial's coefficients: from the points, or from the surface by Gauss-Chebyshev quadrature" },
    { "blocks", types.integer { min = 2, max = 1000 }, default = 6,
      help = "blocks of time left out in turn, for the score and the deviation" },
    { "name", types.string, default = "surface", help = "how it is written in equations" },
    { "between", types.choice { "linear", "cubic" },
      help = "what surface(y, v) is between the corners of the drawn surface's cells: straight, or a spline without a jump in "
        .. "its first and second derivatives; else cubic where the drawn kind is smooth (mlp, gaussian_process, "
        .. "support_vectors, a cubic grid)" },
  },
  returns = "surface",
  example = [[
local surface = lunid.rfs { record = train, mass = 49, interpolate = { lunid.grid {}, lunid.mlp {} }, order = { 4, 4 } }
print(surface)
local model = lunid.model { mass = 49, restoring = surface(y, v) }]],
}, function(given)
  local list = record_list(given.record, given.window)
  given.order_y, given.order_v = given.order[1], given.order[2]
  given.kinds = kinds_of(given)
  return core.rfs(list, given)
end)

surfaces.section = schema.define({
  name = "section",
  help = "A cut through a surface along one axis: columns place, f and std of the cut, points_place and points_f of the "
    .. "measured points near it.",
  positional = { "surface" },
  fields = {
    { "surface", types.is("surface", "lunid.rfs"), required = true, help = "what to cut" },
    { "v", types.number(), unit = "m/s", help = "cuts along y at this velocity" },
    { "y", types.number(), unit = "m", help = "cuts along v at this displacement" },
    { "count", types.integer { min = 2 }, default = 200, help = "places along the cut" },
    { "half_width", types.number { above = 0 }, help = "of the band from which points come; else a twentieth of the range" },
  },
  returns = "section",
  example = [[
local cut = lunid.section { surface, v = 0 }
lunid.figure.lines { series = { lunid.figure.series { cut.points_place, cut.points_f, style = "points" },
  lunid.figure.series { cut.place, cut.f } }, x = "displacement [m]", y = "restoring force [N]" }:save "cut.png"]],
}, function(given)
  if (given.y == nil) == (given.v == nil) then
    schema.fail("section", "expected one of y and v, got " .. (given.y and "both" or "neither"))
  end
  return core.surface_section(given.surface, given)
end)

core.add_method("lunid.surface", "export", function(surface, path)
  return require("lunid.figures.force_surfaces").whole(surface):export(path)
end)

return surfaces

-- Regressions: F - m*a = sum of coefficient * feature.
local core = require "lunid.core"
local features = require "lunid.features"
local schema = require "lunid.schema"
local types = schema.types

local regression = { public = {} }
local public = regression.public

public.weak_form = schema.define({
  name = "weak_form",
  help = "Integrates the equation against bumps of short support, so that no derivative of the data is needed.",
  fields = {
    { "half_width", types.number { min = 0 }, default = 0, unit = "s", help = "of the bumps; 0: from the dominant frequency" },
    { "order", types.integer { min = 3, max = 16 }, default = 8, help = "of the bumps (1 - (t/half_width)^2)^order" },
    { "spacing", types.number { above = 0, max = 1 }, default = 0.25, help = "from bump to bump, in half widths" },
  },
  returns = "form",
  example = "local fit = lunid.regress { record = train, mass = 49, features = { y, v, y^3 }, form = lunid.weak_form {} }",
}, function(given)
  return schema.object("form", given, nil, function() return "weak form" end)
end)

--- Least and largest value of an expression over the records.
local function range_over(records)
  return function(variable)
    local name = tostring(variable)
    local low, high = math.huge, -math.huge
    for _, each in ipairs(records) do
      local symbols = core.is_expression(variable) and variable:symbols() or {}
      if #symbols ~= 1 or symbols[1].kind ~= "channel" or symbols[1].name ~= name then
        schema.fail("regress", ("features: the range of '%s' is not known: give it (range = ...) to the set of features"):format(
          name))
      end
      local column = each:column(name)
      low, high = math.min(low, column:min()), math.max(high, column:max())
    end
    if not (low < high) then schema.fail("regress", ("features: '%s' is constant on these data: it has no range"):format(name)) end
    return low, high
  end
end

--- Constraints by what they are.
local function sorted(list)
  local bounds, groups, passive = {}, {}, nil
  for _, each in ipairs(list) do
    if each.kind == "group" then groups[#groups + 1] = each
    elseif each.kind == "passive" then passive = each
    else bounds[#bounds + 1] = each end
  end
  return bounds, groups, passive
end

local record = types.is("record", "lunid.read")

public.regress = schema.define({
  name = "regress",
  help = "Fits the coefficients of features to the restoring force F - m*a along the measured motion.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), required = true, help = "one record or several" },
    { "mass", types.expression, unit = "kg", help = "without it the target is F itself" },
    { "features", types.list(types.either(types.expression, types.is("features", "lunid.polynomials and its kin")), 1),
      required = true, help = "functions of displacement, velocity, time; sets of them are laid flat" },
    { "known", types.expression, unit = "N", help = "part of the restoring force that is known" },
    { "constraints", types.list(types.is("constraint", "lunid.at_least and its kin")), default = {},
      help = "what is known about the coefficients" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "solver", types.is("solver", "lunid.least_squares and its kin"), help = "least squares by default" },
    { "form", types.is("form", "lunid.weak_form"), help = "integrals in place of the rows themselves" },
    { "blocks", types.integer { min = 1, max = 1000 },
      help = "blocks of time in each record, for cross-validation and standard errors; 8, or 32 for the bootstrap" },
    { "bootstrap", types.integer { min = 20 }, help = "intervals from so many resamplings of the blocks" },
  },
  returns = "regression",
  example = [[local fit = lunid.regress { record = train, mass = 49, features = { lunid.polynomials({ y, v }, 3) } }]],
}, function(given)
  local list = type(given.record) == "table" and given.record or { given.record }
  for i, each in ipairs(list) do
    list[i] = given.window and each:window(given.window.from, given.window.to) or each
  end
  given.blocks = given.blocks or given.bootstrap and 32 or 8
  given.features, given.places, given.notes = features.flat(given.features, range_over(list), core.place())
  given.constraints, given.groups, given.passive = sorted(given.constraints)
  return core.regress(list, given)
end)

return regression

-- Nonlinear regressions: the parameters of any formula of measured columns.
local core = require "lunid.core"
local record_list = require "lunid.record_list"
local schema = require "lunid.schema"
local types = schema.types

local curves = {}

local record = types.is("record", "lunid.read")

curves.channel = schema.define({
  name = "channel",
  help = "A channel of a record, or a column of a table, by its name: what lunid.displacement is for y.",
  style = "arguments",
  positional = { "name" },
  fields = { { "name", types.string, required = true, help = "as the record has it" } },
  returns = "expression",
  example = [[local x = lunid.channel "x"]],
}, function(given) return core.channel(given.name) end)

--- The columns of a table in the order of their names, as the runtime reads them.
local function named_columns(data)
  local names = {}
  for name, values in pairs(data) do
    if type(name) ~= "string" then
      schema.fail("fit_curve", "data: expected entries such as x = { 1, 2, 3 }, got " .. core.describe(values))
    end
    names[#names + 1] = name
  end
  if #names == 0 then schema.fail("fit_curve", "data: the table is empty") end
  table.sort(names)
  local columns = { names = names }
  for _, name in ipairs(names) do columns[name] = data[name] end
  return columns
end

local function data_of(given)
  if (given.record == nil) == (given.data == nil) then
    schema.fail("fit_curve", "expected either record or data")
  end
  if given.data then return named_columns(given.data) end
  return record_list(given.record, given.window)
end

local function words_of(fit)
  local lines = { ("curve fit of %d rows: R2 %.6g, residual std %.4g after %d iterations, %s"):format(fit.rows, fit.r2,
    fit.residual_std, fit.iterations, fit.converged and "converged" or "not converged") }
  for _, row in ipairs(fit.parameters) do
    lines[#lines + 1] = ("  %s = %.7g%s%s%s"):format(row.name, row.value, row.std and (" +- %.2g"):format(row.std) or "",
      row.at_bound and " (at its bound)" or "", row.unexcited and " (the data do not tell it from the others)" or "")
  end
  return table.concat(lines, "\n")
end

curves.fit_curve = schema.define({
  name = "fit_curve",
  help = "Nonlinear least squares: fits the parameters of a formula to measured columns, by Levenberg-Marquardt with "
    .. "exact derivatives. What moves is fitted on its trajectory instead: lunid.fit_trajectory.",
  fields = {
    { "record", types.either(record, types.list(record, 1)), help = "one record or several; or else data" },
    { "data", types.table, help = "columns by name, such as { x = { 1, 2, 3 }, y = { 1, 4, 9 } }, of equal length" },
    { "response", types.expression, required = true, help = "what was measured, such as lunid.force" },
    { "formula", types.expression, required = true,
      help = "what it shall be: channels, lunid.time and parameters with first guesses, or with min and max" },
    { "weight", types.expression, help = "of a row's squared residual, an expression of channels; else 1" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "max_iterations", types.integer { min = 1 }, default = 500, help = "of Levenberg-Marquardt" },
  },
  returns = "curve_fit",
  example = [[local fit = lunid.fit_curve { record = train, response = lunid.force, formula = e1*lunid.tanh(e2*y) + c*v }]],
}, function(given)
  local fit = core.fit_curve(data_of(given), given)
  return schema.object("curve_fit", fit, nil, words_of)
end)

return curves

-- lunid.scoreboard: several models of one system side by side. Their terms, how well each gives the force along the
-- measured motion, and how well it runs freely over a record that nothing was fitted to.
local comparison = require "lunid.comparison"
local core = require "lunid.core"
local schema = require "lunid.schema"
local simulation = require("lunid.simulation").public
local statistics = require("lunid.statistics").public.statistics
local types = schema.types

local scoreboard = {}

-- ---- terms ----

--- The terms of a model's restoring force, in its order: what a coefficient multiplies, as text, with its value; a
--- parameter in which the force is not linear, such as p of tanh(p*y), stands for itself.
local function terms_of(model)
  local list = {}
  if model.degrees > 1 or type(model.restoring) == "number" then return list end
  for _, row in ipairs(model.parameters) do
    local symbol = core.parse(row.name, "scoreboard")
    local slope = model.restoring:derivative(symbol)
    local linear = tostring(slope:derivative(symbol)) == "0"
    local name = linear and tostring(slope) or row.name
    if name ~= "0" then
      list[#list + 1] = { name = name, value = row.value, std = row.std and row.std > 0 and row.std or nil,
        feature = linear and slope or nil }
      list[name] = list[#list]
    end
  end
  return list
end

--- Names of all terms: those of the truth first, then others in the order of the models.
local function names_of(rows, truth)
  local names, seen = {}, {}
  local function take(terms)
    for _, term in ipairs(terms or {}) do
      if not seen[term.name] then names[#names + 1], seen[term.name] = term.name, true end
    end
  end
  take(truth)
  for _, row in ipairs(rows) do take(row.terms) end
  return names
end

-- ---- measures ----

local function joined(columns)
  local all = {}
  for _, column in ipairs(columns) do
    for _, value in ipairs(column:list()) do all[#all + 1] = value end
  end
  return core.column(all)
end

--- The force of a model along all measured motions, as if they were one record.
local function along_motion(model, records)
  local measured, predicted, residual = {}, {}, {}
  for i, record in ipairs(records) do
    local found = comparison.compare { model = model, record = record, mode = "equation_error", lags = 1 }
    measured[i], predicted[i], residual[i] = found.measured, found.predicted, found.residual
  end
  local m, p, r = joined(measured), joined(predicted), joined(residual)
  return { measured = measured, predicted = predicted, residual = residual, joined = r, rmse = statistics.rmse(m, p),
    r2 = statistics.r2(m, p), qqcc = statistics.qqcc(r), mutual_information = statistics.mutual_information(m, p) }
end

local function score(name, model, given)
  local row = { name = name, model = model, terms = terms_of(model) }
  if model.degrees == 1 then
    row.force = along_motion(model, given.record)
    row.test_force = along_motion(model, { given.test })
  end
  local run = simulation.simulate { model = model, excitation = given.test, from = "record" }
  row.free = comparison.compare { run = run, record = given.test, data = "test", channel = given.channel, lags = 1 }
  row.run = run.rows > 1 and run:record() or nil
  return row
end

-- ---- the result ----

local function number(value) return value and value == value and ("%.4g"):format(value) or "-" end

local function term_cell(term)
  if not term then return "" end
  return ("%.5g"):format(term.value) .. (term.std and (" +- %.2g"):format(term.std) or "")
end

local methods = {}

--- The terms of all models as a table for lunid.report: { head =, rows = }. False terms are marked where the truth is known.
function methods.terms(self)
  local head, rows = { "term" }, {}
  if self.truth then head[2] = "truth" end
  for _, row in ipairs(self.rows) do head[#head + 1] = row.name end
  for _, name in ipairs(names_of(self.rows, self.truth)) do
    local cells = { name }
    if self.truth then cells[2] = self.truth[name] and term_cell(self.truth[name]) or "(none)" end
    for _, row in ipairs(self.rows) do cells[#cells + 1] = term_cell(row.terms[name]) end
    rows[#rows + 1] = cells
  end
  return { head = head, rows = rows, caption = "Terms of the restoring force" }
end

--- The measures of all models as a table for lunid.report.
function methods.measures(self)
  local rows = {}
  for i, row in ipairs(self.rows) do
    local force, free = row.force or {}, row.free
    rows[i] = { row.name, number(force.r2), number(force.rmse), number(force.qqcc), number(force.mutual_information),
      number(row.test_force and row.test_force.r2), number(free.r2), number(free.nrmse), number(free.dtw),
      free.stopped_at and ("stops at %.3g s"):format(free.stopped_at) or "runs" }
  end
  return { head = { "model", "R2", "RMSE [N]", "QQCC", "MI [nat]", "test R2", "run R2", "run error", "DTW", "free run" }, rows = rows,
    caption = "R2, RMSE, QQCC and mutual information of the force along the measured motion of the training records (test R2: of "
      .. "the test record); run: free run over the test record, error over the motion's deviation, DTW of the phase portraits" }
end

local function row_named(self, name)
  for _, row in ipairs(self.rows) do
    if row.name == name then return row end
  end
  schema.fail("scoreboard", ("no model '%s'"):format(tostring(name)))
end

--- What results.json of a study says of one model: terms { value, std, truth } (false ones with truth 0, true ones that it
--- has not with value 0) and its free run.
function methods.result(self, name)
  local row, terms = row_named(self, name), {}
  local truth = self.truth or {}
  for _, term in ipairs(row.terms) do
    terms[term.name] = { value = term.value, std = term.std, truth = truth[term.name] and truth[term.name].value or self.truth and 0 }
  end
  for _, term in ipairs(truth) do
    terms[term.name] = terms[term.name] or { value = 0, truth = term.value, reason = "not in the model" }
  end
  local free = row.free
  return { terms = terms, force = row.force and { r2 = row.force.r2, rmse = row.force.rmse, qqcc = row.force.qqcc,
    mutual_information = row.force.mutual_information }, free_run = free.stopped_at
    and { stopped_at = free.stopped_at, cause = free.cause } or { r2 = free.r2, nrmse = free.nrmse, dtw = free.dtw } }
end

--- Figures that compare the models, as a list of { name, figure, caption }.
function methods.figures(self) return require("lunid.scoreboard_figures").of(self) end

local function text(self)
  local lines = {}
  for _, shown in ipairs { self:terms(), self:measures() } do
    lines[#lines + 1] = shown.caption
    lines[#lines + 1] = "  " .. table.concat(shown.head, " | ")
    for _, cells in ipairs(shown.rows) do lines[#lines + 1] = "  " .. table.concat(cells, " | ") end
  end
  return table.concat(lines, "\n")
end

local record = types.is("record", "lunid.read")

scoreboard.public = {
  scoreboard = schema.define({
    name = "scoreboard",
    help = "Several models of one system side by side: terms, the force along the measured motion, free runs over a test "
      .. "record. board:terms(), board:measures() are tables for lunid.report, board:figures() its figures, "
      .. "board:result(name) what results.json says of one model.",
    fields = {
      { "models", types.list(types.list(types.any, 2), 1), required = true, help = "entries { name, model }" },
      { "record", types.either(record, types.list(record, 1)), required = true, help = "training records" },
      { "test", record, required = true, help = "for the free runs, which start from its first state" },
      { "truth", types.is("model", "lunid.model"), help = "where it is known: false terms are told" },
      { "channel", types.string, default = "y", help = "the displacement that is compared" },
    },
    returns = "scoreboard",
    example = [[
local board = lunid.scoreboard { models = { { "least squares", fit.model }, { "chosen", found.model } }, record = train, test = test }
print(board)]],
  }, function(given)
    given.record = type(given.record) == "table" and given.record or { given.record }
    local rows = {}
    for i, entry in ipairs(given.models) do
      if type(entry[1]) ~= "string" or getmetatable(entry[2]) ~= "lunid.model" then
        schema.fail("scoreboard: models", ("entry %d: expected { name, model }, got { %s, %s }"):format(i,
          core.describe(entry[1]), core.describe(entry[2])))
      end
      rows[i] = score(entry[1], entry[2], given)
    end
    return schema.object("scoreboard", { rows = rows, record = given.record, test = given.test, channel = given.channel,
      truth_model = given.truth, truth = given.truth and terms_of(given.truth) }, methods, text)
  end),
}

return scoreboard

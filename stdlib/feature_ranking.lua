-- Which features tell something about a force? By information, ranks and what a fit makes of them.
local core = require "lunid.core"
local regression = require "lunid.regression"
local schema = require "lunid.schema"
local types = schema.types

local feature_ranking = {}
local measures = core.statistics

local function fail(message) schema.fail("rank_features", message) end

types.named_columns = { words = "a list of { name, column }", check = function(value)
  if type(value) ~= "table" or getmetatable(value) ~= nil or #value == 0 then return false, types.named_columns.words end
  local kept = {}
  for i, each in ipairs(value) do
    local good, column = false, nil
    if type(each) == "table" and type(each[1]) == "string" then good, column = types.column.check(each[2]) end
    if not good then return false, ("entry %d: expected { name, column }"):format(i), nil, each end
    kept[i] = { name = each[1], values = column }
  end
  return true, kept
end }

local expressions = types.list(types.either(types.expression, types.is("features", "lunid.polynomials")), 1)

--- Features of a record as names and values.
local function of_record(given, list)
  local columns = {}
  for i, feature in ipairs(regression.flat(list, { given.record })) do
    columns[i] = { name = tostring(feature), values = core.evaluate(given.record, feature, "rank_features") }
  end
  return columns
end

local function gather(given)
  local by_record, by_columns = given.record ~= nil, given.target ~= nil
  if by_record == by_columns then fail "expected a record with features, or a target with columns" end
  if by_columns then
    if not given.columns then fail "missing field 'columns': a list of { name, column }" end
    return given.target, given.columns, given.given_columns or {}, "a column", ("%d rows"):format(#given.target)
  end
  if not given.features and given.regression then
    given.features = {}
    for i, term in ipairs(given.regression.terms) do given.features[i] = term.feature end
  end
  if not given.features then fail "missing field 'features': functions of displacement, velocity, time" end
  given.record = given.window and given.record:window(given.window.from, given.window.to) or given.record
  local record, target = given.record, core.channel "F"
  if given.mass then target = target - given.mass*core.channel "a" end
  if given.known then target = target - given.known end
  local place = ("record %s, %g to %g s, %d rows"):format(record.name, record.start, record.start + record.duration, record.rows)
  return core.evaluate(record, target, "rank_features"), of_record(given, given.features), of_record(given, given.given or {}),
    tostring(target), place
end

local function check_constant(columns)
  for _, each in ipairs(columns) do
    if each.values:min() == each.values:max() then
      fail(("the feature '%s' is constant, %g: leave it out"):format(each.name, each.values:min()))
    end
  end
end

local function values_of(columns)
  local list = {}
  for i, each in ipairs(columns) do list[i] = each.values end
  return list
end

local heads = { { "information", "MI [nat]" }, { "beyond", "MI beyond" }, { "spearman", "Spearman" }, { "kendall", "Kendall" },
  { "contribution", "max |c f|" }, { "significance", "index" } }

local function text(self)
  local width = 8
  for _, row in ipairs(self) do width = math.max(width, #row.name) end
  local shown, lines = {}, {}
  local head = ("  %-" .. width .. "s"):format "feature"
  for _, column in ipairs(heads) do
    if self[1][column[1]] then
      shown[#shown + 1] = column[1]
      head = head .. ("%11s"):format(column[2])
    end
  end
  lines[1] = ("features of %s; %s"):format(self.target, self.data)
  lines[2] = head
  for _, row in ipairs(self) do
    local line = ("  %-" .. width .. "s"):format(row.name)
    for _, name in ipairs(shown) do line = line .. ("%11s"):format(row[name] and ("%.3g"):format(row[name]) or "") end
    lines[#lines + 1] = line
  end
  if self[1].beyond then lines[#lines + 1] = "  MI beyond: what the feature tells beyond " .. table.concat(self.given, ", ") end
  return table.concat(lines, "\n")
end

feature_ranking.rank_features = schema.define({
  name = "rank_features",
  help = "Features by what they tell about the restoring force: mutual information, rank correlations, and with a regression the "
    .. "thesis' significance index MI*max|c f|. A list in falling order of information, each found by its name too.",
  fields = {
    { "record", types.is("record", "lunid.read"), help = "what was measured" },
    { "features", expressions, help = "functions of displacement, velocity, time; else those of the regression" },
    { "mass", types.expression, unit = "kg", help = "without it the target is F itself" },
    { "known", types.expression, unit = "N", help = "part of the restoring force that is known" },
    { "window", types.is("window", "lunid.window"), help = "part of the record" },
    { "given", expressions, help = "features that are chosen already: adds what each tells beyond them" },
    { "regression", types.is("regression", "lunid.regress"), help = "whose coefficients the significance index takes" },
    { "target", types.column, help = "in place of a record: any column" },
    { "columns", types.named_columns, help = "its features, as { { \"y\", column }, ... }" },
    { "given_columns", types.named_columns, help = "those that are chosen already" },
    { "neighbours", types.integer { min = 1 }, default = 3, help = "of the mutual information" },
  },
  returns = "feature_ranking",
  example = [[print(lunid.rank_features { record = train, mass = 49, features = { lunid.polynomials({ y, v }, 3) } })]],
}, function(given)
  local target, columns, chosen, target_words, data = gather(given)
  check_constant(columns)
  check_constant(chosen)
  local information = measures.mutual_information(values_of(columns), target, {}, given.neighbours)
  local beyond = #chosen > 0 and measures.mutual_information(values_of(columns), target, values_of(chosen), given.neighbours)
  local ranking = { target = target_words, data = data, given = {} }
  for i, each in ipairs(chosen) do ranking.given[i] = each.name end
  for i, each in ipairs(columns) do
    local row = { name = each.name, information = information[i], beyond = beyond and beyond[i], place = i }
    row.spearman, row.spearman_p_value = measures.spearman(each.values, target)
    row.kendall, row.kendall_p_value = measures.kendall(each.values, target)
    local term = given.regression and given.regression.terms[each.name]
    if given.regression then
      local coefficient = term and term.value or 0
      row.contribution = measures.significance_index(1, coefficient, each.values)
      row.significance = measures.significance_index(information[i], coefficient, each.values)
    end
    ranking[i] = row
  end
  table.sort(ranking, function(a, b)
    if a.information ~= b.information then return a.information > b.information end
    return a.place < b.place
  end)
  for _, row in ipairs(ranking) do ranking[row.name] = row end
  return schema.object("feature_ranking", ranking, nil, text)
end)

feature_ranking.public = { rank_features = feature_ranking.rank_features }
return feature_ranking

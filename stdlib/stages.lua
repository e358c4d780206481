-- The stages of discovery one by one: where a model fails, which entries would help, how given sets compare.
local catalogue = require "lunid.catalogue"
local core = require "lunid.core"
local record_runs = require "lunid.record_runs"
local schema = require "lunid.schema"
local types = schema.types

local record = types.is("record", "lunid.read")
local model_field = { "model", types.is("model", "lunid.model"), required = true, help = "the baseline, fitted first" }
local record_field = { "record", types.either(record, types.list(record, 1)), required = true,
  help = "one record or several; all rows are used" }
local window_field = { "window", types.is("window", "lunid.window"), help = "part of the records" }
local catalogue_field = { "catalogue", types.list(types.string, 1),
  help = "names of entries, any of `lunid list effects`; else those marked * there" }
local without_field = { "without", types.list(types.string), default = {}, help = "names of entries that are not tried" }
local effects_field = { "effects", types.list(types.is("effect", "lunid.effect")), default = {},
  help = "entries of your own, beside the catalogue" }

local function number(value) return value and ("%.3g"):format(value) or "none" end

local function lines_of(head, rows, format)
  local lines = { head }
  for _, row in ipairs(rows) do lines[#lines + 1] = format(row) end
  return table.concat(lines, "\n")
end

local function with_warnings(warnings, text)
  local lines = {}
  for i, warning in ipairs(warnings) do lines[i] = "note       " .. warning end
  lines[#lines + 1] = text
  return table.concat(lines, "\n")
end

-- ---- locate ----

--- On which time the maps are: records that begin anew follow each other.
local function words_of_time(records)
  if #records < 2 then return "" end
  local last, parts = -math.huge, {}
  for i, each in ipairs(records) do
    local start = each.start > last and each.start or last + each.dt
    last = start + each.duration
    parts[i] = ("%s from %.4g s"):format(each.name, start)
  end
  return "\ntime       of the records one after another: " .. table.concat(parts, ", ")
end

local locate = schema.define({
  name = "locate",
  help = "Where a model fails: the force that it leaves unexplained along the smoothed measured motion, over time, "
    .. "displacement, velocity, the phase plane, amplitude, harmonic order, frequency and slow time, each with the level "
    .. "that noise of any colour stays below (95 %, over all bins at once).",
  fields = { model_field, record_field, window_field,
    { "place", types.string, help = 'with several coordinates where to look, "y2" or "y1 - y2"; else where most is left' } },
  returns = "location",
  example = [[local where = lunid.locate { model = model, record = train }
print(where)
print(where.maps.y.x, where.maps.y.value, where.maps.y.level)]],
}, function(given)
  if given.place and given.model.degrees == 1 then
    schema.fail("locate: place", ("the model has one coordinate: leave it out, got '%s'"):format(given.place))
  end
  local records = record_runs(given.record, given.window)
  local found = core.locate(given.model, records, { place = given.place })
  return schema.object("location", found, nil, function(self)
    local where = {}
    for _, over in ipairs { "time", "y", "v", "amplitude", "harmonic", "frequency" } do
      if self.maps[over].above then where[#where + 1] = over end
    end
    return with_warnings(self.warnings, ("where      %s\nnoise      rms %s of it is no function of y and v\nabove      "
      .. "%s\nno data    %s"):format(self.sentence, number(self.noise),
      #where > 0 and table.concat(where, ", ") or "nowhere", self.no_data) .. words_of_time(records))
  end)
end)

-- ---- propose ----

local propose = schema.define({
  name = "propose",
  help = "Which entries of the catalogue would help: each one's effect on the trajectory, projected orthogonal to what the "
    .. "model's own parameters and first states can do, and on the force along the motion. Best first, by the larger of "
    .. "both gains. To first order: lunid.rank fits them.",
  fields = { model_field, record_field, window_field, catalogue_field, without_field, effects_field },
  returns = "proposals",
  example = [[local list = lunid.propose { model = model, record = train }
print(list[1].name, list[1].gain)]],
}, function(given)
  local found = core.propose(given.model, catalogue.asked_for("propose", given, given.catalogue or catalogue.searched),
    record_runs(given.record, given.window), {})
  local list = found.proposals
  list.model, list.gap, list.warnings = found.model, found.gap, found.warnings
  return schema.object("proposals", list, nil, function(self)
    return with_warnings(self.warnings, lines_of(("%-36s %8s %12s %10s"):format("effect", "gain", "of the force", "p"),
      self, function(row)
        return row.remark and ("%-36s %s"):format(row.name, row.remark)
          or ("%-36s %8.3g %12.3g %10.2g"):format(row.name, row.gain, row.force_gain, row.p_value)
      end) .. "\n(by the larger of the two gains, to first order; lunid.rank fits them, and orders them by what they leave)")
  end)
end)

-- ---- rank ----

--- Sets as lists of names: "a", { "a", "b at y2" }.
local function sets_of(given)
  local sets = {}
  for i, set in ipairs(given.sets) do sets[i] = type(set) == "table" and set or { set } end
  return sets
end

--- The entries that the sets name, at whatever place, and the user's own.
local function entries_named(given)
  local own, wanted, seen = {}, {}, {}
  for _, entry in ipairs(given.effects) do own[entry.name] = true end
  for _, set in ipairs(sets_of(given)) do
    for _, label in ipairs(set) do
      local name = label:match "^%S*"
      if label:find("+", 1, true) then
        local parts = {}
        for part in label:gmatch "[^+]+" do parts[#parts + 1] = ("%q"):format(part:match "^%s*(.-)%s*$") end
        schema.fail("rank: sets", ("'%s': several effects at once are a list, { %s }"):format(label, table.concat(parts, ", ")))
      end
      if not own[name] and not seen[name] then wanted[#wanted + 1] = name end
      seen[name] = true
    end
  end
  catalogue.check_names("rank: sets", wanted, given.effects)
  local entries = catalogue.entries(wanted)
  for _, entry in ipairs(given.effects) do entries[#entries + 1] = entry end
  return entries
end

--- Asks the user's function of each row: false rejects it, a number is what the rows are ordered by (least first).
local function judge(rows, criterion)
  local kept, rejected, scored = {}, {}, false
  for _, row in ipairs(rows) do
    local answer = criterion(row)
    if answer ~= nil and type(answer) ~= "boolean" and type(answer) ~= "number" then
      schema.fail("rank: criterion", "expected the function to return true, false or a number, got " .. core.describe(answer))
    end
    if answer == false then
      rejected[#rejected + 1] = row
    else
      row.score = type(answer) == "number" and answer or nil
      scored = scored or row.score ~= nil
      kept[#kept + 1] = row
    end
  end
  if scored then
    local place = {}
    for i, row in ipairs(kept) do place[row] = i end
    table.sort(kept, function(a, b)
      local x, y = a.score or math.huge, b.score or math.huge
      if x ~= y then return x < y end
      return place[a] < place[b]
    end)
  end
  kept.rejected = rejected
  return kept
end

local rank = schema.define({
  name = "rank",
  help = "How given sets of effects compare: each is fitted with the baseline on the trajectory and judged by free runs "
    .. "over left-out blocks and by a likelihood with the noise's colour. The baseline takes part. Best left-out gap first.",
  fields = { model_field, record_field,
    { "sets", types.list(types.either(types.string, types.list(types.string, 1)), 1), required = true,
      help = 'names, and lists of names for several effects at once; with several coordinates "cubic_stiffness at y2", or that name alone for each place' },
    window_field, effects_field,
    { "blocks", types.integer { min = 3, max = 100 }, default = 6, help = "left-out blocks of the records" },
    { "criterion", types.callable, help = "function(row) of your own: false rejects a set, a number orders them, least first" },
  },
  returns = "ranking",
  example = [[local rows = lunid.rank { model = model, record = train, sets = { "cubic_stiffness", { "coulomb_friction",
  "constant_force" } }, criterion = function(row) return row.model and row.left_out_gap end }
print(rows[1].name, rows[1].model)]],
}, function(given)
  local rows = core.rank_sets(given.model, entries_named(given), sets_of(given), record_runs(given.record, given.window), { blocks = given.blocks })
  rows = judge(rows, given.criterion or function() return true end)
  return schema.object("ranking", rows, nil, function(self)
    local text = lines_of(("%-40s %10s %10s %12s %8s"):format("set", "left out", "gap", "log L", "z"), self, function(row)
      return ("%-40s %10s %10s %12s %8s%s"):format(row.name, number(row.left_out_gap), number(row.gap),
        row.log_likelihood and ("%.1f"):format(row.log_likelihood) or "none", row.z and number(row.z) or "nested",
        row.remark and "  " .. row.remark or "")
    end) .. "\n(z: of the likeliest set against this one, above 2.3 they are told apart; nested: the one holds all of the other)"
    for _, row in ipairs(self.rejected) do text = text .. ("\n%-40s rejected by the criterion"):format(row.name) end
    return text
  end)
end)

return { public = { locate = locate, propose = propose, rank = rank } }

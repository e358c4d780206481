-- Discovery: what a model lacks, named out of the catalogue; and what it writes.
local catalogue = require "lunid.catalogue"
local core = require "lunid.core"
local models = require "lunid.models"
local output = require "lunid.output"
local record_runs = require "lunid.record_runs"
local schema = require "lunid.schema"
local types = schema.types

local discovery = {}

local record = types.is("record", "lunid.read")
local records = types.either(record, types.list(record, 1))
local window = types.is("window", "lunid.window")

--- Writes discovery.json, results.json, model.lua, closure.lua (of an unknown effect), report.html and figures into
--- `folder`; returns what was made.
function discovery.save(found, folder)
  local prefix = folder and folder ~= "" and folder:gsub("/+$", "") .. "/" or ""
  if prefix ~= "" then output.make_folder(prefix) end
  local made = {
    json = output.write(prefix .. "discovery.json", found.json),
    model = output.write(prefix .. "model.lua", models.text(found.model)),
  }
  if found.closure then made.closure = output.write(prefix .. "closure.lua", models.text(found.closure)) end
  output.write(prefix .. "results.json", found.json)
  local report = require("lunid.report").write(found, prefix)
  made.report, made.figures, made.figure_count, made.note = report.path, report.folder, report.count, report.note
  return made
end

--- The last line of what the terminal shows.
function discovery.where_it_is(made)
  local figures = made.figures and (", %s (%d)"):format(made.figures, made.figure_count) or ""
  local files = { made.report, made.model, made.json }
  if made.closure then table.insert(files, 3, made.closure) end
  return ("%-11s%s%s%s"):format("", table.concat(files, ", "), figures,
    made.note and ("\n%-11s%s"):format("note", made.note) or "")
end

local definition = {
  name = "discover",
  help = "Where a model and its records disagree, what effect is missing, and how far the gap shrinks with it.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "the baseline" },
    { "train", records, required = true, help = "record or list of records, used for every choice" },
    { "test", records, help = "opened once, when the training records have chosen; else the last part of each record is held out" },
    { "window", window, help = "part of the training records" },
    { "test_window", window, help = "part of the test records; of the training files where no test is given" },
    { "catalogue", types.list(types.string, 1), help = "names of entries to try, any of `lunid list effects`; else those marked * there, and all where these leave it open" },
    { "without", types.list(types.string), default = {}, help = "names of entries that are not tried: what you know cannot be there" },
    { "effects", types.list(types.is("effect", "lunid.effect")), default = {},
      help = "entries of your own, beside the catalogue" },
    { "alpha", types.number { above = 0, below = 0.5 }, default = 0.01,
      help = "level of false alarms of the whole search" },
    { "minimum_gain", types.number { min = 0, below = 1 }, default = 0.05,
      help = "least relative drop of the left-out gap for which an effect is named, unless the test bears it out whole; five times "
        .. "that where 1.5 times the noise and more stays open" },
    { "max_effects", types.integer { min = 1, max = 20 }, default = 4, help = "named one after another" },
    { "blocks", types.integer { min = 3, max = 100 }, default = 6, help = "left-out blocks of the training records" },
    { "holdout", types.number { above = 0, max = 0.9 }, default = 0.3, help = "part held out when no test is given" },
    { "criterion", types.callable, help = "function(set) of your own: false keeps it from being named; a set has name, gap (of its "
        .. "fit) and model, as those of `lunid.rank`" },
    { "out", types.string, help = "folder for report, model, discovery.json and figures, below the run's out directory (--out); "
      .. "else that directory itself, for a second discovery of the run discovery_2, and so on" },
  },
  returns = "discovery",
  example = [[local found = lunid.discover { model = model, train = train, test = test }]],
}

--- The entries to try and the records, windows cut.
local function prepare(given)
  local entries = catalogue.asked_for("discover", given, given.catalogue or catalogue.names)
  if not given.catalogue then  -- what these leave open is held against all
    given.first = #entries
    for _, entry in ipairs(catalogue.others(given.without)) do entries[#entries + 1] = entry end
  end
  local train = record_runs(given.train, given.window)
  local tested = given.test or given.test_window and given.train
  local test = tested and record_runs(tested, given.test_window) or {}
  return entries, train, test
end

local function search(given)
  local entries, train, test = prepare(given)
  return core.discover(given.model, entries, train, test, given)
end

local unnamed = 0  -- discoveries of this run that name no folder

--- The out directory itself for the first of them; one that follows must not write over it.
local function own_folder()
  unnamed = unnamed + 1
  return unnamed > 1 and "discovery_" .. unnamed or nil
end

local discover = schema.define(definition, function(given)
  local found = search(given)
  if given.out or output.active() then
    local made = discovery.save(found, given.out or own_folder())
    if made.note then print(("%-11s%s"):format("note", made.note)) end
  end
  return found
end)

--- The same without writing: for the command line, which shows the result first.
function discovery.find(given) return search(schema.validate(definition, given)) end

--- What a search would start from: prints the records as they are used, the model, and what there is to say of them
--- before anything is fitted.
function discovery.check(given)
  given = schema.validate(definition, given)
  local _, train, test = prepare(given)
  local said = {}
  for _, list in ipairs { train, test } do
    for _, each in ipairs(list) do
      print(each)
      for _, text in ipairs(each.warnings) do said[text] = true end
    end
  end
  local baseline, notes = core.before_discovery(given.model, train, test, given)
  print(baseline)
  for _, note in ipairs(notes) do
    if not said[note] then print(("%-11s%s"):format("note", note)) end
  end
end

core.add_method("lunid.discovery", "save", function(found, folder)
  return discovery.save(found, folder)
end)

--- What would decide an ambiguous verdict, as lunid.design_experiment gives it; nil of any other.
core.add_method("lunid.discovery", "next_experiment", function(found)
  local design = found.designed
  return design and require("lunid.experiment").wrap(design) or nil
end)

discovery.public = { discover = discover }
return discovery

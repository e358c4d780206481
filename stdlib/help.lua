-- `lunid help TOPIC` and `lunid list`: written from the schemas and the catalogue, never by hand.
require "lunid.symbols"  -- the first that the manual tells of
local catalogue = require "lunid.catalogue"
local core = require "lunid.core"
local element = require "lunid.element"
local first_guesses = require "lunid.first_guesses"
local solvers = require "lunid.solvers"
local schema = require "lunid.schema"
local simulation = require "lunid.simulation"

local help = {}

local command_words = {
  { "run", "STUDY.lua [--out DIR] [--seed N] [--threads N] [key=value ...]", "run a study, or repeat a run from its run.json" },
  { "discover", "TRAIN.csv [MORE.csv ...] --mass M --restoring \"k*y + c*v\"", "name the effect that a model of a record lacks" },
  { "simulate", "model.lua --excitation RECORD.csv [--out DIR]", "run a model freely under a record's force" },
  { "thesis", "[list|CASE ...|all] [--quick] [--seed N] [--out DIR]", "make the thesis again, with the published numbers beside" },
  { "check", "STUDY.lua", "look through a study without running it" },
  { "repl", "", "type expressions and see their values" },
  { "list", "[effects|features|solvers|excitations|systems|cases]", "what there is" },
  { "help", "TOPIC", "explain a constructor, a group of them (systems) or an effect" },
  { "doctor", "", "say what is installed and whether figures work here" },
}

--- One line for a field: name, type, unit, default, help.
local function field_line(field)
  return ("  %-14s %s%s\n%17s%s"):format(field.name, field.type.words, schema.notes(field), "", field.help)
end

--- "lunid.window { from, to }", "lunid.at_least(feature, bound)" or "record:decimate { factor }"
function help.signature(definition)
  if definition.style == "arguments" then
    return ("%s(%s)"):format(schema.spelled(definition), table.concat(definition.positional, ", "))
  end
  local parts = {}
  for _, name in ipairs(definition.positional or {}) do parts[#parts + 1] = name end
  local seen = {}
  for _, name in ipairs(parts) do seen[name] = true end
  for _, field in ipairs(definition.fields) do
    if not seen[field.name] then parts[#parts + 1] = field.name .. " =" end
  end
  return (("%s { %s }"):format(schema.spelled(definition), table.concat(parts, ", ")):gsub("{  }", "{}"))
end

local function explain_constructor(definition)
  print(help.signature(definition))
  print(definition.help)
  if #definition.fields > 0 then print "" end
  for _, field in ipairs(definition.fields) do print(field_line(field)) end
  print("\nGives: " .. definition.returns .. "\n\n  " .. definition.example:gsub("\n", "\n  "))
end

local passive_words = { [true] = "yes: over a cycle it creates no energy", [false] = "no: it can create energy" }

local function explain_effect(entry)
  print(("%s (%s)\n  %s\n  %s"):format(entry.name, entry.family, entry.formula, entry.sentence))
  if entry.note ~= "" then print("  note: " .. entry.note) end
  if entry.any_motion then print("  the same of v or a, where that was measured") end
  if entry.separate == true then print("  a test record has parameters of its own") end
  for _, row in ipairs(entry.own_of_record) do
    if row.unless ~= "" then
      print(("  a test record has its own %s where no %s was measured"):format(row.parameter, row.unless))
    end
  end
  if entry.repeats then print("  may stand up to three times at one place; the parameters of the second end in _b") end
  print("\n" .. help.signature(element.definition(entry)))
  for _, row in ipairs(entry.parameters) do
    local bounds = (row.min and (", at least %g"):format(row.min) or "") .. (row.max and (", at most %g"):format(row.max) or "")
    print(("  %-14s %s%s%s"):format(row[1], row.unit and row.unit ~= "" and row.unit or "no unit", bounds, row.fixed and ", held at its value" or ""))
  end
  local function line(words, list)
    if #list > 0 then print(("  %s: %s"):format(words, table.concat(list, ", "))) end
  end
  line("with", entry.requires)
  print("  " .. table.concat(first_guesses.lines(entry), "\n  "))
  local loop = require("lunid.loop_plot").text(entry)
  if loop then print("\n  " .. loop:gsub("\n", "\n  ")) end
  print("\n  shows as: " .. entry.signature)
  print("  passive: " .. (passive_words[entry.passive] or entry.passive))
  line("easily taken for", entry.confusers)
  line("a special case of (docs/effects.md: at which values)", entry.special_case_of)
  line("modifies", entry.acts_on)
  line("needs the channels", entry.channels)
  print("  source: " .. entry.source)
end

--- "Such as this.", of a text whose next sentence begins with a capital letter.
local function first_sentence(text) return (text .. " A"):match "^(.-%.) %u" end

local groups = { "excitation", "noise", "derivative", "record", "systems", "statistics", "figure" }

--- Constructors of lunid.<group>, such as those of lunid.excitation, or the methods of a record.
local function members_of(group)
  local members = {}
  for _, definition in ipairs(schema.definitions) do
    local member = definition.name:match("^" .. group .. "[.:](.*)$")
    if member then members[#members + 1] = { name = member, definition = definition } end
  end
  return members
end

--- Prints rows { name, words } in two columns, the second where the longest name has ended.
local function print_columns(before, rows)
  local width = 19
  for _, row in ipairs(rows) do width = math.max(width, #row[1]) end
  for _, row in ipairs(rows) do print(("%s%s%s  %s"):format(before, row[1], (" "):rep(width - #row[1]), row[2])) end
end

--- The members with the first sentence of each.
local function sentences_of(members)
  local rows = {}
  for i, member in ipairs(members) do rows[i] = { member.name, first_sentence(member.definition.help) } end
  return rows
end

local function explain_group(group, members)
  print(("%s (lunid help %s NAME)"):format(schema.spelled(members[1].definition):match "^(.*)[.:]", group))
  print_columns("  ", sentences_of(members))
end

--- "lunid check     STUDY.lua"
local function usage(row) return (("lunid %-9s %s"):format(row[1], row[2]):gsub("%s+$", "")) end

local function overview()
  print "Lunid: from a measured record to the equation of its motion.\n\nCommands"
  for _, row in ipairs(command_words) do print(("  %s\n%17s%s"):format(usage(row), "", row[3])) end
  print "\nConstructors of the language (lunid help NAME)"
  local constructors = {}
  for _, definition in ipairs(schema.definitions) do
    if not definition.name:find "[.:]" then constructors[#constructors + 1] = { name = definition.name, definition = definition } end
  end
  print_columns("  ", sentences_of(constructors))
  print "\nGroups of them (lunid help GROUP, lunid help GROUP NAME)"
  for _, group in ipairs(groups) do
    local names = {}
    for i, member in ipairs(members_of(group)) do names[i] = member.name end
    print(("  %-21s%s"):format(group, table.concat(names, " ")))
  end
  print "\nEffects that discovery tries (lunid help NAME)"
  local effects = {}
  for i, entry in ipairs(catalogue.entries()) do effects[i] = { entry.name, entry.sentence } end
  print_columns("  ", effects)
  print(("  and %d more in the catalogue: lunid list effects"):format(#catalogue.names - #catalogue.searched))
end

--- Words of results and of the field that no constructor has for its name.
local words = {
  fit = "A fit is made by one of several constructors: lunid.fit_trajectory fits a model's parameters on its free runs, "
    .. "lunid.regress finds coefficients of features, lunid.fit_curve fits a formula of a record's channels.\n"
    .. "See `lunid help fit_trajectory`, `lunid help regress`, `lunid help fit_curve`.",
  columns = "Which column of a file is which channel: channel=header [unit], with commas between, such as "
    .. "\"t=time,y=disp [mm],F=load [kN]\". Channels are t, F, y, v, a; y1, F1 ... of several coordinates; yb, vb, ab of a base;\n"
    .. "shaft_angle, shaft_speed; y_reference of a set point; any other name keeps a column under it. Without a unit the header's is "
    .. "taken, else SI.\nA header with a comma stands in quotes, a table without headers has their numbers (\"t=1,y=2\"), and a number with its "
    .. "unit is the same in\nevery row (\"F=0\" where nothing drives). On the command line --columns, in a study columns = \"...\".\n"
    .. "See `lunid help read`, `lunid help units`.",
  rate = "Rows per second of a file without a time column, --rate 800 or --rate \"4 kHz\", in a study rate = 800. A time that is there is "
    .. "left out.\nSee `lunid help read`.",
  units = "Units of columns stand in the header, y [mm] or F (kN), or in --columns; answers are in SI. Known are "
    .. core.known_units() .. ".",
  gap = "The gap is the error of a free run over the size of the motion: 0 is perfect, and noise alone leaves its floor.\nSee `lunid help discover`, `lunid help compare`.",
  verdict = "The verdict of a discovery: explained (the model with what was named leaves nothing above the noise), "
    .. "nothing-missing, ambiguous (several effects do as well), unknown-effect (something is missing, and no name holds).\n"
    .. "See `lunid help discover`.",
}

local lists

--- "lunid help systems duffing": where help on a word is that has none of its own.
local function elsewhere(topic)
  local places = {}
  if lists[topic] then places[1] = ("`lunid list %s`"):format(topic) end
  for _, group in ipairs(groups) do
    for _, member in ipairs(members_of(group)) do
      if member.name == topic then places[#places + 1] = ("`lunid help %s %s`"):format(group, topic) end
    end
  end
  return #places > 0 and table.concat(places, " or ") or nil
end

function help.explain(topic)
  require "lunid"  -- all constructors declare themselves
  if not topic then return overview() end
  if topic == "stubs" or topic == "manual" or topic == "effects_table" then  -- for the editor and for docs
    io.write(require("lunid." .. topic).text())
    return
  end
  topic = topic:gsub("^effects?%.", "")
  if topic == "effects" then return help.list "effects" end
  local name = topic:gsub("^lunid%.", "")
  local definition = schema.definitions[name] or schema.definitions[name:gsub("%.", ":", 1)]  -- lunid help record save
  local names = {}
  for _, group in ipairs(groups) do
    names[#names + 1] = group
    if group == topic then return explain_group(group, members_of(group)) end
  end
  for _, each in ipairs(schema.definitions) do names[#names + 1] = each.name end
  if definition then explain_constructor(definition) end
  for _, row in ipairs(command_words) do
    names[#names + 1] = row[1]
    if row[1] == topic then
      print((definition and "\nOn the command line (all options: lunid %s --help)\n" or "%s: all options: lunid %s --help\n")
        :format(topic, topic) .. ("  %s\n  %s"):format(usage(row):gsub("%s+", " "), row[3]))
      definition = row
    end
  end
  for _, name in ipairs(catalogue.names) do
    names[#names + 1] = name
    if name == topic then
      explain_effect(catalogue.entry(name))
      definition = name
    end
  end
  if definition then return end
  if words[topic] then return print(words[topic]) end
  local place = elsewhere(topic)
  if place then core.raise(("no help on '%s' alone: see %s"):format(topic, place), "usage") end
  core.raise(("no help on '%s'%s"):format(topic, core.did_you_mean(core.nearest(topic, names)) or "; see `lunid help`"),
    "usage")
end

lists = {}

function lists.effects()
  local searched = {}
  for _, name in ipairs(catalogue.searched) do searched[name] = true end
  for _, entry in ipairs(catalogue.entries(catalogue.names)) do
    print(("%s %-30s%-15s%s\n%47s%s"):format(searched[entry.name] and "*" or " ", entry.name, entry.family,
      entry.formula, "", entry.sentence))
  end
  print "\n(* tried first by discovery, the others where these leave it open; lunid.discover { catalogue = { ... } } restricts it)"
end

function lists.features()
  print "signals     displacement y, velocity v, acceleration a, time t, force F"
  print "sets        polynomials chebyshev fourier tanhs exponentials powers piecewise radial lags features;"
  print "            a set times a set, or times an expression, is the set of all products"
  local names = {}
  for name in pairs(core.functions) do names[#names + 1] = name end
  table.sort(names)
  print("functions   " .. table.concat(names, " "))
end

local function list_group(group) print_columns("", sentences_of(members_of(group))) end

function lists.excitations() list_group "excitation" end
function lists.systems() list_group "systems" end
function lists.cases() require("lunid.thesis").list() end

function lists.solvers()
  local of_regressions, of_runs = {}, {}
  for i, name in ipairs(solvers.names) do of_regressions[i] = { name, schema.definitions[name].help } end
  for i, name in ipairs(simulation.solvers) do of_runs[i] = { name, simulation.solver_words[name] } end
  print "of a regression"
  print_columns("  ", of_regressions)
  print "of a simulation (solver = \"...\")"
  print_columns("  ", of_runs)
end

function help.list(topic)
  require "lunid"
  local topics = { "effects", "features", "solvers", "excitations", "systems", "cases" }
  if not topic then
    for _, name in ipairs(topics) do
      print(name:upper())
      lists[name]()
      print ""
    end
    return
  end
  if topic:find(".", 1, true) then core.raise(("list: expected one topic, got '%s'"):format(topic:gsub("%.", " ")), "usage") end
  if not lists[topic] then
    core.raise(("list: expected effects, features, solvers, excitations, systems or cases, got '%s'%s"):format(topic,
      core.did_you_mean(core.nearest(topic, topics)) or ""), "usage")
  end
  lists[topic]()
end

return help

-- The commands of the executable. Each gets its options as a table and returns nothing or an exit code.
local core = require "lunid.core"
local option = require "lunid.option"
local output = require "lunid.output"
local records = require "lunid.records"
local strict = require "lunid.strict"

local commands = {}

local function fault(message, kind) core.raise(message, kind) end

--- What run.json holds: all that the run depends on.
local function run_record(command, options)
  return { schema = 1, version = core.version, command = command, options = options, seed = options.seed,
    threads = options.threads, inputs = core.inputs() }
end

--- Runs `work` with an out directory; commits its files and returns their names, or says what was kept.
local function with_output(command, options, work)
  core.set_run(options.seed, options.threads)
  output.begin(options.out or "lunid-out", core.rank())
  local good, message = xpcall(work, function(error) return tostring(error) end)
  if good then
    good, message = pcall(output.commit, run_record(command, options))
    if good then return message end
  end
  local interrupted = core.take_interrupt()
  local kept = output.abandon(message, interrupted)
  if interrupted then fault("interrupted; " .. kept, "interrupted") end
  core.reraise(message .. "\n  " .. kept, message)
end

local function run_study(options)
  option.take(options.arguments or {})
  records.folder = core.parent_of(options.study)
  core.note_input(options.study)
  strict.load_file(options.study)()
  option.check_all_read()
end

--- Repeats a run from its run.json: the same command, options and seed, on inputs that are the same.
local function repeat_run(options)
  local run = core.parse_json(core.read_text(options.study))
  if type(run) ~= "table" or not commands[run.command] or not run.inputs then
    fault(("'%s' is not the run.json of a run"):format(options.study), "data")
  end
  for _, input in ipairs(run.inputs) do
    if not core.kind_of(input.path) then fault(("the run's input '%s' is missing"):format(input.path), "data") end
    if core.hash_of(input.path) ~= input.sha256 then
      fault(("the run's input '%s' has changed since (another SHA-256)"):format(input.path), "data")
    end
  end
  if run.version ~= core.version then
    io.stderr:write(("lunid: the run was made by version %s, this is %s\n"):format(run.version, core.version))
  end
  run.options.out = options.out or run.options.out
  return commands[run.command](run.options)
end

commands["run"] = function(options)
  if options.study:match "%.json$" then return repeat_run(options) end
  require("lunid.check").expect_study(options.study)
  core.join_ranks()
  local files = with_output("run", options, function() run_study(options) end)
  if #files > 0 then print(("%-11s%s"):format("wrote", output.summary(options.out or "lunid-out", files))) end
end

--- "2:10" -> a window
local function window(lunid, texts, name)
  if not texts then return nil end
  if #texts > 1 then fault(("--%s: expected one A:B, got %d"):format(name, #texts), "usage") end
  local from, to = texts[1]:match "^([^:]+):([^:]+)$"
  from, to = tonumber(from), tonumber(to)
  if not from or not to then fault(("--%s: expected A:B in seconds, got '%s'"):format(name, texts[1]), "usage") end
  if to <= from then fault(("--%s: expected A < B, got '%s'"):format(name, texts[1]), "usage") end
  return lunid.window(from, to)
end

local likely = { x = "displacement is written y", X = "displacement is written y", Y = "displacement is written y",
  V = "velocity is written v", dy = "velocity is written v", dx = "velocity is written v" }

local function note(source, text) print(("%-11s%s: %s"):format("note", source, text)) end

--- A parameter by a name that others give to a signal is most likely meant as that signal, by that of an effect as this.
local function warn_of_name(source, name)
  local meant = likely[name] and "the " .. likely[name]
  for _, effect in ipairs(require("lunid.catalogue").names) do
    if name == effect then
      meant = ("the effect stands in the file of a baseline (--baseline), as lunid.effects.%s {}"):format(name)
    end
  end
  if meant then note(source, ("'%s' is taken for a parameter to fit; %s"):format(name, meant)) end
end

--- Parameters that stand alone are constant forces, of which a record shows the sum: "ky + cv" is "k*y + c*v" most likely.
local function warn_of_constants(source, force)
  local has, constants, product = {}, {}, false
  for _, symbol in ipairs(force:symbols()) do has[symbol.name] = true end
  for _, symbol in ipairs(force:symbols()) do
    if symbol.kind == "parameter" then
      local alone = true
      for _, other in ipairs(force:derivative(core.parse(symbol.name, source)):symbols()) do
        alone = alone and other.kind == "parameter"
      end
      local factor, signal = symbol.name:match "^(%a%d*)([yva])$"
      if alone then constants[#constants + 1] = symbol.name end
      product = product or alone and signal and (has[factor] or not has[signal])
    end
  end
  if product or #constants > 1 then
    note(source, ("constant forces to fit: %s; a product is written with *, as k*y"):format(table.concat(constants, ", ")))
  end
end

--- "2*a + k*y" beside a mass of 2: the mass stands there already.
local function warn_of_second_mass(source, model)
  local weight = model.restoring:derivative(core.parse("a", source))
  if tostring(weight) ~= "0" and tostring(weight) == tostring(model.mass) then
    note(source, ("%s*a stands beside the mass %s, and both act; the mass is given by --mass alone"):format(tostring(weight),
      tostring(model.mass)))
  end
end

--- "v^p" is no number for v < 0 unless p is whole.
local function warn_of_power(source, force)
  for signal, exponent in tostring(force):gmatch "%f[%w_]([yva])%^%(?([%w_.]+)" do
    local value = tonumber(exponent)
    if not value or value % 1 ~= 0 then
      note(source, ("%s^%s is no number where %s < 0; write abs(%s)^%s*sign(%s)"):format(signal, exponent, signal, signal,
        exponent, signal))
    end
  end
end

local of_a_kilogram = { [""] = 1e-3, m = 1e-6, u = 1e-9, n = 1e-12 }

--- "1.9 t" -> 1.9, "t"; nil of all that is no number with a unit.
local function quantity(text)
  local value, unit = text:match "^%s*([%d.]+[eE]?[-+]?%d*)%s*(%a.-)%s*$"
  if tonumber(text) or not tonumber(value) then return nil end
  return tonumber(value), unit
end

--- "1.9 t" -> "1900", "kg": a mass with its unit, in SI; any other text as it is. Here g is the gram, as nowhere else.
local function mass_in_si(text)
  local value, unit = quantity(text)
  if not value then return text end
  local prefix, of_inertia = unit:match "^([mun]?)g%f[%A](.*)$"
  local factor, si = core.si_unit(prefix and "kg" .. of_inertia or unit)
  if factor and prefix then factor = factor * of_a_kilogram[prefix] end
  if factor and (si:find "kg" or si:find " s^2" or si == "V s/A") then return ("%.15g"):format(value * factor), si end
  local meant = core.unit_meant(unit)
  local problem = factor and ("'%s' is a unit of %s"):format(unit, si ~= "" and si or "no dimension")
    or ("unknown unit '%s'%s"):format(unit, core.did_you_mean(meant) or "")
  fault(("--mass: expected a number with or without a unit of mass (kg g mg ug t lb slug, or a product such as kg m^2, "
    .. "of a circuit H), got '%s' (%s)"):format(text, problem), "usage")
end

local mass_beside = { m = "kg", rad = "kg m^2", C = "H", A = "H" }
local all_masses = { kg = "kg", ["kg m^2"] = "kg m^2", ["V s/A"] = "H" }

--- Raises on a mass of another kind than its motion: in kg beside an angle, or an inductance beside a displacement; a
--- moment of inertia only where the file says that y is in metres. What is driven by no voltage is no circuit.
local function check_kind_of_mass(text, record)
  local _, unit = mass_in_si(text)
  local name = "y"
  for _, each in ipairs { "y", "v" } do
    if record.channels[each] and not record.channels[each].derived then
      name = each
      break
    end
  end
  local motion = record.channels[name] and record.channels[name].unit
  local kind, is_circuit = mass_beside[motion], record.channels.F and record.channels.F.unit == "V"
  if not kind or kind == "H" and not is_circuit or not all_masses[unit] or all_masses[unit] == kind then return end
  if unit == "kg m^2" and record.channels[name].source_unit == "" then return end
  fault(("--mass: expected a unit of the kind of %s, since %s is in %s, got '%s'"):format(kind, name, motion, text), "usage")
end

--- "4 kHz" -> 4000: rows per second; any other text, a name in a file, as it is.
local function rate_in_hertz(text)
  local value, unit = quantity(text)
  local factor, si = core.si_unit(unit or "")
  return tonumber(text) or si == "Hz" and value * factor or text
end

local function baseline(lunid, options)
  if options.baseline then
    if options.mass or options.restoring then
      fault("give --baseline, or --mass and --restoring; not both", "usage")
    end
    if options.interpolation then
      fault("--interpolation: the baseline's file says it: lunid.model { interpolation = ... }", "usage")
    end
    return lunid.load(options.baseline)
  end
  if not options.restoring then fault("--restoring (or --baseline model.lua) is needed", "usage") end
  if not options.mass and not options.imposed_motion then
    fault("--mass is needed where the motion is free; where a machine imposes it, say --imposed-motion", "usage")
  end
  local schema = require "lunid.schema"
  local function read(text, source)
    local lua = text:match "lunid%.[%w_.]*"
    if lua then
      fault(("%s: expected a formula such as k*y + c*v, got Lua, '%s': that stands in the file of a baseline, --baseline "
        .. "model.lua"):format(source, lua), "usage")
    end
    local value = core.parse(text, source)
    for _, symbol in ipairs(value:symbols()) do
      if symbol.kind == "parameter" then
        schema.check_name(source, symbol.name)
        warn_of_name(source, symbol.name)
      end
    end
    return value
  end
  local good, model = pcall(function()
    local mass, restoring = read(mass_in_si(options.mass or "0"), "--mass"), read(options.restoring, "--restoring")
    warn_of_constants("--restoring", restoring)
    return lunid.model { mass = mass, restoring = restoring, motion = options.imposed_motion and "imposed" or "free",
      interpolation = options.interpolation }
  end)
  if not good then fault(model, "usage") end
  warn_of_second_mass("--restoring", model)
  warn_of_power("--restoring", model.restoring)
  return model
end

--- A record as the options of the command line say.
local function read(lunid, path, options, part)
  return lunid.read { path, columns = options.columns, resample = options.resample, window = part,
    rate = options.rate and rate_in_hertz(options.rate) }
end

local function read_all(lunid, paths, options)
  local list = {}
  for i, path in ipairs(paths) do list[i] = read(lunid, path, options) end
  return list
end

--- "clearance, cubic_stiffness" -> a list of entries that there are; `option` gave them
local function names(option, text)
  if not text then return nil end
  local list = {}
  local known = {}
  for _, name in ipairs(require("lunid.catalogue").names) do known[name] = true end
  for item in text:gmatch "[^,]+" do
    item = item:match "^%s*(.-)%s*$"
    local words, all = {}, true
    for word in item:gmatch "%S+" do
      words[#words + 1] = word
      all = all and known[word] ~= nil
    end
    table.move(all and words or { item }, 1, all and #words or 1, #list + 1, list)
  end
  local good, message = pcall(require("lunid.catalogue").check_names, option, list)
  if not good then fault(tostring(message):gsub("^.-%-%-", "--"), "usage") end
  return list
end

--- What a discovery starts from, read as the options say.
local function start_of_discovery(lunid, options)
  local start = { model = baseline(lunid, options), train = read_all(lunid, options.train, options) }
  if not options.baseline then
    check_kind_of_mass(options.mass or "0", start.train[1])
    start.model = require("lunid.units").complete(start.model, start.train[1])
  end
  start.test = options.test and read_all(lunid, options.test, options)
  start.window = window(lunid, options.window, "window")
  start.test_window = window(lunid, options.test_window, "test-window")
  start.alpha, start.minimum_gain = options.alpha, options.minimum_gain
  start.catalogue = names("--catalogue", options.catalogue)
  start.without = names("--without", options.without)
  return start
end

commands["discover"] = function(options)
  local lunid, discovery = require "lunid", require "lunid.discovery"
  if options.check then
    if options.out then output.expect_free(options.out) end
    return discovery.check(start_of_discovery(lunid, options))
  end
  with_output("discover", options, function()
    local found = discovery.find(start_of_discovery(lunid, options))
    print(found)
    print(discovery.where_it_is(discovery.save(found)))
  end)
end

commands["simulate"] = function(options)
  local lunid = require "lunid"
  with_output("simulate", options, function()
    local model = lunid.load(options.model)
    local record = read(lunid, options.excitation, options, window(lunid, options.window, "window"))
    local from
    if options.from then
      from = {}
      for text in options.from:gmatch "[^,]+" do
        local value = tonumber(text)
        if not value then fault(("--from: expected numbers \"y,v\", got '%s'"):format(text), "usage") end
        from[#from + 1] = value
      end
      if #from < 2 then fault("--from: expected \"y,v\"", "usage") end
    end
    local run = lunid.simulate { model = model, excitation = record, from = from, solver = options.solver or "auto" }
    require("lunid.free_run").report(model, record, run, from)
  end)
end

commands["thesis"] = function(options)
  local thesis = require "lunid.thesis"
  local words = options.cases or { "list" }
  if words[1] == "list" then return thesis.list() end
  local failed
  local files = with_output("thesis", options, function() failed = thesis.run(options) end)
  print(("%-11s%s"):format("wrote", output.summary(options.out or "lunid-out", files)))
  if #failed > 0 then
    io.stderr:write(("thesis: failed: %s\n"):format(table.concat(failed, ", ")))
    return 1
  end
end

commands["check"] = function(options) return require("lunid.check").study(options.study) end
commands["list"] = function(options) return require("lunid.help").list(options.topic) end
commands["help"] = function(options) return require("lunid.help").explain(options.topic) end
commands["doctor"] = function() return require("lunid.doctor").report() end
return commands

-- Measured records and windows of time.
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"
local types = schema.types

local records = {}

-- Study-relative paths: set by the command that runs a study.
records.folder = nil

--- The path of an input: beside the study, or from the current directory.
function records.find(path)
  if records.folder and path:sub(1, 1) ~= "/" then
    local beside = records.folder .. "/" .. path
    if records.folder ~= "" and core.kind_of(beside) then return beside end
  end
  if output.is_gathered(path) then
    core.raise(("'%s' is in the out directory when the study has ended: use what was saved, or to read it at once save it "
      .. "elsewhere, under an absolute path"):format(path), "study")
  end
  return path
end

local channels = { time = "t", force = "F", displacement = "y", velocity = "v", acceleration = "a" }

--- The fields that say which columns of a file are what.
local columns_fields = {
  { "path", types.string, required = true, help = "file, beside the study or from the current directory" },
  { "time", types.string, help = "header of the time column, with its unit: \"t [ms]\"" },
  { "force", types.string, help = "header of the force column: \"load [kN]\"; \"0\" where nothing drives" },
  { "displacement", types.string, help = "header of the displacement column: \"y [mm]\"" },
  { "velocity", types.string, help = "header of the velocity column" },
  { "acceleration", types.string, help = "header of the acceleration column" },
  { "columns", types.string, help = "all at once: \"t=time,y=disp [mm],F=load [kN]\"" },
  { "rate", types.either(types.number { above = 0 }, types.string), unit = "Hz",
    help = "rows per second, where there is no time: a number, or its name in a MAT or HDF5 file" },
  { "interval", types.either(types.number { above = 0 }, types.string), unit = "s",
    help = "the same as the time between rows" },
}

--- Those and others; copies, because each definition names its own.
local function with_columns(others)
  local all = {}
  for _, list in ipairs { columns_fields, others } do
    for _, field in ipairs(list) do
      local copy = {}
      for key, value in pairs(field) do copy[key] = value end
      all[#all + 1] = copy
    end
  end
  return all
end

--- The columns of the file as the runtime takes them.
local function columns_of(given, name)
  local columns = {}
  for _, field in ipairs { "time", "force", "displacement", "velocity", "acceleration" } do
    if given[field] then columns[#columns + 1] = channels[field] .. "=" .. given[field] end
  end
  if given.columns then
    for _, column in ipairs(core.split_columns(given.columns)) do columns[#columns + 1] = column end
  end
  if given.rate and given.interval then schema.fail(name, "expected rate or interval, got both") end
  return columns
end

local window_field = { "window", types.is("window", "lunid.window"), help = "part of the record to keep" }

records.read = schema.define({
  name = "read",
  help = "Reads a record from a CSV, MAT or HDF5 file. Columns are t F y v a in SI by default; v and a are derived where "
    .. "absent. A MAT file gives its variables, fields as \"run.y\", columns of arrays as \"data:2\".",
  positional = { "path" },
  fields = with_columns {
    { "resample", types.boolean, default = false, help = "resample an uneven time base to its median step" },
    window_field,
  },
  returns = "record",
  example = [[local record = lunid.read("run3.csv", { time = "t", force = "F", displacement = "y [mm]" })]],
}, function(given)
  local record = core.read(records.find(given.path),
    { columns = columns_of(given, "read"), resample = given.resample, rate = given.rate, interval = given.interval })
  return given.window and record:window(given.window.from, given.window.to) or record
end)

local units = { F = "N", y = "m", v = "m/s", a = "m/s^2" }

records.record = schema.define({
  name = "record",
  help = "A record of columns that are there already, such as forces computed from gauges. Channels t F y v a are in SI; v and a "
    .. "are derived where absent.",
  fields = {
    { "channels", types.list(types.table, 1), required = true, help = "entries { name, column }: { { \"F\", force }, { \"y\", y } }; of other SI units "
      .. "than N and m { \"y\", angle, unit = \"rad\" }, { \"F\", torque, unit = \"N m\" }" },
    { "dt", types.number { above = 0 }, required = true, unit = "s", help = "time between rows" },
    { "start", types.number(), default = 0, unit = "s", help = "time of the first row" },
    { "name", types.string, default = "record", help = "what messages and figures call it" },
  },
  returns = "record",
  example = [[local shaft = lunid.record { channels = { { "F", force }, { "y", test:column "y" } }, dt = test.dt, start = test.start }]],
}, function(given)
  local list = {}
  for i, entry in ipairs(given.channels) do
    local name, values = entry[1], entry[2]
    if type(name) ~= "string" then
      schema.fail("record: channels", ("entry %d: expected { name, column }, got { %s, ... }"):format(i, core.describe(name)))
    end
    if type(values) == "table" and getmetatable(values) == nil then values = core.column(values) end
    if getmetatable(values) ~= "lunid.column" then
      schema.fail("record: channels", ("'%s': expected a column or a list of numbers, got %s"):format(name, core.describe(values)))
    end
    for key in pairs(entry) do
      if key ~= 1 and key ~= 2 and key ~= "unit" then
        schema.fail("record: channels", ("'%s': unknown field '%s' (fields: unit)"):format(name, tostring(key)))
      end
    end
    if entry.unit ~= nil and type(entry.unit) ~= "string" then
      schema.fail("record: channels", ("'%s': unit: expected a string, got %s"):format(name, core.describe(entry.unit)))
    end
    local problem = entry.unit and require("lunid.units").problem(entry.unit)
    if problem then schema.fail("record: channels", ("'%s': unit: %s"):format(name, problem)) end
    list[i] = { name = name, unit = entry.unit or units[name:match "^%a"] or "", values = values }
  end
  return core.record_of_columns(given.name, given.start, given.dt, list)
end)

records.stream = schema.define({
  name = "stream",
  help = "A record that stays in its file (CSV, HDF5, MAT of version 7.3) and is read block by block, for files larger "
    .. "than memory. lunid.regress takes it as it takes a record, with the same result; what needs all rows at once does "
    .. "not. The file is looked through twice when it is opened, and read again for each pass of a regression.",
  positional = { "path" },
  fields = with_columns {
    { "derivative", types.is("derivative", "lunid.derivative"),
      help = "of what of v and a was not measured: lunid.derivative.savitzky_golay {} by default. fourier and "
        .. "total_variation need the whole record; spline and kalman give its numbers to 1e-9 of a deviation" },
    { "smooth", types.boolean, default = false, help = "smooth measured y, v and a too, by the same method" },
    window_field,
  },
  returns = "stream",
  example = [[local big = lunid.stream("year.csv", { displacement = "y [mm]" }):filter { to = 120 }:decimate(4)]],
}, function(given)
  local stream = core.stream(records.find(given.path), { columns = columns_of(given, "stream"), rate = given.rate,
    interval = given.interval, derivative = given.derivative, smooth = given.smooth })
  return given.window and stream:window(given.window.from, given.window.to) or stream
end)

records.window = schema.define({
  name = "window",
  help = "A part of a record's time, from <= t <= to.",
  positional = { "from", "to" },
  fields = {
    { "from", types.number(), required = true, unit = "s", help = "first time kept" },
    { "to", types.number(), required = true, unit = "s", help = "last time kept" },
  },
  returns = "window",
  example = [[window = lunid.window { from = 2, to = 10 }]],
}, function(given)
  if given.to <= given.from then
    schema.fail("window", ("to: expected > from, which is %g, got %g"):format(given.from, given.to))
  end
  given.place = core.place()
  return schema.object("window", given, nil, function(self)
    return ("window %g to %g s"):format(self.from, self.to)
  end)
end)

schema.method({
  name = "record:save",
  also = "run",
  help = "Writes the time and the channels in SI with their units, below the out directory: as HDF5 (.h5, .hdf5), for "
    .. "MATLAB (.mat) or else as CSV. Derived channels are called v_derived in the file, and are derived ones again where it is read. Whole or not at all. Also run:save.",
  positional = { "path" },
  fields = {
    { "path", types.string, required = true, help = "below the out directory" },
    { "version", types.choice { "5", "7.3" }, default = "5",
      help = "of a MAT file: 5 is read by all programs and holds 2 GB a channel, 7.3 can be a stream" },
  },
  returns = "string",
  example = [[record:save("run3.mat", { version = "7.3" })]],
}, function(record, given)
  core.write_record(getmetatable(record) == "lunid.run" and record:record() or record, output.place(given.path), given.version)
  return output.shown(given.path)
end)

return records

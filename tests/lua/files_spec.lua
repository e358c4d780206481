-- Records and tables in HDF5 and MAT files, through the language.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local model = lunid.model { mass = 1, restoring = 2e4*y + 10*v }
local record = lunid.simulate { model = model, excitation = 10*lunid.sin(80*t), duration = 0.5, dt = 1e-3 }:record()
local path = spec.folder .. "/run.h5"

spec.case("a record is saved as HDF5 and read back to the same bits", function()
  record:save(path)
  local back = lunid.read(path)
  spec.equal(back.rows, record.rows)
  for _, name in ipairs { "t", "F", "y", "v", "a" } do
    local a, b = record:column(name), back:column(name)
    for i = 1, record.rows do spec.equal(b[i], a[i]) end
  end
  spec.equal(back.channels.v.unit, "m/s")
  spec.equal(back.channels.v.derived, false)
  local named = lunid.read(path, { displacement = "a [mm]", force = "F" })
  spec.equal(named:column("y")[7], record:column("a")[7]*1e-3)
  local rated = lunid.read(path, { rate = 500 })
  spec.equal(rated.dt, 0.002)
  spec.equal(rated.warnings[1], "left out: the time 't', because a rate or interval is given")
end)

spec.case("a record is saved for MATLAB and read back to the same bits", function()
  for _, version in ipairs { "5", "7.3" } do
    local file = spec.folder .. "/run_" .. version .. ".mat"
    record:save(file, { version = version })
    local back = lunid.read(file)
    spec.equal(back.rows, record.rows)
    spec.near(back.dt, record.dt, 1e-15)
    for _, name in ipairs { "F", "y", "v", "a" } do
      local a, b = record:column(name), back:column(name)
      for i = 1, record.rows do spec.equal(b[i], a[i]) end
      spec.equal(back.channels[name].unit, ({ F = "N", y = "m", v = "m/s", a = "m/s^2" })[name])
    end
  end
  spec.equal(lunid.stream(spec.folder .. "/run_7.3.mat").rows, record.rows)
  spec.equal(spec.message_of(function() record:save("run.mat", { version = "7" }) end),
    "save: version: expected '5' or '7.3', got the string '7'")
  spec.equal(spec.message_of(function() record:save() end), "save: missing field 'path': a string")
end)

spec.case("derived channels are derived ones again where they are read", function()
  local given = lunid.record { dt = record.dt, channels = { { "F", record:column "F" }, { "y", record:column "y" } } }
  spec.equal(given.channels.v.derived, true)
  for _, ending in ipairs { "csv", "h5", "mat" } do
    local file = spec.folder .. "/derived." .. ending
    given:save(file)
    local back = lunid.read(file)
    for _, name in ipairs { "F", "y", "v", "a" } do
      spec.equal(back.channels[name].derived, given.channels[name].derived)
      for i = 1, record.rows, 40 do spec.equal(back:column(name)[i], given:column(name)[i]) end
    end
  end
  spec.equal(io.lines(spec.folder .. "/derived.csv")(), "t [s],F [N],y [m],v_derived [m/s],a_derived [m/s^2]")
  -- A column that is measured stands for itself, and one that is asked for is what it was asked for.
  spec.write("both.csv", "t,F,y,v,v_derived\n" .. ("%g,1,2,3,4\n"):rep(8):format(0, 1, 2, 3, 4, 5, 6, 7))
  local both = lunid.read(spec.folder .. "/both.csv")
  spec.equal(both.channels.v.derived, false)
  spec.equal(both:column("v_derived")[1], 4)
  spec.equal(lunid.read(spec.folder .. "/derived.csv", { velocity = "v_derived" }).channels.v.derived, false)
end)

spec.case("a sweep is saved as HDF5 and read back as a table", function()
  local sweep = lunid.ensemble { model = model, vary = { v = { 0, 0.1, 0.2 } }, excitation = record }
  sweep:save(spec.folder .. "/sweep.h5")
  sweep:save(spec.folder .. "/sweep.csv")
  local hdf5, csv = lunid.table(spec.folder .. "/sweep.h5"), lunid.table(spec.folder .. "/sweep.csv")
  spec.equal(table.concat(hdf5.names, " "), table.concat(csv.names, " "))
  spec.equal(tostring(hdf5), "table of 3 rows: v, rms_y, max_y, stopped_at")
  for _, name in ipairs { "v", "rms_y", "max_y" } do
    for i = 1, 3 do spec.equal(hdf5:column(name)[i], csv:column(name)[i]) end
  end
  assert(hdf5:column("stopped_at")[1] ~= hdf5:column("stopped_at")[1], "no number stays none")
  spec.equal(spec.message_of(function() sweep:save "sweep.xls" end),
    "save: expected a path that ends in .csv or .h5, got the string 'sweep.xls'")
end)

spec.case("errors name the file, and the line that asks for it", function()
  local said, code = spec.study [[
    local lunid = require "lunid"
    lunid.read("run.h5", { displacement = "w" })
  ]]
  spec.equal(code, 3)
  spec.equal(said, "run.h5: no variable 'w' for channel 'y'; the file has t (501 values), F (501 values), y (501 values), "
    .. "v (501 values), a (501 values)\n  asked for at study.lua:2\n  nothing was written\n")
  spec.equal(spec.message_of(function() lunid.read(path, { rate = 500, interval = 0.002 }) end),
    "read: expected rate or interval, got both")
  spec.equal(spec.message_of(function() lunid.read(path, { rate = -1 }) end), "read: rate: expected > 0, got -1")
end)

local data = os.getenv "LUNID_SHARED_DATA"
local probe = data and io.open(data .. "/emps/DATA_EMPS.mat")
if probe then
  probe:close()
  spec.case("EMPS from its MAT file is that of its CSV", function()
    local mat = lunid.read(data .. "/emps/DATA_EMPS.mat", { time = "t", displacement = "qm", force = "vir" })
    local csv = lunid.read(data .. "/emps/emps.csv")
    spec.equal(mat.rows, csv.rows)
    spec.near(mat.dt, csv.dt, 1e-15)  -- its stamps are off even time by up to 32 ns
    for i = 1, mat.rows, 100 do spec.near(mat:column("y")[i], csv:column("y")[i], 1e-9) end
  end)
else
  print(("SKIPPED: no measured records at %s"):format(tostring(data)))
end

spec.case("what a study has saved is not there before it ends, and what an earlier run left is not taken for it", function()
  local study = [[
local lunid = require "lunid"
local record = lunid.record { dt = 0.01, channels = { { "y", { 1, 2, 4, 7, 5, 3, 2, 1 } } } }
local path = record:save "part.csv"
]]
  for _ = 1, 2 do
    spec.contains(spec.study(study .. "lunid.read(path)\n"), "study.lua:4: 'study-out/part.csv' is in the out directory when "
      .. "the study has ended: use what was saved, or to read it at once save it elsewhere, under an absolute path\n")
    spec.contains(spec.study(study .. "lunid.read 'part.csv'\n"), "study.lua:4: 'part.csv' is in the out directory when")
    spec.write("part.csv", "t,y\n" .. ("%g,1\n"):rep(8):format(0, 1, 2, 3, 4, 5, 6, 7))  -- one that was there is an input
    spec.contains(spec.study(study .. "print(lunid.read('part.csv').rows)\n"), "8\n")
    os.remove(spec.folder .. "/part.csv")
  end
end)

spec.clean()
spec.finish()

-- What a file lacks: a velocity, a time column, an even time base; and two recorders of different rates. A channel that was
-- derived is told from one that was measured, also when the record has been saved and is read again.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local model = lunid.model { mass = 2, restoring = 5e3*y + 6*v }
local push = lunid.excitation.multisine { from = 2, to = 20, rms = 30, dt = 1/500, duration = 8, seed = 1 }
local run = lunid.simulate { model = model, excitation = push }:record():with_noise { y = 0.01, seed = 1 }

-- Relative paths are below the out directory, where files are once the study is done; these are read at once.
local mark = os.tmpname()
local function path(name) return mark .. "-" .. name end

-- Force and displacement were measured; v and a are derived. The file says so: its header names v_derived and a_derived.
local record = lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
record:save(path "run.csv")
print(io.lines(path "run.csv")())
local back = lunid.read(path "run.csv")
print(back)
assert(back.channels.v.derived and not back.channels.y.derived)
-- To take it for a measured one is possible, and has to be said: lunid.read(file, { velocity = "v_derived" }).

-- A second recorder: 300 rows per second, no time column, millimetres.
local second = record:resample(300)
local out = assert(io.open(path "logger.csv", "w"))
out:write "load [kN];way [mm]\n"
local F, w = second:column "F", second:column "y"
for i = 1, second.rows do out:write(("%.6f;%.5f\n"):format(F[i]/1e3, 1e3*w[i])) end
out:close()
local logger = lunid.read(path "logger.csv", { force = "load [kN]", displacement = "way [mm]", rate = 300 })
print(logger)
assert(logger.rows == 2401 and logger.channels.v.derived)
for _, name in ipairs { "run.csv", "logger.csv" } do os.remove(path(name)) end
os.remove(mark)

-- Records of different rates stand in one list as they are.
local k, c = lunid.parameter { "k", 4e3, min = 0, unit = "N/m" }, lunid.parameter { "c", 10, min = 0, unit = "N s/m" }
local fit = lunid.fit_trajectory { model = lunid.model { mass = 2, restoring = k*y + c*v }, record = { back, logger } }
print(fit)
assert(math.abs(fit.model.parameters.k.value/5e3 - 1) < 1e-3 and math.abs(fit.model.parameters.c.value/6 - 1) < 0.01)

-- Rows that are to be subtracted from each other have to be of one rate: 500 Hz again.
local again = logger:resample(500)
local sum, at, here = 0, again:column "y", back:column "y"
for i = 1, again.rows do sum = sum + (at[i] - here[i])^2/again.rows end
print(("%d rows at 500 Hz, %.2g of the motion from the first recorder's"):format(again.rows, math.sqrt(sum)/here:std()))
assert(again.rows == back.rows and math.sqrt(sum) < 0.02*here:std())  -- noise above 150 Hz is lost, the motion is not

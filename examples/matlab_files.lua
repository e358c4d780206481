-- A MAT file from a recorder, and one for MATLAB. It holds single precision, no time but a rate, and a structure `units`
-- whose texts are the units of the variables of those names (here: disp in mm); a unit in the study comes before them.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local record = lunid.read("../tests/data/shaker.mat", { force = "load", displacement = "disp", rate = "fs" })
print(record)
print(("y goes to %.3g %s"):format(record:column("y"):max(), record.channels.y.unit))

local inches = lunid.read("../tests/data/shaker.mat", { force = "load [kN]", displacement = "disp [in]", rate = "fs" })
print(("had it been inches: %.3g m"):format(inches:column("y"):max()))

local ready = record:derive { method = lunid.derivative.kalman {}, smooth = true }
print(lunid.regress { record = ready, mass = 49, features = { y, v, y^3 } })

-- Time and channels in SI, with the same structure of units. Version 7.3 is for what is large: lunid.stream reads it.
ready:save "ready.mat"
ready:save("ready_7.3.mat", { version = "7.3" })

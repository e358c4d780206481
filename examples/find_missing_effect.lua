-- A mass on a spring was shaken and measured. The model knows a linear spring and a dashpot: what does it lack?
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", min = 0, unit = "N/m" }
local c = lunid.parameter { "c", min = 0, unit = "N s/m" }

local train = lunid.read "../tests/data/spring_multisine.csv"
local test = lunid.read "../tests/data/spring_sweep.csv"

local model = lunid.model { mass = 49, restoring = k*y + c*v } -- m*a + restoring = F

local found = lunid.discover { model = model, train = train, test = test }
print(found)
found.model:save "spring.lua"

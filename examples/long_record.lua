-- A record that stays in its file: lunid.stream reads it block by block, so that a file of any length is regressed in a few
-- megabytes, with the same result as lunid.read to the last bit. Here the file is a short one.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local long = lunid.stream "../tests/data/spring_multisine.csv"
print(long)

local fit = lunid.regress {
  record = long,
  mass = 49,
  features = { lunid.polynomials({ y, v }, 3) },
  window = lunid.window(1, 7),
  solver = lunid.stlsq { threshold = 0.05 },
}
print(fit)

-- a Kalman smoother reaches over the ends of the blocks: its numbers are those of the whole record
local smooth = lunid.stream("../tests/data/spring_multisine.csv", { derivative = lunid.derivative.kalman {} })
print(smooth.channels.a.derivation)
print(lunid.regress { record = smooth, mass = 49, features = { y, v, y^3 } })

-- filters, trends, other rates and integrals go block by block too
local slow = long:detrend { degree = 1, channels = { "y" } }:filter { to = 120 }:decimate(2)
print(slow)
for _, step in ipairs(slow.history) do print("  " .. step) end

-- what needs all rows at once (a trajectory fit) takes a window that fits into memory
local part = lunid.read("../tests/data/spring_multisine.csv", { window = lunid.window(1, 3) })
print(lunid.fit_trajectory { model = fit.model, record = part, interpolation = "band_limited" })

-- How good is a model? One wrong model beside one right one: every measure says its mode, its data and its window; residual
-- tests tell that something is left, information and ranks where it is, and blocks of time how sure all that is.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local statistics = lunid.statistics

local truth = lunid.model { mass = 1, restoring = 2e4*y + 1e9*y^3 + 10*v }
local push = lunid.excitation.white_noise { rms = 60, seed = 5, dt = 1e-3, duration = 6 }
local record = lunid.simulate { model = truth, excitation = push }:record():with_noise { y = 0.01, v = 0.01, a = 0.01, seed = 1 }
local train, test = record:window(0, 4), record:window(4, 6)

local linear = lunid.regress { record = train, mass = 1, features = { y, v } }.model
local cubic = lunid.regress { record = train, mass = 1, features = { y, v, y^3 } }.model
for _, model in ipairs { linear, cubic } do
  print(lunid.compare { model = model, record = test, data = "test" })
  print(lunid.compare { model = model, record = test, data = "test", mode = "one_step" })
  print(lunid.compare { model = model, record = test, data = "test", mode = "equation_error" })
end

-- What does the force that the linear model leaves depend on? Most on y^3 and on y.
local left = lunid.compare { model = linear, record = train, mode = "equation_error" }.residual
print(lunid.rank_features { record = train, mass = 1, known = linear.restoring, features = { y, v, y^2, y*v, v^2, y^3, v^3 } })
print(statistics.whiteness(left))
print(statistics.cross_correlation(left, train:column "F"))
print(statistics.qq(left))
print(("Kolmogorov-Smirnov distance from a normal distribution %.3g, p = %.2g"):format(statistics.kolmogorov_smirnov(left)))
print(statistics.principal_components { { train:column "y", train:column "v", train:column "a" } })

-- How sure is the error of the better one's free run? Rows are coloured: blocks of them are drawn anew.
local free = lunid.simulate { model = cubic, excitation = test, from = "record" }:column "y"
print(statistics.interval { of = statistics.nrmse, columns = { test:column "y", free } })

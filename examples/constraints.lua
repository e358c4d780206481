-- What is known about an equation goes into its regression: signs, values, bounds, relations, choices, passivity. The record
-- is case 1 of the thesis with 5 % noise, whose bias plain least squares answers with terms that are not there.
local lunid = require "lunid"
local y, v, tanh = lunid.displacement, lunid.velocity, lunid.tanh

local record = lunid.thesis_record { system = lunid.systems.duffing {}, frequency = 20, seed = 1 }
local k1, k3 = lunid.coefficient(y), lunid.coefficient(y^3)

local function fit(title, given)
  given.record, given.mass = record, 1
  given.features = given.features or { lunid.polynomials({ y, v }, 3) }
  local found = lunid.regress(given)
  print(("\n%s (conditions met to %.1g)"):format(title, found.kkt))
  print(found)
  return found
end

fit("nothing is known", {})
fit("springs and dampers only, k1 between bounds, the damper weighed before", { constraints = {
  lunid.between(y, 1e4, 4e4), lunid.at_least(y^3, 0), lunid.fixed(v, 10) } })
fit("a relation: the force at 0.1 m is 3000 N", { features = { y, v, y^3 }, constraints = {
  lunid.at_least(0.1*k1 + 0.001*k3, 3000), lunid.at_most(0.1*k1 + 0.001*k3, 3000) } })
fit("the cubic term is at most fifty times the linear one", { features = { y, v, y^3 }, constraints = { lunid.at_most(k3, 50*k1) } })
fit("one kind of hardening", { features = { y, v, y^3, y^5, tanh(20*y) }, constraints = { lunid.one_of { y^3, y^5, tanh(20*y) } } })
local passive = fit("no energy is created", { constraints = { lunid.passive {} } })
print(("least power %.3g W"):format(passive.passivity.least_power))
fit("a part of the force is known", { known = 2e4*y, features = { v, y^3 }, bootstrap = 200 })
fit("the mean force counts", { objective = { mean_force = 0.25 }, solver = lunid.stlsq { threshold = 0.02 } })

-- Constraints against one another are named, with their lines.
local good, message = pcall(fit, "impossible", { constraints = { lunid.at_least(y, 3e4), lunid.at_most(y, 2e4) } })
print("\n" .. (good and "?" or message))

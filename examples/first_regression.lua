-- The restoring force F - m*a as a polynomial of y and v. The acceleration comes from a noisy displacement, so the
-- coefficients are a first guess; the last step refines them on the trajectory.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local record = lunid.read "../tests/data/spring_multisine.csv"

local fit = lunid.regress {
  record = record,
  mass = 49,
  features = { lunid.polynomials({ y, v }, 3) },
  constraints = { lunid.at_least(y, 0), lunid.at_least(v, 0) },
  window = lunid.window { from = 1, to = 7 },
  solver = lunid.stlsq { threshold = 0.05 },
}
print(fit)

local refined = lunid.fit_trajectory { model = fit.model, record = record, interpolation = "band_limited" }
print(refined)

-- lunid.fit_curve: what a fit tells, and its faults.
local lunid = require "lunid"
local spec = require "spec"

local x = lunid.channel "x"
local b1 = lunid.parameter { "b1", 500 }
local b2 = lunid.parameter { "b2", 1e-4 }

-- NIST StRD, Misra1a (Misra 1978): dental research, monomolecular adsorption; certified by NIST to 11 digits.
local misra = {
  x = { 77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0 },
  y = { 10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78 },
}
local saturation = b1*(1 - lunid.exp(-b2*x))

spec.case("a table of columns and its certified answer", function()
  local fit = lunid.fit_curve { data = misra, response = lunid.displacement, formula = saturation }
  assert(fit.converged and fit.rows == 14)
  spec.near(fit.parameters.b1.value, 238.94212918, 1e-6)
  spec.near(fit.parameters.b2.value, 5.5015643181e-4, 1e-12)
  spec.near(fit.parameters.b1.std, 2.7070075241, 1e-7)
  spec.near(fit.residual_std, 0.10187876330, 1e-9)
  spec.near(fit.correlation[1][1], 1, 1e-12)
  spec.contains(tostring(fit), "\n  b1 = 238.9421 +- 2.7\n")
  spec.near(fit.formula:at { x = 0 }, 0, 1e-12)
end)

spec.case("bounds and fixed values", function()
  local low = lunid.parameter { "b1", 200, max = 230 }
  local fit = lunid.fit_curve { data = misra, response = lunid.displacement, formula = low*(1 - lunid.exp(-b2*x)) }
  spec.equal(fit.parameters.b1.value, 230)
  assert(fit.parameters.b1.at_bound and fit.parameters.b1.std == nil)
  local held = lunid.parameter { "b1", 238.94212918, fixed = true }
  local other = lunid.fit_curve { data = misra, response = lunid.displacement, formula = held*(1 - lunid.exp(-b2*x)) }
  spec.equal(#other.parameters, 1)
  spec.near(other.parameters.b2.value, 5.5015643181e-4, 1e-11)
end)

spec.case("faults", function()
  local function fault(fields, message)
    spec.equal(spec.message_of(function() lunid.fit_curve(fields) end), message)
  end
  local y = lunid.displacement
  fault({ response = y, formula = saturation }, "fit_curve: expected either record or data")
  fault({ data = misra, response = y, formula = x }, "fit_curve: the formula has no parameter to fit")
  fault({ data = misra, response = y, formula = lunid.parameter { "b3" }*x },
    "fit_curve: parameter 'b3' has no first guess; give it one, or min and max")
  spec.contains(spec.message_of(function()
    lunid.fit_curve { data = { x = { 1, 2 }, y = { 1, 2, 3 } }, response = y, formula = b1*x }
  end), "data: record: channel 'y' has 3 rows, channel 'x' has 2")
  fault({ data = { x = { 1 }, y = { 1 } }, response = y, formula = saturation },
    "fit_curve: 1 rows for 2 parameters: expected at least as many rows")
  fault({ data = { x = { 0, 1, 2 }, y = { 1, 2, 3 } }, response = y, formula = b1*lunid.log(x) },
    "fit_curve: at the first guess the formula or a derivative of it is not finite in row 1 of data: choose another "
    .. "guess, or leave such rows out")
  fault({ data = misra, response = y, formula = b1*x, weight = -1 },
    "fit_curve: weight: expected >= 0, got -1 in row 1 of data")
end)

spec.clean()
spec.finish()

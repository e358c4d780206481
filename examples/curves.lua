-- The parameters of any formula of measured columns: Misra1a of NIST's StRD, and a spring with a soft stop from its record.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local b1, b2 = lunid.parameter { "b1", 500 }, lunid.parameter { "b2", 1e-4 }
local x = lunid.channel "x"
local fit = lunid.fit_curve { response = lunid.channel "z", formula = b1*(1 - lunid.exp(-b2*x)), data = {
  x = { 77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0 },
  z = { 10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78 } } }
print(fit)
print(("certified: b1 = 238.94212918 +- 2.7070075241, b2 = 5.5015643181e-04 +- 7.2668688436e-06"))

local truth = lunid.model { mass = 1, restoring = 5e3*y + 40*lunid.exp(2e3*(y - 3e-3)) + 8*v }
local record = lunid.simulate { model = truth,
  excitation = lunid.excitation.white_noise { rms = 15, seed = 3, dt = 1e-3, duration = 5 } }:record()
local k, c = lunid.parameter { "k", 3e3, min = 0 }, lunid.parameter { "c", 1, min = 0 }
local force, rate = lunid.parameter { "force", 10, min = 0 }, lunid.parameter { "rate", 500, min = 100, max = 1e4 }
print(lunid.fit_curve { record = record, response = lunid.force - lunid.acceleration,
  formula = k*y + c*v + force*lunid.exp(rate*(y - 3e-3)) })

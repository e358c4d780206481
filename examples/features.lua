-- The language of features: one record of a spring that hardens and yields with dry friction, and what different sets make of
-- its force. A set remembers its line; sets multiply; what is there twice or cannot be told apart is said.
local lunid = require "lunid"
local y, v, F = lunid.displacement, lunid.velocity, lunid.force

local truth = lunid.model { mass = 1, restoring = 8e3*y + 4*lunid.tanh(3e3*y) + 3*lunid.tanh(80*v) + 10*v }
local record = lunid.simulate { model = truth,
  excitation = lunid.excitation.white_noise { rms = 30, seed = 2, dt = 1e-3, duration = 6 } }:record()

local bump = lunid.lua_function { "bump", function(y) return y / (1 + (3e3*y)^2) end }
local sets = {
  { "powers up to 3", { lunid.polynomials({ y, v }, 3) } },
  { "odd powers up to 5", { lunid.polynomials({ y, v }, 5, { keep = "odd" }) } },
  { "each power up to 2", { lunid.polynomials({ y, v }, 2, { degree = "tensor" }) } },
  { "Chebyshev T over the data", { lunid.chebyshev({ y, v }, 3) } },
  { "Chebyshev U", { lunid.chebyshev({ y, v }, 3, "U") } },
  { "Fourier in y", { y, v, lunid.fourier(y, 3, 400) } },
  { "tanh of several slopes", { y, v, lunid.tanhs(y, { 1e3, 3e3 }), lunid.tanhs(v, { 20, 80 }) } },
  { "exponentials", { y, v, lunid.exponentials(y, { -500, 500 }) } },
  { "fractional powers", { y, v, lunid.powers(v, { 0.5 }), lunid.powers(y, { 0.5 }) } },
  { "pieces in y", { y, v, lunid.piecewise(y, { -5e-4, 5e-4 }) } },
  { "Gaussian bumps", { y, v, lunid.radial({ v }, 7) } },
  { "products of sets", { lunid.features { y, v, lunid.sign(v) } * lunid.polynomials({ y }, 2, true) } },
  { "a function in Lua", { y, v, bump(y) } },
  { "samples before (no model)", { y, v, lunid.lags(F, { 1 }), lunid.lags(y, { 1, 2 }) } },
}
print "set                          terms    rmse [N]   condition"
for _, set in ipairs(sets) do
  local fit = lunid.regress { record = record, mass = 1, features = set[2] }
  print(("%-28s %5d %11.4f %11.3g"):format(set[1], #fit.terms, fit.rmse, fit.condition))
end

-- A slope that is not known is searched for, with an exact gradient.
local slope = lunid.parameter { "slope", 20, min = 5, max = 300 }
local fit = lunid.regress { record = record, mass = 1, features = { y, v, lunid.tanhs(y, { 3e3 }), lunid.tanh(slope*v) },
  search = lunid.search { "mlsl", evaluations = 80 } }
print(fit)

-- What is there twice, and what is one on these data, is said with the lines.
local doubled = lunid.regress { record = record, mass = 1, features = { y, v, lunid.features { 2*y, y } } }
for _, warning in ipairs(doubled.warnings) do print(warning) end

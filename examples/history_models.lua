-- The next sample from samples before it: ARX and ARMAX of a linear oscillator, whose mass, damper and spring come back from
-- them, and NARX of a cubic one. Noise in the measured output biases ARX; past errors among the terms do away with most of it.
-- The zeros of such noise lie where the motion's poles are, all but on the unit circle: extended least squares does not get
-- quite there, and the residual tests say so.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local linear = lunid.model { mass = 2, restoring = 5e3*y + 6*v }
local push = lunid.excitation.white_noise { rms = 50, seed = 4, dt = 2e-3, duration = 20 }
local clean = lunid.simulate { model = linear, excitation = push, interpolation = "linear" }:record()
local train, test = clean:with_noise { y = 0.02, seed = 1 }:window(0, 14), clean:window(14, 20)

print(lunid.history_orders { record = train, outputs = 4, inputs = 4 })
local function fits(model)
  return ("fit of one step %.4g %%, of five %.4g %%, of a free run %.4g %%"):format(model:predict(test).fit,
    model:predict(test, 5).fit, model:free_run(test).fit)
end

for _, each in ipairs {
  { "ARX without noise", lunid.arx { record = clean:window(0, 14), outputs = 2, inputs = 3, delay = 0 } },
  { "ARX with noise", lunid.arx { record = train, outputs = 2, inputs = 3, delay = 0 } },
  { "ARMAX with noise", lunid.armax { record = train, outputs = 2, inputs = 3, delay = 0, noise = 2 } },
} do
  local name, model = each[1], each[2]
  print(("\n%s: %s"):format(name, fits(model)))
  print(model)
  for _, check in ipairs(model:residual_tests(train)) do
    print(("  %s: %d beyond +-%.3g, %s"):format(check.name, check.outside, check.bound, check.passed and "passed" or "failed"))
  end
  local found = model:equation()
  print(("  m = %.4g kg, c = %.4g N s/m, k = %.5g N/m"):format(found.mass, found.damping, found.stiffness))
end

local duffing = lunid.model { mass = 2, restoring = 5e3*y + 6*v + 2e7*y^3 }
local bent = lunid.simulate { model = duffing, excitation = push, interpolation = "linear" }:record()
local narx = lunid.narx { record = bent:window(0, 14), outputs = 2, inputs = 3, delay = 0,
  features = { lunid.channel "y_1", lunid.channel "y_2", lunid.channel "F_0", lunid.channel "F_1", lunid.channel "F_2",
    lunid.channel "y_1"^3 } }
local free = narx:free_run(bent:window(14, 20))
print(("free run of the cubic spring's own record: %.4g %%"):format(free.fit))
print(narx)
narx:save "narx.lua"

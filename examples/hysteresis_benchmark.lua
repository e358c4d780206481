-- The Bouc-Wen benchmark of Noel and Schoukens (2016): a loop that stiffens as it is loaded, beta + gamma < 0. In the words of
-- the catalogue: k = alpha, zy = 1/abs(beta*gamma + beta*delta), rho = beta*gamma*zy, second form. "Nature" stands for the
-- benchmark's system: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local alpha, beta, gamma, delta = 5e4, 1e3, 0.8, -1.1
local zy = 1 / math.abs(beta*gamma + beta*delta)
local loop = lunid.effects.bouc_wen { k = alpha, zy = zy, rho = beta*gamma*zy, n = 1, variant = 2 }
local nature = lunid.model { mass = 2, restoring = 10*v + 5e4*y + loop }

local function measure(excitation, seed)
  local run = lunid.simulate { model = nature, excitation = excitation }
    :record():with_noise { y = lunid.noise.gaussian { std = 8e-6 }, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local shaken = lunid.excitation.multisine { from = 5, to = 150, rms = 50, dt = 1/750, duration = 4, seed = 1 }
local swept = lunid.excitation.swept_sine { from = 20, to = 50, amplitude = 40, dt = 1/750, duration = 8 }
local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }

local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v },
  train = measure(shaken, 1), test = measure(swept, 2) }
print(found)
for _, each in ipairs(found.data.effects) do
  local p = each.parameters
  print(("%s: %s\n  k %.4g N/m (%.4g), zy %.4g mm (%.4g), rho %.4g (%.4g), n %.4g (1)"):format(each.name, each.formula, p.k.value,
    alpha, 1e3*p.zy.value, 1e3*zy, p.rho.value, beta*gamma*zy, p.n.value))
end

-- Two runs of one machine on different days: its spring is the same, its damping is not. Both records are fitted together,
-- in short free runs first and with a loss that outliers do not pull; a profile shows how well the cubic term is known.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local k = lunid.parameter { "k", 1.2e4, min = 0, unit = "N/m" }
local c = lunid.parameter { "c", 20, min = 0, unit = "N s/m" }
local k3 = lunid.parameter { "k3", 0, unit = "N/m^3" }
local model = lunid.model { mass = 1, restoring = k*y + c*v + k3*y^3 }

--- What the machine did, with 3 % noise and a few wild samples.
local function day(damping, seed)
  local push = lunid.excitation.multisine { from = 5, to = 60, rms = 60, period = 2, dt = 0.00125, duration = 4, seed = seed }
  local truth = model:with { k = 2e4, c = damping, k3 = 1e6 }
  return lunid.simulate { model = truth, excitation = push }:record()
    :with_noise { y = { lunid.noise.gaussian { relative = 0.03 }, lunid.noise.outliers { fraction = 0.005, relative = 5 } }, v = 0.03, seed = seed }
end

local fit = lunid.fit_trajectory {
  model = model,
  record = { day(10, 1), day(15, 2) },
  separate = { "c" },        -- each record has its own
  channels = { "y", "v" },
  loss = "huber",
  segment = 0.5,             -- free runs of half a second, each from a first state of its own
}
print(fit)
print(("SUNDIALS' runs differ from the fit's by %.0e of the motion"):format(fit.summary.checked))
print(("correlation of k and k3: %.2f"):format(fit.correlation[1][3]))

local profile = fit:profile "k3"
print(("k3 between %.4g and %.4g N/m^3 (95 %%)"):format(profile.low, profile.high))
lunid.figure.lines {
  title = "profile likelihood of the cubic term",
  series = { lunid.figure.series { profile.value, profile.drop, label = "drop of twice the log-likelihood" } },
  x = "k3 [N/m^3]",
  y = "drop [-]",
}:save "profile.png"

-- Models of past samples (thesis, section 1.9): ARX, ARMAX, NARX and NARMAX predict the displacement of case 1 from its own past and the
-- force. One step ahead all are good; run freely only what holds the physics is. The equation of motion of case 1 stands beside them.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "History: ARX, ARMAX, NARX and NARMAX" }
local system = lunid.systems.duffing {}
local push = lunid.excitation.multisine { from = 5, to = 40, rms = 150, period = 4, dt = 0.00125, duration = quick and 6 or 12, seed = seed }
local clean = lunid.simulate { model = system, excitation = push }:record()
local to = clean.duration - 2
local test = clean:window(to, clean.duration)

--- Past samples, the cube of the last one, which is what a cubic spring needs where little happens between samples, and others by name.
local function lagged(...)
  local list = { lunid.channel "y_1"^3 }
  for _, name in ipairs { "y_1", "y_2", "F_0", "F_1", "F_2", ... } do list[#list + 1] = lunid.channel(name) end
  return list
end

local rows, runs = {}, {}
for level, noise in ipairs { 0, 0.01, 0.05 } do
  local train = (noise > 0 and clean:with_noise { y = noise, v = noise, seed = 10*seed } or clean):window(0, to)
  local base = { record = train, outputs = 2, inputs = 3, delay = 0 }
  local function with(more)
    for name, value in pairs(base) do more[name] = value end
    return more
  end
  for _, each in ipairs {
    { "ARX", lunid.arx(with {}) },
    { "ARMAX", noise > 0 and lunid.armax(with { noise = 2 }) },
    { "NARX, cube of the last sample", lunid.narx(with { features = lagged() }) },
    { "NARMAX, cube of the last sample", noise > 0 and lunid.narmax(with { features = lagged("e_1", "e_2"), noise = 2 }) },
  } do
    local model = each[2]
    if model then
      local one, free = model:predict(test), model:free_run(test)
      local passed = 0
      for _, check in ipairs(model:residual_tests(train)) do passed = passed + (check.passed and 1 or 0) end
      rows[#rows + 1] = { 100*noise, each[1], one.fit, model:predict(test, 10).fit, free.fit, passed }
      runs[#runs + 1] = { model = each[1], noise = noise, one_step = one.fit, free_run = free.fit }
    end
  end
  local guess = lunid.model { mass = 1, restoring = lunid.parameter { "k", 1.8e4 }*y + lunid.parameter { "k3", 5e5 }*y^3 + lunid.parameter { "c", 8 }*v }
  local fit = lunid.fit_trajectory { model = guess, record = train, channels = { "y", "v" } }
  local free = 100*(1 - lunid.compare { model = fit.model, record = test }.nrmse)
  rows[#rows + 1] = { 100*noise, "equation of motion, on the trajectory", nil, nil, free }
  runs[#runs + 1] = { model = "equation", noise = noise, free_run = free }
  report:progress("noise levels", level, 3)
end
report:table { head = { "noise [%]", "model", "fit of one step [%]", "of ten steps [%]", "of a free run [%]", "residual tests passed" }, rows = rows,
  caption = "Fit on two seconds without noise after the training; 100: as measured, 0 and less: no better than the mean" }
report:text("Past samples in noise are regressors in noise: their coefficients are pulled towards one another, and poles that lie near the unit circle "
  .. "move. One step ahead hardly shows it. A fit on the trajectory has no noise among its regressors.")
report:results { case = "history", variant = "1.9", runs = runs }
report:save()

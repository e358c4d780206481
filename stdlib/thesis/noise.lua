-- Other noise than white and additive (thesis, section 2.7): coloured, multiplicative and Poisson noise of 5 % on case 1, outliers,
-- and what scaling by median and interquartile range would do. The truth is a + 2e4*y + 1e6*y^3 + 10*v = F.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Noise: coloured, multiplicative, Poisson" }
local system = lunid.systems.duffing {}
local noise = lunid.noise
local kinds = {
  { "white", noise.gaussian { relative = 0.05 } },
  { "pink, 1/f", noise.coloured { exponent = 1, relative = 0.05 } },
  { "autoregressive, 0.9", noise.coloured { ar = { 0.9 }, relative = 0.05 } },
  { "multiplicative", noise.multiplicative { std = 0.05 } },
  { "Poisson", noise.poisson { relative = 0.05 } },
  { "1 % outliers of 3 deviations", { noise.gaussian { relative = 0.02 }, noise.outliers { fraction = 0.01, relative = 3 } } },
}
local truth = { c_y = 2e4, c_y3 = 1e6, c_v = 10 }

local rows, runs = {}, {}
for i, kind in ipairs(kinds) do
  local clean = lunid.thesis_record { system = system, frequency = { 20, 30 }, noise = 0, seed = 10*seed }
  local train = {}
  for r, record in ipairs(clean) do
    train[r] = record:with_noise { y = kind[2], v = kind[2], seed = 10*seed + r }:derive { channels = { "a" }, from = "v", smooth = false }
  end
  local test = lunid.thesis_validation { system = system, from = clean[1] }
  local found = lunid.select { record = train, mass = 1, features = { lunid.polynomials({ y, v }, quick and 3 or 5) } }
  local robust = lunid.fit_trajectory { model = found.model, record = train, channels = { "y", "v" }, loss = "huber" }
  local board = lunid.scoreboard { record = train, test = test, truth = system, models = { { "Lunid", found.model } } }
  local run = board:result "Lunid"
  run.seed, run.equation, run.noise = seed, 1, kind[1]
  runs[#runs + 1] = run
  local function off(model, name)
    local row = model.parameters[name]
    return row and ("%.2f"):format(100*(row.value/truth[name] - 1)) or "missing"
  end
  rows[i] = { kind[1], found.terms, off(found.model, "c_y"), off(found.model, "c_y3"), off(found.model, "c_v"),
    off(robust.model, "c_y3"), run.free_run.nrmse, found.naive.terms or #found.naive.model.parameters }
  report:progress("kinds", i, #kinds)
end
report:table { head = { "noise", "terms", "k1 off [%]", "k3 off [%]", "c off [%]", "k3 by Huber [%]", "run error", "terms, usual" }, rows = rows,
  caption = "Case 1 under six kinds of noise in y and v; the truth has three terms" }

-- ---- scaling by the median and the interquartile range ----

local train = lunid.thesis_record { system = system, frequency = 20, seed = 10*seed }
local spread = {}
for i, name in ipairs { "y", "y^3", "y^5" } do
  local power = tonumber(name:match "%d$") or 1
  local values = train:column("y"):list()
  for r = 1, #values do values[r] = values[r]^power end
  local hit = { table.unpack(values) }
  for r = 1, #hit, 200 do hit[r] = 10*hit[r] end  -- half a per cent of gross errors
  local function scales(list)
    local sorted, sum, squares = { table.unpack(list) }, 0, 0
    table.sort(sorted)
    for _, x in ipairs(list) do sum, squares = sum + x, squares + x*x end
    local n = #list
    return math.sqrt(squares/n - (sum/n)^2), sorted[(3*n)//4] - sorted[n//4]
  end
  local deviation, quartiles = scales(values)
  local deviation_hit, quartiles_hit = scales(hit)
  spread[i] = { name, deviation_hit/deviation, quartiles_hit/quartiles }
end
report:table { head = { "feature", "deviation grows by", "interquartile range grows by" }, rows = spread,
  caption = "Scaling of features where one row in 200 is ten times too large: the thesis suggests the interquartile range. Lunid's "
    .. "solvers scale by the size over the data; outliers are met by the loss (huber), not by the scale" }
report:results { case = "noise", variant = "2.7", runs = runs }
report:save()

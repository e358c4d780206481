-- Case 1 of the thesis by its noisy protocol: which of 20 terms does the equation hold? The choice by free runs, beside
-- the usual pipeline of central differences and thresholded least squares. Then case 3.2: the tanh and its slope.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local truth = { ["y"] = 2e4, ["v"] = 10, ["y^3"] = 1e6 }

local function error_of(model, name)
  local row = model.parameters["c_" .. name:gsub("%^", "")]
  return row and ("%8.2f"):format(100*(row.value / truth[name] - 1)) or " missing"
end

local function count_false(model)
  local count = 0
  for _, row in ipairs(model.parameters) do
    if row.name ~= "c_y" and row.name ~= "c_v" and row.name ~= "c_y3" then count = count + 1 end
  end
  return count
end

local function row_of(title, noise, seed, model, gap)
  print(("%-12s %5.0f %% %5d %6d %s %s %s   %s"):format(title, 100*noise, seed, count_false(model), error_of(model, "y"),
    error_of(model, "y^3"), error_of(model, "v"), gap and ("%.3g"):format(gap) or "runs away"))
end

local seeds = lunid.option { "seeds", 5 }
local duffing = lunid.systems.duffing {}
print "             noise  seed  false   k1 [%]   k3 [%]    c [%]   test gap"
for _, noise in ipairs { 0.05, 0.01, 0 } do
  for seed = 1, noise > 0 and seeds or 1 do
    local train = lunid.thesis_record { system = duffing, frequency = { 20, 30 }, noise = noise, seed = 10*seed }
    local test = lunid.thesis_validation { system = duffing, from = train[1] }
    local found = lunid.select { record = train, test = test, mass = 1, features = { lunid.polynomials({ y, v }, 5) } }
    row_of("free runs", noise, seed, found.model, found.test_gap)
    row_of("naive", noise, seed, found.naive.model, found.naive.test_gap)
  end
end

-- Case 3.2: a tanh with an unknown slope p among polynomials. The truth is 3000*tanh(80*y) + 10*v.
local p = lunid.parameter { "p", 50, min = 5, max = 300 }
local tanh_yield = lunid.systems.tanh_yield {}
local train = lunid.thesis_record { system = tanh_yield, frequency = { 20, 30 }, seed = 10 }
local found = lunid.select { record = train, mass = 1, features = { lunid.polynomials({ y, v }, 3), lunid.tanh(p*y) },
  search = lunid.search { starts = 2 }, most_terms = 4,
  test = lunid.thesis_validation { system = tanh_yield, from = train[1] } }

local function slope_of(title, model, gap)
  local false_terms = #model.parameters - 3  -- less p and the coefficients of the tanh and of v
  local force, slope = model.parameters.c_tanh_p_y, model.parameters.p
  print(("%-12s %6d  %9s %9s   %s"):format(title, false_terms, force and ("%.2f"):format(force.value) or "missing",
    slope and ("%.3f"):format(slope.value) or "missing", gap and ("%.3g"):format(gap) or "runs away"))
end

print "\ncase 3.2       false  e1 (3000)    p (80)   test gap"
slope_of("free runs", found.model, found.test_gap)
slope_of("naive", found.naive.model, found.naive.test_gap)

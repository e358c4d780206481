-- Case 4 (thesis, appendix J): two masses in a row, one of the springs cubic. Each equation is identified from a library of the
-- displacements y1, y2 - y1 and their rates; then both together on the trajectory, where what is not significant goes.
-- Appendix J drops a minus: the internal force of the second mass is that of the first link with the sign turned.
local lunid = require "lunid"
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }
local y1, y2 = lunid.displacements(2)
local v1, v2 = lunid.velocities(2)
local a1, a2 = lunid.accelerations(2)

local report = lunid.report { title = "Case 4: two masses, one cubic spring" }
local system = lunid.systems.chain { cubic = 1e6, cubic_at = 1 }
local d, w = y2 - y1, v2 - v1  -- the link between the masses

--- What each equation may hold: powers of the elongation to the ground and of the link to the third order, and their rates.
local function library(position, rate) return { position, position^2, position^3, rate, d, d^2, d^3, w } end
local libraries = { library(y1, v1), library(y2, v2) }
local truth = {
  { ["y1"] = 2e4, ["y1^3"] = 1e6, ["v1"] = 10, ["y2 - y1"] = -2e4, ["v2 - v1"] = -10 },
  { ["y2 - y1"] = 2e4, ["v2 - v1"] = 10 },
}

local function records(number)
  local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, seed = 10*number, from = { 0, 0, 0, 0 } }
  local first = {}
  for i, channel in ipairs { "y1", "v1", "y2", "v2" } do first[i] = train[1]:column(channel)[1] end
  return train, lunid.thesis_validation { system = system, from = first }
end

--- Terms { feature, first guess } of one equation: least squares of F - m*a over its library.
local function first_guess(train, number)
  local force, acceleration = lunid.channel("F" .. number), number == 1 and a1 or a2
  local sum = 0
  for k, feature in ipairs(libraries[number]) do sum = sum + lunid.parameter { "b" .. k, 0 } * feature end
  local fit = lunid.fit_curve { record = train, response = force - acceleration, formula = sum }
  local terms = {}
  for k, feature in ipairs(libraries[number]) do terms[k] = { feature, fit.parameters["b" .. k].value, k } end
  return terms
end

--- The model of both equations from lists of terms.
local function model_of(equations)
  local forces = {}
  for i, terms in ipairs(equations) do
    forces[i] = 0
    for _, term in ipairs(terms) do
      forces[i] = forces[i] + lunid.parameter { ("b%d_%d"):format(i, term[3]), term[2] } * term[1]
    end
  end
  return lunid.model { mass = { 1, 1 }, restoring = forces, forces = { 1, 2 } }
end

--- Fits both equations on the trajectory and drops the weakest term until all are beyond four deviations.
local function identified(train)
  local equations = { first_guess(train, 1), first_guess(train, 2) }
  while true do
    local fit = lunid.fit_trajectory { model = model_of(equations), record = train, channels = { "y1", "v1", "y2", "v2" } }
    local weakest, size = nil, 4
    for i, terms in ipairs(equations) do
      for k, term in ipairs(terms) do
        local row = fit.model.parameters[("b%d_%d"):format(i, term[3])]
        term[2], term.std = row.value, row.std
        local ratio = row.std and row.std > 0 and math.abs(row.value)/row.std or 0
        if ratio < size then weakest, size = { i, k }, ratio end
      end
    end
    if not weakest then return equations, fit end
    table.remove(equations[weakest[1]], weakest[2])
  end
end

local runs, rows, boards = {}, {}, {}
for number = seed, seed + (quick and 1 or 4) do
  local train, test = records(number)
  local equations, fit = identified(train)
  boards[#boards + 1] = lunid.scoreboard { record = train, test = test, models = { { "Lunid", fit.model }, { "truth", system } }, channel = "y1" }
  local second = lunid.scoreboard { record = train, test = test, models = { { "Lunid", fit.model } }, channel = "y2" }
  for i, terms in ipairs(equations) do
    local said = {}
    for _, term in ipairs(terms) do
      local name = tostring(term[1])
      local true_value = truth[i][name] or 0
      said[name] = { value = term[2], std = term.std, truth = true_value }
      rows[#rows + 1] = { number, i, name, ("%.5g +- %.2g"):format(term[2], term.std), true_value,
        true_value ~= 0 and ("%.2f"):format(100*(term[2]/true_value - 1)) or "false" }
    end
    for name, value in pairs(truth[i]) do said[name] = said[name] or { value = 0, truth = value, reason = "not in the model" } end
    runs[#runs + 1] = { seed = number, equation = i, terms = said,
      free_run = (i == 1 and boards[#boards] or second):result("Lunid").free_run }
  end
  report:progress("seeds", #boards, quick and 2 or 5)
end
report:table { head = { "seed", "equation", "term", "Lunid", "truth", "off [%]" }, rows = rows,
  caption = "Both equations; forces per kg. y2 - y1 is the elongation of the link" }
report:table(boards[1]:measures())
for _, each in ipairs(boards[1]:figures()) do report:figure(each.name, each.figure, each.caption) end
report:results { case = "case4", variant = "4", runs = runs }
report:save()

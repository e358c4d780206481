-- What the questions share: records of a system by the thesis' protocol, models chosen from them, and what there is to say of a model.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local asked = {}
asked.quick = lunid.option { "quick", false }
asked.seed = lunid.option { "seed", 1 }
asked.duffing = lunid.systems.duffing {}
asked.library = lunid.polynomials({ y, v }, asked.quick and 3 or 5)
asked.truth = { c_y = 2e4, c_y3 = 1e6, c_v = 10 }  -- of the Duffing oscillator, by the names of the library

--- Training records of a system { frequency, amplitude, noise }, and the validation record.
function asked.records(system, given)
  local train = lunid.thesis_record { system = system, frequency = given.frequency or { 20, 30 }, amplitude = given.amplitude or 2000,
    noise = given.noise or 0.05, seed = 10*asked.seed }
  return train, lunid.thesis_validation { system = system, from = type(train) == "table" and train[1] or train }
end

--- The answer by free runs and the trajectory, from features or the library.
function asked.chosen(train, features)
  return lunid.select { record = train, mass = 1, features = features or { asked.library }, most_terms = 5 }
end

--- Error of the free run on a record, over the deviation of the motion.
function asked.run_error(model, test) return lunid.compare { model = model, record = test, lags = 1 }.nrmse end

--- False and missing terms, and the largest error of the true ones in per cent.
function asked.verdict(model, truth)
  local seen, wrong, worst, all = 0, 0, 0, 0
  for _, row in ipairs(model.parameters) do
    local value = truth[row.name]
    if value then
      seen, worst = seen + 1, math.max(worst, math.abs(row.value/value - 1)*100)
    elseif math.abs(row.value) > 0 and not row.fixed then
      wrong = wrong + 1
    end
  end
  for _ in pairs(truth) do all = all + 1 end
  return ("%d false, %d missing"):format(wrong, all - seen), worst
end

return asked

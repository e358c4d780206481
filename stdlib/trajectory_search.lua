-- The search for a model on the trajectory: the best candidates of each size are fitted there, thinned by what is not
-- significant, and grown and changed by one feature while that lowers the criterion.
local candidates = require "lunid.candidates"
local core = require "lunid.core"

local search = {}

local key_of, model_of, without = candidates.key_of, candidates.model_of, candidates.without

--- Free run over records; gap, or the reason for which it ended.
local function judge(candidate, list)
  local run = core.judge(candidate.model, list)
  if not run.gap then return nil, ("free run stopped at t = %.4g s: %s"):format(run.stopped_at, run.cause) end
  return run.gap
end

local function reject(candidate, reason)
  candidate.rejected = reason
  return nil
end

--- log of the number of ways to choose k of n.
local function log_choices(n, k)
  local sum = 0
  for i = 1, k do sum = sum + math.log((n - k + i) / i) end
  return sum
end

--- Schwarz's criterion, extended by the number of models of this size that the library holds (Chen & Chen 2008).
--- `share`: of the rows that count as independent.
local function criterion(candidate, library, share)
  local terms, rows = #candidate.model.parameters, candidate.rows
  return share*rows*math.log(candidate.cost / rows) + terms*math.log(math.max(share*rows, 2))
    + 2*log_choices(math.max(library, terms), terms)
end

--- Fits a candidate on the trajectory; a new candidate, or nil. `told`: its deviations will be, and count the noise of
--- the force too, at the cost of 24 runs.
local function refined(candidate, given, list, iterations, told)
  local good, fit = pcall(core.fit_trajectory, candidate.model, list,
    { channels = given.channels, max_iterations = iterations or given.iterations, force_noise = told })
  if not good then
    if tostring(fit):match "interrupted" then error(fit, 0) end
    return reject(candidate, "no trajectory fit: " .. tostring(fit))
  end
  if not (fit.summary.cost < math.huge) then return reject(candidate, "no trajectory fit: " .. fit.summary.stopped) end
  local new = { terms = candidate.terms, features = candidate.features, model = fit.model, r2 = candidate.r2, fit = fit,
    from = candidate.from, cost = fit.summary.cost, rows = fit.summary.rows }
  new.criterion = criterion(new, #given.features, 1)
  return new
end

--- The candidate without the term that its trajectory needs least: least coefficient over its standard deviation.
local function thinned(candidate, given)
  local least, index = math.huge, nil
  for i = 1, candidate.terms do
    local parameter = candidate.model.parameters[i]
    local size = parameter.std and parameter.std > 0 and math.abs(parameter.value) / parameter.std or 0
    if size < least then least, index = size, i end
  end
  local values = {}
  for i = 1, candidate.terms do values[i] = candidate.model.parameters[i].value end
  local features = without(candidate.features, index)
  return { terms = candidate.terms - 1, features = features, r2 = candidate.r2,
    from = candidate.from .. ", thinned on the trajectory", model = model_of(given, features, without(values, index)) }
end

--- The best three stable candidates of each size, fitted on the trajectory.
local function best_of_each_size(pool, given, train, known)
  local fitted = {}
  for terms = 1, given.most_terms do
    local stable = {}
    for _, candidate in ipairs(pool) do
      if candidate.terms == terms then
        local reason
        candidate.gap, reason = judge(candidate, train)
        if candidate.gap then stable[#stable + 1] = candidate else reject(candidate, reason) end
      end
    end
    table.sort(stable, function(a, b) return a.gap < b.gap end)
    local seen, count = {}, 0
    for _, candidate in ipairs(stable) do
      local key = key_of(candidate.features)
      if not seen[key] and count < 3 then
        count = count + 1
        fitted[#fitted + 1] = refined(candidate, given, train)
      end
      seen[key], known[key] = true, true
    end
  end
  return fitted
end

--- Takes term after term away from a fit, on the trajectory.
local function thin_out(candidate, fitted, given, train, known)
  while candidate and candidate.terms > 1 do
    local smaller = thinned(candidate, given)
    local key = key_of(smaller.features)
    if known[key] then return end
    known[key] = true
    candidate = refined(smaller, given, train)
    fitted[#fitted + 1] = candidate
  end
end

local screening = 4  -- iterations of a fit that only ranks a feature

--- The best of `base` with one feature more, where its criterion is below that of `best`; else `best`.
local function with_one_more(base, best, given, train, known, how)
  local there, values = {}, {}
  for i, feature in ipairs(base.features) do
    there[tostring(feature)], values[i] = true, base.model.parameters[i].value
  end
  values[#values + 1] = 0
  for _, feature in ipairs(given.features) do
    local features = { table.unpack(base.features) }
    features[#features + 1] = feature
    local key = key_of(features)
    if not there[tostring(feature)] and not known[key] then
      known[key] = true
      local larger = refined({ terms = #features, features = features, r2 = base.r2, from = base.from .. how,
        model = model_of(given, features, values) }, given, train, screening)
      if larger and larger.criterion < best.criterion then best = larger end
    end
  end
  return best
end

--- What a step has found, fitted to the end and listed; nil where it found nothing better than where it came from.
local function settled(best, candidate, fitted, given, train)
  if best == candidate then return nil end
  best = refined(best, given, train)
  fitted[#fitted + 1] = best
  return best
end

--- The candidate with the one more feature that lowers the criterion most; nil where none does.
local function grown(candidate, fitted, given, train, known)
  local best = with_one_more(candidate, candidate, given, train, known, ", grown on the trajectory")
  return settled(best, candidate, fitted, given, train)
end

--- Places of a candidate's terms, those first that its trajectory needs least.
local function weakest(candidate)
  local places, sizes = {}, {}
  for i = 1, candidate.terms do
    local parameter = candidate.model.parameters[i]
    places[i], sizes[i] = i, parameter.std and parameter.std > 0 and math.abs(parameter.value) / parameter.std or 0
  end
  table.sort(places, function(a, b) return sizes[a] < sizes[b] or sizes[a] == sizes[b] and a < b end)
  return places
end

--- The candidate with one of its three weakest features exchanged for another, where that lowers the criterion; else nil.
local function exchanged(candidate, fitted, given, train, known)
  local best = candidate
  for _, i in ipairs { table.unpack(weakest(candidate), 1, 3) } do
    local values = {}
    for k = 1, candidate.terms do values[k] = candidate.model.parameters[k].value end
    local features = without(candidate.features, i)
    local base = { terms = candidate.terms - 1, features = features, r2 = candidate.r2, from = candidate.from,
      model = model_of(given, features, without(values, i)) }
    best = with_one_more(base, best, given, train, known, ", exchanged on the trajectory")
  end
  return settled(best, candidate, fitted, given, train)
end

local function least_criterion(list)
  table.sort(list, function(a, b) return a.criterion < b.criterion end)
  return list[1]
end

--- Thins the best fits, grows the best of what is left and exchanges its features, until nothing helps.
local function search_on_trajectory(fitted, given, train, known)
  least_criterion(fitted)
  for _, start in ipairs { table.unpack(fitted, 1, math.min(3, #fitted)) } do
    thin_out(start, fitted, given, train, known)
  end
  for _ = 1, 4 do
    local best = least_criterion(fitted)
    if not best then return end
    local other = best.terms < given.most_terms and grown(best, fitted, given, train, known)
      or best.terms > 1 and exchanged(best, fitted, given, train, known)
    if not other then return end
    thin_out(other, fitted, given, train, known)
  end
end

search.judge = judge
search.reject = reject
search.criterion = criterion
search.refined = refined
search.best_of_each_size = best_of_each_size
search.least_criterion = least_criterion
search.on_trajectory = search_on_trajectory

return search

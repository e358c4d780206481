-- Candidates for the choice of a model: regressions of a library of features, on smoothed motions and on the weak form,
-- with ever fewer terms.
local core = require "lunid.core"
local schema = require "lunid.schema"

local candidates = {}

--- Half widths of the smoothing filters in samples, from a twelfth of a period of the motion down.
local function half_widths(list)
  local crossings, rows = 0, 0
  for _, each in ipairs(list) do
    local y = each:column "y"
    local mean, before = y:mean(), nil
    for i = 1, #y do
      local above = y[i] > mean
      if before ~= nil and above ~= before then crossings = crossings + 1 end
      before = above
    end
    rows = rows + #y
  end
  local period = 2*rows / math.max(crossings, 1)
  local widths, seen = {}, {}
  for _, part in ipairs { 1/2, 1/3, 1/4, 1/6, 1/10 } do
    local half = math.max(2, math.floor(part*period/2 + 0.5))
    if not seen[half] then widths[#widths + 1] = half end
    seen[half] = true
  end
  return widths
end

--- Motions through cubics over 2*half + 1 samples, without the one-sided ends; half = 0: as they are, with central
--- differences for what was not measured.
local function smoothed(list, half)
  local out, cut = {}, math.max(half, 1)
  local how = half > 0 and { method = { kind = "savitzky_golay", rows = 2*half + 1, order = 3 }, channels = { "y", "v", "a" },
    smooth = true } or { method = { kind = "finite_differences", accuracy = 2, step = 1 } }
  for i, each in ipairs(list) do
    if each.rows < 2*cut + 7 then schema.fail("select", each.name .. " is too short to be smoothed") end
    local motion = core.derive_record(each, how)
    out[i] = motion:window(each.start + cut*each.dt, each.start + each.duration - cut*each.dt)
  end
  return out
end

--- The term of a fit whose loss raises the residual least: the least value over standard deviation.
local function weakest(fit, features)
  local least, index = math.huge, nil
  for i = 1, #features do
    local term = fit.terms[i]
    local size = term.std and term.std > 0 and math.abs(term.value or 0) / term.std or 0
    if size < least then least, index = size, i end
  end
  return index
end

local function without(list, index)
  local out = {}
  for i, entry in ipairs(list) do
    if i ~= index then out[#out + 1] = entry end
  end
  return out
end

local function key_of(features)
  local names = {}
  for i, feature in ipairs(features) do names[i] = tostring(feature) end
  table.sort(names)
  return table.concat(names, ", ")
end

--- "c_y3", "c_y_v2": a name for a feature's coefficient, as regressions have it.
local function coefficient_name(feature)
  local name = "c_" .. tostring(feature):gsub("[%^ ]", ""):gsub("[^%w_]+", "_")
  return (name:gsub("_+$", ""))
end

--- mass*a + known + sum of value*feature = F.
local function model_of(given, features, values)
  local restoring = given.known or 0
  for i, feature in ipairs(features) do
    restoring = restoring + core.parameter { name = coefficient_name(feature), value = values[i], place = "" } * feature
  end
  return core.model { mass = { given.mass }, restoring = { restoring }, states = {} }
end

local function add(pool, given, candidate)
  local key = key_of(candidate.features)
  if #candidate.features > given.most_terms or pool.known[key .. candidate.from] then return end
  pool.known[key .. candidate.from] = true
  candidate.terms = #candidate.features
  pool[#pool + 1] = candidate
end

--- Regressions with ever fewer terms; those with at most given.most_terms are candidates.
local function add_path(pool, given, motion, form, from, strong)
  local features = given.features
  while #features > 0 do
    local fit = core.regress(motion, { mass = given.mass, known = given.known, features = features, blocks = 1,
      search = given.search, form = form })
    add(pool, given, { features = features, model = fit.model, r2 = fit.r2, strong = strong, rows = motion[1].rows*#motion,
      from = from })
    features = without(features, weakest(fit, features))
  end
end

--- On motions of one width.
local function add_strong(pool, given, train, half)
  add_path(pool, given, smoothed(train, half), nil, ("motion smoothed over %d samples"):format(2*half + 1), half)
end

--- On the weak form, which takes no derivative of the data, where the records hold some test functions. A narrow filter
--- comes first, since noise biases the powers of y and v.
local function add_weak(pool, given, train, half)
  for _, each in ipairs(train) do
    if each.rows < 6*(2*half + 1) then return end
  end
  local form = { half_width = half*train[1].dt, order = 4, spacing = 0.25 }
  add_path(pool, given, smoothed(train, 3), form, ("weak form over %d samples"):format(2*half + 1))
end

--- The weak form needs a mass that is a number and features without parameters inside.
local function is_linear(given)
  if type(given.mass) ~= "number" then return false end
  for _, feature in ipairs(given.features) do
    for _, symbol in ipairs(core.is_expression(feature) and feature:symbols() or {}) do
      if symbol.kind == "parameter" then return false end
    end
  end
  return true
end

candidates.half_widths = half_widths
candidates.smoothed = smoothed
candidates.without = without
candidates.key_of = key_of
candidates.model_of = model_of
candidates.add_strong = add_strong
candidates.add_weak = add_weak
candidates.is_linear = is_linear

return candidates

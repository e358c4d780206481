-- An entry that stands more than once at a place: two masses that are not measured, stops on either side with gaps of
-- their own. Records by Runge and Kutta's method, m = k = 1 but for scales.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local k, c = lunid.parameter { "k", min = 0 }, lunid.parameter { "c", min = 0 }
local spacing, finer = 2 * math.pi / 28, 10

--- Twenty lines from 0.2 to 2.5 times the natural frequency, phases by a rule.
local function force_at(tau, seed)
  local sum = 0
  for i = 1, 20 do sum = sum + math.cos((0.2 + 0.121 * (i - 1)) * tau + (seed * i * i) % 6.28) end
  return 0.25 * sum
end

--- Displacements of x1'' + 0.04 x1' + x1 + force = u, where force, rates = others(x): x1, x1' and further states.
local function motion(others, states, rows, seed)
  local h, x, out = spacing / finer, {}, {}
  for j = 1, 2 + states do x[j] = 0 end
  local function slopes(tau, at)
    local force, further = others(at)
    local d = { at[2], force_at(tau, seed) - 0.04 * at[2] - at[1] - force }
    for j = 1, states do d[2 + j] = further[j] end
    return d
  end
  for i = 0, rows * finer - 1 do
    if i % finer == 0 then out[#out + 1] = x[1] end
    x = spec.runge_kutta(slopes, i * h, x, h)
  end
  return out
end

--- In units of mass, omega and length, with 40 dB of noise.
local function record(truth, seed)
  local ys, fs = motion(truth.others, truth.states or 0, truth.rows, seed), {}
  for i = 1, #ys do
    fs[i] = force_at((i - 1) * spacing, seed) * truth.mass * truth.omega ^ 2 * truth.length
    ys[i] = ys[i] * truth.length
  end
  return lunid.record({ channels = { { "F", fs }, { "y", ys } }, dt = spacing / truth.omega })
    :with_noise { y = lunid.noise.gaussian { relative = 0.01 }, seed = seed }
end

local function discover(truth, restoring, catalogue)
  return lunid.discover { model = lunid.model { mass = truth.mass, restoring = restoring },
    train = record(truth, 1), test = record(truth, 2), catalogue = catalogue }
end

local function within(got, expected, part) spec.near(got, expected, part * expected) end

--- Two masses on springs of their own.
local modes = { mass = 40, omega = 130, length = 2e-3, rows = 1800, states = 4, others = function(x)
  local first = 0.18 * (x[1] - x[3]) + 0.01 * (x[2] - x[4])
  local second = 0.40 * (x[1] - x[5]) + 0.012 * (x[2] - x[6])
  return first + second, { x[4], first / 0.10, x[6], second / 0.08 }
end }
local around = { "hidden_mode", "soil_plug", "added_mass", "maxwell_relaxation", "cubic_stiffness" }

spec.case("two masses that are not measured are two hidden modes, each with its own names", function()
  local found = discover(modes, k*y + c*v, around)
  spec.equal(spec.names_of(found), "hidden_mode hidden_mode")
  spec.equal(found.verdict, "explained")
  spec.contains(found.sentence, "hidden_mode (twice)")
  local masses = {}
  for _, each in ipairs(found.effects) do masses[#masses + 1] = each.parameters.mh.value end
  table.sort(masses)
  within(masses[1], 0.08 * modes.mass, 0.03)
  within(masses[2], 0.10 * modes.mass, 0.03)
  spec.contains(tostring(found), "hidden_mode_kh_b*(y - hidden_mode_x_b)")
  assert(found.data.final.gap_test < 1.2 * found.data.noise_floor.gap_test)
end)

spec.case("a mode that the baseline has already is no reason against a second", function()
  local known = lunid.effects.hidden_mode { mh = 4, kh = 1.2e5, ch = 50 }
  local found = discover(modes, k*y + c*v + known, around)
  spec.equal(spec.names_of(found), "hidden_mode")
  spec.contains(tostring(found), "hidden_mode_kh_b*(y - hidden_mode_x_b)")
end)

--- Stops with gaps of their own on either side.
local stops = { mass = 0.3, omega = 2e3, length = 2e-5, rows = 2200, others = function(x)
  return 1.5 * math.max(x[1] - 0.5, 0) + math.min(x[1] + 0.85, 0)
end }

spec.case("stops on either side with gaps of their own are two stops", function()
  local found = discover(stops, k*y + c*v, { "one_sided_stop", "clearance", "cubic_stiffness", "quadratic_stiffness",
    "constant_force" })
  spec.equal(spec.names_of(found), "one_sided_stop one_sided_stop")
  local gaps = {}
  for _, each in ipairs(found.effects) do gaps[each.formula] = each.parameters.g.value end
  within(gaps["k*max(y - g, 0)"], 0.5 * stops.length, 0.02)
  within(gaps["k*min(y + g, 0)"], 0.85 * stops.length, 0.02)
end)

spec.case("one stop is one", function()
  local one = setmetatable({ others = function(x) return 1.5 * math.max(x[1] - 0.5, 0) end }, { __index = stops })
  spec.equal(spec.names_of(discover(one, k*y + c*v, { "one_sided_stop", "clearance", "quadratic_stiffness" })), "one_sided_stop")
end)

spec.case("rank takes a set in which an entry that repeats stands twice, and no other", function()
  local ask = { model = lunid.model { mass = modes.mass, restoring = k*y + c*v }, record = record(modes, 1),
    sets = { "hidden_mode", { "hidden_mode", "hidden_mode" } } }
  local rows = lunid.rank(ask)
  spec.equal(rows[1].name, "hidden_mode + hidden_mode")
  ask.sets = { { "cubic_stiffness", "cubic_stiffness" } }
  spec.equal(spec.message_of(function() lunid.rank(ask) end),
    "rank: sets: 'cubic_stiffness' stands in a set more often than its entry repeats")
end)

spec.finish()

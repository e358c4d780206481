-- The systems of the thesis (table 2.1, sections 2.3 to 2.7, chapter 3) by name: models whose parameters are known.
-- Defaults are the thesis' where it gives them; where they were in a figure that is lost, one that shows the same effect
-- was chosen, and its help says so.
local schema = require "lunid.schema"
local symbols = require "lunid.symbols"
local models = require "lunid.models"
local types = schema.types

local y, v = symbols.displacement, symbols.velocity
local abs, less, max, tanh, where = symbols.abs, symbols.less, symbols.max, symbols.tanh, symbols.where

local systems = {}

--- A field that becomes a parameter of the model, known at its value.
local function known(name, default, unit, help, range)
  return { name, types.number(range or {}), default = default, unit = unit, help = help, known = true }
end

local function mass(default) return { "mass", types.number { above = 0 }, default = default or 1, unit = "kg",
  help = "parameter m of the model, fixed" } end

--- Declares lunid.systems.<name>. build(p, given) returns the restoring force, and the mass where it is no constant, or a
--- whole model; p holds the fields as parameters.
local function define(definition, build)
  local name = definition.name
  definition.name, definition.returns = "systems." .. name, "model"
  if definition.mass ~= false then table.insert(definition.fields, 1, mass(definition.mass)) end
  systems[name] = schema.define(definition, function(given)
    local p = { m = given.mass and symbols.parameter { "m", given.mass, unit = "kg", fixed = true } }
    for _, field in ipairs(definition.fields) do
      if field.known then p[field.name] = symbols.parameter { field.name, given[field.name], unit = field.unit } end
    end
    local restoring, inertia = build(p, given)
    if getmetatable(restoring) == "lunid.model" then return restoring end
    return models.model { mass = inertia or p.m, restoring = restoring }
  end)
end

local k = known("k", 2e4, "N/m", "linear stiffness (case 1)")
local c = known("c", 10, "N s/m", "viscous damping")

define({
  name = "linear",
  help = "Mass, spring and dashpot: m*a + k*y + c*v = F.",
  fields = { k, c },
  example = [[local model = lunid.systems.linear { k = 2e4, c = 10 }]],
}, function(p) return p.k*y + p.c*v end)

define({
  name = "duffing",
  help = "A spring that hardens: m*a + k*y + k3*y^3 + c*v = F. The defaults are case 1.",
  fields = { k, known("k3", 1e6, "N/m^3", "cubic stiffness"), c },
  example = [[local model = lunid.systems.duffing { k = 2e4, k3 = 1e6, c = 10, mass = 1 }]],
}, function(p) return p.k*y + p.k3*y^3 + p.c*v end)

define({
  name = "softening_duffing",
  help = "The destabilising Duffing oscillator: m*a + k*y - k3*y^3 + c*v = F. It runs away beyond y = sqrt(k/k3).",
  fields = { k, known("k3", 1e4, "N/m^3", "cubic softening; chosen to show at 20 Hz: the figure is lost"), c },
  example = [[local model = lunid.systems.softening_duffing {}]],
}, function(p) return p.k*y - p.k3*y^3 + p.c*v end)

define({
  name = "modified_duffing",
  help = "Case 2: m*a + k*y + k3*y^3 + k5*y^5 + e*y^3*v^n + c*v = F. Most of the terms lie near the noise.",
  fields = {
    known("k", 1e4, "N/m", "linear stiffness"),
    known("k3", 1e5, "N/m^3", "cubic stiffness"),
    known("k5", 5e6, "N/m^5", "stiffness of fifth order"),
    known("e", 2000, "", "of y^3*v^n"),
    c,
    { "velocity_power", types.integer { min = 2, max = 3 }, default = 2,
      help = "n: 2 as in the results of section 2.4; 3 as printed in table 2.1, which runs away at 20 Hz unless e is small" },
  },
  example = [[local model = lunid.systems.modified_duffing { velocity_power = 2 }]],
}, function(p, given)
  return p.k*y + p.k3*y^3 + p.k5*y^5 + p.e*y^3*v^given.velocity_power + p.c*v
end)

define({
  name = "tanh_yield",
  help = "Case 3: a spring that yields smoothly, m*a + c*v + e1*tanh(e2*y) = F.",
  fields = {
    known("e1", 3000, "N", "force at full yield; chosen so that the motion reaches it and e2 can be seen"),
    known("e2", 80, "1/m", "1/e2 is where it yields; chosen near the 84.9 that the thesis found"),
    c,
  },
  example = [[local model = lunid.systems.tanh_yield {}]],
}, function(p) return p.e1*tanh(p.e2*y) + p.c*v end)

define({
  name = "harsh_yield",
  help = "A spring that yields at once and on one side. Its force is k*y up to y = edge and e1 beyond, with a jump.",
  fields = {
    k,
    known("e1", 500, "N", "force beyond the edge; chosen: the figure is lost"),
    { "edge", types.number(), default = 1e-3, unit = "m", help = "where it yields" },
    c,
  },
  example = [[local model = lunid.systems.harsh_yield {}]],
}, function(p, given) return where(less(given.edge, y), p.e1, p.k*y) + p.c*v end)

define({
  name = "van_der_pol",
  help = "Damping that changes its sign at |y| = 1: m*a + k*y + c*(y^2 - 1)*v = F, which swings by itself.",
  fields = {
    k, c,
    { "sign", types.choice { "usual", "printed" }, default = "usual",
      help = "'printed': c*(1 - y^2)*v as in table 2.1, damped within -1 < y < 1 and unstable beyond" },
  },
  example = [[local model = lunid.systems.van_der_pol { k = 1, c = 5 }]],
}, function(p, given)
  return p.k*y + p.c*(given.sign == "usual" and y^2 - 1 or 1 - y^2)*v
end)

--- Parameters k1, k2 ... of a list, or of one number for all.
local function series(name, value, count, unit, fixed)
  local list = type(value) == "table" and value or {}
  if #list > 0 and #list ~= count then
    schema.fail("systems.chain: " .. name, ("expected %d, one for each mass, got %d"):format(count, #list))
  end
  local parameters = {}
  for i = 1, count do
    parameters[i] = symbols.parameter { name .. i, list[i] or value, unit = unit, fixed = fixed }
  end
  return parameters
end

local each = types.either(types.number(), types.list(types.number(), 1))

define({
  name = "chain",
  mass = false,
  help = "Masses in a row on springs and dashpots, the first one tied to the ground, one of the springs hardening "
    .. "(appendix J and case 4). Coordinates are y1 y2 ..., forces F1 F2 ...",
  fields = {
    { "masses", types.list(types.number { above = 0 }, 2), default = { 1, 1 }, unit = "kg", help = "one for each coordinate" },
    { "k", each, default = 2e4, unit = "N/m", help = "stiffness k1, k2 ... of each spring; one number for all" },
    { "c", each, default = 10, unit = "N s/m", help = "damping c1, c2 ... of each dashpot; one number for all" },
    known("cubic", 1e6, "N/m^3", "cubic stiffness of one spring"),
    { "cubic_at", types.integer { min = 1 }, default = 1,
      help = "which spring: 1 to the ground, 2 between the first two masses; chosen: the figure is lost" },
  },
  example = [[local model = lunid.systems.chain { masses = { 1, 2 }, cubic_at = 2 }]],
}, function(p, given)
  local n = #given.masses
  if given.cubic_at > n then
    schema.fail("systems.chain: cubic_at", ("expected 1 to %d, got %d"):format(n, given.cubic_at))
  end
  local k, c = series("k", given.k, n, "N/m"), series("c", given.c, n, "N s/m")
  local function element(d, rate, i) return k[i]*d + c[i]*rate + (i == given.cubic_at and p.cubic*d^3 or 0) end
  return models.chain { masses = series("m", given.masses, n, "kg", true), element = element, ends = "left" }
end)

define({
  name = "velocity_mass",
  help = "A mass that depends on the velocity (section 2.7): (m + A*v)*a + k*y + c*v = F.",
  fields = { k, c, known("A", 5e-3, "kg s/m", "mass per velocity; chosen: the text gives none. m + A*v must stay > 0") },
  example = [[local model = lunid.systems.velocity_mass {}]],
}, function(p) return p.k*y + p.c*v, p.m + p.A*v end)

define({
  name = "pile",
  mass = 49,
  help = "A rigid pile that is driven into soil; y is its penetration. Shaft friction slips beyond a quake; the toe "
    .. "yields, lifts off and comes back (Smith 1960, J. Soil Mech. Found. Div. ASCE 86, 35).",
  fields = {
    known("shaft", 2000, "N", "shaft friction at slip; chosen, as all of the soil: the measurements are not public",
      { above = 0 }),
    known("shaft_quake", 1e-3, "m", "movement at which the shaft slips", { above = 0 }),
    known("shaft_damping", 0.2, "s/m", "Smith's J: the friction times 1 + J*abs(v)", { min = 0 }),
    known("toe", 5000, "N", "resistance of the toe at yield", { above = 0 }),
    known("toe_quake", 2e-3, "m", "movement at which the toe yields", { above = 0 }),
    known("toe_damping", 0.2, "s/m", "Smith's J of the toe", { min = 0 }),
    known("push", 480, "N", "weight that the crane leaves to the pile, 49 kg times gravity", { min = 0 }),
  },
  example = [[local model = lunid.systems.pile { toe = 4000 }]],
}, function(p)
  -- slip: how far the soil at the shaft is drawn along. toe_at: where the toe's soil begins, pushed down as it yields.
  local slip = symbols.state { "slip", rate = v, min = -p.shaft_quake, max = p.shaft_quake }
  local toe_at = symbols.state { "toe_at", rate = 0, min = y - p.toe_quake }
  local shaft = p.shaft / p.shaft_quake * slip * (1 + p.shaft_damping*abs(v))
  local toe = p.toe / p.toe_quake * max(0, y - toe_at) * (1 + p.toe_damping*abs(v))
  return shaft + toe - p.push
end)

return { public = { systems = schema.strict_table("lunid.systems", systems) } }

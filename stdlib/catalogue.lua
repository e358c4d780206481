-- The catalogue: its entries by name, loaded when they are asked for.
local core = require "lunid.core"
local effect = require "lunid.effect"
local schema = require "lunid.schema"
local types = schema.types

local catalogue = {}

-- Every entry, in the order in which they are printed.
catalogue.names = {
  "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "quintic_stiffness", "clearance", "one_sided_stop",
  "bilinear_stiffness", "saturating_stiffness", "preload", "constant_force", "sinusoidal_stiffness",
  "odd_quadratic_stiffness", "impact_hunt_crossley",
  "viscous_damping", "quadratic_drag", "cubic_damping", "power_law_damping", "van_der_pol_damping",
  "asymmetric_damping", "coulomb_friction", "position_dependent_friction", "fractional_damping", "stribeck_friction",
  "elastic_slip", "iwan", "dahl_friction", "lugre_friction", "bouc_wen", "pinching_degrading_hysteresis",
  "backlash_play", "maxwell_relaxation", "friction_lift_off",
  "hyperbolic_soil", "masing_soil", "smith_shaft", "smith_toe", "rate_power_law", "shaft_softening",
  "vibro_liquefaction", "soil_plug", "radiation_damping", "degrading_resistance", "setup_recovery",
  "depth_resistance", "crane_lowering",
  "added_mass", "velocity_dependent_mass", "displacement_dependent_mass", "stiffness_drift", "damping_drift",
  "parametric_stiffness", "hidden_mode", "force_delay",
  "missing_harmonic", "base_motion", "rotating_unbalance", "force_gain",
  "sensor_lag", "displacement_offset", "sensor_drift", "sensor_gain", "clipping",
}

-- Those that discovery tries first where a study names none; the others where these leave it open.
catalogue.searched = { "linear_stiffness", "quadratic_stiffness", "cubic_stiffness", "clearance", "one_sided_stop",
  "constant_force", "viscous_damping", "quadratic_drag", "coulomb_friction", "bouc_wen" }

local loaded = {}

--- The entry of that name, which must be one of catalogue.names.
function catalogue.entry(name)
  loaded[name] = loaded[name] or require("lunid.effects." .. name)(effect)
  return loaded[name]
end

--- Those of the names that begin with a word: "cubic" of cubic_stiffness and cubic_damping.
local function names_with(word, names)
  local found = {}
  for _, name in ipairs(names) do
    if name:sub(1, #word + 1) == word .. "_" then found[#found + 1] = name end
  end
  return found
end

--- Raises, as the field `where`, on a name that is neither in the catalogue nor that of an entry of the user's own.
function catalogue.check_names(where, names, own)
  local there, known = { table.unpack(catalogue.names) }, {}
  for _, entry in ipairs(own or {}) do there[#there + 1] = entry.name end
  for _, name in ipairs(there) do known[name] = true end
  for _, name in ipairs(names) do
    if not known[name] then
      schema.fail(where, ("unknown effect '%s'%s"):format(name,
        core.did_you_mean(core.nearest(name, there) or table.concat(names_with(name, there), "' or '"))
          or " (see `lunid list effects`; entries of your own stand in effects = { ... })"))
    end
  end
end

--- The entries of these names (nil: those searched), in the catalogue's order, but for those in `without`. All are names
--- that there are.
function catalogue.entries(names, without)
  local wanted, entries = {}, {}
  for _, name in ipairs(names or catalogue.searched) do wanted[name] = true end
  for _, name in ipairs(without or {}) do wanted[name] = nil end
  for _, name in ipairs(catalogue.names) do
    if wanted[name] then entries[#entries + 1] = catalogue.entry(name) end
  end
  return entries
end

--- The entries that a study asks for, by its fields `catalogue`, `without` and `effects`, a user's own last. Raises, as
--- `where`, on a name that there is not, on an own entry whose name is `taken`, and where nothing is left.
function catalogue.asked_for(where, given, taken)
  local own = given.effects
  catalogue.check_names(where .. ": catalogue", given.catalogue or {})
  catalogue.check_names(where .. ": without", given.without)
  local entries = catalogue.entries(given.catalogue, given.without)
  if #entries + #own == 0 then schema.fail(where .. ": without", "leaves no effect to try") end
  for _, entry in ipairs(own) do
    for _, name in ipairs(taken) do
      if name == entry.name then
        schema.fail(where .. ": effects", ("'%s' is in the catalogue already; give it another name"):format(name))
      end
    end
    entries[#entries + 1] = entry
  end
  return entries
end

--- The entries that are not among those searched first, but for those in `without`.
function catalogue.others(without)
  local first, names = {}, {}
  for _, name in ipairs(catalogue.searched) do first[name] = true end
  for _, name in ipairs(catalogue.names) do
    if not first[name] then names[#names + 1] = name end
  end
  return catalogue.entries(names, without)
end

--- Raises where a study's own guesses are no list of values for the entry's parameters, within their bounds; read_guesses
--- in lua_discovery.cpp says of which entry.
local function check_guesses(entry, guesses)
  local names, rows = {}, {}
  for i, row in ipairs(entry.parameters) do names[i], rows[row[1]] = row[1], entry.rows[i] end
  local function refuse(words, ...) error(words:format(...), 0) end
  if type(guesses) ~= "table" or next(guesses) ~= nil and guesses[1] == nil then
    refuse("expected a list { { %s = ... }, ... }, got %s", names[1], type(guesses) == "table" and "a table that is no list"
      or core.describe(guesses))
  end
  for i, guess in ipairs(guesses) do
    if type(guess) ~= "table" then refuse("entry %d: expected { %s = ... }, got %s", i, names[1], core.describe(guess)) end
    for name, value in pairs(guess) do
      local row = rows[name]
      if not row then refuse("unknown parameter '%s' (%s)", name, table.concat(names, ", ")) end
      if type(value) ~= "number" or value ~= value or value < (row.min or value) or value > (row.max or value) then
        refuse("%s: expected %s, got %s", name, types.number({ min = row.min, max = row.max }).words, core.describe(value))
      end
    end
  end
  return guesses
end

--- lunid.effect: an entry of the study's own. Those of the catalogue follow any scale; they are brought within bounds.
local function own_effect(...)
  local entry = effect(...)
  local guess = entry.guess
  if guess then entry.guess = function(...) return check_guesses(entry, guess(...)) end end
  return entry
end

catalogue.public = { effect = own_effect, effects = schema.strict_list("lunid.effects", catalogue.names, catalogue.entry) }
return catalogue

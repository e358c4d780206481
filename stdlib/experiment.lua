-- The experiment that would tell rivals apart.
local core = require "lunid.core"
local output = require "lunid.output"
local schema = require "lunid.schema"
local types = schema.types

local experiment = {}

local model = types.is("model", "lunid.model")

--- The rivals of a discovery: what was named and what the record cannot tell from it; else the best rival.
local function rivals_of(found)
  local models, names = { found.model }, {}
  for i, effect in ipairs(found.effects) do names[i] = effect.name end
  names = { #names > 0 and table.concat(names, " + ") or "baseline" }
  local alike, last = {}, found.effects[#found.effects]
  for _, name in ipairs(last and last.indistinguishable or {}) do alike[name] = true end
  for _, rival in ipairs(found.rivals) do
    if alike[rival.name] then models[#models + 1], names[#names + 1] = rival.model, rival.name end
  end
  local first = found.rivals[1]
  if #models == 1 and first then models[2], names[2] = first.model, first.name end
  if #models == 1 then schema.fail("design_experiment: from", "the discovery has no rival to what it found") end
  return models, names
end

local limit_names = { "force", "displacement", "frequency" }

--- force, displacement, from and to, each given or as the discovery's records had it.
local function limits_of(given, same)
  local limits = given.limits
  for key, value in pairs(limits) do
    local known = false
    for _, name in ipairs(limit_names) do known = known or name == key end
    if not known then
      schema.fail("design_experiment: limits", ("unknown field '%s'%s"):format(key,
        core.did_you_mean(core.nearest(key, limit_names)) or " (fields: force, displacement, frequency)"))
    end
    if key ~= "frequency" and type(value) ~= "number" then
      schema.fail("design_experiment: limits." .. key, "expected a number, got " .. core.describe(value))
    end
  end
  local band = limits.frequency
  if band ~= nil and (type(band) ~= "table" or #band ~= 2 or type(band[1]) ~= "number" or type(band[2]) ~= "number") then
    schema.fail("design_experiment: limits.frequency", "expected { lowest, highest } in Hz, got " .. core.describe(band))
  end
  return { force = limits.force or same.force, displacement = limits.displacement or same.displacement,
    from = band and band[1] or same.from, to = band and band[2] or same.to }
end

--- A number that is given, that the discovery's records had, or that follows from the band; else an error.
local function choose(given, name, same, otherwise)
  local value = given[name] or same[name] or otherwise
  if not value then
    schema.fail("design_experiment", ("missing field '%s': a number; only a discovery (from = ...) brings its own"):format(name))
  end
  return value
end

local function check_known(given, limits, imposed)
  for _, pair in ipairs { { "from", "frequency" }, not imposed and { "force", "force" }
    or { "displacement", "displacement" } } do
    if not limits[pair[1]] then
      schema.fail("design_experiment: limits", ("missing field '%s'; only a discovery (from = ...) brings its own"):format(
        pair[2]))
    end
  end
end

--- A design as studies see it.
function experiment.wrap(design)
  design.best = design.candidates[1]
  design.excitation = design.best.excitation
  return schema.object("experiment_design", design, { save = function(self, path)
    if type(path) ~= "string" or not path:match "%.json$" then
      schema.fail("save", "expected a path that ends in .json, got " .. core.describe(path))
    end
    return output.write(path, self.json)
  end }, function(self) return self.text end)
end

local design_experiment = schema.define({
  name = "design_experiment",
  help = "The experiment that would tell rival models apart: of a small family of excitations (multisine, swept sine up "
    .. "and down, steps of amplitude, a low and a high level, offsets, steps, pull and release), each simulated with every "
    .. "rival, the one whose answers stay farthest apart, in standard deviations of the noise, when each rival may refit "
    .. "its parameters to the other's answer. Give models that have values, or a discovery.",
  fields = {
    { "models", types.list(model, 2), help = "the rivals, each with values for all parameters" },
    { "names", types.list(types.string), help = "of the models; else model 1, model 2 ..." },
    { "from", types.is("discovery", "lunid.discover"),
      help = "takes the model that it found and what its records cannot tell from it, else the best rival; limits, rate and "
        .. "noise of its records where they are not given" },
    { "limits", types.table, default = {},
      help = "what the machine can do: { force = largest [N], displacement = largest [m], frequency = { lowest, highest } [Hz] }" },
    { "duration", types.number { above = 0 }, unit = "s", help = "else 16 periods of the lowest frequency" },
    { "rate", types.number { above = 0 }, unit = "Hz", help = "else 20 rows in a period of the highest frequency" },
    { "measured", types.choice { "y", "v", "a" },
      help = "of each coordinate: displacement, velocity or acceleration; else what the discovery's records had, or y" },
    { "noise", types.number { above = 0 },
      help = "standard deviation of the noise of what is measured, in SI; of the force's where the motion is imposed" },
  },
  returns = "experiment_design",
  example = [[local next = lunid.design_experiment { models = { a, b }, limits = { force = 40, displacement = 0.005,
  frequency = { 5, 60 } }, noise = 2e-5 }
print(next)
next.excitation:save "next.csv"]],
}, function(given)
  if (given.models == nil) == (given.from == nil) then
    schema.fail("design_experiment", "give either models or from, a discovery")
  end
  local models, names, same = given.models, given.names, {}
  if given.from then
    models, names = rivals_of(given.from)
    same = given.from.same_experiment
  end
  names = names or {}
  for i = #names + 1, #models do names[i] = "model " .. i end
  local limits = limits_of(given, same)
  check_known(given, limits, models[1].imposed_motion)
  limits.duration = choose(given, "duration", same, 16 / limits.from)
  limits.rate = choose(given, "rate", same, 20 * limits.to)
  limits.noise = choose(given, "noise", same)
  limits.measured = given.measured or same.measured or "y"
  limits.units = same.units
  return experiment.wrap(core.design_experiment(models, names, limits))
end)

experiment.public = { design_experiment = design_experiment }
return experiment

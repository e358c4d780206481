-- The module `lunid`: everything that a study may call.
local core = require "lunid.core"
local schema = require "lunid.schema"

local public = { version = core.version }

for _, room in ipairs { "symbols", "functions", "records", "derivatives", "signals", "spectra", "models", "features",
  "constraints", "solvers", "regression", "curves", "histories", "selection", "surfaces", "excitation", "noise", "systems",
  "simulation", "responses", "ensembles", "protocol", "catalogue", "discovery", "stages", "experiment", "statistics",
  "comparison", "feature_ranking", "scoreboard", "study_report", "figures.all", "option" } do
  local exported = require("lunid." .. room)
  for name, value in pairs(exported.public or exported) do
    if name ~= "public" then public[name] = value end
  end
end

return schema.strict_table("lunid", public, {
  fit = "'fit_trajectory', 'regress' or 'fit_curve'",
  plot = "'figure', such as lunid.figure.history",
})

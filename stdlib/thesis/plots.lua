-- The figures that the captions of chapter 2 and appendix M name beside those of lunid.scoreboard: the data, the surfaces
-- with their sections and side views, scores against the number of terms.
local lunid = require "lunid"
local lines, series = lunid.figure.lines, lunid.figure.series

local plots = {}

--- The beginning of a record, some periods long.
local function beginning(record) return record:window(record.start, record.start + math.min(record.duration, 0.25)) end

--- Simulated displacement and velocity, target force, phase portrait of the training data.
function plots.data(report, train, mass)
  local part = beginning(train)
  local t = part:column "t"
  report:figure("training_displacement", lines { series = { series { t, part:column "y", role = "measured" } }, x = "time [s]",
    y = "displacement [m]" }, "Measured displacement, its beginning")
  report:figure("training_velocity", lines { series = { series { t, part:column "v", role = "measured" } }, x = "time [s]",
    y = "velocity [m/s]" }, "Measured velocity, its beginning")
  local surface = lunid.rfs { record = part, mass = mass, order = { 1, 1 } }
  report:figure("target_force", lines { series = { series { t, surface.points.f, role = "measured" } }, x = "time [s]",
    y = "restoring force [N]" }, "Target of the fits: F - m*a, the acceleration derived from the measured velocity")
  report:figure("training_phase", lines { series = { series { train:column "y", train:column "v", role = "measured",
    style = "points" } }, x = "displacement [m]", y = "velocity [m/s]" }, "Phase portrait of the training data")
end

--- The chosen surface from three sides, its sections and side views, and the scores of its rivals; `all`: each rival's surface
--- too.
function plots.surface(report, surface, train)
  report:figure("surface", lunid.figure.surface { surface }, "Selected restoring force surface: " .. surface.kind)
  report:figure("surface_contour", lunid.figure.contour { surface }, "The surface from above; hatched: no data")
  report:figure("side_views", lunid.figure.side_views { surface }, "Side views of surface and data, over displacement and velocity")
  local top = math.max(surface.points.v:max(), -surface.points.v:min())
  report:figure("sections", lunid.figure.sections { surface, v = { -0.5*top, 0, 0.5*top }, y = { 0 } },
    "Cross sections of the surface along displacement and velocity, with the data near them")
  local rows = {}
  for i, rival in ipairs(surface.rivals) do rows[i] = { rival.kind, rival.left_out and rival.left_out.r2, rival.left_out and rival.left_out.rmse } end
  report:table { head = { "interpolation", "R2 left out", "RMSE left out [N]" }, rows = rows,
    caption = "Surfaces side by side, scored on blocks of time that they had not seen" }
  for _, kind in ipairs(train and { "grid", "nearest", "triangulation", "mlp", "gaussian_process", "support_vectors", "random_forest" } or {}) do
    local one = lunid.rfs { record = train, mass = 1, interpolate = lunid[kind] {} }
    report:figure("surface_" .. kind, lunid.figure.surface { one }, ("Surface by %s: R2 %.3f"):format(one.kind, one.r2))
  end
end

--- RMSE of the force against the number of terms, the best subset of each size.
function plots.pruning(report, train, features, mass)
  local fit = lunid.regress { record = train, mass = mass, features = { features }, solver = lunid.best_subset {} }
  local count, rmse, rows = {}, {}, {}
  for i, step in ipairs(fit.steps) do
    count[i], rmse[i] = #step.features, step.rmse
    rows[i] = { #step.features, step.rmse, ("%.0f"):format(step.criterion), table.concat(step.features, ", ") }
  end
  report:table { head = { "terms", "RMSE [N]", "BIC", "which" }, rows = rows, caption = "Removing terms: the best subset of each size, by equation error" }
  report:figure("removing_terms", lunid.figure.score { fit }, "Removing unnecessary terms: score against number of terms")
end

--- Mutual information and the thesis' significance index of each term; `true_terms` are marked.
function plots.ranking(report, ranking, true_terms)
  local is_true, rows = {}, {}
  for _, name in ipairs(true_terms) do is_true[name] = true end
  for i, row in ipairs(ranking) do
    rows[i] = { row.name .. (is_true[row.name] and " (true)" or ""), row.information, row.spearman, row.kendall, row.significance }
  end
  report:table { head = { "term", "mutual information [nat]", "Spearman", "Kendall", "significance index" }, rows = rows,
    caption = "What statistics say of the terms: mutual information with the force, and MI * max|c f|" }
  local information, significance = {}, {}
  for i, row in ipairs(ranking) do
    information[i] = { row.name, row.information }
    significance[i] = { row.name, row.significance }
  end
  report:figure("mutual_information", lunid.figure.contributions { information, axis = "mutual information [nat]" },
    "Mutual information of the terms with the force")
  report:figure("significance", lunid.figure.contributions { significance, axis = "MI * max|c f| [N]" }, "The thesis' significance index")
end

return plots

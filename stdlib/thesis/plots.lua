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

--- A section along one axis with the points near it, and beside it all points from the side.
local function section(report, surface, axis, words)
  local cut = lunid.section { surface, [axis == "y" and "v" or "y"] = 0 }
  local label = axis == "y" and "displacement [m]" or "velocity [m/s]"
  report:figure("section_" .. axis, lines { x = label, y = "restoring force [N]", series = {
    series { cut.points_place, cut.points_f, label = "measured near it", role = "measured", style = "points" },
    series { cut.place, cut.f, label = surface.kind, role = "final" } } }, "Section of the surface along the " .. words)
  local points = surface.points
  report:figure("side_" .. axis, lines { x = label, y = "restoring force [N]", series = {
    series { points[axis]:every(3), points.f:every(3), label = "all measured points", role = "measured", style = "points" },
    series { cut.place, cut.f, label = "section at 0", role = "final" } } }, "Side view of the surface: all points over the " .. words)
end

--- The chosen surface, its sections and side views, and the scores of its rivals.
function plots.surface(report, surface)
  report:figure("surface", lunid.figure.surface { surface }, "Selected restoring force surface: " .. surface.kind)
  report:figure("surface_from_the_velocity_side", lunid.figure.surface { surface, azimuth = 0, elevation = 5 },
    "The surface from the side of the velocity")
  report:figure("surface_from_the_displacement_side", lunid.figure.surface { surface, azimuth = -90, elevation = 5 },
    "The surface from the side of the displacement")
  section(report, surface, "y", "displacement")
  section(report, surface, "v", "velocity")
  local rows = {}
  for i, rival in ipairs(surface.rivals) do rows[i] = { rival.kind, rival.left_out and rival.left_out.r2, rival.left_out and rival.left_out.rmse } end
  report:table { head = { "interpolation", "R2 left out", "RMSE left out [N]" }, rows = rows,
    caption = "Surfaces side by side, scored on blocks of time that they had not seen" }
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
  report:figure("removing_terms", lines { x = "number of terms", y = "RMSE of the force [N]", series = {
    series { count, rmse, style = "line_points", role = "final" } } }, "Removing unnecessary terms: score against number of terms")
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
end

return plots

-- The figures that the captions of chapter 2 and appendix M name beside those of lunid.scoreboard: the data, the surfaces
-- with their sections and side views, scores against the number of terms.
local lunid = require "lunid"
local lines, series, grid = lunid.figure.lines, lunid.figure.series, lunid.figure.grid

local plots = {}

--- The beginning of a record, some periods long.
local function beginning(record) return record:window(record.start, record.start + math.min(record.duration, 0.25)) end

--- Simulated displacement and velocity, external and internal force, phase portrait of the training data.
function plots.data(report, train, mass)
  local part = beginning(train)
  local t = part:column "t"
  report:figure("training_motion", lunid.figure.history { part, channels = { "y", "v" } },
    "Measured displacement and velocity, their beginning")
  local surface = lunid.rfs { record = part, mass = mass, order = { 1, 1 } }
  report:figure("target_force", lines { series = { series { t, part:column "F", label = "external, F", role = "baseline", style = "dashed" },
    series { t, surface.points.f, label = "internal, F - m*a", role = "measured" } }, x = "time [s]", y = "force [N]" },
    "External force, and the target of the fits: the acceleration is derived from the measured velocity")
  report:figure("training_phase", lines { series = { series { train:column "y", train:column "v", role = "measured",
    style = "points" } }, x = "displacement [m]", y = "velocity [m/s]" }, "Phase portrait of the training data")
end

--- Surfaces by several learners side by side, each fitted to `record`; with_points: where the data are a loop, and hardly a surface.
function plots.learners(report, name, record, mass, kinds, with_points)
  local list = {}
  for i, kind in ipairs(kinds) do
    local one = lunid.rfs { record = record, mass = mass, interpolate = lunid[kind] {} }
    list[i] = lunid.figure.surface { one, points = with_points == true, title = ("%s, R2 %.3f"):format(one.kind:gsub("_", " "), one.r2) }
  end
  report:figure(name .. "surfaces", grid { list, columns = 2, width = 24, height = 10*math.ceil(#list/2) + 1 }, "Surfaces fitted by several learners, and their R2 on their own data")
end

--- A surface seen from four sides.
function plots.views(report, name, surface, what)
  local list = {}
  for i, azimuth in ipairs { -130, -40, 50, 140 } do
    list[i] = lunid.figure.surface { surface, azimuth = azimuth, title = ("from %d degrees"):format(azimuth) }
  end
  report:figure(name .. "views", grid { list, columns = 2, width = 24, height = 21 }, ("%s from four sides"):format(what))
end

--- The chosen surface: in space, from above, from the sides, cut near and far.
function plots.faces(report, name, surface, what)
  report:figure(name .. "surface", lunid.figure.surface { surface }, ("Selected %s surface: %s"):format(what, surface.kind:gsub("_", " ")))
  report:figure(name .. "contour", lunid.figure.contour { surface }, "The surface from above; hatched: no data")
  report:figure(name .. "side_views", lunid.figure.side_views { surface }, "Side views of surface and data, over displacement and velocity")
  local top = math.max(surface.points.v:max(), -surface.points.v:min())
  report:figure(name .. "sections", lunid.figure.sections { surface, v = { -0.5*top, 0, 0.5*top }, y = { 0 } },
    "Cross sections of the surface along displacement and velocity, with the data near them")
  report:figure(name .. "sections_zoomed_out", lunid.figure.sections { surface, v = {}, y = { 0 }, half_width = surface.points.y:std() },
    "The section along velocity again with the data of the whole middle: the plane of velocity and internal force, zoomed out")
end

--- The surface chosen from `rivals` and what the captions show of it; learners: those drawn side by side.
function plots.surface(report, surface, record, learners)
  plots.learners(report, "", record, 1, learners)
  plots.faces(report, "", surface, "restoring force")
  local rows = {}
  for i, rival in ipairs(surface.rivals) do rows[i] = { rival.kind, rival.left_out and rival.left_out.r2, rival.left_out and rival.left_out.rmse } end
  report:table { head = { "interpolation", "R2 left out", "RMSE left out [N]" }, rows = rows,
    caption = "Surfaces side by side, scored on blocks of time that they had not seen" }
end

--- Learners of a quick form, and all of them.
function plots.learners_of(quick)
  return quick and { "grid", "nearest", "mlp", "triangulation" } or { "grid", "nearest", "triangulation", "mlp", "gaussian_process",
    "support_vectors", "random_forest" }
end

--- Each term's share of the excitation in per cent, with the cut-off that the thesis drops terms by; and the score of the force
--- against the number of terms, the best subset of each size. name: before those of the figures; labels: of features whose text is long.
function plots.pruning(report, train, features, mass, name, labels)
  name, features = name or "", getmetatable(features) and { features } or features
  local function label(term) return labels and labels[term] or term end
  local all = lunid.regress { record = train, mass = mass, features = features }
  local shares = {}
  for i, term in ipairs(all.terms) do shares[i] = { label(term.name), 100*term.contribution } end
  report:figure(name .. "cut_off", lunid.figure.contributions { shares, cut_off = 5 }, "Contribution of each term, and the cut-off at 5 %")
  local fit = lunid.regress { record = train, mass = mass, features = features, solver = lunid.best_subset {} }
  local rows = {}
  for i, step in ipairs(fit.steps) do
    local which = {}
    for k, feature in ipairs(step.features) do which[k] = label(feature) end
    rows[i] = { #which, step.rmse, ("%.0f"):format(step.criterion), table.concat(which, ", ") }
  end
  report:table { head = { "terms", "RMSE [N]", "BIC", "which" }, rows = rows, caption = "Removing terms: the best subset of each size, by equation error" }
  report:figure(name .. "removing_terms", lunid.figure.score { fit }, "Removing unnecessary terms: score against number of terms")
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

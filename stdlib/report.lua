-- report.html: what was found, for one who was not there. Self-contained: figures lie inside as PNG.
local core = require "lunid.core"
local figures = require "lunid.figures"
local output = require "lunid.output"

local report = {}

local escapes = { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;" }
local function escape(text) return (tostring(text):gsub('[&<>"]', escapes)) end

local function number(value, reason)
  if value == nil then return "none" .. (reason and " (" .. escape(reason) .. ")" or "") end
  return ("%.4g"):format(value)
end

-- ---- figures ----

--- Force or displacement: what the gap is about.
local function output_axis(found)
  return found.model.imposed_motion and { name = "force", unit = "N" } or { name = "displacement", unit = "m" }
end

local function history(found, comparison, title)
  return { title = title, x = { name = "time", unit = "s" }, y = output_axis(found), series = {
    { x = comparison.t, y = comparison.measured, label = "measured", role = "measured" },
    { x = comparison.t, y = comparison.baseline, label = "baseline, free run", role = "baseline", style = "dashed" },
    { x = comparison.t, y = comparison.final, label = "final model, free run", role = "final", style = "dotted" } } }
end

local function residuals(comparison, title)
  return { title = title, x = { name = "time", unit = "s" }, y = { name = "unexplained force", unit = "N" }, series = {
    { x = comparison.t, y = comparison.residual_before, label = "baseline", role = "baseline" },
    { x = comparison.t, y = comparison.residual_after, label = "final model", role = "final" } } }
end

local function named_force(comparison, x, axis)
  return { x = axis, y = { name = "force", unit = "N" }, series = {
    { x = x, y = comparison.residual_before, label = "left by the baseline", role = "residual", style = "points" },
    { x = x, y = comparison.named_force, label = "named effect", role = "effect", style = "points" } } }
end

local function largest(rows)
  local most = 0
  for _, row in ipairs(rows) do
    if row:max() == row:max() then most = math.max(most, row:max(), -row:min()) end
  end
  return most > 0 and most or nil
end

local function map_panel(map, rows, title, most)
  return { title = title, x = { name = "displacement", unit = "m" }, y = { name = "velocity", unit = "m/s" },
    map = { x = map.y, y = map.v, z = rows,
      colour = { name = "mean unexplained force", unit = "N", min = most and -most, max = most } } }
end

--- Both maps side by side, in one range of colours.
function report.residual_map(found)
  local map = found.map
  local most = largest(map.before)
  return figures.make { columns = 2, size = { width_cm = 24 }, panels = {
    map_panel(map, map.before, "baseline", most), map_panel(map, map.after, "final model", most) } }
end

--- Name, caption and figure of each picture, in the report's order.
local function pictures(found)
  local list = {}
  local function add(name, caption, fields)
    list[#list + 1] = { name = name, caption = caption, figure = figures.make(fields) }
  end
  local train
  for _, comparison in ipairs(found.comparisons) do
    if comparison.role == "train" and not train then train = comparison end
  end
  local seen = {}
  for _, comparison in ipairs(found.comparisons) do
    seen[comparison.role] = (seen[comparison.role] or 0) + 1
    add(("history_%s_%d"):format(comparison.role, seen[comparison.role]),
      ("%s (%s): measured, and the free runs of baseline and final model; never re-initialised."):format(
        comparison.record, comparison.role),
      { panels = { history(found, comparison, ""), residuals(comparison, "") } })
  end
  if #found.map.y > 1 and #found.map.v > 1 then
    list[#list + 1] = { name = "residual_map", figure = report.residual_map(found),
      caption = "Mean force that the model leaves unexplained, over displacement and velocity: where the "
        .. "baseline fails, and what is left. Hatched: no data." }
  end
  if train and #found.effects > 0 then
    add("named_force", "The force of what was named, against the force that the baseline leaves unexplained.",
      { columns = 2, size = { width_cm = 24 }, panels = {
        named_force(train, train.y, { name = "displacement", unit = "m" }),
        named_force(train, train.v, { name = "velocity", unit = "m/s" }) } })
  end
  return list
end

--- Draws all pictures; returns them with `path`, or with the reason why there are none.
local function draw(found, prefix)
  local drawn = {}
  for _, picture in ipairs(pictures(found)) do
    local path = prefix .. "figures/" .. picture.name .. ".png"
    local good, message = pcall(core.render_figure, picture.figure, output.place(path))
    if not good then return drawn, "figures could not be drawn: " .. tostring(message) end
    picture.image = core.base64(core.read_text(output.place(path)))
    drawn[#drawn + 1] = picture
    core.export_figure(picture.figure, output.place(prefix .. "figures/" .. picture.name .. ".csv"))
  end
  return drawn
end

-- ---- text ----

local style = [[
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc }
table { border-collapse: collapse; margin: .8rem 0 } th, td { padding: .3rem .8rem; text-align: left;
border-bottom: 1px solid #e2e2e2; vertical-align: top } td.n { font-variant-numeric: tabular-nums }
.verdict { font-size: 1.15rem; padding: .8rem 1rem; background: #eef4fb; border-left: .3rem solid #0072b2 }
code, pre { font-family: ui-monospace, monospace; background: #f5f5f5 } pre { padding: .7rem; overflow-x: auto }
figure { margin: 1.2rem 0 } img { max-width: 100% } figcaption { color: #444; font-size: .92rem }
.small { color: #555; font-size: .92rem }]]

local function row(cells, tag)
  local parts = {}
  for i, cell in ipairs(cells) do parts[i] = ("<%s%s>%s</%s>"):format(tag, tag == "td" and i > 1 and ' class="n"' or "", cell, tag) end
  return "<tr>" .. table.concat(parts) .. "</tr>"
end

local function html_table(head, rows)
  local lines = { "<table>", row(head, "th") }
  for _, cells in ipairs(rows) do lines[#lines + 1] = row(cells, "td") end
  lines[#lines + 1] = "</table>"
  return table.concat(lines, "\n")
end

local function sorted_keys(object)
  local keys = {}
  for key in pairs(object) do keys[#keys + 1] = key end
  table.sort(keys)
  return keys
end

local function parameter_rows(parameters, first_guess)
  local rows = {}
  for _, name in ipairs(sorted_keys(parameters)) do
    local p = parameters[name]
    local interval = p.interval and ("%.4g to %.4g"):format(p.interval[1], p.interval[2])
      or escape(p.std_reason or "none")
    local before = first_guess and first_guess[name]
    rows[#rows + 1] = { "<code>" .. escape(name) .. "</code>", before and number(before.value, "not given") or "",
      number(p.value, p.reason), interval, escape(p.unit or "") }
  end
  return rows
end

local function gap_section(data)
  local floor = data.noise_floor
  return "<h2>The gap</h2>" .. html_table({ "", "baseline", "final model", "noise alone" }, {
    { "training record", number(data.baseline.gap_train, data.baseline.cause), number(data.final.gap_train, data.final.cause),
      number(floor.gap_train, floor.reason) },
    { "test record, opened after the verdict", number(data.baseline.gap_test, data.baseline.cause),
      number(data.final.gap_test, data.final.cause), number(floor.gap_test, floor.reason) },
    { "rows of the training record that the fit did not see", number(data.left_out.gap_before, data.left_out.reason),
      number(data.left_out.gap_after, data.left_out.reason), "" } })
    .. ('<p class="small">%s. Noise alone is what a perfect model would leave (standard deviation %s).</p>'):format(
      escape(data.method.gap), number(floor.std))
end

local function effect_section(effect)
  local lines = { ("<h3><code>%s</code>: %s</h3>"):format(escape(effect.name), escape(effect.sentence)) }
  lines[#lines + 1] = ("<p>Adds <code>%s</code> to the restoring force (%s). Seen %s. Chance of a gain as large where "
    .. "nothing is missing: p = %s.</p>"):format(escape(effect.formula), escape(effect.family), escape(effect.where),
    number(effect.p_value))
  lines[#lines + 1] = html_table({ "parameter", "", "value", "95 % interval", "unit" }, parameter_rows(effect.parameters))
  lines[#lines + 1] = ("<p>With it the gap is %s on the training record and %s on the test record.</p>"):format(
    number(effect.gap_train, effect.cause), number(effect.gap_test, effect.cause))
  if #effect.indistinguishable > 0 then
    lines[#lines + 1] = "<p><b>This record cannot tell it from</b> <code>"
      .. escape(table.concat(effect.indistinguishable, ", ")) .. "</code>.</p>"
  end
  return table.concat(lines, "\n")
end

local function rivals_section(data)
  if #data.rivals == 0 then return "" end
  local rows = {}
  for _, rival in ipairs(data.rivals) do
    rows[#rows + 1] = { "<code>" .. escape(rival.name) .. "</code>", number(rival.gap, rival.cause),
      number(rival.p_value), escape(rival.remark) }
  end
  return "<h2>Why not another effect</h2><p>Each was fitted on the trajectory and judged by free runs over rows that "
    .. "its fit did not see.</p>" .. html_table({ "effect", "gap", "p", "remark" }, rows)
end

local function named_section(data)
  if #data.effects == 0 then return "<h2>What is missing</h2><p>No effect was named.</p>" end
  local lines = { "<h2>What is missing</h2>" }
  for _, effect in ipairs(data.effects) do lines[#lines + 1] = effect_section(effect) end
  return table.concat(lines, "\n")
end

local function figure_section(drawn, why_none)
  local lines = { "<h2>Figures</h2>" }
  if why_none then lines[#lines + 1] = "<p>" .. escape(why_none) .. "</p>" end
  for _, picture in ipairs(drawn) do
    lines[#lines + 1] = ('<figure><img alt="%s" src="data:image/png;base64,%s"><figcaption>%s</figcaption></figure>')
      :format(escape(picture.caption), picture.image, escape(picture.caption))
  end
  return table.concat(lines, "\n")
end

local function provenance(data)
  local rows = { { "Lunid", core.version }, { "force between samples", escape(data.method.force_between_samples) },
    { "integration", escape(data.method.solver) }, { "noise", escape(data.method.noise) } }
  if data.method.check then
    rows[#rows + 1] = { "check of the integration", ("%s; largest difference %s (%s)"):format(
      escape(data.method.check.solver), number(data.method.check.largest_difference), escape(data.method.check.meaning)) }
  end
  for _, input in ipairs(core.inputs()) do
    rows[#rows + 1] = { "input", ("%s<br><span class=\"small\">SHA-256 %s</span>"):format(escape(input.path), input.sha256) }
  end
  return "<h2>Where this comes from</h2>" .. html_table({ "", "" }, rows)
    .. '<p class="small">run.json beside this file repeats the run: <code>lunid run run.json</code>.</p>'
end

local function warnings_section(data)
  if #data.warnings == 0 then return "" end
  local lines = { "<h2>Notes on the data</h2><ul>" }
  for _, warning in ipairs(data.warnings) do lines[#lines + 1] = "<li>" .. escape(warning) .. "</li>" end
  return table.concat(lines, "\n") .. "</ul>"
end

--- Writes figures/ and report.html below `prefix`.
function report.write(found, prefix)
  local data = found.data
  local drawn, why_none = draw(found, prefix)
  local page = table.concat({
    '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Lunid: ' .. escape(data.verdict)
      .. "</title><style>" .. style .. "</style></head><body>",
    "<h1>What the model lacks</h1>",
    ('<p class="verdict"><b>%s</b>: %s</p>'):format(escape(data.verdict), escape(data.sentence)),
    "<h2>Where the baseline fails</h2><p>" .. escape(data.where) .. "</p>",
    named_section(data), gap_section(data), figure_section(drawn, why_none), rivals_section(data),
    "<h2>Equation of motion</h2><pre>" .. escape(data.final.equation) .. "</pre>",
    html_table({ "parameter", "first guess", "value", "95 % interval", "unit" },
      parameter_rows(data.final.parameters, data.baseline.first_guess)),
    "<p>Baseline, refitted to the same record:</p>",
    html_table({ "parameter", "first guess", "value", "95 % interval", "unit" },
      parameter_rows(data.baseline.parameters, data.baseline.first_guess)),
    warnings_section(data), provenance(data), "</body></html>\n" }, "\n")
  return { path = output.write(prefix .. "report.html", page), count = #drawn, note = why_none,
    folder = #drawn > 0 and output.shown(prefix .. "figures") or nil }
end

return report

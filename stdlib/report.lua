-- report.html: what was found, for one who was not there. Self-contained: figures lie inside as data that a script draws,
-- and as PNG for where scripts are off.
local core = require "lunid.core"
local output = require "lunid.output"
local page_of = require "lunid.figures.page"
local pictures = require "lunid.pictures"

local report = {}

local escape = page_of.escape

--- 11600533039 -> "1.16005·10<sup>10</sup>"
local function power_of_ten(text) return (text:gsub("e([+-])0*(%d+)$", function(sign, exponent)
  return ("·10<sup>%s%s</sup>"):format(sign == "-" and "−" or "", exponent)
end)) end

--- The list with a function applied to each entry.
local function each(list, change)
  local out = {}
  for i, entry in ipairs(list) do out[i] = change(entry) end
  return out
end

local function missing(reason) return "none" .. (reason and " (" .. escape(reason) .. ")" or "") end

--- As the terminal shows a gap.
local function number(value, reason)
  if value == nil then return missing(reason) end
  return power_of_ten(("%.3g"):format(value))
end

--- With as many digits as show two of the standard deviation.
local function precise(value, std)
  if not std or std <= 0 or value == 0 then return power_of_ten(("%.4g"):format(value)) end
  local digits = math.floor(math.log(math.abs(value), 10)) - math.floor(math.log(std, 10)) + 2
  digits = math.max(2, math.min(digits, 15))
  local size = math.abs(value)
  if size >= 1e6 or size < 1e-3 then return power_of_ten(("%%.%de"):format(digits - 1):format(value)) end
  local decimals = digits - 1 - math.floor(math.log(size, 10))
  if decimals >= 0 then return (("%%.%df"):format(decimals):format(value)) end
  local unit = 10 ^ -decimals
  return ("%.0f"):format(math.floor(value / unit + 0.5) * unit)
end

local function p_value(p) return not p and "none" or p < 1e-4 and "below 0.0001" or ("%.2g"):format(p) end

-- ---- figures ----

--- Draws all pictures; returns them, how many files there are, and the reason where there are none: the page shows them
--- all the same.
local function draw(found, prefix)
  local list, why_none, count = pictures.of(found), nil, 0
  output.make_folder(prefix .. "figures")
  for _, picture in ipairs(list) do
    local path = prefix .. "figures/" .. picture.name
    core.export_figure(picture.figure, output.place(path .. ".csv"))
    if not why_none then
      local good, message = pcall(core.render_figure, picture.figure, output.place(path .. ".png"))
      if good then
        picture.image, count = core.base64(core.read_text(output.place(path .. ".png"))), count + 1
      else
        why_none = "figures could not be drawn as files: " .. tostring(message)
      end
    end
  end
  return list, count, why_none
end

-- ---- text ----

local style = [[
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc }
h3 { font-size: 1rem }
table { border-collapse: collapse; margin: .8rem 0 } th, td { padding: .3rem .8rem; text-align: left;
border-bottom: 1px solid #e2e2e2; vertical-align: top } td.n { font-variant-numeric: tabular-nums }
.verdict { font-size: 1.15rem; padding: .8rem 1rem; background: #eef4fb; border-left: .3rem solid #0072b2 }
code, pre { font-family: ui-monospace, monospace; background: #f5f5f5 } pre { padding: .7rem; overflow-x: auto }
.small { color: #555; font-size: .92rem }
]] .. page_of.style

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

--- The names of a model's parameters, in the order of its equation.
local function names_of(model)
  local names = {}
  for i, row in ipairs(model.parameters) do names[i] = row.name end
  return names
end

local function sorted_keys(object)
  local keys = {}
  for key in pairs(object) do keys[#keys + 1] = key end
  table.sort(keys)
  return keys
end

local function interval_text(p)
  if not p.interval then return escape(p.std_reason or "none") end
  if p.std == 0 then return "at its bound" end
  return ("%s to %s"):format(precise(p.interval[1], p.std), precise(p.interval[2], p.std))
end

local function parameter_rows(parameters, names, first_guess)
  local rows = {}
  for _, name in ipairs(names) do
    local p = parameters[name]
    local guess = first_guess[name] and first_guess[name].value
    rows[#rows + 1] = { "<code>" .. escape(name) .. "</code>", p.value and precise(p.value, p.std) or missing(p.reason),
      p.std and p.std > 0 and precise(p.std, p.std) or "", interval_text(p), escape(p.unit or ""),
      guess and precise(guess) or nil }
  end
  return rows
end

--- Parameters with what is known of them; the column of first guesses only where one was given.
local function parameter_table(parameters, names, first_guess)
  local head = { "parameter", "value", "standard deviation", "95 % interval", "unit" }
  for _, guess in pairs(first_guess) do
    if guess.value then head[6] = "first guess" end
  end
  return html_table(head, parameter_rows(parameters, names, first_guess))
end

--- The gaps of each of several coordinates.
local function outputs_table(data)
  if not data.outputs then return "" end
  local rows = {}
  for _, output in ipairs(data.outputs) do
    for _, part in ipairs { "train", "test" } do
      local gap = "gap_" .. part
      rows[#rows + 1] = { ("<code>%s</code>, %s"):format(escape(output.output), part), number(output.baseline[gap], output.baseline.cause),
        number(output.final[gap], output.final.cause), number(output.noise_floor[gap], output.final.cause) }
    end
  end
  return "<p>Of each coordinate:</p>" .. html_table({ "", "baseline", "final model", "noise alone" }, rows)
end

--- Where fits take several rows for one their gaps lie below those of single rows, by the noise that a mean has less.
local function of_means(data)
  local most = 1
  for _, record in ipairs(data.records) do most = math.max(most, record.joined) end
  return most > 1 and (", of means of %d rows"):format(most) or ""
end

local function gap_section(data)
  local floor = data.noise_floor
  return "<h2>The gap</h2>" .. html_table({ "", "baseline", "final model", "noise alone" }, {
    { "training record", number(data.baseline.gap_train, data.baseline.cause), number(data.final.gap_train, data.final.cause),
      number(floor.gap_train, floor.reason) },
    { "test record, opened when the training records had chosen"
      .. (data.test_chose and " (it chose among what these had left open)" or ""), number(data.baseline.gap_test, data.baseline.cause),
      number(data.final.gap_test, data.final.cause), number(floor.gap_test, floor.reason) },
    { "rows of the training record that the fit did not see" .. of_means(data), number(data.left_out.gap_before, data.left_out.reason),
      number(data.left_out.gap_after, data.left_out.reason), "" } }) .. outputs_table(data)
    .. ('<p class="small">%s. Noise alone is what a perfect model would leave (known to %s); the level of the noise is read off %s.</p>'):format(
      escape(data.method.gap), number(floor.std), escape(floor.read_off))
end

local function effect_section(effect)
  local lines = { ("<h3><code>%s</code>: %s</h3>"):format(escape(effect.label or effect.name), escape(effect.sentence)) }
  local what = effect.is == "physics" and "Adds <code>%s</code> to the restoring force (%s)."
    or "This is " .. effect.is .. ": <code>%s</code> (%s)."
  lines[#lines + 1] = ("<p>" .. what .. " The chance of as large a gain where it is not there (p) is %s.</p>"):format(
    escape(effect.formula), escape(effect.family), p_value(effect.p_value))
  lines[#lines + 1] = parameter_table(effect.parameters, sorted_keys(effect.parameters), {})
  lines[#lines + 1] = ("<p>With it the gap is %s on the training record and %s on the test record.</p>"):format(
    number(effect.gap_train, effect.cause), number(effect.gap_test, effect.cause))
  local same, rivals = {}, {}
  for _, name in ipairs(effect.same_force) do same[name] = true end
  for _, name in ipairs(effect.indistinguishable) do
    if not same[name] then rivals[#rivals + 1] = name end
  end
  local function names(words, list)
    if #list > 0 then
      lines[#lines + 1] = ("<p><b>%s</b> <code>%s</code>.</p>"):format(words, escape(table.concat(list, ", ")))
    end
  end
  names("This record cannot tell it from", rivals)
  names("The same force in another notation:", effect.same_force)
  return table.concat(lines, "\n")
end

local function rivals_section(data)
  if #data.rivals == 0 then return "" end
  local rows = {}
  for _, rival in ipairs(data.rivals) do
    rows[#rows + 1] = { "<code>" .. escape(rival.name) .. "</code>", number(rival.gap, rival.cause),
      p_value(rival.p_value), escape(rival.remark) }
  end
  return "<h2>Why not another effect</h2><p>Each was fitted on the trajectory. The gap is that of its fit, which knows all "
    .. "rows of the training record" .. of_means(data) .. " (the final model's is " .. number(data.final.gap_fit, data.final.cause) .. "); p is the "
    .. "chance of as large a gain over the baseline where nothing is missing.</p>"
    .. html_table({ "effect", "gap", "p", "why it was not named" }, rows)
end

--- "97 of 100: cubic_stiffness; 3: nothing"
local function naming_section(data)
  if not data.naming then return "" end
  local rows = {}
  for i, row in ipairs(data.naming.counts) do rows[i] = { "<code>" .. escape(row.name) .. "</code>", ("%d of %d"):format(row.count,
    data.naming.resamples) } end
  return "<h3>How sure the name is</h3><p>The choice made again on resampled blocks of the training record:</p>"
    .. html_table({ "named", "resamples" }, rows)
end

--- " [N]"
local function in_unit(unit) return " [" .. escape(unit) .. "]" end

--- Amplitudes of the unexplained force over the phase of the motion.
local function harmonic_table(harmonics, unit)
  if #harmonics == 0 then return "" end
  local rows = {}
  for i, each in ipairs(harmonics) do
    local seen = each.amplitude and each.level and each.amplitude > each.level
    rows[i] = { ("%d"):format(each.order), number(each.amplitude), number(each.level), seen and "yes" or "" }
  end
  return html_table({ "harmonic", "amplitude" .. unit, "noise alone stays below" .. unit, "above it" }, rows)
end

--- Of an unknown effect: the harmonics of its force, and the model that follows it without a name.
local function unknown_section(found)
  local data = found.data
  if not data.unknown_force then return "" end
  local lines = { "<h3>What its force looks like</h3>",
    "<p>Amplitudes of the force that the baseline leaves unexplained, over the phase of the motion:</p>",
    harmonic_table(data.unknown_force.harmonics, in_unit(data.units.F)) }
  if not data.closure then
    lines[#lines + 1] = "<p>No forces of y and v without a name lower the gap on the test record: "
      .. "there is no model of it to simulate.</p>"
    return table.concat(lines, "\n")
  end
  lines[#lines + 1] = ("<p>Forces without a name that follow it lower the gap on the training record from %s to %s, and on "
    .. "the test record from %s to %s. <code>closure.lua</code> beside this file is that model, to simulate within the "
    .. "motion of these records:</p><pre>%s</pre>"):format(number(data.final.gap_train, data.final.cause), number(data.closure.gap_train, data.closure.cause),
      number(data.final.gap_test, data.final.cause), number(data.closure.gap_test, data.closure.cause), escape(data.closure.equation))
  lines[#lines + 1] = parameter_table(data.closure.parameters, names_of(found.closure), {})
  return table.concat(lines, "\n")
end

local function named_section(found)
  local data = found.data
  if #data.effects == 0 then
    return "<h2>What is missing</h2><p>No effect was named.</p>" .. unknown_section(found)
  end
  local lines = { "<h2>What is missing</h2>" }
  for _, effect in ipairs(data.effects) do lines[#lines + 1] = effect_section(effect) end
  lines[#lines + 1] = naming_section(data)
  return table.concat(lines, "\n")
end

--- What to measure next: the design that would decide, or what a record must reach to say more.
local function next_section(data)
  local design = data.next_experiment
  if not design then
    local words = { ["unknown-effect"] = "Look at the map of the unexplained force: a record at other amplitudes and "
        .. "frequencies shows whether it follows the displacement, the velocity, or neither. An entry of your own can be put "
        .. "beside the catalogue (<code>lunid.effect</code>).",
      ["nothing-missing"] = "This holds at the amplitudes and frequencies of these records. A record that goes beyond them "
        .. "would show what is hidden there.",
      ["explained"] = "This holds at the amplitudes and frequencies of these records. A record that goes beyond them is the "
        .. "next test." }
    return words[data.verdict] and "<h2>What to measure next</h2><p>" .. words[data.verdict] .. "</p>" or ""
  end
  local rows = {}
  for i, c in ipairs(design.candidates) do
    rows[i] = { "<code>" .. escape(c.name) .. "</code>", escape(c.what), c.force and number(c.force) or number(c.displacement),
      number(c.motion), number(c.separation, c.reason), number(c.expected_z, c.reason) }
  end
  return "<h2>What to measure next</h2><p>" .. escape(design.sentence) .. ".</p>"
    .. html_table({ "excitation", "", design.candidates[1].force and "largest force" .. in_unit(data.units.F)
      or "largest displacement" .. in_unit(data.units.y), "largest motion" .. in_unit(data.units.y), "separation", "expected z" }, rows)
    .. '<p class="small">Separation: what is left between the motions of <code>' .. table.concat(each(design.rivals, escape), "</code> and <code>")
    .. "</code> after each has fitted its parameters to the other's, in standard deviations of the noise ("
    .. number(design.noise) .. "), over " .. number(design.duration) .. " s at " .. number(design.rate)
    .. " Hz. Expected z: what the test between them would say; 2.3 names the truth as often as not, 4 nearly always.</p>"
end

--- Terms of the baseline that may go.
local function removable_section(data)
  if #data.removable == 0 then return "" end
  local rows = {}
  for i, term in ipairs(data.removable) do rows[i] = { "<code>" .. escape(term.term) .. "</code>", escape(term.reason) } end
  return "<h3>Terms of the baseline that these records do not need</h3><p>Offered for removal; nothing was removed. Take one "
    .. "away and run again.</p>" .. html_table({ "term", "why" }, rows)
end

--- Of a closed loop: what answers what, the parameters by instruments, the gaps by other ways of looking.
local function loop_section(found)
  local loop = found.data.closed_loop
  if not loop then return "" end
  local lines = { "<h2>Closed loop</h2><p>" .. escape(loop.sentence) .. ".</p>" }
  if loop.reference and next(loop.by_instruments) then
    local names = {}
    for _, name in ipairs(names_of(found.model)) do names[#names + 1] = loop.by_instruments[name] and name end
    lines[#lines + 1] = "<p>The final model's parameters with <code>" .. escape(loop.reference)
      .. "</code> as instrument, whose motion no noise enters:</p>" .. parameter_table(loop.by_instruments, names, {})
  end
  local rows = {}
  for _, part in ipairs { "train", "test" } do
    for _, way in ipairs { { "force along the measured motion", loop.force[part] }, { "one step", loop.one_step[part] } } do
      rows[#rows + 1] = { way[1] .. ", " .. part, number(way[2].before, way[2].reason), number(way[2].after, way[2].reason) }
    end
  end
  lines[#lines + 1] = "<p>The gap by other ways of looking, which do not let errors add up as a free run does:</p>"
    .. html_table({ "", "baseline", "final model" }, rows)
  return table.concat(lines, "\n")
end

local function figure_section(drawn, why_none)
  local lines = { "<h2>Figures</h2>", '<p class="small">' .. page_of.hint .. "</p>" }
  if why_none then lines[#lines + 1] = "<p>" .. escape(why_none) .. "</p>" end
  for _, picture in ipairs(drawn) do
    if not picture.section then lines[#lines + 1] = page_of.figure(picture.figure, picture.caption, picture.image) end
  end
  return table.concat(lines, "\n")
end

--- What the maps of the residual say, over what each is, and their figure.
local function where_section(found, drawn)
  local data = found.data
  local lines = { "<h2>Where the model failed</h2><p>" .. escape(data.where) .. "</p>" }
  for _, picture in ipairs(drawn) do
    if picture.section == "where" then lines[#lines + 1] = page_of.figure(picture.figure, picture.caption, picture.image) end
  end
  local rows = each(pictures.sentences(found), function(row) return each(row, escape) end)
  if #rows > 0 then
    lines[#lines + 1] = "<p>Over each of these, the force that is left unexplained is" .. (found.map.place ~= ""
      and " (y and v: of " .. escape(found.map.place) .. ")" or "") .. ":</p>"
      .. html_table({ "over", "by the baseline", rows[1][3] and "by the final model" or nil }, rows)
    lines[#lines + 1] = '<p class="small">No data: ' .. escape(data.residual_maps.before.no_data) .. ".</p>"
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

--- What the baseline's parameters were before anything was added.
local function baseline_section(found)
  local data = found.data
  if #data.effects == 0 then return "" end
  return "<p>The baseline alone, fitted to the same record:</p>"
    .. parameter_table(data.baseline.parameters, names_of(found.baseline), data.baseline.first_guess)
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
  local drawn, count, why_none = draw(found, prefix)
  local page = table.concat({
    '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Lunid: ' .. escape(data.verdict)
      .. "</title><style>" .. style .. "</style></head><body>",
    "<h1>What the model lacks</h1>",
    ('<p class="verdict"><b>%s</b>: %s</p>'):format(escape(data.verdict), escape(data.sentence)),
    where_section(found, drawn),
    named_section(found), gap_section(data), "<h2>Equation of motion</h2><pre>" .. escape(data.final.equation) .. "</pre>",
    parameter_table(data.final.parameters, names_of(found.model), data.baseline.first_guess), baseline_section(found),
    removable_section(data), loop_section(found), rivals_section(data), next_section(data), figure_section(drawn, why_none),
    warnings_section(data), provenance(data), page_of.script(), "</body></html>\n" }, "\n")
  return { path = output.write(prefix .. "report.html", page), count = count, note = why_none,
    folder = count > 0 and output.shown(prefix .. "figures") or nil }
end

return report

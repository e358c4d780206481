-- Figures of motion: histories, phase portraits, loops, sections, alignments.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local sources = require "lunid.figures.sources"
local types = schema.types

local time = { name = "time", unit = "s" }
local window = types.is("window", "lunid.window")
local what = { "of", sources.type, required = true,
  help = "records, runs, comparisons or series of plain columns: one or a list" }

--- The windowed sources: records are cut, runs and series are shown within limits of the axis.
local function cut(list, part)
  if not part then return list end
  for _, each in ipairs(list) do
    if each.kind == "record" then
      local record = each.object:window(part.from, part.to)
      each.object, each.column = record, function(name) return record:column(name) end
    end
  end
  return list
end

local function limited(axis, part)
  return { name = axis.name, unit = axis.unit, min = part and part.from, max = part and part.to }
end

-- ---- histories ----

local function shaded(parts)
  local bands = {}
  for i, part in ipairs(parts) do bands[i] = { from = part.from, to = part.to, role = "noise" } end
  return bands
end

figures.define({
  name = "history",
  help = "Channels over time, the whole above and parts of it enlarged below.",
  positional = { "of" },
  fields = {
    what,
    { "channels", types.list(types.string, 1), default = { "y" }, help = "one panel for each" },
    { "window", window, help = "part of the time that is shown" },
    { "zoom", types.either(window, types.list(window, 1)), default = {}, help = "parts that are enlarged" },
  },
  example = [[lunid.figure.history { { record, run }, zoom = { lunid.window(2, 2.3) } }:save "history.png"]],
}, function(given)
  local list = sources.of(given.of, "history")
  local zoom = getmetatable(given.zoom) and { given.zoom } or given.zoom
  local columns, panels = math.max(1, math.min(2, #zoom)), {}
  for _, channel in ipairs(given.channels) do
    local y, curves = sources.axis(channel, sources.unit(list, channel)), sources.curves(list, "t", channel)
    panels[#panels + 1] = { x = limited(time, given.window), y = y, series = curves, bands = shaded(zoom),
      column_span = columns }
    for _, part in ipairs(zoom) do
      panels[#panels + 1] = { title = ("%g to %g s"):format(part.from, part.to), x = limited(time, part), y = y,
        series = curves }
    end
  end
  return { columns = columns, panels = panels, share_x = #zoom == 0 }
end)

-- ---- over the phase plane ----

--- Colours a lone curve by its cycles.
local function coloured(curve, cycles)
  if not cycles then return end
  curve.colour, curve.label, curve.style = cycles, "", "line"
end

local cycle_axis = { name = "cycle", unit = "" }

figures.define({
  name = "phase_portrait",
  help = "Velocity over displacement, or any channel over another; a lone record or run is coloured by its cycles.",
  positional = { "of" },
  fields = {
    what,
    { "x", types.string, default = "y", help = "channel across" },
    { "y", types.string, default = "v", help = "channel upward" },
    { "window", window, help = "part of the records" },
    { "cycles", types.boolean, default = true, help = "colour a lone curve by its cycles" },
  },
  example = [[lunid.figure.phase_portrait { { record, run } }:save "phase.png"]],
}, function(given)
  local list = cut(sources.of(given.of, "phase_portrait"), given.window)
  local curves = sources.curves(list, given.x, given.y)
  if #list == 1 and given.cycles and list[1].kind ~= "series" then coloured(curves[1], sources.cycles(curves[1].x)) end
  return { panels = { { x = sources.axis(given.x, sources.unit(list, given.x)),
    y = sources.axis(given.y, sources.unit(list, given.y)), series = curves, colour = cycle_axis } } }
end)

--- The force of a source: its column, or F - m*a.
local function force_of(source, given)
  if not given.mass then return source.column(given.force) end
  local F, a = source.column(given.force):list(), source.column("a"):list()
  for i = 1, #F do F[i] = F[i] - given.mass*a[i] end
  return core.column(F)
end

figures.define({
  name = "loop",
  help = "The loops of force over displacement and over velocity; those of a lone record or run are coloured by their cycles.",
  positional = { "of" },
  fields = {
    what,
    { "mass", types.number { min = 0 }, unit = "kg", help = "shows the restoring force F - m*a; else the force itself" },
    { "force", types.string, default = "F", help = "channel of the force" },
    { "over", types.list(types.string, 1), default = { "y", "v" }, help = "channels across, one panel for each" },
    { "window", window, help = "part of the records" },
    { "cycles", types.boolean, default = true, help = "colour a lone curve by its cycles" },
  },
  example = [[lunid.figure.loop { record, mass = 49, window = lunid.window(2, 3) }:save "loops.png"]],
}, function(given)
  local list = cut(sources.of(given.of, "loop"), given.window)
  local plain = list[1].kind == "series"
  local cycles = #list == 1 and given.cycles and not plain and sources.cycles(list[1].column(given.over[1])) or nil
  local panels = {}
  for i, channel in ipairs(plain and { given.over[1] } or given.over) do
    local series = {}
    for k, each in ipairs(list) do
      series[k] = sources.curves({ each }, channel, given.force)[1]
      if each.kind ~= "series" then series[k].y = force_of(each, given) end
    end
    coloured(series[1], cycles)
    panels[i] = { x = sources.axis(channel, sources.unit(list, channel)), series = series, colour = cycle_axis,
      y = { name = given.mass and "restoring force" or "force", unit = sources.unit(list, given.force) or "N" } }
  end
  return { columns = #panels, panels = panels, share_y = true }
end)

figures.define({
  name = "poincare",
  help = "A Poincare section: the states once per period of the excitation.",
  positional = { "of" },
  fields = {
    { "of", types.either(types.is("section", "lunid.poincare"), figures.series), required = true, help = "what to draw" },
    { "x", types.string, default = "y", help = "column across" },
    { "y", types.string, default = "v", help = "column upward" },
  },
  example = [[lunid.figure.poincare(section):save "section.png"]],
}, function(given)
  local plain = getmetatable(given.of) == "lunid.series"
  if not plain and not given.of.run then
    figures.fail("poincare", "expected a section from lunid.poincare, got one from lunid.section (see figure.sections)")
  end
  return { panels = { { x = sources.axis(given.x), y = sources.axis(given.y), series = { {
    x = plain and given.of.x or given.of:column(given.x), y = plain and given.of.y or given.of:column(given.y),
    role = "first", style = "points", label = plain and given.of.label or "" } } } } }
end)

-- ---- alignment ----

--- At most so many pairs are drawn as links.
local links = 120

figures.define({
  name = "alignment",
  help = "Which rows of two curves dynamic time warping pairs: the curves one above the other with links, and the pairing "
    .. "itself, straight where the paces are alike.",
  positional = { "of" },
  fields = {
    { "of", types.is("pairing", "lunid.statistics.dtw_pairing"), required = true, help = "what to draw" },
    { "dt", types.number { above = 0 }, unit = "s", help = "between rows: shows seconds in place of rows" },
    { "labels", types.list(types.string), default = { "measured", "model" }, help = "of the two curves" },
  },
  example = [[lunid.figure.alignment { pairing, dt = record.dt }:save "dtw.png"]],
}, function(given)
  local pairing, step = given.of, given.dt or 1
  local first, second = pairing.curves[1]:list(), pairing.curves[2]:list()
  local reach = math.max(pairing.curves[1]:max(), pairing.curves[2]:max())
    - math.min(pairing.curves[1]:min(), pairing.curves[2]:min())
  local shift = 0.8 * reach
  local function places(n)
    local list = {}
    for i = 1, n do list[i] = (i - 1)*step end
    return core.column(list)
  end
  for i = 1, #second do second[i] = second[i] - shift end
  local x, y, a, b = {}, {}, pairing.a:list(), pairing.b:list()
  for i = 1, #a, math.max(1, #a // links) do
    for _, point in ipairs { { a[i], first[a[i]] }, { b[i], second[b[i]] }, { 0/0, 0/0 } } do
      x[#x + 1], y[#y + 1] = (point[1] - 1)*step, point[2]
    end
  end
  for i = 1, #a do a[i], b[i] = (a[i] - 1)*step, (b[i] - 1)*step end
  local ends = core.column { 0, math.min(a[#a], b[#b]) }
  local unit = given.dt and "s" or ""
  local function axis(label) return { name = (given.dt and "time, " or "row, ") .. label, unit = unit } end
  return { columns = 1, panels = {
    { x = { name = given.dt and "time" or "row", unit = unit }, y = { name = "curves, one lowered", unit = "" }, legend = "above",
      series = { { x = core.column(x), y = core.column(y), role = "noise", width = 0.6 },
        { x = places(#first), y = core.column(first), role = "measured", label = given.labels[1] or "first" },
        { x = places(#second), y = core.column(second), role = "final", label = given.labels[2] or "second" } } },
    { note = ("distance %.4g"):format(pairing.distance), x = axis(given.labels[1] or "first"), y = axis(given.labels[2] or "second"),
      series = { { x = ends, y = ends, role = "noise", style = "dashed", label = "equal pace" },
        { x = core.column(a), y = core.column(b), role = "first", label = "pairing" } } } } }
end)

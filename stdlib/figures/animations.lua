-- Animations: frames as PNG files, numbered, for any tool that joins them.
local core = require "lunid.core"
local figures = require "lunid.figures"
local output = require "lunid.output"
local schema = require "lunid.schema"
local sources = require "lunid.figures.sources"
local types = schema.types

local methods = {}

--- Draws all frames into a folder as frame_0001.png and so on.
function methods.save(animation, folder)
  if type(folder) ~= "string" then schema.fail("save", "path: expected a string, got " .. core.describe(folder)) end
  if folder:match "%.%a%w*$" then
    schema.fail("save", ("expected a folder, which gets the frames as PNG files, got '%s'; another tool makes a film of them")
      :format(folder))
  end
  output.make_folder(folder)
  for i = 1, animation.frames do
    core.render_figure(animation.frame(i), output.place(("%s/frame_%04d.png"):format(folder, i)))
  end
  return output.shown(folder)
end

local function animation(frames, frame)
  return schema.object("animation", { frames = frames, frame = frame }, methods, function(self)
    return ("animation of %d frames"):format(self.frames)
  end)
end

local function copy(fields)
  local same = {}
  for key, value in pairs(fields) do same[key] = value end
  return same
end

local frames = { "frames", types.integer { min = 2, max = 10000 }, default = 72, help = "PNG files, frame_0001.png and so on" }

figures.public.turn = schema.define({
  name = "figure.turn",
  help = "A surface that turns once about its upright axis, as PNG frames: animation:save \"folder\".",
  positional = { "figure" },
  fields = { { "figure", figures.type, required = true, help = "with a surface in its first panel" }, frames },
  returns = "animation",
  example = [[lunid.figure.turn { lunid.figure.surface(surface), frames = 36 }:save "turn"]],
}, function(given)
  if not given.figure.panels[1].scene then
    schema.fail("figure.turn", "expected a figure with a surface, such as one of figure.surface")
  end
  return animation(given.frames, function(i)
    local figure = copy(given.figure)
    figure.panels = { copy(figure.panels[1]) }
    figure.panels[1].scene = copy(figure.panels[1].scene)
    figure.panels[1].scene.azimuth = (figure.panels[1].scene.azimuth or -130) + 360*(i - 1)/given.frames
    return figure
  end)
end)

--- Least and largest of a column with a little room.
local function limits(column)
  local low, high = column:min(), column:max()
  local room = high > low and 0.05*(high - low) or 1
  return low - room, high + room
end

figures.public.motion = schema.define({
  name = "figure.motion",
  help = "A motion that runs along its phase portrait and its history, as PNG frames: animation:save \"folder\".",
  positional = { "of" },
  fields = {
    { "of", types.either(types.is("record", "lunid.read"), types.is("run", "lunid.simulate")), required = true,
      help = "a record or a run" },
    { "window", types.is("window", "lunid.window"), help = "part of a record" },
    { "x", types.string, default = "y", help = "channel across" },
    { "y", types.string, default = "v", help = "channel upward" },
    frames,
  },
  returns = "animation",
  example = [[lunid.figure.motion { record, window = lunid.window(2, 3), frames = 100 }:save "motion"]],
}, function(given)
  local source = sources.of(given.of, "motion")[1]
  local record = given.of
  if given.window and source.kind == "record" then record = record:window(given.window.from, given.window.to) end
  local t, x, y = record:column "t", record:column(given.x), record:column(given.y)
  if #t < 2 then schema.fail("figure.motion", ("expected at least 2 rows, got %d"):format(#t)) end
  local across, upward = sources.axis(given.x, source.unit(given.x)), sources.axis(given.y, source.unit(given.y))
  across.min, across.max = limits(x)
  upward.min, upward.max = limits(y)
  local times, xs, ys = t:list(), x:list(), y:list()
  return animation(given.frames, function(i)
    local row = 1 + math.floor((#times - 1)*(i - 1)/(given.frames - 1) + 0.5)
    local function part(list) return core.column(table.move(list, 1, row, 1, {})) end
    local function here(list) return core.column { list[row] } end
    return { columns = 2, panels = {
      { x = across, y = upward, note = ("t = %.4g s"):format(times[row]), series = {
        { x = x, y = y, role = "noise", width = 0.5 }, { x = part(xs), y = part(ys), role = "first" },
        { x = here(xs), y = here(ys), role = "second", style = "points", width = 3 } } },
      { x = { name = "time", unit = "s", min = times[1], max = times[#times] }, y = across, series = {
        { x = t, y = x, role = "noise", width = 0.5 }, { x = part(times), y = part(xs), role = "first" },
        { x = here(times), y = here(xs), role = "second", style = "points", width = 3 } } } } }
  end)
end)

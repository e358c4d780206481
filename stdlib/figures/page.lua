-- Pages on which charts zoom and surfaces turn: one file of HTML that needs no network, no display and no drawing module.
local core = require "lunid.core"
local figures = require "lunid.figures"
local output = require "lunid.output"
local schema = require "lunid.schema"
local types = schema.types

local page = {}

local escapes = { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;" }
function page.escape(text) return (tostring(text):gsub('[&<>"]', escapes)) end

page.style = [[
figure { margin: 1.2rem 0 } figcaption { color: #444; font-size: .92rem }
.lunid-figure canvas { cursor: crosshair } img { max-width: 100% }]]

page.hint = "Wheel or drag: enlarge; shift and drag: move; double click: all again. A surface: drag to turn it."

--- A figure in a page: data for the script, and the PNG (base64, may be nil) that shows where scripts are off.
function page.figure(figure, caption, image)
  local data = core.page_data(figure):gsub("</", "<\\/")
  local picture = image and ('<img alt="%s" src="data:image/png;base64,%s">'):format(page.escape(caption), image) or ""
  local wide = (figure.columns or 1) > 1 and ' class="wide"' or ""  -- panels side by side have the width of a report
  return ('<figure%s><div class="lunid-figure">%s<script type="application/json">%s</script></div><figcaption>%s</figcaption>'
    .. '</figure>'):format(wide, picture, data, page.escape(caption))
end

--- What draws them; comes after the last figure.
function page.script()
  return "<script>\n" .. core.read_text(core.library .. "/web/figure.js") .. "</script>"
end

local methods = {}

function methods.save(self, path)
  if type(path) ~= "string" then schema.fail("save", "path: expected a string, got " .. core.describe(path)) end
  local parts = { '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>' .. page.escape(self.title)
    .. "</title><style>body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }"
    .. page.style .. "</style></head><body>", "<h1>" .. page.escape(self.title) .. "</h1>", "<p>" .. page.hint .. "</p>" }
  for i, figure in ipairs(self.figures) do parts[#parts + 1] = page.figure(figure, self.captions[i] or "") end
  parts[#parts + 1] = page.script()
  parts[#parts + 1] = "</body></html>\n"
  return output.write(path, table.concat(parts, "\n"))
end

figures.public.page = schema.define({
  name = "figure.page",
  help = "Figures on one page of HTML on which charts zoom and surfaces turn, without a network: page:save \"figures.html\".",
  positional = { "figures" },
  fields = {
    { "figures", types.list(figures.type, 1), required = true, help = "in their order" },
    { "title", types.string, default = "Figures", help = "above them" },
    { "captions", types.list(types.string), default = {}, help = "one under each" },
  },
  returns = "page",
  example = [[lunid.figure.page { { lunid.figure.surface(surface), lunid.figure.history(record) } }:save "figures.html"]],
}, function(given)
  return schema.object("page", given, methods, function(self) return ("page of %d figures"):format(#self.figures) end)
end)

return page

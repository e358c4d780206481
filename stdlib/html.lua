-- Pieces of a page that stands alone: no file beside it, no network.
local html = {}

local escapes = { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;" }

function html.escape(text) return (tostring(text):gsub('[&<>"]', escapes)) end

html.style = [[
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a }
h1 { font-size: 1.5rem } h2 { font-size: 1.25rem; margin-top: 2.6rem; border-bottom: 1px solid #ccc } h3 { font-size: 1.05rem }
table { border-collapse: collapse; margin: .8rem 0; font-size: .92rem } caption { text-align: left; color: #444 }
th, td { padding: .25rem .7rem; text-align: left; border-bottom: 1px solid #e2e2e2; vertical-align: top }
pre { background: #f5f5f5; padding: .7rem; overflow-x: auto } td.n { font-variant-numeric: tabular-nums } .scroll { overflow-x: auto }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(30rem, 1fr)); gap: 1rem }
figure { margin: 0 } figure.wide { grid-column: 1 / -1 } img { max-width: 100% } figcaption { color: #444; font-size: .92rem } nav a { margin-right: 1rem }]]

local function row(cells, count, tag)
  local parts = {}
  for i = 1, count do
    parts[i] = ("<%s%s>%s</%s>"):format(tag, tag == "td" and i > 1 and ' class="n"' or "", html.escape(cells[i] or ""), tag)
  end
  return "<tr>" .. table.concat(parts) .. "</tr>"
end

--- A table of texts: { head = { ... }, rows = { { ... } ... }, caption = }.
function html.table(given)
  local lines = { '<div class="scroll"><table>', given.caption and "<caption>" .. html.escape(given.caption) .. "</caption>"
    or "", row(given.head, #given.head, "th") }
  for _, cells in ipairs(given.rows) do lines[#lines + 1] = row(cells, #given.head, "td") end
  lines[#lines + 1] = "</table></div>"
  return table.concat(lines, "\n")
end

function html.page(title, body)
  return table.concat({ '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>' .. html.escape(title)
    .. "</title><style>" .. html.style .. "</style></head><body>", body, "</body></html>\n" }, "\n")
end

return html

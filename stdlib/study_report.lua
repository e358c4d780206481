-- lunid.report: what a study found, told once and shown in the terminal, in report.html and in results.json.
local core = require "lunid.core"
local html = require "lunid.html"
local output = require "lunid.output"
local page_of = require "lunid.figures.page"
local schema = require "lunid.schema"
local types = schema.types

local study_report = { saved = {} }  -- saved: the reports that this process has written, for a page of all of them

local width = 118  -- of lines in the terminal

--- A text in lines that fit the terminal.
local function wrapped(text)
  local lines, line = {}, ""
  for word in text:gmatch "%S+" do
    if #line + #word + 1 > width and line ~= "" then
      lines[#lines + 1], line = line, word
    else
      line = line == "" and word or line .. " " .. word
    end
  end
  lines[#lines + 1] = line
  return table.concat(lines, "\n")
end

--- A number as tables show it; nil as "-".
local function cell(value)
  if value == nil or value == false then return "-" end
  if math.type(value) == "float" then return value == value and ("%.4g"):format(value) or "-" end
  return tostring(value)
end

local function print_table(given)
  local widths = {}
  for _, cells in ipairs { given.head, table.unpack(given.rows) } do
    for i = 1, #given.head do widths[i] = math.max(widths[i] or 0, utf8.len(cells[i]) or #cells[i]) end
  end
  if given.caption then print("\n" .. wrapped(given.caption)) else print "" end
  for _, cells in ipairs { given.head, table.unpack(given.rows) } do
    local parts = {}
    for i = 1, #given.head do
      parts[i] = cells[i] .. (" "):rep(i < #given.head and widths[i] - (utf8.len(cells[i]) or #cells[i]) or 0)
    end
    print("  " .. table.concat(parts, "  "))
  end
end

local methods = {}

local function check_text(method, text)
  if type(text) ~= "string" then schema.fail("report:" .. method, "expected a string, got " .. core.describe(text)) end
end

--- A paragraph.
function methods.text(self, text)
  check_text("text", text)
  print("\n" .. wrapped(text))
  self.parts[#self.parts + 1] = { text = text }
end

--- A text as it stands, line by line, such as print shows of a result.
function methods.verbatim(self, text)
  check_text("verbatim", text)
  print("\n" .. text)
  self.parts[#self.parts + 1] = { verbatim = text }
end

--- A heading.
function methods.section(self, title)
  check_text("section", title)
  print("\n" .. title .. "\n" .. ("-"):rep(utf8.len(title) or #title))
  self.parts[#self.parts + 1] = { section = title }
end

local function is_plain_table(value) return type(value) == "table" and getmetatable(value) == nil end

--- Raises where a table of a report has other fields, more cells than its head, or cells that no table can show.
local function check_table(given)
  local where = "report:table"
  if not is_plain_table(given) or not is_plain_table(given.head) or not is_plain_table(given.rows) then
    schema.fail(where, "expected { head = { ... }, rows = { { ... }, ... } }")
  end
  for key in pairs(given) do
    if key ~= "head" and key ~= "rows" and key ~= "caption" then
      schema.fail(where, ("unknown field '%s' (fields: head, rows, caption)"):format(key))
    end
  end
  if given.caption ~= nil and type(given.caption) ~= "string" then
    schema.fail(where, "caption: expected a string, got " .. core.describe(given.caption))
  end
  if #given.head == 0 then schema.fail(where, "head: expected a list of strings, got an empty table") end
  for i, title in ipairs(given.head) do
    if type(title) ~= "string" and type(title) ~= "number" then
      schema.fail(where, ("head: entry %d: expected a string, got %s"):format(i, core.describe(title)))
    end
  end
  for r, cells in ipairs(given.rows) do
    if not is_plain_table(cells) then
      schema.fail(where, ("row %d: expected a list of cells, got %s"):format(r, core.describe(cells)))
    end
    for key, value in pairs(cells) do
      if math.type(key) ~= "integer" then
        schema.fail(where, ("row %d: expected a list of cells, got the field '%s'"):format(r, tostring(key)))
      end
      if key < 1 or key > #given.head then
        schema.fail(where, ("row %d: expected at most %d cells, as many as the head has, got a cell %d: %s"):format(r,
          #given.head, key, core.describe(value)))
      end
      if is_plain_table(value) or type(value) == "function" then
        schema.fail(where, ("row %d: cell %d: expected a text or a number, got %s"):format(r, key, core.describe(value)))
      end
    end
  end
end

--- A table of texts and numbers: head, rows, caption. A number is shown with four digits; nil, `false`, and what a row
--- lacks at its end as "-".
function methods.table(self, given)
  check_table(given)
  local shown = { head = given.head, rows = {}, caption = given.caption }
  for r, cells in ipairs(given.rows) do
    local texts = {}
    for i = 1, #given.head do texts[i] = cell(cells[i]) end
    shown.rows[r] = texts
  end
  print_table(shown)
  self.parts[#self.parts + 1] = { table = shown }
end

--- Draws a figure to figures/NAME.png; says once why it cannot be, the page shows it all the same.
local function drawn(self, name, figure)
  if self.no_figures then return nil end
  local path = output.place("figures/" .. name .. ".png")
  local good, message = pcall(core.render_figure, figure, path)
  if good then return core.base64(core.read_text(path)) end
  if tostring(message):match "interrupted" then error(message, 0) end
  self.no_figures = tostring(message)
  self:text("Figures could not be drawn as files: " .. self.no_figures)
end

--- Draws a figure to figures/NAME.png with its numbers beside it, and shows it on the page, where it zooms and turns.
function methods.figure(self, name, figure, caption)
  check_text("figure", name)
  if getmetatable(figure) ~= "lunid.figure" then
    schema.fail("report:figure", "expected report:figure(name, figure, caption), got " .. core.describe(figure) .. " for the figure")
  end
  if caption ~= nil then check_text("figure", caption) end
  output.make_folder "figures"
  core.export_figure(figure, output.place("figures/" .. name .. ".csv"))
  self.parts[#self.parts + 1] = { figure = page_of.figure(figure, caption or name, drawn(self, name, figure)) }
end

--- What results.json is to hold: anything that JSON can; a later call adds to it.
function methods.results(self, results)
  if not is_plain_table(results) then
    schema.fail("report:results", "expected a table { name = value }, got " .. core.describe(results))
  end
  for key, value in pairs(results) do
    if type(key) ~= "string" then
      schema.fail("report:results", ("expected name = value, got entry %s: %s"):format(tostring(key), core.describe(value)))
    end
  end
  for key, value in pairs(results) do self.data[key] = value end
end

--- One line on the way, to the error stream: what is done of how much.
function methods.progress(self, what, done, total)
  check_text("progress", what)
  for _, count in ipairs { { "done", done }, { "total", total } } do
    if type(count[2]) ~= "number" or not math.tointeger(count[2]) then
      schema.fail("report:progress", ("%s: expected a whole number, got %s"):format(count[1], core.describe(count[2])))
    end
  end
  io.stderr:write(("  %s: %s %d of %d, %.0f s\n"):format(self.title:match "^[^:]+", what, done, total, os.clock() - self.began))
end

local function body(self)
  local lines, in_figures = { ("<h2>%s</h2>"):format(html.escape(self.title)) }, false
  for _, part in ipairs(self.parts) do
    if (part.figure ~= nil) ~= in_figures then
      lines[#lines + 1] = part.figure and '<div class="figures">' or "</div>"
      in_figures = part.figure ~= nil
    end
    lines[#lines + 1] = part.verbatim and "<pre>" .. html.escape(part.verbatim) .. "</pre>" or part.text and "<p>" .. html.escape(part.text) .. "</p>"
      or part.section and "<h3>" .. html.escape(part.section) .. "</h3>"
      or part.table and html.table(part.table) or part.figure
  end
  if in_figures then lines[#lines + 1] = "</div>" end
  return table.concat(lines, "\n")
end

--- Writes report.html, and results.json where there are results, to the out directory.
function methods.save(self, path)
  if path ~= nil then
    schema.fail("report:save", ("takes no path: it writes report.html to the directory of --out, got %s"):format(core.describe(path)))
  end
  if next(self.data) then output.write_json("results.json", self.data) end
  study_report.saved[#study_report.saved + 1] = self
  return output.write("report.html", html.page(self.title, "<p>" .. page_of.hint .. "</p>\n" .. body(self) .. page_of.script()))
end

for name, method in pairs(methods) do
  methods[name] = function(self, ...)
    if getmetatable(self) ~= "lunid.report" then schema.fail("report:" .. name, "expected report:" .. name .. "(...), with a colon") end
    return method(self, ...)
  end
end

--- One page of several reports.
function study_report.page(title, reports)
  local lines, links = { "<h1>" .. html.escape(title) .. "</h1>" }, {}
  for i, each in ipairs(reports) do
    links[i] = ('<a href="#r%d">%s</a>'):format(i, html.escape(each.title))
  end
  lines[2] = "<p>" .. page_of.hint .. "</p><nav>" .. table.concat(links, "\n") .. "</nav>"
  for i, each in ipairs(reports) do lines[#lines + 1] = ('<section id="r%d">%s</section>'):format(i, body(each)) end
  lines[#lines + 1] = page_of.script()
  return html.page(title, table.concat(lines, "\n"))
end

study_report.public = {
  report = schema.define({
    name = "report",
    help = "What a study found, in the terminal, in report.html and in results.json: report:section(title), report:text(words), "
      .. "report:verbatim(text), "
      .. "report:table { head =, rows =, caption = } (no row longer than the head), report:figure(name, figure, caption), report:results { ... }, "
      .. "report:progress(what, done, total), and at the end report:save().",
    fields = {
      { "title", types.string, required = true, help = "above the page" },
    },
    returns = "report",
    example = [[
local report = lunid.report { title = "Run 3" }
report:table { head = { "term", "value" }, rows = { { "k", 2e4 }, { "c", 10 } } }
report:save()]],
  }, function(given)
    print("\n" .. given.title .. "\n" .. ("="):rep(utf8.len(given.title) or #given.title))
    return schema.object("report", { title = given.title, parts = {}, data = {}, began = os.clock() }, methods)
  end),
}

return study_report

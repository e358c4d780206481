-- Pages in a browser, without a network: figures draw themselves, zoom and turn, and nothing complains.
local lunid = require "lunid"
local spec = require "spec"
local figure = lunid.figure

local browser = spec.shell "command -v chromium chromium-browser google-chrome | head -n 1":gsub("%s+$", "")
if browser == "" then return spec.skip "there is no Chromium (apt-get install chromium)" end

--- What is written into a copy of a page: how much ink each canvas has, and whether it changes under the wheel and comes back.
local watcher = [[
<script>
const seen = [];
addEventListener("error", (event) => seen.push("error: " + event.message));
const image = (c) => c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
const ink = (c) => { const d = image(c); let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] !== d[0] || d[i + 1] !== d[1]; return n; };
const text = (c) => c.toDataURL();
setTimeout(() => {
  dispatchEvent(new Event("beforeprint"));  // draws what has not come into view: without a window nothing does
  for (const canvas of document.querySelectorAll("canvas")) {
    const before = text(canvas), at = canvas.getBoundingClientRect();
    const to = { clientX: at.left + at.width / 2, clientY: at.top + at.height / 2, bubbles: true, cancelable: true };
    canvas.dispatchEvent(new WheelEvent("wheel", { ...to, deltaY: -400 }));
    const zoomed = text(canvas) !== before;
    canvas.dispatchEvent(new MouseEvent("dblclick", to));
    seen.push(`ink ${ink(canvas)} zooms ${zoomed} back ${text(canvas) === before}`);
  }
  const drawn = [...document.querySelectorAll(".lunid-figure")].map((holder) => holder.dataset.drawn);
  document.body.dataset.seen = `[drawn ${drawn.join(" ")}] ` + seen.join("; ");
}, 1500);
</script>]]

--- Opens a page: { what the watcher saw, lines of the console, bytes of a screenshot }.
local function opened(name)
  local file = assert(io.open(spec.folder .. "/" .. name))
  local page = file:read "a"
  file:close()
  spec.write("watched.html", (page:gsub("</body>", function() return watcher .. "</body>" end)))
  local options = "--headless --no-sandbox --disable-gpu --disable-dev-shm-usage --window-size=1100,5000 --virtual-time-budget=6000 "
    .. "--user-data-dir=profile --host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr"
  local dom = spec.shell(("'%s' %s --dump-dom 'file://%s/watched.html' 2>console.txt"):format(browser, options, spec.folder))
  spec.shell(("'%s' %s --screenshot=shot.png 'file://%s/%s' 2>/dev/null"):format(browser, options, spec.folder, name))
  local shot = io.open(spec.folder .. "/shot.png", "rb")
  local bytes = shot and shot:read "a" or ""
  if shot then shot:close() end
  return dom:match 'data%-seen="([^"]*)"' or "nothing: " .. dom:sub(1, 400), spec.shell "grep CONSOLE console.txt; true", bytes
end

local wave, hills = { {}, {} }, {}
for i = 1, 200 do
  wave[1][i], wave[2][i] = i/100, math.sin(i/10)
  if i <= 20 then
    hills[i] = {}
    for k = 1, 20 do hills[i][k] = math.sin(i/4)*math.cos(k/4) end
  end
end
local places = {}
for i = 1, 20 do places[i] = i end
local chart = figure.lines { series = { figure.series { wave[1], wave[2], label = "wave" } }, x = "time [s]", y = "y [m]" }
local surface = figure.relief { x = places, y = places, z = hills }
local map = figure.map { x = places, y = places, z = hills, contours = true }
local bars = figure.contributions { { { "y", 80 }, { "v", 20 } } }

spec.case("a page of figures: each is drawn, zooms or turns, and comes back", function()
  figure.page { { chart, surface, map, bars } }:save(spec.folder .. "/page.html")
  local seen, console, shot = opened "page.html"
  spec.contains(seen, "[drawn 1 1 1 1]")
  local count = 0
  for ink, zooms, back in seen:gmatch "ink (%d+) zooms (%a+) back (%a+)" do
    count = count + 1
    assert(tonumber(ink) > 3000, "an empty canvas: " .. seen)
    spec.equal(zooms .. " " .. back, "true true")
  end
  spec.equal(count, 4)
  assert(not seen:find "error", seen)
  spec.equal(console, "")
  assert(shot:sub(2, 4) == "PNG" and #shot > 30000, "the screenshot has " .. #shot .. " bytes")
end)

spec.case("the report of a study has its figures, and says so where there are no scripts", function()
  spec.write("study.lua", [[
local lunid = require "lunid"
local report = lunid.report { title = "A study" }
report:section "First"
report:figure("wave", lunid.figure.lines { series = { lunid.figure.series { { 0, 1, 2 }, { 0, 1, 4 } } } }, "A wave & more")
report:table { head = { "a" }, rows = { { 1 } } }
report:save()]])
  local said, code = spec.lunid "run study.lua --out report"
  spec.equal(code, 0)
  spec.contains(said, "report.html")
  local seen, console = opened "report/report.html"
  spec.contains(seen, "[drawn 1] ink ")
  spec.contains(seen, "zooms true back true")
  spec.equal(console, "")
  spec.contains(spec.shell "cat report/report.html", '<img alt="A wave &amp; more" src="data:image/png;base64,')
end)

spec.clean()
spec.finish()

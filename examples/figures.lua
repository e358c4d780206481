-- Every kind of figure, each drawn from Lunid's own results: one file each, all on one contact sheet, and a page on which
-- they zoom and turn.
local lunid = require "lunid"
local figure = lunid.figure
local y, v = lunid.displacement, lunid.velocity

-- A hardening spring under two sweeps, measured with noise, and what can be made of it.
local truth = lunid.model { mass = 2, restoring = 800*y + 4e6*y^3 + 6*v }
local function measured(from, to, seed)
  local push = lunid.excitation.swept_sine { from = from, to = to, amplitude = 25, dt = 0.002, duration = 8 }
  return lunid.simulate { model = truth, excitation = push }:record():with_noise { y = 0.02, v = 0.02, a = 0.02, F = 0.01,
    seed = seed }
end
local record, other = measured(1, 12, 4), measured(12, 2, 5)
local k, c = lunid.parameter { "k", 800, min = 0, unit = "N/m" }, lunid.parameter { "c", 6, min = 0, unit = "N s/m" }
local linear = lunid.model { mass = 2, restoring = k*y + c*v }
local run = lunid.simulate { model = linear, excitation = record, from = "record" }
local compared = lunid.compare { record = record, run = run }
local library = { y, v, y^2, y*v, v^2, y^3, y^2*v, y*v^2, v^3 }
local lasso = lunid.regress { record = record, mass = 2, features = library, solver = lunid.lasso {} }
local stepwise = lunid.regress { record = record, mass = 2, features = library, solver = lunid.frols {} }
local fit = lunid.fit_trajectory { model = lunid.model { mass = 2, restoring = k*y + c*v
  + lunid.parameter { "k3", 3e6, unit = "N/m^3" }*y^3 }, record = record }
local surface = lunid.rfs { record = record, mass = 2, interpolate = lunid.grid { cells = { 24, 24 } } }
local found = lunid.discover { model = linear, train = record, test = other, out = "discovery",
  catalogue = { "cubic_stiffness", "coulomb_friction", "quadratic_drag", "clearance" } }
local response = lunid.frequency_response { model = truth, amplitude = { 5, 15 }, from = 1, to = 12 }
local w = 1.2
local chaos = lunid.poincare { model = lunid.model { mass = 1, restoring = 0.3*v - y + y^3 },
  excitation = 0.5*lunid.cos(w*lunid.time), period = 2*math.pi/w, from = { 0.5, 0 }, points = 2000 }
local decay = lunid.window(2, 3)
local warped = lunid.statistics.dtw_pairing({ record:window(4, 5):column "y" },
  { run:record():window(4, 5):column "y" }, 100)

local places, ripple = {}, {}
for i = 1, 60 do places[i], ripple[i] = (i - 30.5)/3, {} end
for i = 1, 60 do
  for j = 1, 60 do
    local r = math.sqrt(places[i]^2 + places[j]^2)
    ripple[i][j] = math.sin(r)/r
  end
end

local sheet, count = {}, 0
local function add(name, kind)
  count = count + 1
  kind:save(("figures/%02d_%s.png"):format(count, name))
  kind:export(("figures/%02d_%s.csv"):format(count, name))
  sheet[count] = kind
end

add("history", figure.history { compared, zoom = { lunid.window(2, 2.5), lunid.window(6, 6.5) }, title = "history" })
add("phase_portrait", figure.phase_portrait { record, window = decay, title = "phase_portrait" })
add("loop", figure.loop { record, mass = 2, window = decay, title = "loop" })
add("poincare", figure.poincare { chaos, title = "poincare" })
add("alignment", figure.alignment { warped, dt = record.dt, labels = { "measured", "linear model" }, title = "alignment" })
add("residual_map", figure.residual_map { record = record, model = linear, title = "residual_map" })
add("residual_over_time", figure.residual_map { found, over = "time", title = "residual_map over time" })
add("surface", figure.surface { surface, title = "surface" })
add("contour", figure.contour { surface, title = "contour" })
add("side_views", figure.side_views { surface, title = "side_views" })
add("sections", figure.sections { surface, v = { 0, 0.1 }, y = { 0, 0.01 }, title = "sections" })
add("coefficient_path", figure.coefficient_path { lasso, title = "coefficient_path" })
add("score", figure.score { stepwise, title = "score" })
add("pareto", figure.pareto { figure.series { { 1, 2, 2, 3, 3, 4, 5 }, { 0.6, 0.31, 0.4, 0.05, 0.22, 0.049, 0.048 } },
  title = "pareto" })
add("contributions", figure.contributions { stepwise, cut_off = 5, title = "contributions" })
add("intervals", figure.intervals { fit, truth = { k = 800, c = 6, k3 = 4e6 }, title = "intervals" })
add("information_matrix", figure.information_matrix { record, rows = 1000, title = "information_matrix" })
add("correlation_matrix", figure.correlation_matrix { fit, title = "correlation_matrix" })
add("qq", figure.qq { compared, title = "qq" })
add("histogram", figure.histogram { compared, title = "histogram" })
add("correlogram", figure.correlogram { compared, dt = record.dt, title = "correlogram" })
add("spectrum", figure.spectrum { { record, other }, labels = { "upward", "downward" }, title = "spectrum" })
add("spectrogram", figure.spectrogram { record, to = 40, length = 512, title = "spectrogram" })
add("coherence", figure.coherence { record, to = 40, title = "coherence" })
add("transfer", figure.transfer { record, to = 40, title = "transfer" })
add("response", figure.response { response, title = "response" })
add("gaps", figure.gaps { found, title = "gaps" })
add("rivals", figure.rivals { found, title = "rivals" })
add("named_force", figure.named_force { found, title = "named_force" })
add("failures", figure.failures { found, title = "failures" })
add("map_before_after", figure.residual_map { found, title = "residual_map of a discovery" })
add("relief", figure.relief { x = places, y = places, z = ripple, title = "relief" })
add("map", figure.map { x = places, y = places, z = ripple, contours = true, title = "map" })

figure.grid { sheet, columns = 6, width = 84, dpi = 110 }:save "contact_sheet.png"
figure.page { sheet, title = "Every kind of figure" }:save "figures.html"
sheet[1]:save "history.svg"
sheet[8]:save "surface.pdf"
for _, extension in ipairs { "vts", "vtp", "vtu", "vtm" } do sheet[8]:export("surfaces/surface." .. extension) end
figure.turn { sheet[8], frames = 4 }:save "turn"
figure.motion { record, window = decay, frames = 4 }:save "motion"
print(("%d kinds of figure, all on contact_sheet.png and on figures.html"):format(count))

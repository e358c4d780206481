-- report.html and the figures of a discovery say what discovery.json says.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", min = 0, unit = "N/m" }
local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local k3 = lunid.parameter { "k3", unit = "N/m^3" }

local function read(path)
  local file = assert(io.open(spec.folder .. "/" .. path))
  local text = file:read "a"
  file:close()
  return text
end

--- Rows of figures/NAME.csv: { panel, kind, label, name, x, y, z }.
local function numbers(folder, name)
  local rows = {}
  for line in read(folder .. "/figures/" .. name .. ".csv"):gmatch "[^\n]+" do
    local row = {}
    local plain = line:gsub('"([^"]*)"', function(text) return (text:gsub(",", "\1")) end)
    for cell in (plain .. ","):gmatch "([^,]*)," do row[#row + 1] = (cell:gsub("\1", ",")) end
    if line:sub(1, 1) ~= "#" and row[1] ~= "panel" then rows[#rows + 1] = row end
  end
  return rows
end

--- As a page writes it.
local function page_text(text) return (text:gsub("[&<>]", { ["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;" })) end

local function labels(rows)
  local seen, list = {}, {}
  for _, row in ipairs(rows) do
    if not seen[row[3]] then list[#list + 1] = row[3] end
    seen[row[3]] = true
  end
  return table.concat(list, "; ")
end

local function discover(restoring, catalogue, folder)
  local found = lunid.discover {
    model = lunid.model { mass = 49, restoring = restoring },
    train = lunid.read "../data/spring_multisine.csv",
    test = lunid.read "../data/spring_sweep.csv",
    catalogue = catalogue,
  }
  found:save(spec.folder .. "/" .. folder)
  return found
end

local named = discover(k*y + c*v, { "cubic_stiffness" }, "named")
local nothing = discover(k*y + c*v + k3*y^3, { "coulomb_friction" }, "nothing")

spec.case("the model that is saved reads forces as it was fitted", function()
  local model, data = lunid.load(spec.folder .. "/named/model.lua"), named.data
  spec.equal(model.interpolation, data.method.force_between_samples)
  local sweep = lunid.read "../data/spring_sweep.csv"
  local function gap(how)
    local run = lunid.simulate { model = model, excitation = sweep, interpolation = how }
    return lunid.statistics.nrmse(sweep:column "y", run:column "y")
  end
  assert(gap() < 1.1*data.final.gap_test and gap() < 0.85*gap "linear", gap())
end)

spec.case("the page holds the verdict and the gaps of discovery.json", function()
  local page, data = read "named/report.html", named.data
  spec.equal(data.verdict, "explained")
  spec.contains(page, data.sentence)
  for _, gap in ipairs { data.baseline.gap_train, data.baseline.gap_test, data.final.gap_train, data.final.gap_test,
    data.noise_floor.gap_train, data.noise_floor.gap_test, data.left_out.gap_before, data.left_out.gap_after } do
    spec.contains(page, ("<td class=\"n\">%.3g</td>"):format(gap))
  end
  spec.equal(data.noise_floor.read_off, "the quietest band of the spectrum")
  spec.contains(page, "read off " .. data.noise_floor.read_off)
end)

spec.case("the maps of the residual, each with its level, are drawn, said and written", function()
  local before, after, page = named.data.residual_maps.before, named.data.residual_maps.after, read "named/report.html"
  spec.contains(page, "<h2>Where the model failed</h2>")
  local drawn = numbers("named", "where_it_fails")
  local points = {}
  for _, row in ipairs(drawn) do
    local key = row[1] .. " " .. row[3]
    local list = points[key] or { count = 0 }
    list.count = list.count + 1
    list[list.count], points[key] = tonumber(row[6]), list
  end
  for i, over in ipairs { "time", "slow_time", "y", "v", "amplitude", "harmonic", "frequency", "phase_plane" } do
    spec.contains(page, page_text(before[over].sentence))
    spec.contains(page, page_text(after[over].sentence))
    if over ~= "slow_time" and over ~= "phase_plane" then
      local baseline, level = points[i .. " baseline"], points[i .. " noise, 95 %"]
      local middle = #before[over].x // 2
      spec.equal(baseline.count, #before[over].x)
      spec.equal(baseline[middle], before[over].value[middle])
      spec.equal(level[middle], before[over].level[middle])
      spec.equal(points[i .. " final model"][middle], after[over].value[middle])
    end
  end
  assert(points["8 above the noise"].count > 10, "the phase plane does not mark where the baseline fails")
  spec.equal(before.y.above, true)
  spec.contains(before.harmonic.sentence, "most in the third harmonic")
  spec.contains(before.amplitude.sentence, "above the noise")
  spec.equal(after.y.above, false)
  spec.equal(named.maps.before.y.sentence, before.y.sentence)
  spec.equal(nothing.data.residual_maps.after, nil)
end)

spec.case("parameters have as many digits as their standard deviation allows", function()
  local page, parameters = read "named/report.html", named.data.final.parameters
  local row = parameters.cubic_stiffness_k3
  assert(row.std > 1e7 and row.std < 1e8, "the case is no longer what this spec is about")
  spec.contains(page, ("%.4f·10<sup>10</sup>"):format(row.value / 1e10))
  spec.contains(page, ("%.1f·10<sup>7</sup>"):format(row.std / 1e7))
  spec.contains(page, ("<td class=\"n\">%.0f</td>"):format(parameters.k.value))
  local stiffness = named.data.baseline.parameters.k
  assert(stiffness.std > 1e3 and stiffness.std < 1e4, "the case is no longer what this spec is about")
  spec.contains(page, ("<td class=\"n\">%.0f00</td>"):format(stiffness.value / 100))
  assert(not page:find("first guess", 1, true), "no first guess was given, and a column speaks of it")
end)

spec.case("histories show errors over the whole record, and curves where the baseline is worst", function()
  local rows = numbers("named", "history_test_1")
  spec.equal(labels(rows), "measured; error, baseline; error, final model; baseline, free run; final model, free run; "
    .. "left by the baseline; left by the final model")
end)

spec.case("the unexplained force leaves out the ends, where the derivatives are poor", function()
  local first, last
  for _, row in ipairs(numbers("named", "history_train_1")) do
    if row[3] == "left by the baseline" and tonumber(row[6]) == tonumber(row[6]) and tonumber(row[6]) then
      first, last = first or tonumber(row[5]), tonumber(row[5])
    end
  end
  assert(first > 0.01 and last < 7.99, ("drawn from %g to %g s"):format(first, last))
end)

spec.case("a named effect is drawn over what it depends on", function()
  local rows = numbers("named", "named_force")
  spec.equal(labels(rows), "left by the rest of the final model; named effect")
  spec.equal(rows[#rows][1], "1")
end)

spec.case("the steps and the rivals are drawn with the numbers of discovery.json", function()
  local data, values = named.data, {}
  for _, row in ipairs(numbers("named", "gaps")) do
    if row[2] == "bar" then values[row[3] .. " " .. row[4]] = tonumber(row[5]) end
  end
  spec.equal(values["train baseline"], data.baseline.gap_train)
  spec.equal(values["test baseline"], data.baseline.gap_test)
  spec.equal(values["train cubic_stiffness"], data.effects[1].gap_train)
  spec.equal(values["test final"], data.final.gap_test)
  assert(not io.open(spec.folder .. "/nothing/figures/gaps.png"), "no step was made, and a figure shows some")
end)

spec.case("what was named and its rivals are compared by their fits", function()
  local data, values = discover(k*y + c*v, { "cubic_stiffness", "clearance" }, "contested").data, {}
  for _, row in ipairs(numbers("contested", "rivals")) do
    if row[2] == "bar" then values[row[4]] = tonumber(row[5]) end
  end
  spec.equal(values["* cubic_stiffness"], data.final.gap_fit)
  spec.equal(values["clearance"], data.rivals[1].gap)
  assert(data.final.gap_fit < 1.05 * data.noise_floor.gap_train and data.final.gap_fit < data.rivals[1].gap)
  spec.contains(read "contested/report.html", ("the final model's is %.3g"):format(data.final.gap_fit))
end)

--- The cubic coefficient of a force over y and v, beside what is linear in y: of its slopes to two displacements, where the
--- velocity is least.
local function cubic_part(shape)
  local y_values, force = shape.y:list(), shape.force[#shape.force // 2]:list()
  local a, b = 15, 21  -- of 24 cells from side to side
  return (force[b] / y_values[b] - force[a] / y_values[a]) / (y_values[b] ^ 2 - y_values[a] ^ 2)
end

spec.case("an unknown force has a shape, harmonics and a model to simulate", function()
  local found = discover(k*y + c*v, { "coulomb_friction" }, "unknown")
  local data, page = found.data, read "unknown/report.html"
  spec.equal(data.verdict, "unknown-effect")
  local harmonics = data.unknown_force.harmonics
  spec.equal(harmonics[2].order, 1)
  assert(harmonics[2].amplitude > harmonics[2].level and harmonics[3].amplitude < harmonics[3].level, "a cubic spring is odd")
  assert(data.closure.gap_test < 1.1 * data.noise_floor.gap_test, found.sentence)
  spec.near(cubic_part(found.unknown_force), named.data.final.parameters.cubic_stiffness_k3.value, 1e9)
  spec.equal(data.unknown_force.of, "closure")
  spec.equal(#data.unknown_force.force, #found.unknown_force.y)
  spec.equal(lunid.load(spec.folder .. "/unknown/closure.lua"):equation(), found.closure:equation())
  spec.contains(page, found.closure:equation())
  spec.contains(page, ("<td class=\"n\">%.3g</td>"):format(harmonics[2].amplitude))
  spec.equal(numbers("unknown", "unknown_force")[1][2], "map")
  assert(named.unknown_force == nil and named.closure == nil, "a name was found")
end)

--- The record with its displacement as an angle and its force as a moment: the same numbers.
local function turned(name)
  return lunid.read("../data/" .. name, { time = "t", displacement = "y [mrad]", force = "F [kN m]" })
end

spec.case("a shaft's report has moments in N m and angles in rad", function()
  local found = lunid.discover { model = lunid.model { mass = 49, restoring = lunid.parameter "k"*y + lunid.parameter "c"*v },
    train = turned "spring_multisine.csv", test = turned "spring_sweep.csv", catalogue = { "coulomb_friction" } }
  found:save(spec.folder .. "/shaft")
  local data, page = found.data, read "shaft/report.html"
  local units = data.units
  spec.equal(table.concat({ units.y, units.v, units.a, units.F }, " "), "rad rad/s rad/s^2 N m")
  spec.contains(read "shaft/figures/residual_map.csv",
    "x: displacement [rad]; y: velocity [rad/s]; z: unexplained force [N m]")
  spec.contains(read "shaft/figures/history_test_1.csv", "y: displacement [rad]")
  spec.contains(page, "<th>amplitude [N m]</th>")
  spec.equal(data.closure.parameters.closure_5.unit, "N m")
  for _, file in ipairs { "report.html", "figures/unknown_force.csv", "figures/history_train_1.csv" } do
    assert(not read("shaft/" .. file):find "%[m%]" and not read("shaft/" .. file):find "%[N%]", file)
  end
end)

spec.case("the page draws its figures itself, from numbers that lie inside, and asks for nothing", function()
  local page = read "named/report.html"
  local _, charts = page:gsub('<div class="lunid%-figure">', "")
  local _, pictures = page:gsub('<img alt="[^"]*" src="data:image/png;base64,', "")
  local _, captions = page:gsub("<figcaption>[^<]", "")
  spec.equal(charts, 6)
  spec.equal(pictures, 6)  -- for where scripts are off
  spec.equal(captions, 6)
  assert(not page:find("https?://") and not page:find('src="[^d]') and not page:find "<link", "the page asks for something")
  local first = page:match '<script type="application/json">(.-)</script>'
  spec.contains(first, '"title":"slow time, baseline"')
  spec.contains(first, '"label":"noise, 95 %"')
  spec.contains(page, '"title":"whole record"')
  spec.contains(page, '"label":"measured"')
  spec.contains(page, "document.querySelectorAll(\".lunid-figure\")")
end)

spec.case("a second discovery of a study does not write over the first", function()
  spec.write("good.csv", (function()
    local rows, y, v = { "t,F,y" }, 0.01, 0
    for i = 0, 600 do
      local force = 20 * math.sin(0.07 * i)
      rows[#rows + 1] = ("%.3f,%.17g,%.17g"):format(i * 0.01, force, y)
      for _ = 1, 10 do
        v = v + 0.001 * (force - 100 * y - 0.8 * v)
        y = y + 0.001 * v
      end
    end
    return table.concat(rows, "\n") .. "\n"
  end)())
  local said, code = spec.study [[
local lunid = require "lunid"
for _ = 1, 2 do
  lunid.discover { model = lunid.model { mass = 1, restoring = lunid.parameter { "k" } * lunid.displacement },
    train = lunid.read "good.csv", catalogue = { "viscous_damping" } }
end
]]
  spec.equal(code, 0)
  spec.contains(said, "study-out/discovery.json")
  spec.contains(said, "study-out/discovery_2 (")
end)

spec.case("where nothing is named there is one model, not two", function()
  spec.equal(nothing.verdict, "nothing-missing")
  spec.equal(labels(numbers("nothing", "history_train_1")), "measured; error, baseline; baseline, free run; left by the baseline")
  local rows = numbers("nothing", "residual_map")
  spec.equal(rows[#rows][1], "1")
  assert(not io.open(spec.folder .. "/nothing/figures/named_force.png"))
end)

spec.case("a baseline whose run explodes is said to, and no gap is nan or inf", function()
  local found = discover(c*v - 1e6*y, { "linear_stiffness", "cubic_stiffness" }, "explodes")
  local text, page = tostring(found), read "explodes/report.html":gsub("<script.->.-</script>", ""):gsub("base64,[^\"]*", "")
  for _, word in ipairs { "%f[%w]nan%f[%W]", "%f[%w]inf%f[%W]" } do
    assert(not text:find(word), text)
    local at = page:find(word)
    assert(not at, at and "the page shows " .. page:sub(at - 20, at + 20))
  end
  spec.contains(text, "gap  train none (the run explodes) -> ")
  spec.contains(text, "left-out blocks of train none (the run explodes) -> ")
  spec.contains(text, "the restoring force drives y away from rest at any displacement")
  assert(not text:find "e%-31", text)
  for _, rival in ipairs(found.rivals) do assert(rival.remark ~= "no better than the baseline", rival.name) end
end)

spec.clean()
spec.finish()

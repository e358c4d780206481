-- The figures of a scoreboard: terms compared, forces along the motion, residuals and their quantiles, free runs.
local core = require "lunid.core"
local figures = require "lunid.figures"
local statistics = require("lunid.statistics").public.statistics

local pictures = {}

local time = { name = "time", unit = "s" }
local force = { name = "restoring force", unit = "N" }
local roles = { "baseline", "effect", "fourth", "fifth", "noise", "sixth" }
local styles = { "dashed", "dotted", "dash_dot", "line" }
local shown_rows = 160  -- of a training record: some periods, so that curves can be told apart

--- The last model is the answer; the others come in their order.
local function role_of(i, count) return i == count and "final" or roles[(i - 1) % #roles + 1] end
local function style_of(i) return styles[(i - 1) % #styles + 1] end

--- The first rows of a column.
local function head(column, count)
  local values = {}
  for i = 1, math.min(count, #column) do values[i] = column[i] end
  return core.column(values)
end

local function row_of(panels, columns) return figures.make { columns = columns or #panels, panels = panels, size = { width_cm = 24 } } end

-- ---- terms ----

--- The largest force that a term reaches along the training records.
local function peak(term, records)
  local most = 0
  for _, record in ipairs(records) do
    local column = core.evaluate(record, term.feature, "scoreboard")
    most = math.max(most, math.abs(term.value) * math.max(column:max(), -column:min()))
  end
  return most
end

--- A bar for each term of each list: its peak, over `unit`.
local function term_bars(lists, records, unit, axis)
  local names, places, sets = {}, {}, {}
  for _, list in ipairs(lists) do
    for _, term in ipairs(list.terms) do
      if term.feature and not places[term.name] then
        names[#names + 1] = term.name
        places[term.name] = #names
      end
    end
  end
  for i, list in ipairs(lists) do
    local values = {}
    for k = 1, #names do values[k] = 0/0 end
    for _, term in ipairs(list.terms) do
      if term.feature then values[places[term.name]] = peak(term, records) / unit end
    end
    sets[i] = { label = list.name, value = values, role = list.role }
  end
  if #names == 0 then return nil end
  return figures.make { panels = { { x = axis, bars = { names = names, sets = sets } } },
    size = { width_cm = 16, height_cm = math.max(5, 1.6 + 0.55 * #names * math.max(1, #sets)) } }
end

--- The channel that drives: F, or F1.
local function drive(record) return record:column(record.channels.F and "F" or "F1") end

local function peak_force(records)
  local most = 0
  for _, record in ipairs(records) do
    local column = drive(record)
    most = math.max(most, column:max(), -column:min())
  end
  return most
end

local function add_terms(list, board)
  if #board.rows == 0 or not board.rows[1].force then return end
  if board.truth then
    list[#list + 1] = { name = "components", caption = "Components of the true force: peak of each term in per cent of the peak excitation",
      figure = term_bars({ { name = "truth", terms = board.truth, role = "measured" } }, board.record,
        peak_force(board.record) / 100, { name = "peak force over the peak excitation", unit = "%" }) }
  end
  local lists = board.truth and { { name = "truth", terms = board.truth, role = "measured" } } or {}
  for i, row in ipairs(board.rows) do  -- a surface has no terms
    if row.terms and #row.terms > 0 then lists[#lists + 1] = { name = row.name, terms = row.terms, role = role_of(i, #board.rows) } end
  end
  list[#list + 1] = { name = "terms", caption = "Force features compared: peak of each term along the training records",
    figure = term_bars(lists, board.record, 1, { name = "peak force", unit = "N" }) }
end

-- ---- the force along the measured motion ----

--- Measured force and that of each model over some rows.
local function force_panel(board, record, along, title)
  local rows = math.min(shown_rows, record.rows)
  local t = head(record:column "t", rows)
  local series = { { x = t, y = head(along(board.rows[1]).measured, rows), label = "measured", role = "measured" } }
  for i, row in ipairs(board.rows) do
    series[i + 1] = { x = t, y = head(along(row).predicted, rows), label = row.name, role = role_of(i, #board.rows), style = style_of(i) }
  end
  return { title = title, x = time, y = force, series = series }
end

local function first(of) return function(row)
  return { measured = row[of].measured[1], predicted = row[of].predicted[1], residual = row[of].residual[1] }
end end

local function residual_panels(board, record, of)
  local panels = {}
  local t = head(record:column "t", shown_rows)
  for i, row in ipairs(board.rows) do
    panels[#panels + 1] = { title = row.name, x = time, y = { name = "residual", unit = "N" },
      series = { { x = t, y = head(row[of].residual[1], shown_rows), role = role_of(i, #board.rows) } } }
    local joined = row[of].joined
    if joined:std() > 0 then
      local points = statistics.qq(joined)
      local low, high = points.expected:min(), points.expected:max()
      local step = math.max(1, #points.expected // 800)
      panels[#panels + 1] = { title = ("QQCC %.4f"):format(points.qqcc), x = { name = "normal quantiles", unit = "N" },
        y = { name = "residual", unit = "N" }, series = {
          { x = core.column { low, high }, y = core.column { low, high }, role = "measured", style = "dashed" },
          { x = points.expected:every(step), y = points.found:every(step), role = role_of(i, #board.rows), style = "points" } } }
    end
  end
  return row_of(panels, 2)
end

local function add_forces(list, board)
  if not board.rows[1].force then return end
  local record, test = board.record[1], board.test
  list[#list + 1] = { name = "force_fit", caption = "Training data: the force along the measured motion, its beginning",
    figure = row_of { force_panel(board, record, first "force", "") } }
  list[#list + 1] = { name = "force_residual", caption = "Training data: residual of the force, and its quantiles against normal ones",
    figure = residual_panels(board, record, "force") }
  list[#list + 1] = { name = "test_force", caption = "Validation: the force along the test record's motion, its beginning",
    figure = row_of { force_panel(board, test, first "test_force", "") } }
  list[#list + 1] = { name = "test_residual", caption = "Validation: residual of the force, and its quantiles against normal ones",
    figure = residual_panels(board, test, "test_force") }
end

-- ---- free runs ----

--- Part of the test record around the place where its force begins: a tenth of it.
local function lively(test)
  local f, rows = drive(test), test.rows
  local start = 1
  while start < rows and math.abs(f[start]) < 1e-9 do start = start + 1 end
  local width = math.max(20, rows // 10)
  local from = math.max(1, math.min(start - width // 5, rows - width))
  return test.start + (from - 1) * test.dt, test.start + (from + width - 1) * test.dt
end

--- An axis with room for twice the motion: a run that leaves it is seen to do so, and does not flatten the rest.
local function roomy(axis, column)
  local most = 2 * math.max(column:max(), -column:min(), 1e-12)
  return { name = axis.name, unit = axis.unit, min = -most, max = most }
end

local function motion_panel(board, channel, axis, from, to)
  local part = board.test:window(from, to)
  local series = { { x = part:column "t", y = part:column(channel), label = "measured", role = "measured" } }
  for i, row in ipairs(board.rows) do
    if row.run and row.run.rows > 10 then
      local run = row.run:window(math.max(from, row.run.start), math.min(to, row.run.start + row.run.duration))
      series[#series + 1] = { x = run:column "t", y = run:column(channel), label = row.name .. ", free run", role = role_of(i, #board.rows),
        style = style_of(i) }
    end
  end
  return { x = time, y = roomy(axis, part:column(channel)), series = series }
end

local function phase_panel(board, i, channel, rate)
  local row, test = board.rows[i], board.test
  local series = { { x = test:column(channel), y = test:column(rate), label = "measured", role = "measured" } }
  if row.run then
    series[2] = { x = row.run:column(channel), y = row.run:column(rate), label = "free run", role = role_of(i, #board.rows), style = "dashed" }
  end
  return { title = row.name, note = row.free.stopped_at and ("stops at %.3g s"):format(row.free.stopped_at)
      or ("DTW %.3g"):format(row.free.dtw or 0/0), x = { name = "displacement", unit = "m" }, y = { name = "velocity", unit = "m/s" }, series = series }
end

local function add_runs(list, board)
  local channel, rate = board.channel, board.channel:gsub("^y", "v")
  local from, to = lively(board.test)
  list[#list + 1] = { name = "test_excitation", caption = "The validation force", figure = row_of { { x = time,
    y = { name = "force", unit = "N" }, series = { { x = board.test:column "t", y = drive(board.test),
      role = "measured" } } } } }
  list[#list + 1] = { name = "test_motion", caption = "Validation: displacement and velocity of free runs where the force begins",
    figure = row_of({ motion_panel(board, channel, { name = "displacement", unit = "m" }, from, to),
      motion_panel(board, rate, { name = "velocity", unit = "m/s" }, from, to) }, 1) }
  local panels = {}
  for i = 1, #board.rows do panels[i] = phase_panel(board, i, channel, rate) end
  list[#list + 1] = { name = "test_phase", caption = "Validation: phase portraits of the free runs", figure = row_of(panels, 2) }
end

--- All figures of a board; the truth itself is drawn as "measured".
function pictures.of(whole)
  local board, list = {}, {}
  for key, value in pairs(whole) do board[key] = value end
  board.rows = {}
  for _, row in ipairs(whole.rows) do
    if row.name ~= "truth" then board.rows[#board.rows + 1] = row end
  end
  add_terms(list, board)
  add_forces(list, board)
  add_runs(list, board)
  return list
end

return pictures

-- The loop of an entry as text, for `lunid help effect NAME`: its force over the displacement in a harmonic motion.
local core = require "lunid.core"
local element = require "lunid.element"
local models = require "lunid.models"
local record_of = require("lunid.records").record
local first_guesses = require "lunid.first_guesses"

local loop_plot = {}

local across, down = 41, 11     -- characters
local unit_scale, cycles, rows = first_guesses.rig, first_guesses.periods, first_guesses.rows

--- Values of entries whose guesses show little of what they are.
local telling = {
  sinusoidal_stiffness = { p = 5 }, van_der_pol_damping = { mu = 0.2 }, smith_toe = { q = 0.4, J = 2 },
  lugre_friction = { s0 = 20, s1 = 0.3, Fc = 0.3, Fs = 0.6, vs = 0.3 }, shaft_softening = { sr = 30 },
  soil_plug = { mp = 1, k = 10, Fs = 0.5 }, crane_lowering = { yc0 = -0.5, Vc = 0.005 },
}

--- Whether it is a force of the motion: what inputs and sensors do is none.
local function has_loop(entry)
  return entry.family ~= "input" and entry.family ~= "sensor" and #entry.channels == 0 and not entry.maps[1].field
end

--- What stands for a parameter that needs no guess: 1, and 2 for one that is at least another one.
local function unguessed(entry, name)
  for _, condition in ipairs(entry.conditions) do
    if condition.left:match "^%s*(.-)%s*$" == name then return 2 end
  end
  return 1
end

--- The values of the first form's parameters, by the guess in the middle of the list, and the same in words.
local function values_of(entry)
  local guesses, told = entry.guess and entry.guess(unit_scale, 1) or {}, telling[entry.name] or {}
  local guess, values, words = guesses[(#guesses + 1) // 2] or {}, {}, {}
  local held = element.symbols_in(entry, 1)
  for i, row in ipairs(entry.rows) do
    local own = entry.parameters[i][1]
    if held[row.name] then
      values[own] = told[own] or guess[own] or unguessed(entry, own)
      words[#words + 1] = ("%s = %.3g%s"):format(own, values[own], row.unit ~= "" and " " .. row.unit or "")
    end
  end
  return values, table.concat(words, ", ")
end

--- A motion sin(t) over all cycles.
local function motion()
  local y, v, a = {}, {}, {}
  for i = 0, cycles * rows do
    local angle = 2 * math.pi * (i % rows) / rows
    y[i + 1], v[i + 1], a[i + 1] = math.sin(angle), math.cos(angle), -math.sin(angle)
  end
  return record_of { dt = unit_scale.interval, channels = { { "y", y }, { "v", v }, { "a", a } } }
end

--- The force over one cycle, from row to row, its first point again at the end.
local function cycle_of(force, number)
  local part = {}
  for i = 1, rows + 1 do part[i] = force[(number - 1) * rows + i] end
  return part
end

--- Whether the last cycle is that of half the time: no drift, nothing that is used up.
local function is_steady(force)
  local before, last, most, apart = cycle_of(force, cycles // 2), cycle_of(force, cycles), 0, 0
  for i = 2, rows do
    most, apart = math.max(most, math.abs(last[i])), math.max(apart, math.abs(last[i] - before[i]))
  end
  return apart <= 0.05 * most
end

--- Draws the lines between the points of a cycle into the rows of characters.
local function draw(canvas, force, mark, low, high)
  local x0, y0
  for i = 1, #force do
    local x = (math.sin(2 * math.pi * (i - 1) / rows) + 1) / 2 * (across - 1)
    local y = (high - force[i]) / (high - low) * (down - 1)
    local steps = x0 and math.ceil(2 * math.max(math.abs(x - x0), math.abs(y - y0))) or 0
    for step = steps > 0 and 1 or 0, steps do
      local part = steps > 0 and step / steps or 1
      local column = math.floor((x0 or x) + part * (x - (x0 or x)) + 0.5)
      canvas[math.floor((y0 or y) + part * (y - (y0 or y)) + 0.5) + 1][column + 1] = mark
    end
    x0, y0 = x, y
  end
end

--- Axes through zero.
local function empty_canvas(low, high)
  local canvas, zero = {}, math.floor(high / (high - low) * (down - 1) + 0.5) + 1
  for line = 1, down do
    canvas[line] = {}
    for column = 1, across do
      canvas[line][column] = line == zero and "-" or column == (across + 1) // 2 and "|" or " "
    end
  end
  return canvas
end

--- The plot with what it shows, or nil where the entry is no force of the motion.
function loop_plot.text(entry)
  if not has_loop(entry) then return nil end
  local values, words = values_of(entry)
  local model = models.model { mass = 0, restoring = entry(values), motion = "imposed" }
  local force = model:force(motion())
  local drawn = is_steady(force) and { { cycles, "*" } } or { { cycles, "*" }, { 1, "o" } }
  local low, high = 0, 0
  for _, each in ipairs(drawn) do
    for _, value in ipairs(cycle_of(force, each[1])) do low, high = math.min(low, value), math.max(high, value) end
  end
  if high == low then high = low + 1 end
  local canvas = empty_canvas(low, high)
  for _, each in ipairs(drawn) do draw(canvas, cycle_of(force, each[1]), each[2], low, high) end
  local lines = { ("force over displacement where y = sin(t), %s,"):format(
    #drawn == 1 and "in steady state" or ("cycles 1 (o) and %d (*)"):format(cycles)), "with " .. words }
  for line = 1, down do
    local label = line == 1 and ("%.3g N"):format(high) or line == down and ("%.3g N"):format(low) or ""
    lines[#lines + 1] = (("%10s  %s"):format(label, table.concat(canvas[line])):gsub("%s+$", ""))
  end
  lines[#lines + 1] = ("%10s  -1 m%s1 m"):format("", (" "):rep(across - 7))
  return table.concat(lines, "\n")
end

return loop_plot

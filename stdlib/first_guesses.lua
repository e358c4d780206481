-- From where discovery starts the parameters of an entry, as text for `lunid help effect NAME`: on one rig, since guesses
-- are read off a record.
local first_guesses = {}

--- Periods of the record below, and rows of each.
first_guesses.periods, first_guesses.rows = 20, 128

--- What a record of a rig of 1 kg on 1 N/m says that swings by 1 m at 1 rad/s.
first_guesses.rig = { y_max = 1, y_min = -1, y_std = 0.7, v_max = 1, v_std = 0.7, shown_max = 1, shown_min = -1, shown_std = 0.7,
  force_std = 0.7, residual_std = 0.7, omega = 1, stiffness = 1, interval = 2*math.pi/first_guesses.rows,
  duration = 2*math.pi*first_guesses.periods,
  lines = { 3 }, modulations = { 2 } }

--- Its scales; what is looked at is remembered in `seen`.
local function watched(seen)
  return setmetatable({}, { __index = function(_, name)
    seen[name] = true
    return first_guesses.rig[name]
  end })
end

local function with_unit(text, row) return row.unit and row.unit ~= "" and text .. " " .. row.unit or text end

--- "0.06, 0.2, 0.6": each value once, in order; of many the first three and the last.
local function list_of(values)
  table.sort(values)
  local texts = {}
  for _, value in ipairs(values) do
    local text = ("%.3g"):format(value)
    if text ~= texts[#texts] then texts[#texts + 1] = text end
  end
  if #texts > 6 then return ("%s, %s, %s ... %s"):format(texts[1], texts[2], texts[3], texts[#texts]) end
  return table.concat(texts, ", ")
end

--- "zy 0.06, 0.2, 0.6 m; n 1, 2": the parameters of which `text_of(name)` has something to say, in their order.
local function line_of(entry, text_of)
  local parts = {}
  for _, row in ipairs(entry.parameters) do
    local text = text_of(row[1])
    if text then parts[#parts + 1] = row[1] .. " " .. with_unit(text, row) end
  end
  return table.concat(parts, "; ")
end

--- The first guesses of a form, and where a record can show its shape parameters; "" where there are none. The names of
--- what is guessed go to `guessed`.
local function lines_of(entry, variant, seen, guessed)
  local guesses = entry.guess and entry.guess(watched(seen), variant) or {}
  local range = entry.range and entry.range(watched(seen), variant) or {}
  return line_of(entry, function(name)
    local values = {}
    for _, guess in ipairs(guesses) do values[#values + 1] = guess[name] end
    guessed[name] = guessed[name] or #values > 0
    return #values > 0 and list_of(values) or nil
  end), line_of(entry, function(name)
    local ends = range[name]
    return ends and ("from %.3g to %.3g"):format(ends[1], ends[2]) or nil
  end)
end

--- "y_max and y_min"
local function words_of(seen)
  local names = {}
  for name in pairs(seen) do names[#names + 1] = name end
  table.sort(names)
  local last = table.remove(names)
  return #names > 0 and table.concat(names, ", ") .. " and " .. last or last
end

--- The lines; forms that begin as an earlier one are left out.
function first_guesses.lines(entry)
  local lines, seen, guessed, told = {}, {}, {}, {}
  for variant = 1, #entry.variants do
    local guesses, range = lines_of(entry, variant, seen, guessed)
    local form = variant > 1 and ("form %d: "):format(variant) or ""
    if not told[guesses .. "|" .. range] then
      if guesses ~= "" then lines[#lines + 1] = "  " .. form .. guesses end
      if range ~= "" then lines[#lines + 1] = "  " .. form .. "a record can show " .. range end
    end
    told[guesses .. "|" .. range] = true
  end
  if #lines == 0 then return { "first guesses: it needs none, its parameters are solved for" } end
  local solved = {}
  for _, row in ipairs(entry.parameters) do
    if not guessed[row[1]] then solved[#solved + 1] = row[1] end
  end
  if #solved > 0 then lines[#lines + 1] = "  solved for: " .. table.concat(solved, ", ") end
  local read = words_of(seen)
  table.insert(lines, 1, "first guesses, " .. (read
    and ("read off the records' %s (here: 1 kg on 1 N/m swings by 1 m at 1 rad/s):"):format(read) or "whatever the records:"))
  return lines
end

return first_guesses

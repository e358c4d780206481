-- What the documents show, held against what the tool prints: the same words, and numbers to two digits.
local shown = {}

local alike = 0.02  -- relative: from machine to machine the last digits may be others

function shown.read(path)
  local file = assert(io.open(path))
  local text = file:read "a"
  file:close()
  return text
end

--- The first fenced block after `mark`, of that language ("lua"; nil: of none).
function shown.block(text, mark, language)
  local from = assert(text:find(mark, 1, true), "the document lacks: " .. mark)
  return assert(text:match("\n```" .. (language or "") .. "\n(.-)\n```", from), "no such block after: " .. mark)
end

--- A sentence that a document has on several lines, in one.
function shown.joined(text) return (text:gsub("\n +", " ")) end

local function flat(line) return (line:gsub("%s+", " "):gsub("^ ", ""):gsub(" $", "")) end

--- A pattern for lines like this one, with a capture for each of its numbers but deviations, "(13)"; and these numbers.
--- "..." stands for anything.
local function pattern_of(line)
  local numbers = {}
  local function number(text)
    numbers[#numbers + 1] = tonumber(text)
    return "\2"
  end
  local text = line:gsub("%.%.%.", "\0"):gsub("%(%d+%)", "\1"):gsub("%d+%.?%d*e%-?%d+", number):gsub("%d+%.?%d*", number)
  if #numbers > 32 then error("too many numbers in one line: " .. line, 0) end
  text = text:gsub("%p", "%%%0"):gsub("\2", "(%%d+%%.?%%d*e?%%-?%%d*)"):gsub("\1", "%%(%%d+%%)"):gsub("\0", ".-")
  return "^" .. text .. "$", numbers
end

--- Whether the line has these words and, within 2 %, these numbers; nil where its words are others.
local function is_like(line, pattern, numbers)
  local captures = { line:match(pattern) }
  if not captures[1] then return nil end
  for i, number in ipairs(numbers) do
    local its = tonumber(captures[i])
    if not its or math.abs(its - number) > alike*math.abs(number) then return false end
  end
  return true
end

--- Raises where a line of `text` is none of those that were `said`. What is spaced otherwise is the same.
function shown.agrees(text, said)
  for line in text:gmatch "[^\n]+" do
    local pattern, numbers = pattern_of(flat(line))
    local good, near = false, nil
    for other in said:gmatch "[^\n]+" do
      local like = is_like(flat(other), pattern, numbers)
      good = good or like
      if like == false then near = other end
    end
    assert(good, ("not printed: %s\n%s"):format(line, near and "but: " .. near or "what is:\n" .. said))
  end
end

return shown

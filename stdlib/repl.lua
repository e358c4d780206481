-- The read-evaluate-print loop: runs a chunk, prints its values; an error does not end it.
local core = require "lunid.core"
local strict = require "lunid.strict"

local repl = {}
local environment
local locals = {}  -- names that a line declared for itself

local help_text = [[
help discover      explains a constructor, a command or an effect; help() says what there is
y v a t F          the signals: displacement, velocity, acceleration, time, force
exit               or Ctrl-D ends; Ctrl-C stops what runs]]

--- A word that the loop knows: shown, called, or typed alone.
local function word(kind, text, action)
  return setmetatable({}, { __metatable = kind, __tostring = function() return text end,
    __call = function(_, ...) return action(...) end })
end

local help = word("lunid.help", help_text, function(topic) require("lunid.help").explain(topic) end)
local exit
exit = word("lunid.exit", "exit", function() return exit end)

--- A relaxed environment: lunid and its symbols at hand; plain assignments make globals.
function repl.start(options)
  core.set_run(options.seed or 1, options.threads or 0)
  local lunid = require "lunid"
  local base = strict.environment ""
  environment = setmetatable({ lunid = lunid, y = lunid.displacement, v = lunid.velocity, a = lunid.acceleration,
    t = lunid.time, F = lunid.force, help = help, exit = exit, quit = exit }, { __index = base })
  io.stderr:write("Lunid ", core.version, "; y v a t F and lunid are at hand; help explains; end with Ctrl-D\n")
end

--- A function that gives the packed values of a text; or nil, what is wrong with it, and whether it may go on. An expression
--- stands in a call of its own: a tail call would leave no line to blame.
local function compile(text)
  local comment = text:find("--", 1, true) and "\n" or ""
  local chunk = load("return (...)(" .. text .. comment .. ")", "=repl", "t", environment)
  if chunk then return function() return chunk(table.pack) end end
  local statements, message = load(text, "=repl", "t", environment)
  if statements then return function() return table.pack(statements()) end end
  local _, of_expression = load("return " .. text, "=repl", "t", environment)
  local open = message:match "<eof>$" or of_expression and of_expression:match "<eof>$"
  return nil, message, open ~= nil
end

-- ---- values ----

local widest, most = 160, 40  -- bytes of a value within a table, lines of a table

local function cut(text)
  text = text:gsub("%s*\n%s*", "; ")
  if #text <= widest then return text end
  return text:sub(1, utf8.offset(text, 0, widest - 2) - 1) .. "..."  -- no part of a character
end

local function is_plain(value) return type(value) == "table" and getmetatable(value) == nil end

--- Keys of a table beside its list, in order: numbers, then names in alphabetical order ("name" first), then others.
local function keys_of(value)
  local keys, ranks = {}, { number = 1, string = 2 }
  for key in pairs(value) do
    if not (math.type(key) == "integer" and key >= 1 and key <= #value) then keys[#keys + 1] = key end
  end
  table.sort(keys, function(a, b)
    local first, second = ranks[type(a)] or 3, ranks[type(b)] or 3
    if first ~= second or first == 3 then return first < second end
    if (a == "name") ~= (b == "name") then return a == "name" end
    return a < b
  end)
  return keys
end

--- A value within a table, on one line; tables within are not opened.
local function brief(value, within)
  if type(value) == "string" then return '"' .. cut(value) .. '"' end
  if math.type(value) == "float" then return ("%.7g"):format(value) end
  if not is_plain(value) then return cut(tostring(value)) end
  if next(value) == nil then return "{}" end
  if within then return "{ ... }" end
  local parts, keys, left, size = {}, keys_of(value), 0, 0
  local function add(part)
    size = size + #part + 2
    if size > widest then left = left + 1 else parts[#parts + 1] = part end
  end
  for _, each in ipairs(value) do add(brief(each, true)) end
  for _, key in ipairs(keys) do add(("%s = %s"):format(tostring(key), brief(value[key], true))) end
  if left > 0 then parts[#parts + 1] = ("... %d more"):format(left) end
  return "{ " .. table.concat(parts, ", ") .. " }"
end

--- A plain table, a line for each entry: those of the list in order, then names in alphabetical order. Names that stand for
--- entries of the list are those entries.
local function shown(value)
  if not is_plain(value) then return tostring(value) end
  local lines, listed = {}, {}
  for i, each in ipairs(value) do
    lines[i] = ("%d: %s"):format(i, brief(each))
    if type(each) == "table" then listed[each] = true end
  end
  for _, key in ipairs(keys_of(value)) do
    local each = value[key]
    if type(each) ~= "table" or not listed[each] then lines[#lines + 1] = ("%s = %s"):format(tostring(key), brief(each)) end
  end
  if #lines == 0 then return "{}" end
  if #lines > most then lines[most + 1] = ("... %d more"):format(#lines - most) end
  return table.concat(lines, "\n", 1, math.min(#lines, most + 1))
end

--- Runs `work`; Ctrl-C is an error without a place.
local function run(work)
  local good, values = pcall(work)
  if core.take_interrupt() then error("interrupted", 0) end
  if not good then error(values, 0) end
  return values
end

--- Remembers the names of the locals that a line declares: they end with it.
local function note_locals(text)
  for names in text:gmatch "%f[%w_]local%s+([%a_][%w_%s,]*)" do
    for name in names:gmatch "[%a_][%w_]*" do locals[name] = true end
  end
  for name in text:gmatch "local%s+function%s+([%a_][%w_]*)" do locals[name] = true end
end

--- What is wrong, with a word more where the name was a local of an earlier line.
local function with_hint(message)
  local name = message:match "undeclared name '([%a_][%w_]*)'"
  if not name or not locals[name] then return message end
  return ("%s; a local lasts for one line here: write `%s = ...`"):format(message:match "^(.-undeclared name '[^']*')", name)
end

--- Runs the text; returns 1 when it is the beginning of something longer, 2 when it is the end.
function repl.evaluate(text)
  core.take_interrupt()
  local topic = text:match "^%s*help%s+([%w_.]+)%s*$"
  if topic then return help(topic) end
  local work, message, open = compile(text)
  if not work then
    if open then return 1 end
    core.raise(message, "study")
  end
  local good, values = pcall(run, work)
  note_locals(text)
  if not good then core.reraise(with_hint(tostring(values)), tostring(values)) end
  if values[1] == exit then return 2 end
  for i = 1, values.n do values[i] = shown(values[i]) end
  if values.n > 0 then print(table.concat(values, "\t")) end
  return 0
end

return repl

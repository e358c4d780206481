-- The read-evaluate-print loop: runs a chunk, prints its values; an error does not end it.
local core = require "lunid.core"
local strict = require "lunid.strict"

local repl = {}
local environment

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

--- A function that gives the packed values of a text. An expression stands in a call of its own: a tail call would leave
--- no line to blame.
local function compile(text)
  local comment = text:find("--", 1, true) and "\n" or ""
  local chunk = load("return (...)(" .. text .. comment .. ")", "=repl", "t", environment)
  if chunk then return function() return chunk(table.pack) end end
  local statements, message = load(text, "=repl", "t", environment)
  return statements and function() return table.pack(statements()) end, message
end

--- Runs `work`; Ctrl-C is an error without a place.
local function run(work)
  local good, values = pcall(work)
  if core.take_interrupt() then error("interrupted", 0) end
  if not good then error(values, 0) end
  return values
end

--- Runs the text; returns 1 when it is the beginning of something longer, 2 when it is the end.
function repl.evaluate(text)
  core.take_interrupt()
  local topic = text:match "^%s*help%s+([%w_.]+)%s*$"
  if topic then return help(topic) end
  local work, message = compile(text)
  if not work then
    if message:match "<eof>$" then return 1 end
    core.raise(message, "study")
  end
  local values = run(work)
  if values[1] == exit then return 2 end
  for i = 1, values.n do values[i] = tostring(values[i]) end
  if values.n > 0 then print(table.concat(values, "\t")) end
  return 0
end

return repl

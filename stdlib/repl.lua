-- The read-evaluate-print loop: runs a chunk, prints its values; an error does not end it.
local core = require "lunid.core"
local strict = require "lunid.strict"

local repl = {}
local environment

--- A relaxed environment: lunid and its symbols at hand; plain assignments make globals.
function repl.start(options)
  core.set_run(options.seed or 1, options.threads or 0)
  local lunid = require "lunid"
  local base = strict.environment ""
  environment = setmetatable({ lunid = lunid, y = lunid.displacement, v = lunid.velocity, a = lunid.acceleration,
    t = lunid.time, F = lunid.force }, { __index = base })
  io.stderr:write("Lunid ", core.version, "; y v a t F and lunid are at hand; end with Ctrl-D\n")
end

--- Runs the text; returns 1 when it is the beginning of something longer.
function repl.evaluate(text)
  core.take_interrupt()
  local chunk, message = load("return " .. text, "=repl", "t", environment)
  if not chunk then chunk, message = load(text, "=repl", "t", environment) end
  if not chunk then
    if message:match "<eof>$" then return 1 end
    core.raise(message, "study")
  end
  local values = table.pack(chunk())
  for i = 1, values.n do values[i] = tostring(values[i]) end
  if values.n > 0 then print(table.concat(values, "\t")) end
  return 0
end

return repl

-- What the specs share: cases, comparisons, and studies run by the executable under test.
local spec = {}

local failures, cases = {}, 0

--- Runs a case; a failure is remembered and the next case runs.
function spec.case(name, body)
  cases = cases + 1
  local good, message = pcall(body)
  if not good then
    failures[#failures + 1] = name
    print(("FAILED %s\n  %s"):format(name, tostring(message):gsub("\n", "\n  ")))
  end
end

--- Said where a spec cannot run on this machine: ctest reports it as skipped, with the reason.
function spec.skip(reason) print("SKIPPED: " .. reason) end

--- To be called last: a failed case fails the spec.
function spec.finish()
  print(("%d cases, %d failed"):format(cases, #failures))
  if #failures > 0 then error(("failed: %s"):format(table.concat(failures, "; ")), 0) end
end

local function shown(value)
  return type(value) == "string" and ("%q"):format(value):gsub("\\\n", "\n") or tostring(value)
end

function spec.equal(got, expected)
  if got ~= expected then error(("expected %s\n  got %s"):format(shown(expected), shown(got)), 2) end
end

function spec.near(got, expected, tolerance)
  if not (math.abs(got - expected) <= tolerance) then
    error(("expected %.17g within %g, got %.17g"):format(expected, tolerance, got), 2)
  end
end

function spec.contains(text, part)
  if not text:find(part, 1, true) then error(("expected a text with %s\n  got %s"):format(shown(part), shown(text)), 2) end
end

--- The message of the error that `body` raises, without "file:line: ".
function spec.message_of(body)
  local good, message = pcall(body)
  if good then error("expected an error, there was none", 2) end
  return (tostring(message):gsub("^[^\n]-%.lua:%d+: ", ""))
end

--- What a discovery has named, in alphabetical order: "coulomb_friction cubic_stiffness".
function spec.names_of(found)
  local names = {}
  for i, effect in ipairs(found.effects) do names[i] = effect.name end
  table.sort(names)
  return table.concat(names, " ")
end

-- ---- the executable ----

local function output_of(command)
  local pipe = io.popen(command)
  local text = pipe:read "a"
  pipe:close()
  return text
end

--- This executable, found by the process that runs the spec.
spec.executable = output_of "readlink -f /proc/$PPID/exe":gsub("%s+$", "")

spec.folder = output_of "mktemp -d":gsub("%s+$", "")

function spec.shell(command) return output_of(("cd '%s' && %s"):format(spec.folder, command)) end

--- Writes a file into the spec's own folder.
function spec.write(name, text)
  local file = assert(io.open(spec.folder .. "/" .. name, "w"))
  file:write(text)
  file:close()
end

--- Runs `lunid <arguments>` in the spec's folder: what it wrote to both streams, and its exit code.
function spec.lunid(arguments, before)
  local text = spec.shell(("%s '%s' %s 2>&1; echo \"[exit $?]\""):format(before or "", spec.executable, arguments))
  local said, code = text:match "^(.*)%[exit (%d+)%]%s*$"
  return said, tonumber(code)
end

--- Runs a study given as text, as study.lua.
function spec.study(text)
  spec.write("study.lua", text)
  return spec.lunid "run study.lua --out study-out"
end

--- To stand first in a study: resident() is the memory of its process [MB], `field` VmRSS (now) or VmHWM (at most).
function spec.resident(field)
  return ([[
local function resident()
  for line in io.lines "/proc/self/status" do
    local kilobytes = line:match "^%s:%%s+(%%d+)"
    if kilobytes then return kilobytes/1024 end
  end
end
]]):format(field)
end

--- The state after one step h of the classical Runge-Kutta method; slopes(t, state) returns the rates, a list as the
--- state is.
function spec.runge_kutta(slopes, t, state, h)
  local function moved(rates, step)
    local out = {}
    for i = 1, #state do out[i] = state[i] + step*rates[i] end
    return out
  end
  local a = slopes(t, state)
  local b = slopes(t + h/2, moved(a, h/2))
  local c = slopes(t + h/2, moved(b, h/2))
  local d = slopes(t + h, moved(c, h))
  local out = {}
  for i = 1, #state do out[i] = state[i] + h/6*(a[i] + 2*b[i] + 2*c[i] + d[i]) end
  return out
end

--- A force of time: tones spread evenly from 0.3 to 2.2 times this frequency, of phases that jump about.
function spec.tones(omega, size, seed)
  return function(t)
    local sum = 0
    for i = 1, 25 do sum = sum + math.cos((0.3 + 0.079*(i - 1))*omega*t + seed*i*i) end
    return size*sum
  end
end

function spec.clean() os.execute(("rm -rf '%s'"):format(spec.folder)) end

return spec

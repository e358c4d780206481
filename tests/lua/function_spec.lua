-- Functions in Lua, tables and surfaces as expressions: in models and regressions, what they say of their cost, what
-- they refuse, and models that are saved with them.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local c = lunid.parameter { "c", 20 }
local drive = 10*lunid.sin(80*t) + 5*lunid.sin(141*t)

local damper = lunid.lua_function { "damper", function(y, v) return v*math.exp(-y*y) end }
local called = lunid.model { mass = 1, restoring = 2e4*y + c*damper(y, v) }
local written = lunid.model { mass = 1, restoring = 2e4*y + c*(v*lunid.exp(-y*y)) }

local function run(model, solver)
  return lunid.simulate { model = model, excitation = drive, duration = 0.5, dt = 1e-3, solver = solver }
end

spec.case("a Lua function moves a model as the same expression does", function()
  spec.equal(tostring(called):match "[^\n]*", "a + 20000*y + c*damper(y, v) = F")
  spec.equal(damper(0, 3), 3.0)
  for _, solver in ipairs { "auto", "bdf", "rk45" } do
    local a, b = run(called, solver), run(written, solver)
    for i = 1, a.rows, 50 do spec.near(a:column("y")[i], b:column("y")[i], 1e-9) end
  end
end)

spec.case("it says what it costs", function()
  local notes = run(called).summary.notes
  spec.equal(#notes, 1)
  local form = notes[1]:gsub("%d+", "#")
  spec.equal(form, "Lua function 'damper': # calls, all on one thread; an expression of the language "
    .. "would be faster; # derivatives by central differences, for want of a gradient")
  spec.equal(run(called).summary.notes[1], notes[1])  -- the same words each time
  spec.equal(#run(written).summary.notes, 0)
  local record = run(written):record()
  local fit = lunid.regress { record = record, mass = 1, features = { y, damper(y, v) } }
  spec.near(fit.terms["damper(y, v)"].value, 20, 1e-6)
  spec.contains(tostring(fit), "\n  note: Lua function 'damper': ")
  local sweep = lunid.ensemble { model = called, vary = { c = { 10, 20 } }, excitation = drive, duration = 0.5, dt = 1e-3 }
  spec.contains(tostring(sweep), "\n  note: Lua function 'damper': ")
end)

spec.case("it is fitted on the trajectory as the expression is", function()
  local record = run(written):record()
  local function fitted(model)
    return lunid.fit_trajectory { model = model:with { c = 12 }, record = record, channels = { "y", "v" } }
  end
  local found = fitted(called)
  spec.near(found.model.parameters.c.value, 20, 0.1)  -- the record's force is straight between its samples
  spec.near(found.model.parameters.c.value, fitted(written).model.parameters.c.value, 1e-7)
  spec.contains(tostring(found), "\n  note: Lua function 'damper': ")
end)

spec.case("a gradient takes the place of differences", function()
  local exact = lunid.lua_function { "exact", function(v) return v^3 end, gradient = function(v) return 3*v^2 end }
  local slope = exact(v):derivative(v)
  spec.equal(slope:at { v = 2 }, 12.0)
  spec.near(slope:derivative(v):at { v = 2 }, 12, 1e-6)
  local rough = lunid.lua_function { "rough", function(v) return v^3 end }
  spec.near(rough(v):derivative(v):at { v = 2 }, 12, 1e-8)
  spec.equal(spec.message_of(function() rough(v):derivative(v):derivative(v) end),
    "Lua function 'rough': has no second derivative, because its gradient is not known: give it one")
end)

spec.case("errors in it are shown where they are, through every solver", function()
  for _, solver in ipairs { "auto", "bdf", "adams", "rk45", "esdirk" } do
    local said, code = spec.study(([[
      local lunid = require "lunid"
      local y, t = lunid.displacement, lunid.time
      local torn = lunid.lua_function { "torn", function(y)
        if y > 1e-4 then return nil .. "x" end
        return y
      end }
      local model = lunid.model { mass = 1, restoring = 2e4*torn(y) }
      lunid.simulate { model = model, excitation = 10*lunid.sin(80*t), duration = 1, dt = 1e-3, solver = "%s" }
    ]]):format(solver))
    spec.equal(code, 1)
    spec.equal(said, "study.lua:4: Lua function 'torn': attempt to concatenate a nil value\n  asked for at "
      .. "study.lua:8\n  nothing was written\n")
  end
end)

spec.case("what it returns is checked", function()
  local function says(body, expected)
    local message = spec.message_of(function() return lunid.lua_function { "f", body }(0.5, 2) end)
    spec.equal(message:match "[^\n]*", expected)
  end
  says(function(y, v) end, "Lua function 'f': call: expected a number, got nothing at (0.5, 2)")
  says(function(y, v) return nil end, "Lua function 'f2': call: expected a number, got nothing at (0.5, 2)")
  says(function(y, v) return y, v end, "Lua function 'f3': call: expected a number, got 2 values at (0.5, 2)")
  says(function(y, v) return 0/0 end, "Lua function 'f4': call: expected a number, got what is not a number (nan) at (0.5, 2)")
  says(function(y, v) return "1" end, "Lua function 'f5': call: expected a number, got the string '1' at (0.5, 2)")
  says(function(y, v) return lunid.velocity end, "Lua function 'f6': call: expected a number, got an expression at (0.5, 2)")
  local g = lunid.lua_function { "g", function(y, v) return y*v end, gradient = function(y, v) return v end }
  spec.equal(spec.message_of(function() return g(y, v):derivative(y):at { y = 1, v = 2 } end):match "[^\n]*",
    "Lua function 'g': gradient: expected 2 numbers, got 1 value at (1, 2)")
end)

spec.case("what cannot be one is refused", function()
  local function says(given, expected)
    spec.equal(spec.message_of(function() return lunid.lua_function(given) end), expected)
  end
  says({ "h", function(...) return 1 end },
    "lua_function: call: expected a function of 1 to 4 named arguments, got one of '...'")
  says({ "h", function() return 1 end }, "lua_function: call: expected a function of 1 to 4 named arguments, got one of 0")
  says({ "h", function(y, v) return 1 end, gradient = function(y) return 1 end },
    "lua_function: gradient: expected a function of as many arguments as call, 2, got one of 1")
  says({ "h", function(y, v) return 1 end, scale = { 1 } }, "lua_function: scale: expected 2 numbers, got 1")
  says({ "two words", function(y) return 1 end },
    "lua_function: name: expected letters, digits and _, got 'two words'")
  says({ "y", function(y) return 1 end }, "name 'y': is a channel, not a function; choose another name")
  says({ "h" }, "lua_function: missing field 'call': a function")
  spec.equal(spec.message_of(function() return damper(y) end), "damper: takes 2 arguments, got 1")
  spec.equal(spec.message_of(function() return called:save(spec.folder .. "/called.lua") end),
    "save: the model calls the Lua function 'damper', which has no text: keep the study that makes it")
  spec.equal(spec.message_of(function() return called:export(spec.folder .. "/called.c") end),
    "export: the rates call the Lua function 'damper', which has no text in C")
end)

spec.case("an interruption stops it", function()  -- os.execute shields its parent from SIGINT
  local said, code = spec.lunid("run stop.lua --out stop-out", [[cat > stop.lua <<'END'
    local lunid = require "lunid"
    local y, t = lunid.displacement, lunid.time
    local slow = lunid.lua_function { "slow", function(y)
      if y == 0 then os.execute "kill -TERM $PPID" end
      return y
    end }
    lunid.simulate { model = lunid.model { mass = 1, restoring = 2e4*slow(y) }, excitation = 10*lunid.sin(80*t),
      duration = 100, dt = 1e-3 }
END
]])
  spec.equal(code, 130)
  spec.contains(said, "interrupted")
end)

spec.case("a table is a function, and is saved with the model", function()
  local spring = lunid.lookup { "spring", axes = { { -0.01, 0, 0.02 } }, values = { -90, 0, 210 } }
  spec.equal(spring(0.03), 315.0)
  spec.equal(spring(-0.02), -180.0)
  local plane = lunid.lookup { "plane", axes = { { 0, 1 }, { 0, 2 } }, values = { { 0, 4 }, { 3, 7 } } }
  spec.near(plane(0.5, 1), 3.5, 1e-15)
  local model = lunid.model { mass = 1, restoring = 1e4*plane(y, v) + spring(y) }
  local path = spec.folder .. "/table.lua"
  model:save(path)
  local back = lunid.load(path)
  spec.equal(tostring(back), tostring(model))
  local a, b = run(model), run(back)
  for i = 1, a.rows do spec.equal(a:column("y")[i], b:column("y")[i]) end
  -- In a process of its own, too.
  local said = spec.study(([[
    local lunid = require "lunid"
    print(lunid.load "%s")]]):format(path))
  spec.contains(said, "a + 10000*plane(y, v) + spring(y) = F")
  spec.equal(spec.message_of(function() lunid.lookup { "x", axes = { { 0, 1 } }, values = { 1, 2, 3 } } end),
    "table 'x': values: expected 2, got 3")
end)

spec.case("a surface moves a model, and fits in a regression", function()
  local record = lunid.simulate { model = written, excitation = lunid.excitation.white_noise { rms = 50, seed = 3,
    dt = 1e-3, duration = 20 } }:record()
  local surface = lunid.rfs { record = record, mass = 1, interpolate = lunid.grid { cells = { 8, 8 } }, order = { 3, 3 } }
  local gridded = lunid.model { mass = 1, restoring = surface(y, v) }
  spec.equal(tostring(gridded), "a + surface(y, v) = F")
  local smooth = lunid.rfs { record = record, mass = 1, order = { 3, 3 } }
  local expected = run(written):column("y")
  for _, model in ipairs { gridded, lunid.model { mass = 1, restoring = smooth(y, v) } } do
    local found = run(model):column("y")
    local error = 0
    for i = 1, #found do error = math.max(error, math.abs(found[i] - expected[i])) end
    assert(error < 0.02*expected:max(), "the surface's run is off by " .. error)
  end
  spec.near(surface(1e-4, 0.01), surface:at(1e-4, 0.01), 1e-12)
  local fit = lunid.regress { record = record, mass = 1, features = { surface(y, v), y } }
  spec.near(fit.terms["surface(y, v)"].value, 1, 0.05)
  local path = spec.folder .. "/surface.lua"
  gridded:save(path)
  local a, b = run(gridded), run(lunid.load(path))
  for i = 1, a.rows do spec.equal(a:column("y")[i], b:column("y")[i]) end
  spec.equal(spec.message_of(function() return surface(y) end), "a surface takes 2 arguments, y and v, got 1")
end)

spec.case("a spline is saved as such", function()
  local spring = lunid.lookup { "bent", axes = { { -0.01, 0, 0.01, 0.02 } }, values = { -90, 0, 90, 210 }, between = "cubic" }
  local straight = lunid.lookup { "bent", axes = { { -0.01, 0, 0.01, 0.02 } }, values = { -90, 0, 90, 210 } }
  spec.near(spring(0.015), 144.375, 1e-10)  -- the cubic through the four points
  spec.near(straight(0.015), 150, 1e-10)
  local path = spec.folder .. "/spline.lua"
  local model = lunid.model { mass = 1, restoring = spring(y) + v }
  model:save(path)
  local a, b = run(model), run(lunid.load(path))
  for i = 1, a.rows do spec.equal(a:column("y")[i], b:column("y")[i]) end
  spec.equal(spec.message_of(function() lunid.lookup { "x", axes = { { 0, 1 } }, values = { 1, 2 }, between = "smooth" } end),
    "lookup: between: expected 'linear' or 'cubic', got the string 'smooth'")
end)

--- Order in which the error of runs falls with their steps, on the table of a smooth force.
local function order_of(between)
  local places, values = {}, {}
  for i = 0, 10 do
    places[i + 1] = (i - 5)*2e-3
    values[i + 1] = 2e4*places[i + 1] + 1e8*places[i + 1]^3
  end
  local spring = lunid.lookup { "spring_" .. between, axes = { places }, values = values, between = between }
  local model = lunid.model { mass = 1, restoring = spring(y) + 10*v }
  local function final(substeps)
    return lunid.simulate { model = model, excitation = 60*lunid.sin(80*t), from = { 5e-3, 0 }, duration = 0.4, dt = 4e-3,
      solver = "fixed", substeps = substeps }:column "y"
  end
  local exact = final(512)
  local function error(substeps)
    local found, sum = final(substeps), 0
    for i = 1, #found do sum = sum + (found[i] - exact[i])^2 end
    return math.sqrt(sum / #found)
  end
  return math.log(error(4) / error(32)) / math.log(8)
end

spec.case("a run on a spline converges in the fourth order, on straight pieces in the second", function()
  local straight, spline = order_of "linear", order_of "cubic"
  assert(straight > 1.5 and straight < 2.7, "order " .. straight)
  assert(spline > 3.6 and spline < 5.2, "order " .. spline)
end)

spec.case("a smooth surface is a smooth function", function()
  local hardening = lunid.model { mass = 1, restoring = 2e4*y + 1e10*y^3 + 20*v }
  local record = lunid.simulate { model = hardening, excitation = lunid.excitation.white_noise { rms = 50, seed = 3,
    dt = 1e-3, duration = 20 } }:record()
  local function off(kind, between)
    local surface = lunid.rfs { record = record, mass = 1, interpolate = kind, between = between }
    local most = 0
    for i = 1, 15 do
      local place, speed = i*1e-4 - 8e-4 + 3.3e-5, i*8e-3 - 0.064
      most = math.max(most, math.abs(surface(place, speed) - surface:at(place, speed)))
    end
    return most
  end
  local process = lunid.gaussian_process { centres = 200 }
  local by_itself, straight = off(process), off(process, "linear")
  assert(by_itself < 0.2*straight, ("off by %g, straight by %g"):format(by_itself, straight))
  local grid = lunid.grid { cells = { 8, 8 } }
  spec.near(off(grid), 0, 1e-10)
  assert(off(grid, "cubic") > 1e-3)
  local cubic = lunid.grid { cells = { 8, 8 }, between = "cubic" }
  assert(off(cubic) < 0.1*off(cubic, "linear"))
end)

spec.clean()
spec.finish()

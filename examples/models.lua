-- Models of the kinds that are not a mass on a spring: a base that moves, an element that slips and one that opens, a mass
-- that grows, a force that acts late, and a function of one's own as a last resort.
local lunid = require "lunid"
local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local yb, vb = lunid.base_displacement, lunid.base_velocity

-- A machine on its mounts, on a floor that shakes: the floor's velocity follows from its displacement.
local mounted = lunid.model { mass = 20, restoring = 8e4*(y - yb) + 300*(v - vb) }
print(mounted)
local shaken = lunid.simulate { model = mounted, excitation = { yb = 1e-3*lunid.sin(60*t) }, duration = 2, dt = 0.002 }
print(("the floor moves 1 mm, the machine %.2f mm"):format(1e3*shaken:column("y"):max()))

-- An element that slips at 40 N (a quake of 2 mm), and a toe that pushes but never pulls: states with bounds.
local shaft = lunid.state { "shaft", rate = 2e4*v, min = -40, max = 40 }
local toe = lunid.state { "toe", rate = 5e4*v, min = 0, max = 120 }
local soil = lunid.model { mass = 5, restoring = shaft + toe + 10*v }
local sunk = lunid.simulate { model = soil, excitation = 90 + 150*lunid.sin(2*math.pi*20*t), duration = 1, dt = 1e-3 }
print(("%d slips and lift-offs; sunk %.1f mm"):format(sunk.summary.events, 1e3*sunk:column("y")[1001]))

-- A hopper that fills while it swings, driven by a force that acts 4 ms late.
local filling = lunid.model { mass = 2 + 0.5*t, restoring = 5e3*y + 5*v, delay = lunid.parameter { "tau", 4e-3, unit = "s" } }
print(filling)
print(lunid.simulate { model = filling, excitation = 10*lunid.sin(40*t), duration = 2, dt = 0.002 })

-- Where the language has no words: a function in Lua. The run says what that costs.
local bump = lunid.lua_function { "bump", function(y) return y > 0.01 and 4e6*(y - 0.01)^2 or 0 end }
local own = lunid.model { mass = 1, restoring = 2e4*y + 10*v + bump(y) }
print(lunid.simulate { model = own, excitation = 100*lunid.sin(120*t), duration = 0.5, dt = 1e-3 })

-- Saved as Lua, which lunid.load reads back, and as C and LaTeX for elsewhere.
mounted:save "mounted.lua"
mounted:export "mounted.c"
mounted:export "mounted.tex"
soil:save "soil.lua"

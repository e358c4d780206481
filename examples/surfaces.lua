-- The restoring force surface of a spring that hardens, drawn by eight kinds of interpolation side by side: which one
-- predicts the blocks of time that it has not seen, a section with the measured points near it, and the surface put back
-- into an equation of motion.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local truth = lunid.model { mass = 2, restoring = 800*y + 4e6*y^3 + 6*v }
local push = lunid.excitation.swept_sine { from = 1, to = 12, amplitude = 25, dt = 0.002, duration = 12 }
local record = lunid.simulate { model = truth, excitation = push }:record():with_noise { y = 0.01, v = 0.01, F = 0.02, seed = 4 }

local surface = lunid.rfs { record = record, mass = 2, interpolate = "all", order = { 3, 1 } }
print(surface)
print(("as a polynomial: %.4g y + %.4g y^3 + %.3g v, off the surface by %.2g N rms"):format(
  surface.coefficients[2][1], surface.coefficients[4][1], surface.coefficients[1][2], surface.truncation))
lunid.figure.surface(surface):save "surface.png"

local cut = lunid.section { surface, v = 0 }
lunid.figure.lines {
  title = "section at v = 0",
  series = {
    lunid.figure.series { cut.points_place, cut.points_f, label = "measured near it", style = "points", role = "measured" },
    lunid.figure.series { cut.place, cut.f, label = surface.kind },
  },
  x = "displacement [m]",
  y = "restoring force [N]",
}:save "section.png"

local again = lunid.model { mass = 2, restoring = surface(y, v) }
print(again)
print(lunid.simulate { model = again, excitation = record, from = "record" })

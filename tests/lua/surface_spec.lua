-- Restoring force surfaces from Lua: kinds side by side, sections, expansion, a surface in a model, refusals.
local lunid = require "lunid"
local spec = require "spec"

local y, v = lunid.displacement, lunid.velocity

-- A free oscillation that dies away covers a disc of the phase plane; integrated by Lunid, surface by other code.
local model = lunid.model { mass = 2, restoring = 800*y + 4e6*y^3 + 6*v }
local record = lunid.simulate { model = model, excitation = 0, from = { 0.02, 0 }, duration = 4, dt = 0.001 }:record()
local function force(y, v) return 800*y + 4e6*y^3 + 6*v end

spec.case("several kinds are compared and the best is drawn", function()
  local surface = lunid.rfs { record = record, mass = 2,
    interpolate = { lunid.nearest { neighbours = 40 }, lunid.gaussian_process {}, lunid.mlp {} }, order = { 3, 1 } }
  spec.equal(#surface.rivals, 3)
  spec.equal(surface.rivals[1].kind, surface.kind)
  for i = 2, 3 do
    spec.equal(surface.rivals[i - 1].left_out.rmse <= surface.rivals[i].left_out.rmse, true)
  end
  local f, known, std = surface:at(0.005, 0.1)
  spec.equal(known, true)
  spec.near(f, force(0.005, 0.1), 0.1)
  spec.equal(surface.kind == "Gaussian process", std ~= nil)
  spec.contains(tostring(surface), "nearest neighbours")
  spec.contains(tostring(surface), "R2 left out")
  spec.near(surface.coefficients[2][1], 800, 1)
  spec.near(surface.coefficients[4][1], 4e6, 4e4)
  spec.near(surface.coefficients[1][2], 6, 0.05)
end)

spec.case("quadrature of a smooth surface gives the polynomial too", function()
  local surface = lunid.rfs { record = record, mass = 2, interpolate = lunid.gaussian_process {}, order = { 3, 1 },
    expand = "quadrature" }
  spec.equal(surface.continued > 0.5 and surface.continued < 0.8, true)  -- the nodes crowd in the corners beyond the disc
  spec.equal(surface.truncation < 0.01, true)  -- of 20 N
  spec.near(surface.coefficients[1][2], 6, 0.02)
  spec.near(surface.coefficients[2][1], 800, 2)
  spec.near(surface.coefficients[4][1], 4e6, 1e4)
end)

spec.case("a section runs along the axis that is not given", function()
  local surface = lunid.rfs { record = record, mass = 2, interpolate = lunid.grid {} }
  local cut = lunid.section { surface, v = 0, count = 41 }
  spec.equal(#cut.place, 41)
  local seen = 0
  for i = 1, 41 do
    if cut.f[i] == cut.f[i] then
      seen = seen + 1
      spec.near(cut.f[i], force(cut.place[i], 0), 1)
    end
  end
  spec.equal(seen > 20, true)
  spec.equal(#cut.points_place > 50, true)
end)

spec.case("a surface stands in a model and runs", function()
  local surface = lunid.rfs { record = record, mass = 2, interpolate = lunid.gaussian_process {}, name = "measured" }
  local again = lunid.model { mass = 2, restoring = surface(y, v) }
  spec.equal(tostring(again), "2*a + measured(y, v) = F")
  local run = lunid.simulate { model = again, excitation = 0, from = { 0.015, 0 }, duration = 0.5, dt = 0.001 }
  local truth = lunid.simulate { model = model, excitation = 0, from = { 0.015, 0 }, duration = 0.5, dt = 0.001 }
  local a, b = run:column "y", truth:column "y"
  for i = 1, #a, 25 do spec.near(a[i], b[i], 4e-4) end
end)

spec.case("a network that is cut short is a result that says so", function()
  local surface = lunid.rfs { record = record, mass = 2, interpolate = lunid.mlp { evaluations = 5 } }
  spec.equal(surface.rivals[1].converged, false)
  spec.contains(tostring(surface), "\n  not converged: stopped after 5 evaluations, not at rest")
  local both = lunid.rfs { record = record, mass = 2, interpolate = { lunid.mlp { evaluations = 5 }, lunid.grid {} } }
  spec.contains(tostring(both), "stopped after 5 evaluations, not at rest")
end)

spec.case("messages", function()
  spec.equal(spec.message_of(function() lunid.rfs { record = record, mass = 2, interpolate = "best" } end),
    "rfs: interpolate: expected an interpolator from lunid.grid and its kin or a list of interpolators from lunid.grid "
      .. "and its kin (1 or more) or 'all', got the string 'best'")
  spec.equal(spec.message_of(function() lunid.mlp { hidden = { 0 } } end),
    "mlp: hidden: entry 1: expected a whole number 1 to 500, got 0")
  local surface = lunid.rfs { record = record, mass = 2 }
  spec.equal(spec.message_of(function() lunid.section { surface } end), "section: expected one of y and v, got neither")
  spec.contains(spec.message_of(function() lunid.section { surface, v = 9 } end),
    "surface: section: v: expected within the data")
end)

spec.finish()

-- A state that only adds up: a rubber mount loses its stiffness over the path that it has been worked. A fit estimates where
-- every state begins, and of such a state no record tells that: a mount that begins softer, or one that has been worked before,
-- is the same force. `anchored` says that the path is counted from the record's first row.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local function mount(anchored, given)
  local path = lunid.state { "path", rate = lunid.abs(v), initial = 0, anchored = anchored }
  local k = lunid.parameter { "k", min = 0, unit = "N/m" }
  local fresh = lunid.parameter { "fresh", min = 0, unit = "N/m" }  -- what a new mount has more, at path = 0
  local worn = lunid.parameter { "worn", min = 0, unit = "m" }      -- the path after which 1/e of it is left
  local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
  return lunid.model { mass = 5, restoring = k*y + fresh*lunid.exp(-path/worn)*y + c*v }:with(given)
end

local shaker = lunid.excitation.multisine { from = 3, to = 15, rms = 40, dt = 1/250, duration = 12, seed = 1 }
local record = lunid.simulate { model = mount(true, { k = 1e4, fresh = 4e3, worn = 0.4, c = 25 }), excitation = shaker }
  :record():with_noise { y = 0.01, seed = 1 }

local function fitted(anchored)
  return lunid.fit_trajectory { model = mount(anchored, { k = 9e3, fresh = 6e3, worn = 0.6, c = 30 }), record = record }
end
local counted, free = fitted(true), fitted(false)
print(counted)
print(free)

local of_counted, of_free = counted.model.parameters.fresh, free.model.parameters.fresh
assert(math.abs(of_counted.value/4e3 - 1) < 0.01 and of_counted.std < 0.01*of_counted.value)
assert(of_free.std > of_free.value)  -- it stands for nothing; k, worn and c are as well known as before
assert(math.abs(free.model.parameters.worn.value/0.4 - 1) < 0.01)

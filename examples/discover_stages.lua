-- The stages of a discovery one by one, each with a say of your own: where the model fails, which entries would help, how
-- given sets compare by a criterion of yours, and the search with stricter levels and without what cannot be there.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity
local k = lunid.parameter { "k", min = 0, unit = "N/m" }
local c = lunid.parameter { "c", min = 0, unit = "N s/m" }
local model = lunid.model { mass = 49, restoring = k*y + c*v }
local train = lunid.read("../tests/data/spring_multisine.csv", { window = lunid.window(0, 4) })
local test = lunid.read("../tests/data/spring_sweep.csv", { window = lunid.window(0, 4) })

local where = lunid.locate { model = model, record = train }
print(where)
assert(where.above_noise and where.maps.y.share > where.maps.v.share)  -- it follows y, not v

local list = lunid.propose { model = model, record = train, without = { "bouc_wen" } }  -- nothing yields in this rig
print(list)
assert(list[1].name == "cubic_stiffness")

-- Your criterion: at most 4 % of the motion left, then the fewest parameters. false rejects a set, a number orders them.
local rows = lunid.rank { model = model, record = train,
  sets = { "cubic_stiffness", "clearance", { "cubic_stiffness", "coulomb_friction" } },
  criterion = function(row)
    if not row.model or row.left_out_gap > 0.04 then return false end
    return #row.model.parameters
  end }
print(rows)
assert(rows[1].name == "cubic_stiffness" and rows.rejected[1].name ~= "cubic_stiffness")

-- The whole search: one false name in a thousand, only what lowers the left-out gap by a fifth, and no set that makes more
-- of the spring than a tenth above what a static test gave, 7.7e5 N/m. What a criterion refuses is said in a note.
local found = lunid.discover { model = model, train = train, test = test, alpha = 0.001, minimum_gain = 0.2, max_effects = 2,
  without = { "bouc_wen" }, criterion = function(set) return set.model.parameters.k.value < 8.5e5 end }
print(found)
assert(found.verdict == "explained" and #found.effects == 1 and found.effects[1].name == "cubic_stiffness")
assert(table.concat(found.warnings, "\n"):find("refused by the criterion", 1, true))

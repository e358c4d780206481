-- One force in two notations: a sleeve that is dragged along through a play (`backlash_play`: k, g) is a spring in series with
-- dry friction (`elastic_slip`: k, Fs), with Fs = k*g. No record tells them apart, and none needs to: the answer is not
-- ambiguous. "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 2, restoring = 3e3*y + 6*v + lunid.effects.backlash_play { k = 1500, g = 4e-3 } }

local function measure(seed)
  local shaker = lunid.excitation.multisine { from = 3, to = 12, rms = 20, dt = 1/200, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = shaker }:record():with_noise { y = 0.01, seed = seed }
  return lunid.record { channels = { { "F", run:column "F" }, { "y", run:column "y" } }, dt = run.dt }
end

local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v }, train = measure(1), test = measure(2) }
print(found)

-- The verdict is `explained`. What a record cannot tell from what is named is in `indistinguishable`; of these, what is the same
-- force on any record is in `same_force` too, and any that is left over would have made the verdict `ambiguous`.
local named = found.effects[1]
assert(found.verdict == "explained" and #found.effects == 1 and named.name == "elastic_slip")
assert(#named.same_force == 1 and named.same_force[1] == "backlash_play" and #named.indistinguishable == 1)

-- The other notation has values of its own, fitted to the same record: take the one in whose words you think.
for _, rival in ipairs(found.rivals) do
  if rival.name == "backlash_play" then
    local other, Fs = rival.model.parameters, named.parameters.Fs.value
    local stiffness, play = other.backlash_play_k.value, other.backlash_play_g.value
    print(("elastic_slip Fs = %.3f N; backlash_play k*g = %.0f N/m * %.3f mm = %.3f N"):format(Fs, stiffness, 1e3*play, stiffness*play))
    assert(math.abs(stiffness*play/Fs - 1) < 0.01 and math.abs(play/4e-3 - 1) < 0.02)
  end
end

-- Records that others measured, through the command line: what must be named, how far the gap shrinks, and on what.
-- The data are not part of this repository; LUNID_SHARED_DATA says where they are.
local spec = require "spec"

local data = os.getenv "LUNID_SHARED_DATA"
local probe = data and io.open(data .. "/emps/emps.csv")
if not probe then
  print(("SKIPPED: no measured records at %s"):format(tostring(data)))
  return
end
probe:close()

local function discover(file, options)
  local said, code = spec.lunid(("discover '%s/%s' %s --out out"):format(data, file, options))
  if code ~= 0 then error(said, 2) end
  local json = spec.shell "cat out/discovery.json"
  return said, json
end

--- The first number after a chain of keys.
local function number(json, ...)
  local at = 1
  for _, key in ipairs { ... } do
    local _, after = json:find('"' .. key .. '": ', at, true)
    if not after then error("discovery.json: no " .. key, 2) end
    at = after + 1
  end
  return tonumber(json:match("^[-%d.eE+]+", at))
end

local function named(json)
  local names = {}
  local effects = json:match '\n "effects": (%b[])'
  for name in effects:gmatch '\n   "name": "([%w_]+)"' do names[#names + 1] = name end
  return table.concat(names, " ")
end

spec.case("EMPS: dry friction and a constant force, from the motor's force and the displacement alone", function()
  local said, json = discover("emps/emps.csv", '--mass 95.11 --restoring "c*v"')
  spec.contains(said, "verdict    explained")
  spec.equal(named(json), "coulomb_friction constant_force")
  local effects = json:match '\n "effects": (%b[])'
  local friction, offset = effects:match '"name": "coulomb_friction".-"parameters": (%b{})', effects:match '"name": "constant_force".-"parameters": (%b{})'
  spec.near(number(friction, "Fc", "value"), 20.4, 3 * number(friction, "Fc", "std"))
  spec.near(number(friction, "Fc", "value"), 20.4, 1.5)
  spec.near(number(offset, "F0", "value"), -3.2, 0.3)
  spec.near(number(offset, "F0", "value"), -3.2, 3 * number(offset, "F0", "std"))
  spec.contains(said, "loop       closed: ")
  local by = json:match '"by_instruments": (%b{})'
  spec.near(number(by, "coulomb_friction_Fc", "value"), 20.4, 2 * number(by, "coulomb_friction_Fc", "std"))
  local before, after = number(json, "baseline", "gap_test"), number(json, "final", "gap_test")
  if not (after < before / 4) then error(("gap on the held-out part %g -> %g"):format(before, after)) end
end)

-- The model leaves 5 % of the motion, of which forces without a name follow a part: a name that it would be is not there.
spec.case("EMPS with its friction: nothing more is named", function()
  local _, json = discover("emps/emps.csv", '--mass 95.11 --restoring "c*v + Fc*sign(v) + F0"')
  spec.equal(named(json), "")
end)

spec.case("Silverbox, in volts, its mass unknown: a cubic spring", function()
  local said, json = discover("silverbox/snls80mv.csv",
    '--window 70:77 --test-window 90:97 --mass m --restoring "k*y + c*v"')
  spec.contains(said, "verdict    explained")
  spec.contains(named(json), "cubic_stiffness")
  local before, after = number(json, "baseline", "gap_test"), number(json, "final", "gap_test")
  if not (after < before / 10) then error(("gap on test %g -> %g"):format(before, after)) end
end)

spec.case("a friction damper under imposed motion: memory, not a function of y and v", function()
  local said, json = discover("friction_damper/train_0.5Hz_1in.csv",
    ("'%s/friction_damper/train_0.5Hz_0.5in.csv' --test '%s/friction_damper/test_0.25Hz_1.5in.csv' %s"):format(data, data,
      '--imposed-motion --mass 0 --restoring "k*y + c*v"'))
  spec.contains(said, "verdict    explained")
  spec.contains(named(json), "bouc_wen")
  local resamples = tonumber(said:match "bouc_wen %+ constant_force in (%d+) of 100 resamples")
  assert(resamples and resamples > 50, said)  -- those that the test took back are not among what resamples choose from
  local before, after = number(json, "baseline", "gap_test"), number(json, "final", "gap_test")
  if not (after < before / 4) then error(("gap of the force on test %g -> %g"):format(before, after)) end
end)

spec.finish()

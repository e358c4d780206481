-- README.md and docs/discovery_guide.md show what the tool prints today: their commands and studies are run as they stand.
-- What takes longer than some seconds is not run here: unknown_force.lua (its harmonics, its closure).
local lunid = require "lunid"
local shown = require "shown"
local spec = require "spec"

local guide = shown.read "docs/discovery_guide.md"

--- Runs it from the root, where the documents' paths begin; its results are in a folder of the spec, called lunid-out as there.
local function from_root(arguments)
  local said = spec.shell(("cd - >/dev/null && '%s' %s --out '%s/lunid-out' 2>&1"):format(spec.executable, arguments, spec.folder))
  return (said:gsub(spec.folder:gsub("%p", "%%%0") .. "/", ""))
end

--- The lines of an example before the first that begins with `mark`.
local function example_before(name, mark)
  local text = shown.read("examples/" .. name)
  return text:sub(1, assert(text:find("\n" .. mark, 1, true), name .. " lacks: " .. mark))
end

spec.case("README and the guide show what the demo prints", function()
  local command, lines = shown.block(guide, "## Reading the output"):match "^build/lunid ([^\n]+)\n(.*)$"
  local said = from_root(command)
  shown.agrees(lines, said)
  shown.agrees(shown.block(shown.read "README.md", "The demo prints"), said)
end)

spec.case("an ambiguous verdict ends in the experiment that would decide", function()
  local said = spec.study(example_before("decide_experiment.lua", "-- What would decide") .. "print(first)\n")
  shown.agrees(shown.joined(shown.block(guide, "### `ambiguous`")), said)
end)

spec.case("an entry of one's own is named as the guide says", function()
  local said = spec.study(example_before("unknown_force.lua", "local found")
    .. "local model, train, test = lunid.model { mass = 0.4, restoring = k*y + c*v }, measure(shaken, 1), measure(swept, 2)\n"
    .. shown.block(guide, "once you have an idea", "lua") .. "\nprint(found)\n")
  local value, gap = guide:match "It is named: `([^`]+)`, gap on test ([^\n]-)%.\n"
  shown.agrees(("named ... %s\ngap ... test %s"):format(value, gap), said)
end)

spec.case("the baselines that the guide writes are models", function()
  local simple = shown.block(guide, "Bounds and first guesses need a file", "lua")
  spec.write("baseline.lua", simple)
  local model = lunid.load(spec.folder .. "/baseline.lua")
  spec.equal(model.parameters.k.max, 1e5)
  spec.equal(#model.parameters, 2)
  spec.write("two_masses.lua", shown.block(guide, "## Other rigs", "lua"))
  spec.equal(#lunid.load(spec.folder .. "/two_masses.lua").parameters, 2)
end)

spec.case("the guide lists the units that there are", function()
  spec.write("odd.csv", "t,y [furlong]\n0,1\n1,2\n")
  local units = spec.message_of(function() lunid.read(spec.folder .. "/odd.csv") end):match "known are (.-), many"
  local said, listed = guide:match "Known are (.-), and products and", {}
  for list in said:gmatch "`([^`]*)`" do
    for unit in list:gmatch "%S+" do listed[unit] = true end
  end
  for unit in units:gmatch "%S+" do
    assert(listed[unit] or unit:find "^ms", unit)  -- powers stand behind
  end
end)

spec.case("the options that the guide names are those of the command, its examples are there", function()
  local help = spec.lunid "discover --help"
  for option in guide:gmatch "%-%-[%l][%l%-]+" do
    spec.contains(help .. spec.lunid "simulate --help", option)
  end
  for name in (guide .. shown.read "README.md"):gmatch "examples/([%l_%d]+%.lua)" do shown.read("examples/" .. name) end
end)

spec.clean()
spec.finish()

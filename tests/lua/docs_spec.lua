-- docs/language.md and the editor stubs say what the schemas say: every constructor, every field, nothing else.
local shown = require "shown"
local spec = require "spec"

local manual = shown.read "docs/language.md"
local stubs = shown.read "stdlib/meta/lunid.lua"

--- Constructors and their fields, out of the stubs, which are compared with the schemas first.
local function documented()
  local constructors, fields = {}, {}
  for line in stubs:gmatch "[^\n]+" do
    local field = line:match "^%-%-%-@field ([%w_]+)" or line:match "^%-%-%-@param ([%w_]+)"
    local name = line:match "^function lunid%.([%w_.]+)%(" or line:match "^function (record:[%w_]+)%("
    if field and field ~= "fields" then fields[#fields + 1] = field end
    if name then
      constructors[#constructors + 1] = { name = name, fields = fields }
      fields = {}
    end
  end
  return constructors
end

spec.case("the stubs are those of the schemas", function()
  local said, code = spec.lunid "help stubs"
  spec.equal(code, 0)
  spec.equal(said, stubs)
end)

spec.case("the sections of the manual are those of the schemas", function()
  local sections, code = spec.lunid "help manual"
  spec.equal(code, 0)
  local count = 0
  for section in ("\n" .. sections):gmatch "(### `.-\nGives: [^\n]*\n)" do
    count = count + 1
    local at = manual:find(section, 1, true)
    assert(at, "docs/language.md lacks, or has differently:\n" .. section)
    assert(not manual:find(section, at + 1, true), "docs/language.md has twice:\n" .. section)
  end
  spec.equal(count, #documented())
end)

spec.case("the manual describes no constructor that there is not", function()
  local known = {}
  for _, constructor in ipairs(documented()) do known[constructor.name] = true end
  for name in manual:gmatch "\n### `([%w_.:]+)`" do
    assert(known[name:gsub("^lunid%.", "")], "no such constructor: " .. name)
  end
end)

spec.case("help answers for every constructor and effect", function()
  for _, topic in ipairs { "lasso", "discover", "figure.lines", "bouc_wen", "run" } do
    local said, code = spec.lunid("help " .. topic)
    spec.equal(code, 0)
    assert(#said > 100, "help is too short: " .. said)
  end
  local overview = spec.lunid "help":gsub("(%l)  +", "%1  ")
  spec.contains(overview, "option  A value that `lunid run STUDY.lua key=value` may set.\n")
  spec.contains(overview, "effect  An entry of the catalogue, for lunid.discover { effects = { ... } }.\n")
  assert(not overview:find(" \n", 1, true), "a line ends in a space")
  spec.equal(spec.lunid "list efects",
    "list: expected effects, features, solvers, excitations, systems or cases, got 'efects', did you mean 'effects'?\n")
  local said, code = spec.lunid "help regres"
  spec.equal(code, 2)
  spec.equal(said, "no help on 'regres', did you mean 'regress'?\n")
end)

spec.clean()
spec.finish()

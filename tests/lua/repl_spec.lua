-- The read-evaluate-print loop, through a pipe and through a terminal.
local spec = require "spec"

--- What the loop answers to lines out of a pipe, without its greeting; `fault`: its exit code, 0 by default.
local function answers(lines, fault)
  spec.write("lines", table.concat(lines, "\n") .. "\n")
  local said, code = spec.lunid "repl < lines"
  spec.equal(code, fault or 0)
  return (said:gsub("^Lunid [^\n]*\n", ""))
end

spec.case("values are printed, statements are run", function()
  spec.equal(answers { "1 + 1", "x = 3", "x, nil, 'b'", "-- a remark", "return x" }, "2\n3\tnil\tb\n3\n")
end)

spec.case("an expression that ends in a remark", function()
  spec.equal(answers { "3 -- a remark" }, "3\n")
end)

spec.case("input over several lines", function()
  spec.equal(answers({ "function double(x)", "return 2*x", "end", "double(21)", "for i = 1, 2 do", "" }, 1),
    "42\nthe input above is not complete\n")
  spec.equal(answers { "1 +", "2", "x = {", "3 }", "#x" }, "3\n1\n")
  for _, first in ipairs { "1 +", "x = {", "lunid.model {", "for i = 1, 2 do" } do
    spec.equal(answers({ "3", first, "-- the end" }, 1), "3\nthe input ends before this is complete: " .. first .. "\n")
  end
end)

spec.case("an error names its line and does not end the loop", function()
  spec.equal(answers({ "lunid.regress { feature = 1 }", "2" }, 1),
    "repl:1: regress: unknown field 'feature', did you mean 'features'?\n2\n")
  spec.equal(answers({ "k*y" }, 1), "repl:1: undeclared name 'k'\n")
  spec.equal(answers({ "x = = 3" }, 1), "repl:1: unexpected symbol near '='\n")
  spec.equal(answers({ "lunid.read 'none.csv'", "k" }, 3),
    "none.csv: no such file\n  asked for at repl:1\nrepl:1: undeclared name 'k'\n")  -- the code is that of the first
  spec.equal(answers({ "lunid.help" }, 1), "repl:1: lunid has no 'help'\n")
end)

spec.case("help and exit are words", function()
  spec.contains(answers { "help" }, "Ctrl-C stops what runs")
  spec.contains(answers { "help window" }, "lunid.window { from, to }")
  spec.contains(answers { "help 'window'" }, "lunid.window { from, to }")
  spec.equal(answers { "exit", "1" }, "")
  spec.equal(answers { "quit()", "1" }, "")
end)

spec.case("a local lasts for one line, and that is said", function()
  spec.equal(answers { "local q = 3; return q" }, "3\n")
  spec.equal(answers({ "local q, r = 3", "r", "local function f() end", "f()" }, 1),
    "repl:1: undeclared name 'r'; a local lasts for one line here: write `r = ...`\n"
    .. "repl:1: undeclared name 'f'; a local lasts for one line here: write `f = ...`\n")
end)

spec.case("tables are shown with what they hold, those within them on one line", function()
  spec.equal(answers { "x = { 3, 'b', y, { 1, 2 }, {}, z = 0.1, a = true, k = { unit = 'm', name = 'k', t = {} } }", "x", "{}" },
    '1: 3\n2: "b"\n3: y\n4: { 1, 2 }\n5: {}\na = true\nk = { name = "k", t = {}, unit = "m" }\nz = 0.1\n{}\n')
  spec.equal(answers { "x = {}", "for i = 1, 100 do x[i] = i end", "{ x, deep = { x } }" }, "1: { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, "
    .. "11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, "
    .. "41, 42, ... 58 more }\ndeep = { { ... } }\n")
  local said = answers { "x = {}", "for i = 1, 100 do x[i] = i end", "x" }
  spec.contains(said, "40: 40\n... 60 more\n")
  spec.equal(answers { "lunid.model { mass = 1, restoring = lunid.parameter { 'k', 2e4, unit = 'N/m' }*y }.parameters" },
    '1: { name = "k", fixed = false, unit = "N/m", value = 20000 }\n')
  spec.write("run.csv", "t,F,y\n0,1,2\n1,2,3\n2,1,3\n3,5,6\n4,7,8\n5,9,9\n6,9,9\n")
  said = answers { "lunid.read('run.csv').channels" }
  spec.contains(said, '2: { name = "y", between = "linear", derivation = "", derived = false, noise = ')
  assert(not said:find("0x", 1, true) and not said:find("5:", 1, true), said)  -- each channel once
end)

spec.case("values of the runtime are read-only, and that is said", function()
  spec.equal(answers({ "m = lunid.model { mass = 1, restoring = 2*y }", "m.mass = 3", "r = lunid.read 'run.csv'", "r.rows = 3", "r:column('y')[1] = 3" }, 1),
    "repl:1: a model is read-only: 'mass' cannot be assigned\n"
    .. "repl:1: a record is read-only: 'rows' cannot be assigned\n"
    .. "repl:1: a column is read-only: [1] cannot be assigned\n")
end)

spec.case("models, records and discoveries print themselves", function()
  spec.equal(answers { 'k = lunid.parameter { "k", 100, unit = "N/m" }', "lunid.model { mass = 2, restoring = k*y + 3*v }" },
    "2*a + k*y + 3*v = F\n  k = 100 N/m\n")
end)

--- What is on the screen of a terminal in which `keys` are typed, one entry after another.
local function typed(keys)
  local typing = {}
  for i, key in ipairs(keys) do typing[i] = ("sleep 0.5; printf '%s'"):format(key) end
  return spec.shell(("(%s; sleep 0.5) | TERM=dumb script -qec \"'%s' repl\" /dev/null"):format(table.concat(typing, "; "),
    spec.executable))
end

spec.case("Ctrl-C gives up the line, stops what runs, and ends nothing; Ctrl-D ends", function()
  local screen = typed { "foo(", "\\003", "3 + 4\\n", "while true do end\\n", "\\003", "5 + 6\\n", "\\004" }
  spec.contains(screen, "foo(^C")
  spec.contains(screen, "\n7\r")
  spec.contains(screen, "^Cinterrupted\r\n")
  spec.contains(screen, "\n11\r")
end)

spec.clean()
spec.finish()

-- The read-evaluate-print loop, through a pipe and through a terminal.
local spec = require "spec"

--- What the loop answers to lines out of a pipe, without its greeting.
local function answers(lines)
  spec.write("lines", table.concat(lines, "\n") .. "\n")
  local said, code = spec.lunid "repl < lines"
  spec.equal(code, 0)
  return (said:gsub("^Lunid [^\n]*\n", ""))
end

spec.case("values are printed, statements are run", function()
  spec.equal(answers { "1 + 1", "x = 3", "x, nil, 'b'", "-- a remark", "return x" }, "2\n3\tnil\tb\n3\n")
end)

spec.case("an expression that ends in a remark", function()
  spec.equal(answers { "3 -- a remark" }, "3\n")
end)

spec.case("input over several lines", function()
  spec.equal(answers { "function double(x)", "return 2*x", "end", "double(21)", "for i = 1, 2 do", "" },
    "42\nthe input above is not complete\n")
end)

spec.case("an error names its line and does not end the loop", function()
  spec.equal(answers { "lunid.regress { feature = 1 }", "2" },
    "repl:1: regress: unknown field 'feature', did you mean 'features'?\n2\n")
  spec.equal(answers { "k*y" }, "repl:1: undeclared name 'k'\n")
  spec.equal(answers { "x = = 3" }, "repl:1: unexpected symbol near '='\n")
  spec.equal(answers { "lunid.help" }, "repl:1: lunid has no 'help'\n")
end)

spec.case("help and exit are words", function()
  spec.contains(answers { "help" }, "Ctrl-C stops what runs")
  spec.contains(answers { "help window" }, "lunid.window { from, to }")
  spec.contains(answers { "help 'window'" }, "lunid.window { from, to }")
  spec.equal(answers { "exit", "1" }, "")
  spec.equal(answers { "quit()", "1" }, "")
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

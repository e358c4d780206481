-- `lunid thesis`: the studies of stdlib/thesis, run one by one or all together.
local core = require "lunid.core"
local option = require "lunid.option"
local output = require "lunid.output"
local study_report = require "lunid.study_report"

local thesis = {}

thesis.cases = {
  { "systems", "the ten systems of table 2.1, Duhamel's integral, and the solvers of appendix H" },
  { "case1", "a Duffing oscillator in 5 % noise, by all three methods (section 2.3)" },
  { "frf", "frequency response of case 1 with its unstable branch (figures 2.18 to 2.20, appendix B)" },
  { "case2", "terms near the noise (section 2.4); 2.1 by Chebyshev polynomials" },
  { "case3", "a spring that yields as a tanh: 3.0 by polynomials, 3.2 with the tanh offered (sections 2.5, 2.6)" },
  { "case4", "two masses, one cubic spring (appendix J)" },
  { "inertia", "a mass that depends on velocity or on displacement (section 2.7)" },
  { "noise", "coloured, multiplicative and Poisson noise (section 2.7)" },
  { "uncertainty", "how noise propagates to parameters and predictions (conclusions)" },
  { "sampling", "sampling rate, one frequency or two, other excitations (sections 2.1, 2.7)" },
  { "features", "can statistics name the terms? (appendices F and G)" },
  { "history", "models of past samples: ARX, ARMAX, NARX and NARMAX (section 1.9)" },
  { "optimisers", "constraints between coefficients and parameters inside features (appendix I)" },
  { "derivatives", "acceleration from noisy data (appendices K and L)" },
  { "lorenz", "SINDy on the Lorenz equations (appendix C)" },
  { "sketches", "figures that belong to no case: 1.2, 4.1 and E.1" },
  { "pile", "a pile driven by vibration (chapter 3), on a virtual rig" },
  { "questions", "the research questions (section 0.5), answered by tables" },
}

local function names_of_cases()
  local names = {}
  for i, case in ipairs(thesis.cases) do names[i] = case[1] end
  return names
end

function thesis.list()
  for _, case in ipairs(thesis.cases) do print(("%-12s %s"):format(case[1], case[2])) end
  print(("%-12s %s"):format("all", "all of them, in one report"))
end

--- The cases that are asked for; raises on a name that there is not.
local function asked(words)
  local names, chosen = names_of_cases(), {}
  for _, word in ipairs(words) do
    if word == "all" then return names end
    local found = false
    for _, name in ipairs(names) do found = found or name == word end
    if not found then
      table.insert(names, "all")
      core.raise(("thesis: no case '%s'%s"):format(word, core.did_you_mean(core.nearest(word, names))
        or "; see `lunid thesis list`"), "usage")
    end
    chosen[#chosen + 1] = word
  end
  return chosen
end

local function run_case(name, options)
  option.given = { quick = tostring(options.quick == true), seed = tostring(options.seed) }
  local path = core.library .. "/thesis/" .. name .. ".lua"
  core.note_input(path)
  require("lunid.strict").load_file(path)()
end

--- Runs the cases that are asked for; several have a folder each, and one report together. Of several, one that fails does not
--- end the others: gives the names of those that failed.
function thesis.run(options)
  local chosen, failed, began = asked(options.cases), {}, os.time()
  for i, name in ipairs(chosen) do
    if #chosen == 1 then
      run_case(name, options)
      return failed
    end
    local good, message = output.within(name, function() run_case(name, options) end)
    if not good then
      if tostring(message):match "interrupted" then error(message, 0) end
      io.stderr:write(("%s failed: %s\n"):format(name, message))
      failed[#failed + 1] = name
    end
    io.stderr:write(("%d of %d cases, %d s\n"):format(i, #chosen, os.time() - began))
  end
  output.write("report.html", study_report.page("The thesis, made again" .. (options.quick and " (quick)" or ""),
    study_report.saved))
  return failed
end

return thesis

-- The research questions of the thesis (section 0.5, and "revisited" in its conclusions), each answered by a table that is computed here:
-- those about methods in questions_methods.lua, those about records in questions_records.lua.
local lunid = require "lunid"
local methods, records = require "questions_methods", require "questions_records"

local report = lunid.report { title = "Questions: what the thesis asked" }
local questions = {
  { "methods", methods.methods },
  { "physics", methods.physics },
  { "criteria", methods.criteria },
  { "frequencies", records.frequencies },
  { "hidden", records.hidden },
  { "sampling", records.sampling },
  { "time", records.time },
}

local answers = {}
for i, question in ipairs(questions) do
  answers[question[1]] = question[2](report)
  report:progress("questions", i, #questions)
end
report:results { case = "questions", variant = "0.5", runs = {}, answers = answers }
report:save()

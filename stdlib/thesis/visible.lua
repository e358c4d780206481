-- Which terms of a system can a record show at all? The true equation is fitted to it on the trajectory: what lies below three deviations
-- there is hidden, whatever the method.
local lunid = require "lunid"

local visible = {}

--- A table of each true term, and the set of the hidden ones. terms: { parameter of the system, name of the term }; answers: by name, from a
--- scoreboard.
function visible.terms(system, train, terms, answers)
  local best, rows, hidden = lunid.fit_trajectory { model = system, record = train, channels = { "y", "v" } }.model, {}, {}
  for i, each in ipairs(terms) do
    local limit, answer = best.parameters[each[1]], answers[each[2]]
    local true_value = system.parameters[each[1]].value
    local shown = math.abs(true_value) > 3*limit.std
    if not shown then hidden[each[2]] = true end
    local off = answer.std and math.abs(answer.value - true_value)/answer.std
    rows[i] = { each[2], true_value, limit.std, shown and "can be seen" or "hidden: below 3 deviations",
      answer.std and ("%.5g +- %.2g"):format(answer.value, answer.std) or "not in the model", off and ("%.1f"):format(off) }
  end
  return { head = { "term", "truth", "deviation at best", "on this record", "Lunid", "off, in deviations" }, rows = rows }, hidden
end

return visible

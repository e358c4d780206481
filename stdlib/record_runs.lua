-- What free runs are fitted to where a field takes one record or several.
local record_list = require "lunid.record_list"

--- A record or a list of records as a list, each within the window where there is one, and cut at the gaps that were
--- interpolated: a run through one follows a force that nobody measured.
return function(value, window)
  local list = {}
  for _, record in ipairs(record_list(value, window)) do
    for _, piece in ipairs(record:pieces()) do list[#list + 1] = piece end
  end
  return list
end

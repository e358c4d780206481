-- What a field that takes one record or several holds.

--- A record or a list of records as a new list, each within the window where there is one.
return function(value, window)
  local list = {}
  for i, record in ipairs(type(value) == "table" and value or { value }) do
    list[i] = window and record:window(window.from, window.to) or record
  end
  return list
end

-- What figures are drawn of: records, runs and plain series, seen as columns with names, units and a place in the legend.
local core = require "lunid.core"
local figures = require "lunid.figures"
local schema = require "lunid.schema"
local types = schema.types

local sources = {}

local kinds = { types.is("record", "lunid.read"), types.is("run", "lunid.simulate"),
  types.is("comparison", "lunid.compare"), figures.series }
local one = types.either(table.unpack(kinds))

--- A record, a run, a comparison or a series, or a list of them.
sources.type = types.either(one, types.list(one, 1))

local words = { t = "time", F = "force", y = "displacement", v = "velocity", a = "acceleration" }
local units = { t = "s", F = "N", y = "m", v = "m/s", a = "m/s^2" }

--- The axis of a channel: { name = "velocity 2", unit = "m/s" }.
function sources.axis(channel, unit)
  local letter, number = channel:match "^(%a)(%d*)$"
  local name = words[letter] and (number ~= "" and words[letter] .. " " .. number or words[letter]) or channel
  return { name = name, unit = unit or units[letter] or "" }
end

--- The unit that a record has a channel in; nil where it says none.
function sources.unit_in(record, name)
  local channel = record.channels[name]
  return channel and channel.unit ~= "" and channel.unit or nil
end

local function of_record(record, where)
  return { label = record.name, role = "measured", style = "line", kind = "record", object = record,
    unit = function(name) return sources.unit_in(record, name) end,
    column = function(name)
      if name ~= "t" and not record.channels[name] then
        local names = {}
        for i, each in ipairs(record.channels) do names[i] = each.name end
        figures.fail(where, ("the record '%s' has no channel '%s' (it has t, %s)"):format(record.name, name,
          table.concat(names, ", ")))
      end
      return record:column(name)
    end }
end

local function of_run(run)
  return { label = "free run", role = "final", style = "dashed", kind = "run", object = run, unit = function() end,
    column = function(name) return run:column(name) end }
end

--- The columns of a comparison: t and the quantity that is compared.
local function of_comparison(comparison, field, look, where)
  return { label = look.label, role = look.role, style = look.style, kind = "comparison", object = comparison,
    unit = function(name) return name == comparison.quantity and comparison.unit or nil end,
    column = function(name)
      if name == "t" then return comparison.t end
      if name == comparison.quantity or name == "y" and field then return comparison[field] end
      figures.fail(where, ("a comparison has t and %s, not '%s'"):format(comparison.quantity, name))
    end }
end

local function add(list, each, where)
  local kind = getmetatable(each)
  if kind == "lunid.record" then
    list[#list + 1] = of_record(each, where)
  elseif kind == "lunid.run" then
    list[#list + 1] = of_run(each)
  elseif kind == "lunid.comparison" then
    list[#list + 1] = of_comparison(each, "measured", { label = "measured", role = "measured", style = "line" }, where)
    if each.predicted then
      list[#list + 1] = of_comparison(each, "predicted", { label = "model", role = "final", style = "dashed" }, where)
    end
  else
    list[#list + 1] = { label = each.label, role = each.role, style = each.style, kind = "series", object = each,
      unit = function() end }
  end
end

--- Series that look alike are told apart by what comes next in the order of looks.
local function keep_apart(list)
  local seen = {}
  for i, each in ipairs(list) do
    if not each.role or seen[each.role .. each.style] then
      local role, style = figures.look_of(i)
      each.role, each.style = role, each.kind == "series" and each.style ~= "line" and each.style or style
    end
    seen[each.role .. each.style] = true
  end
  return list
end

--- What is given as sources { label, role, style, kind, object, column(name), unit(name) }; a series has x and y in place
--- of columns. `where`: the figure's name, for messages.
function sources.of(given, where)
  local list = {}
  local single = getmetatable(given) ~= nil and getmetatable(given) ~= "lunid.list"
  for _, each in ipairs(single and { given } or given) do add(list, each, where) end
  return keep_apart(list)
end

--- The series of one channel over another, of every source.
function sources.curves(list, x, y)
  local series = {}
  for i, each in ipairs(list) do
    local given = each.kind == "series"
    series[i] = { x = given and each.object.x or each.column(x), y = given and each.object.y or each.column(y),
      label = each.label, role = each.role, style = each.style, colour = given and each.object.colour or nil }
  end
  return series
end

--- The unit of a channel, by the first source that knows it.
function sources.unit(list, channel)
  for _, each in ipairs(list) do
    local unit = each.unit(channel)
    if unit then return unit end
  end
end

--- The cycle that each row belongs to, counted from 0 by upward crossings of the mean, beyond a tenth of the deviation so
--- that noise counts none; nil where there are fewer than two cycles.
function sources.cycles(column)
  local values, mean, room = column:list(), column:mean(), 0.1 * column:std()
  local cycle, low = 0, false
  for i, value in ipairs(values) do
    if value < mean - room then low = true end
    if low and value > mean + room then cycle, low = cycle + 1, false end
    values[i] = cycle
  end
  return cycle > 1 and core.column(values) or nil
end

--- a - b, row by row, as a column.
function sources.minus(a, b)
  local left, right = a:list(), b:list()
  for i = 1, #left do left[i] = left[i] - right[i] end
  return core.column(left)
end

return sources

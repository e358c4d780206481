-- The table of docs/effects.md, written from the entries: `lunid help effects_table` prints it, and a test compares.
local catalogue = require "lunid.catalogue"

local effects_table = {}

local titles = { stiffness = "Stiffness", damping = "Damping and friction", friction = "Damping and friction",
  hysteresis = "Memory", soil = "Soil and piles", inertia = "Inertia and time", extra_dof = "Inertia and time",
  time_variation = "Inertia and time", input = "Inputs", sensor = "Sensors" }

--- "`k` [N/m] >= 0"
local function parameter(row)
  local text = ("`%s`%s"):format(row[1], row.unit and (" [%s]"):format(row.unit) or "")
  if row.min and row.max then return text .. (" %g to %g"):format(row.min, row.max) end
  if row.min then text = text .. (" >= %g"):format(row.min) end
  return text .. (row.fixed and ", held" or "")
end

local function row(entry, searched)
  local parameters = {}
  for i, each in ipairs(entry.parameters) do parameters[i] = parameter(each) end
  for _, text in ipairs(entry.requires) do parameters[#parameters + 1] = text end
  return ("| `%s`%s | %s | `%s` | %s | %s |"):format(entry.name, searched and " *" or "", entry.family, entry.formula,
    table.concat(parameters, "; "), entry.sentence)
end

--- The whole table, in sections.
function effects_table.text()
  local searched, lines, title = {}, {}, nil
  for _, name in ipairs(catalogue.searched) do searched[name] = true end
  for _, entry in ipairs(catalogue.entries(catalogue.names)) do
    if titles[entry.family] ~= title then
      title = titles[entry.family]
      lines[#lines + 1] = (#lines > 0 and "\n" or "") .. "### " .. title
      lines[#lines + 1] = "\n| name | family | force | parameters | what it is |\n|---|---|---|---|---|"
    end
    lines[#lines + 1] = row(entry, searched[entry.name])
  end
  return table.concat(lines, "\n") .. "\n"
end

return effects_table

-- Units of parameters: those that a study writes must be SI, and others are read off the equation they stand in: the k of
-- k*y is in N/m, since y is in m and the sum in N.
local core = require "lunid.core"

local units = {}

--- "N/m^n" as "N/m", "N/(m s)" as "N/m s", "Ns/m" as "N s/m": factors are what they are in any power that is no whole
--- number, and in any order. A second value: whether nothing was left out.
local function plain(text)
  local short = text:gsub("%^%b()", ""):gsub("%^%-?[%d]*%.[%d]+", ""):gsub("%^%-?[%a_][%w_]*", ""):gsub("[()]", "")
  local whole = short == text
  short = short:gsub("%f[%a](%a?N)([sm])%f[%A]", "%1 %2")
  return short:gsub("%f[%a](%a+)%.%f[%a]", "%1 "):gsub("%s*([/*])%s*", "%1"):gsub("%s+", " "):match "^%s*(.-)%s*$", whole
end

--- What is wrong with a parameter's unit, or nil: values are SI, and a unit of another size would only be a label. One that
--- nobody knows is a label and no more.
function units.problem(text)
  local short, whole = plain(text)
  if short == "" then return nil end
  local factor, si = core.si_unit(short)
  if not factor or factor == 1 then return nil end
  local problem = ("expected an SI unit such as N/m, got '%s'"):format(text)
  if not whole then return problem .. ": write the value in SI" end
  local words = core.number_text(factor) .. (si ~= "" and " " .. si or "")
  return ("%s (%s): write the value %s"):format(problem, words, si ~= "" and "in " .. si or "itself, without a unit")
end

-- Signals of one unit; the motion of a base stands in differences to y and v.
local signals = { { "y", "yb", m = 1, s = 0 }, { "v", "vb", m = 1, s = -1 }, { "a", "ab", m = 1, s = -2 }, { "t", m = 0, s = 1 } }

-- Functions whose values have no unit.
local pure = { sin = true, cos = true, tan = true, tanh = true, exp = true }

--- "abs(v)*sin(y)" -> "abs(v)*1": a sine has no unit, whatever stands in it.
local function without_pure(text)
  return (text:gsub("%f[%w_]([%a_][%w_]*)(%b())", function(name, inner)
    return pure[name] and "1" or name .. "(" .. without_pure(inner:sub(2, -2)) .. ")"
  end))
end

--- The power of signals of one unit in `factor`, or nil where they stand there otherwise than in a power.
local function power(factor, names)
  local function ratio(at)
    local before = factor:at(at)
    for _, name in ipairs(names) do at[name] = 2 * at[name] end
    return math.log(factor:at(at) / before, 2)
  end
  local one = ratio { y = 0.3, v = 0.7, a = 1.1, t = 0.2, yb = 0.1, vb = 0.2, ab = 0.5 }
  local other = ratio { y = 1.7, v = 0.4, a = 0.6, t = 1.3, yb = 0.6, vb = 0.3, ab = 0.1 }
  local whole = math.floor(one + 0.5)
  return math.abs(one - whole) < 1e-9 and math.abs(other - whole) < 1e-9 and whole or nil
end

local function raised(name, exponent) return exponent == 1 and name or ("%s^%d"):format(name, exponent) end

--- "N s/m" from { "N", s = 1, m = -1 }; `length`: the unit of y.
local function text(whole, s, m, length)
  local above, below = { whole }, {}
  for _, each in ipairs { { "s", s }, { length, m } } do
    if each[2] > 0 then above[#above + 1] = raised(each[1], each[2]) end
    if each[2] < 0 then below[#below + 1] = raised(each[1], -each[2]) end
  end
  return table.concat(above, " ") .. (#below > 0 and "/" .. table.concat(below, "/") or "")
end

--- The unit of the parameter `name` in an expression whose own unit is `whole`: "" where the parameter is no plain factor.
--- y is in `length` times seconds to the power `late`.
local function unit_in(expression, name, whole, length, late)
  local factor = expression:derivative(core.parse(name, name))
  for _, other in ipairs(factor:symbols()) do
    if other.kind ~= "channel" or other.name == "F" then return "" end
  end
  local m, s = 0, 0
  local units_alone = core.parse(without_pure(tostring(factor)), name)
  for _, signal in ipairs(signals) do
    local exponent = power(units_alone, signal)
    if not exponent then return "" end
    m, s = m - exponent * signal.m, s - exponent * (signal.s + late * signal.m)
  end
  return text(whole, s, m, length)
end

--- The units of y, of F and of the mass between them, as the record has y and F. Where a derivative of y alone was
--- measured, in a unit that is no length over time (a current), y is in that times seconds: by their power, the last value.
local function units_of(record)
  local function unit(name)
    local channel = record and record.channels[name]
    return channel and channel.unit ~= "" and channel.unit or nil
  end
  local length, late = unit "y", 0
  for power, name in ipairs { "v", "a" } do
    if not length and unit(name) then length, late = unit(name), power end
  end
  length = length or "m"
  local force = unit "F" or (length == "rad" and "N m" or "N")
  local mass = length == "m" and force == "N" and "kg" or length == "rad" and force == "N m" and "kg m^2"
    or text(force, 2 - late, -1, length)
  return length, force, mass, late
end

--- The model with units for those of its parameters that have none, where its motion is that of `record` (nil: m and N).
function units.complete(model, record)
  local rows = {}
  local length, force, mass, late = units_of(record)
  for _, part in ipairs { { model.mass, mass }, { model.restoring, force } } do
    for _, symbol in ipairs(part[1]:symbols()) do
      if symbol.kind == "parameter" and model.parameters[symbol.name].unit == "" and not rows[symbol.name] then
        local unit = unit_in(part[1], symbol.name, part[2], length, late)
        if not units.problem(unit) then rows[symbol.name] = { unit = unit } end
      end
    end
  end
  return core.model_with(model, rows)
end

return units

-- `lunid doctor`: what is installed, and whether figures work here.
local core = require "lunid.core"

local doctor = {}

function doctor.report()
  local function line(name, text) print(("%-12s%s"):format(name, text)) end
  line("lunid", core.version)
  line("stdlib", core.library)
  for _, part in ipairs(core.versions()) do line(part.name, part.version) end
  local good, text = pcall(core.check_figures)
  line("figures", good and text or "do not work here: " .. tostring(text))
  return good and 0 or 1
end

return doctor

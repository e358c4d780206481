-- lunid.figure: every kind, in the order of the manual.
local figures = require "lunid.figures"
local schema = require "lunid.schema"

for _, room in ipairs { "motion", "distributions", "frequency", "force_surfaces", "terms", "findings", "animations",
  "page" } do
  require("lunid.figures." .. room)
end

return { public = { figure = schema.strict_table("lunid.figure", figures.public) } }

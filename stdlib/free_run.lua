-- What `lunid simulate` shows and writes of a free run.
local core = require "lunid.core"
local figures = require "lunid.figures"
local sources = require "lunid.figures.sources"
local output = require "lunid.output"

local free_run = {}

--- RMSE of the run over the standard deviation of the measured displacement; nil where nothing was measured.
local function gap(record, run)
  if not record.channels.y or record.channels.y.derived then return nil end
  local measured = record:column "y"
  return measured:std() > 0 and core.statistics.nrmse(measured, run:column "y") or nil
end

--- Prints what the run from the state `from` (nil: the record's) did; writes run.csv, results.json and a figure.
function free_run.report(model, record, run, from)
  local summary = run.summary
  local result = summary.completed and gap(record, run) or nil
  print(model)
  print(run)
  if result then
    print(("%-11s%.3g (free run from %s)"):format("gap", result, from and "the given state"
      or "the record's first row; discover estimates the first state on a lead-in instead"))
  end
  local path = run:save "run.csv"
  output.write_json("results.json", { summary = summary, gap = result, model = model:equation(),
    excitation = record.name })
  local series = { { x = run:column "t", y = run:column "y", label = "model, free run", role = "final" } }
  if record.channels.y then
    table.insert(series, 1, { x = record:column "t", y = record:column "y", label = "measured", role = "measured" })
  end
  local figure = figures.make { panels = { { x = { name = "time", unit = "s" },
    y = sources.axis("y", sources.unit_in(record, "y")), series = series } } }
  local good, message = pcall(core.render_figure, figure, output.place "figures/run.png")
  print(("%-11s%s, %s%s"):format("", path, output.shown "results.json", good and ", " .. output.shown "figures/run.png" or ""))
  if not good then print(("%-11sno figure: %s"):format("note", message)) end
end

return free_run

-- Free runs, and fits on the trajectory.
local core = require "lunid.core"
local record_list = require "lunid.record_list"
local record_runs = require "lunid.record_runs"
local schema = require "lunid.schema"
local types = schema.types

local simulation = {}

local solvers = { "auto", "fixed", "bdf", "adams", "rk23", "rk45", "rk78", "esdirk" }
local interpolations = { "hold", "linear", "cubic", "band_limited" }
simulation.solver_words = {
  auto = "fixed; BDF where stability limits the explicit path",
  fixed = "Runge-Kutta locked to the record's samples",
  bdf = "CVODE BDF, for stiff models and switches to tolerance",
  adams = "CVODE Adams",
  rk23 = "ARKODE explicit Runge-Kutta 3(2), Bogacki-Shampine",
  rk45 = "ARKODE explicit Runge-Kutta 5(4), Dormand-Prince",
  rk78 = "ARKODE explicit Runge-Kutta 8(7), Fehlberg",
  esdirk = "ARKODE L-stable implicit Runge-Kutta, ESDIRK5(4)7L[2]SA",
}
simulation.solvers = solvers

local function start_of(given)
  if given.from == "record" then
    if not given.record then schema.fail("simulate", "from: 'record' needs a record as excitation") end
    return nil
  end
  if given.from ~= nil then return given.from end
  if given.record and given.record.channels.y then return nil end
  return { 0, 0 }
end

--- The table of expressions by channel that an excitation stands for.
local function signals_of(excitation)
  if type(excitation) == "number" or core.is_expression(excitation) then return { F = excitation } end
  if next(excitation) == nil then schema.fail("simulate", "excitation: the table is empty") end
  for channel, value in pairs(excitation) do
    if type(channel) ~= "string" then
      schema.fail("simulate", "excitation: expected entries such as F1 = an expression, got " .. core.describe(value))
    end
    if type(value) ~= "number" and not core.is_expression(value) then
      schema.fail("simulate: excitation", ("%s: expected an expression or a number, got %s"):format(channel,
        core.describe(value)))
    end
  end
  return excitation
end

local simulate = schema.define({
  name = "simulate",
  help = "Runs a model freely under a force, from a first state. A run that explodes is a result that says when and why.",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "what moves" },
    { "excitation", types.either(types.is("record", "lunid.read"), types.expression, types.table), required = true,
      unit = "N", help = "a record or an excitation, whose channels drive the model, an expression of lunid.time (the "
        .. "force), or a table of expressions by channel, such as { F1 = ..., yb = ... }" },
    { "from", types.either(types.choice { "record" }, types.list(types.number(), 2)),
      help = "first state { y, v, ... }, { y1, v1, y2, v2, ... }, or 'record': that of the record; else the record's, "
        .. "else rest" },
    { "duration", types.number { above = 0 }, unit = "s", help = "length of the run; of a record, else all" },
    { "dt", types.number { above = 0 }, unit = "s", help = "sample time of the result; of a record its own, else a whole "
      .. "part of that" },
    { "solver", types.choice(solvers), default = "auto", help = "how to integrate" },
    { "interpolation", types.choice(interpolations),
      help = "what the force does between samples; else what the record says (its formula), or the model, or straight lines" },
    { "rtol", types.number { above = 0, below = 1 }, default = 1e-8, help = "relative tolerance of SUNDIALS" },
    { "atol", types.number { above = 0 }, help = "absolute tolerance of SUNDIALS, for all states; else rtol times the scale "
      .. "of each" },
    { "substeps", types.integer { min = 1, max = 1000 }, help = "of the fixed path, per sample; else chosen" },
    { "sensitivities", types.boolean, default = false, help = "exact ones of every state and acceleration to every parameter "
      .. "and first state: run:sensitivity('y', 'k'), run:sensitivity('v', 'y(0)'); by fixed, bdf or adams" },
    { "max_memory", types.number { above = 0 }, default = 8, unit = "GB", help = "a run that needs more is refused" },
    { "regularise", types.number { above = 0 }, help = "smooth the branches over so much, in the unit of what switches: "
      .. "sign(v) becomes tanh(v/width), and so on; the run says so. Else every switch is located" },
    { "stop_when", types.expression, help = "the run ends where this rises above 0, such as lunid.displacement - 0.1; "
      .. "looked at four times per sample, then located" },
  },
  returns = "run",
  example = [[local run = lunid.simulate { model = model, excitation = record, from = { 0, 0 } }]],
}, function(given)
  if getmetatable(given.excitation) == "lunid.record" then
    given.record = given.excitation
    if given.duration then
      local record = given.record
      local span = (record.rows - 1) * record.dt
      if given.duration > span + record.dt / 2 then
        schema.fail("simulate", ("duration: the excitation lasts %.6g s, got %.6g s"):format(span, given.duration))
      end
      given.record = record:window(record.start, record.start + given.duration)
    end
  else
    given.signals = signals_of(given.excitation)
    if not given.duration or not given.dt then
      schema.fail("simulate", "duration and dt are needed where the excitation is an expression")
    end
  end
  schema.expect_values("simulate", given.model)
  given.x0 = start_of(given)
  return core.simulate(given.model, given)
end)

local fit_trajectory = schema.define({
  name = "fit_trajectory",
  help = "Refines a model's parameters on the trajectory: least squares between free runs and the measured motion, first "
    .. "states included (these begin at what fits the first rows, then ever more of them, with the parameters as guessed).",
  fields = {
    { "model", types.is("model", "lunid.model"), required = true, help = "with first guesses and bounds" },
    { "record", types.either(types.is("record", "lunid.read"), types.list(types.is("record", "lunid.read"), 1)),
      required = true, help = "one record or several; cut at gaps that were interpolated, but where some parameters are separate" },
    { "window", types.is("window", "lunid.window"), help = "part of the records" },
    { "channels", types.list(types.string, 1),
      help = "the displacements, velocities and accelerations to fit, each weighted by its noise; else of each coordinate "
        .. "what was measured: y, or v or a where that alone was" },
    { "separate", types.list(types.string, 1), help = "names of parameters that each record has for itself" },
    { "loss", types.choice { "squared", "huber" }, default = "squared",
      help = "'huber': residuals beyond 1.345 standard deviations count linearly, so that outliers do not pull" },
    { "segment", types.number { above = 0 }, unit = "s",
      help = "length of free runs with first states of their own (multiple shooting); else the whole record" },
    { "interpolation", types.choice(interpolations),
      help = "what the force does between samples; else what the record says (its formula), or the model, or straight lines" },
    { "solver", types.choice { "auto", "fixed", "bdf", "adams" }, default = "auto",
      help = "what integrates the runs and their sensitivities; auto: fixed, or bdf where the model is stiff at the start" },
    { "gradient", types.choice { "auto", "forward", "adjoint" }, default = "auto",
      help = "forward: sensitivities and Levenberg-Marquardt; adjoint: one backward sweep for all parameters and NLopt's "
        .. "L-BFGS; auto: adjoint from 40 parameters on, or beyond 64 states" },
    { "max_iterations", types.integer { min = 1, max = 1000 }, default = 40,
      help = "of Levenberg-Marquardt; L-BFGS may take 25 evaluations for each" },
    { "check", types.boolean, default = true, help = "compare the final runs of the fixed path with SUNDIALS': "
      .. "summary.checked" },
  },
  returns = "trajectory_fit",
  example = [[local fit = lunid.fit_trajectory { model = model, record = train, channels = { "y", "v" } }]],
}, function(given)
  local records = (given.separate and record_list or record_runs)(given.record, given.window)
  given.force_noise = true
  local fit = core.fit_trajectory(given.model, records, given)
  if not fit.summary.converged then
    print(("%s: fit_trajectory: did not converge (%s)"):format(core.place(), fit.summary.stopped))
  end
  return fit
end)

simulation.public = { simulate = simulate, fit_trajectory = fit_trajectory }
return simulation

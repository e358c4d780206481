---@meta
-- Written from the schemas by `lunid help stubs`; a test compares it with them.
---@class lunid
local lunid = { figure = {} }

---A value that `lunid run STUDY.lua key=value` may set.
---@class lunid.option.fields
---@field name string # the key on the command line
---@field default any # value without the key; its type is the option's type
---@param fields lunid.option.fields
---@return any
function lunid.option(fields) end

---Reads a CSV file. Columns are t F y v a in SI by default; v and a are derived where absent.
---@class lunid.read.fields
---@field path string # file, beside the study or from the current directory
---@field time? string # header of the time column, with its unit: "t [ms]"
---@field force? string # header of the force column: "load [kN]"
---@field displacement? string # header of the displacement column: "y [mm]"
---@field velocity? string # header of the velocity column
---@field acceleration? string # header of the acceleration column
---@field columns? string # all at once: "t=time,y=disp [mm],F=load [kN]"
---@field resample? boolean # resample an uneven time base to its median step
---@field window? lunid.window # part of the record to keep
---@param fields lunid.read.fields
---@return lunid.record
function lunid.read(fields) end

---A part of a record's time, from <= t <= to.
---@class lunid.window.fields
---@field from number # first time kept
---@field to number # last time kept
---@param fields lunid.window.fields
---@return lunid.window
function lunid.window(fields) end

---The displacements of the coordinates of a model of several degrees of freedom, as so many values.
---@param count integer # number of coordinates
---@return lunid.expressions
function lunid.displacements(count) end

---The velocities of the coordinates of a model of several degrees of freedom, as so many values.
---@param count integer # number of coordinates
---@return lunid.expressions
function lunid.velocities(count) end

---The accelerations of the coordinates of a model of several degrees of freedom, as so many values.
---@param count integer # number of coordinates
---@return lunid.expressions
function lunid.accelerations(count) end

---The forces of the coordinates of a model of several degrees of freedom, as so many values.
---@param count integer # number of coordinates
---@return lunid.expressions
function lunid.forces(count) end

---An unknown number to fit. It stands in expressions as a symbol.
---@class lunid.parameter.fields
---@field name string # how it is written in equations and results
---@field value? number # first guess; without one it is read off the data
---@field min? number # least admissible value
---@field max? number # largest admissible value
---@field unit? string # SI unit, such as "N/m"
---@field fixed? boolean # held at its value
---@field std? number # standard deviation, in a saved model
---@param fields lunid.parameter.fields
---@return lunid.expression
function lunid.parameter(fields) end

---An internal state z with a rate of its own. Held at a bound while its rate pushes outward.
---@class lunid.state.fields
---@field name string # how it is written in equations and results
---@field rate number|lunid.expression # dz/dt; function(z) return ... end where the rate holds z itself
---@field initial? number # value at the start of a run
---@field min? number|lunid.expression # lower bound; may follow the motion
---@field max? number|lunid.expression # upper bound; may follow the motion
---@param fields lunid.state.fields
---@return lunid.expression
function lunid.state(fields) end

---An entry of the catalogue, for lunid.discover { effects = { ... } }. Its names are private to it.
---@class lunid.effect.fields
---@field name string # snake_case, as results will call it
---@field family "stiffness"|"damping"|"friction"|"hysteresis"|"soil"|"inertia"|"extra_dof"|"time_variation"|"input"|"sensor" # kind of physics
---@field contribution any # what it adds to the restoring force, as text or expression; a list: its mirror images
---@field formula? string # as an engineer writes it; else the text of the first contribution
---@field parameters table # rows { "k", min =, max =, unit = }
---@field states? lunid.table # z = { rate = "...", initial = 0, min =, max = }
---@field guess? function # function(scale, variant) returning a list of { name = value }: first guesses of the shape parameters
---@field range? function # function(scale, variant) returning { name = { least, most } }: where a record can show a shape parameter
---@field signature? string # parity, harmonics, loop: how it shows in a record
---@field sentence? string # what an engineer would say about it
---@field confusers? table # entries that look like it
---@field special_case_of? table # entries that contain it exactly
---@field channels? table # channels that it needs beside y, v and F
---@field source? string # paper or textbook
---@param fields lunid.effect.fields
---@return lunid.effect
function lunid.effect(fields) end

---Ordinary least squares, by a streaming QR factorisation.
---@class lunid.least_squares.fields
---@param fields lunid.least_squares.fields
---@return lunid.solver
function lunid.least_squares(fields) end

---Least squares with a penalty on the squares of the coefficients, each in units of its feature's size.
---@class lunid.ridge.fields
---@field lambda? number # weight of the penalty, dimensionless
---@param fields lunid.ridge.fields
---@return lunid.solver
function lunid.ridge(fields) end

---Sequentially thresholded least squares: drops features that contribute less than a threshold.
---@class lunid.stlsq.fields
---@field threshold? number # least rms of coefficient * feature over the rms of the target
---@field ridge? number # lambda of the ridge regression in each pass
---@field max_passes? integer # at most so many passes
---@param fields lunid.stlsq.fields
---@return lunid.solver
function lunid.stlsq(fields) end

---Least squares with a penalty on the absolute coefficients: keeps few features.
---@class lunid.lasso.fields
---@field lambda? number # weight of the penalty, dimensionless; or chosen over left-out blocks of time
---@field path? integer # values of lambda that are tried
---@field refit? boolean # refit what was kept by least squares
---@param fields lunid.lasso.fields
---@return lunid.solver
function lunid.lasso(fields) end

---Fits the coefficients of features to the restoring force F - m*a along the measured motion.
---@class lunid.regress.fields
---@field record any # one record or several
---@field mass? number|lunid.expression # without it the target is F itself
---@field features table # functions of displacement, velocity, time; sets of them are laid flat
---@field known? number|lunid.expression # part of the restoring force that is known
---@field constraints? table # what is known about the coefficients
---@field window? lunid.window # part of the records
---@field solver? any # least squares by default
---@field blocks? integer # blocks of time, for cross-validation and standard errors
---@param fields lunid.regress.fields
---@return lunid.regression
function lunid.regress(fields) end

---Runs a model freely under a force, from a first state. A run that explodes is a result that says when and why.
---@class lunid.simulate.fields
---@field model lunid.model # what moves
---@field excitation any # a record, whose channels drive the model, an expression of lunid.time (the force), or a table of expressions by channel, such as { F1 = ..., yb = ... }
---@field from? "record"|table # first state { y, v, ... }, { y1, v1, y2, v2, ... }, or 'record': that of the record; else the record's, else rest
---@field duration? number # length of the run; of a record, else all
---@field dt? number # sample time of the result, where the force is an expression
---@field solver? "auto"|"fixed"|"bdf"|"adams"|"rk23"|"rk45"|"rk78"|"esdirk" # how to integrate
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what the force does between samples
---@field rtol? number # relative tolerance of SUNDIALS
---@field substeps? integer # of the fixed path, per sample; else chosen
---@param fields lunid.simulate.fields
---@return lunid.run
function lunid.simulate(fields) end

---Refines a model's parameters on the trajectory: least squares between free runs and the measured motion, first states included.
---@class lunid.fit_trajectory.fields
---@field model lunid.model # with first guesses and bounds
---@field record any # one record or several
---@field window? lunid.window # part of the records
---@field channels? table # the displacements and velocities to fit, each weighted by its noise; else the displacements
---@field separate? table # names of parameters that each record has for itself
---@field loss? "squared"|"huber" # 'huber': residuals beyond 1.345 standard deviations count linearly, so that outliers do not pull
---@field segment? number # length of free runs with first states of their own (multiple shooting); else the whole record
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what the force does between samples
---@field max_iterations? integer # of Levenberg-Marquardt
---@param fields lunid.fit_trajectory.fields
---@return lunid.trajectory_fit
function lunid.fit_trajectory(fields) end

---The equation of motion m*a + restoring = F, or one of them for each of several coordinates. With imposed motion, y and v drive it and F is its output.
---@class lunid.model.fields
---@field mass number|lunid.expression # a number, a parameter, or an expression; for several coordinates a list, or the rows of a matrix
---@field restoring number|lunid.expression # restoring force; 0 for none; for several coordinates a list
---@field forces? table # the coordinates that a force acts on, such as { 1 }; else all
---@field states? table # internal states that the restoring force does not name
---@field motion? "free"|"imposed" # 'imposed': the measured motion drives the model; the mass may then be 0
---@param fields lunid.model.fields
---@return lunid.model
function lunid.model(fields) end

---Masses in a row with an element between neighbours: y1 ... yn, each element a function of its elongation and the rate of it.
---@class lunid.chain.fields
---@field masses table # one for each coordinate
---@field element function # function(elongation, rate, index) that returns the force, positive in tension
---@field ends? "fixed"|"left"|"right"|"free" # which ends an element ties to the ground: both, the first mass, the last, none
---@field forces? table # the coordinates that a force acts on; else all
---@param fields lunid.chain.fields
---@return lunid.model
function lunid.chain(fields) end

---Loads a model that model:save wrote, or that is written by hand in the same form.
---@class lunid.load.fields
---@field path string # a Lua file that returns a lunid.model
---@param fields lunid.load.fields
---@return lunid.model
function lunid.load(fields) end

---All products of powers of the variables up to an order, without the constant unless asked for.
---@param variables table # such as { y, v }
---@param order integer # largest sum of the powers
---@param constant? boolean # put the constant 1 first
---@return lunid.features
function lunid.polynomials(variables, order, constant) end

---The coefficient is at least a bound.
---@param feature number|lunid.expression # the feature whose coefficient is meant
---@param bound number|lunid.expression # a number, or another feature, whose coefficient is meant
---@return lunid.constraint
function lunid.at_least(feature, bound) end

---The coefficient is at most a bound.
---@param feature number|lunid.expression # the feature whose coefficient is meant
---@param bound number|lunid.expression # a number, or another feature, whose coefficient is meant
---@return lunid.constraint
function lunid.at_most(feature, bound) end

---The coefficient has a known value.
---@param feature number|lunid.expression # the feature whose coefficient is meant
---@param value number # its value
---@return lunid.constraint
function lunid.fixed(feature, value) end

---The coefficient lies between two values.
---@param feature number|lunid.expression # the feature whose coefficient is meant
---@param lower number # least value
---@param upper number # largest value
---@return lunid.constraint
function lunid.between(feature, lower, upper) end

---A curve or a cloud of points, for figure.lines.
---@class lunid.figure.series.fields
---@field x any # a column, such as record:column "t", or a list
---@field y any # of the same length
---@field label? string # in the legend
---@field role? "measured"|"baseline"|"final"|"residual"|"effect"|"noise"|"first"|"second"|"third"|"fourth"|"fifth"|"sixth" # what it means; decides its colour
---@field style? "line"|"dashed"|"dotted"|"dash_dot"|"points"|"line_points" # how it is drawn
---@param fields lunid.figure.series.fields
---@return lunid.series
function lunid.figure.series(fields) end

---A chart of curves over common axes.
---@class lunid.figure.lines.fields
---@field series table # its curves
---@field title? string # above the chart
---@field x? string # axis with its unit: "time [s]"
---@field y? string # axis with its unit: "displacement [m]"
---@field note? string # one short line above the chart, on the right
---@param fields lunid.figure.lines.fields
---@return lunid.figure
function lunid.figure.lines(fields) end

---A restoring force surface over displacement and velocity, with the measured points near it.
---@class lunid.figure.surface.fields
---@field surface lunid.surface # what to draw
---@field title? string # above the figure
---@field points? boolean # draw the measured points too
---@field azimuth? number # where it is seen from, about the force axis
---@field elevation? number # where it is seen from, above the plane
---@param fields lunid.figure.surface.fields
---@return lunid.figure
function lunid.figure.surface(fields) end

---Where baseline and final model leave force unexplained, over displacement and velocity.
---@class lunid.figure.residual_map.fields
---@field discovery lunid.discovery # what was found
---@param fields lunid.figure.residual_map.fields
---@return lunid.figure
function lunid.figure.residual_map(fields) end

---A frequency response: stable branches solid, unstable ones dashed, folds and bifurcations marked.
---@class lunid.figure.response.fields
---@field response lunid.response # what to draw
---@field quantity? string # a column of the response, such as "amplitude_3" or "phase_1"
---@field state? string # whose motion; else the first displacement
---@field series? table # curves to compare with
---@field log? boolean # logarithmic axis of the quantity
---@field title? string # above the chart
---@param fields lunid.figure.response.fields
---@return lunid.figure
function lunid.figure.response(fields) end

---Bilinear interpolation between the corners of equal cells; cells without data stay empty.
---@class lunid.grid.fields
---@field cells? table # number of cells along displacement and velocity
---@field least_count? integer # cells with fewer points have no data
---@field smoothness? number # weight of the squared second differences
---@param fields lunid.grid.fields
---@return lunid.interpolator
function lunid.grid(fields) end

---The restoring force surface of a record: interpolated where asked for, and as a Chebyshev polynomial.
---@class lunid.rfs.fields
---@field record any # one record or several
---@field mass? number|lunid.expression # without it the surface is that of F itself
---@field window? lunid.window # part of the records
---@field interpolate? lunid.interpolator # how it is drawn; else by the polynomial
---@field order? table # of the polynomial in displacement and in velocity
---@field blocks? integer # blocks of time left out in turn for the score
---@param fields lunid.rfs.fields
---@return lunid.surface
function lunid.rfs(fields) end

---The periodic answers of a model to a harmonic excitation over a range of frequencies: stable and unstable branches by continuation, or what a stepped or swept sine shows.
---@class lunid.frequency_response.fields
---@field model lunid.model # what is driven
---@field amplitude number # of the force amplitude*cos(2*pi*f*t), or of the base's displacement in m; a list gives a curve for each
---@field input? string # the force that acts, such as 'F2', or 'base'; else the model's first input
---@field from number # lowest frequency
---@field to number # highest frequency
---@field method? "auto"|"harmonic_balance"|"shooting"|"stepped_up"|"stepped_down"|"swept_up"|"swept_down" # 'auto': harmonic balance, and shooting where the model has switches or bounds
---@field harmonics? integer # of harmonic balance; else as many as are needed, up to 63
---@field accuracy? number # of harmonics left out, and of steadiness, over the amplitude
---@field max_step? number # largest relative change of motion and frequency from point to point
---@field max_points? integer # of a branch
---@field stability? boolean # find the Floquet multipliers of each point
---@field points? integer # frequencies of a stepped sine
---@field max_periods? integer # in which a stepped sine must become steady
---@field rate? number # of a swept sine
---@param fields lunid.frequency_response.fields
---@return lunid.response
function lunid.frequency_response(fields) end

---The free motions that grow out of a mode: frequency and damping ratio over amplitude.
---@class lunid.backbone.fields
---@field model lunid.model # its damping is made up for, its forces are 0
---@field from number # smallest amplitude of the displacement that moves most
---@field to number # largest amplitude
---@field mode? integer # counted from the lowest frequency
---@field harmonics? integer # else as many as are needed, up to 63
---@field accuracy? number # of harmonics left out, over the amplitude
---@field max_step? number # largest relative change of motion and frequency from point to point
---@field max_points? integer # of the curve
---@param fields lunid.backbone.fields
---@return lunid.backbone
function lunid.backbone(fields) end

---The states of a free run once per period of its excitation.
---@class lunid.poincare.fields
---@field model lunid.model # what moves
---@field excitation number|lunid.expression # an expression of lunid.time, or a table of them by channel, as of lunid.simulate
---@field period number # of the excitation
---@field from? table # first state { y, v, ... }
---@field points? integer # periods shown
---@field transient? integer # periods before them that are left out
---@field phase? number # part of the period at which to look
---@field samples? integer # of a period; each is two steps
---@param fields lunid.poincare.fields
---@return lunid.section
function lunid.poincare(fields) end

---Where a model and its records disagree, what effect is missing, and how far the gap shrinks with it.
---@class lunid.discover.fields
---@field model lunid.model # the baseline
---@field train any # record or list of records, used for every choice
---@field test? any # opened once, after the verdict; else the last part of each record is held out
---@field window? lunid.window # part of the training records
---@field test_window? lunid.window # part of the test records; of the training files where no test is given
---@field catalogue? table # names of entries to try; else all (`lunid list effects`)
---@field effects? table # entries of your own, beside the catalogue
---@field alpha? number # level of false alarms of the whole search
---@field max_effects? integer # named one after another
---@field blocks? integer # left-out blocks of the training records
---@field holdout? number # part held out when no test is given
---@field out? string # folder for report, model, JSON and figures, below the run's out directory
---@param fields lunid.discover.fields
---@return lunid.discovery
function lunid.discover(fields) end

return lunid

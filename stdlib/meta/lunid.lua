---@meta
-- Written from the schemas by `lunid help stubs`; a test compares it with them.
---@class lunid
local lunid = { effects = {}, derivative = {}, excitation = {}, noise = {}, systems = {}, figure = {}, statistics = {} }
---@class lunid.record
local record = {}

---A value that `lunid run STUDY.lua key=value` may set.
---@class lunid.option.fields
---@field name string # the key on the command line
---@field default any # value without the key; its type is the option's type
---@param fields lunid.option.fields
---@return any
function lunid.option(fields) end

---Reads a record from a CSV, MAT or HDF5 file. Columns are t F y v a in SI by default; v and a are derived where absent. A MAT file gives its variables, fields as "run.y", columns of arrays as "data:2".
---@class lunid.read.fields
---@field path string # file, beside the study or from the current directory
---@field time? string # header of the time column, with its unit: "t [ms]"
---@field force? string # header of the force column: "load [kN]"; "0" where nothing drives
---@field displacement? string # header of the displacement column: "y [mm]"
---@field velocity? string # header of the velocity column
---@field acceleration? string # header of the acceleration column
---@field columns? string # all at once: "t=time,y=disp [mm],F=load [kN]"
---@field rate? number # rows per second, where there is no time: a number, or its name in a MAT or HDF5 file
---@field interval? number # the same as the time between rows
---@field resample? boolean # resample an uneven time base to its median step
---@field window? lunid.window # part of the record to keep
---@param fields lunid.read.fields
---@return lunid.record
function lunid.read(fields) end

---A record of columns that are there already, such as forces computed from gauges. Channels t F y v a are in SI; v and a are derived where absent.
---@class lunid.record.fields
---@field channels table # entries { name, column }: { { "F", force }, { "y", y } }; of other SI units than N and m { "y", angle, unit = "rad" }, { "F", torque, unit = "N m" }
---@field dt number # time between rows
---@field start? number # time of the first row
---@field name? string # what messages and figures call it
---@param fields lunid.record.fields
---@return lunid.record
function lunid.record(fields) end

---A record that stays in its file (CSV, HDF5, MAT of version 7.3) and is read block by block, for files larger than memory. lunid.regress takes it as it takes a record, with the same result; what needs all rows at once does not. The file is looked through twice when it is opened, and read again for each pass of a regression.
---@class lunid.stream.fields
---@field path string # file, beside the study or from the current directory
---@field time? string # header of the time column, with its unit: "t [ms]"
---@field force? string # header of the force column: "load [kN]"; "0" where nothing drives
---@field displacement? string # header of the displacement column: "y [mm]"
---@field velocity? string # header of the velocity column
---@field acceleration? string # header of the acceleration column
---@field columns? string # all at once: "t=time,y=disp [mm],F=load [kN]"
---@field rate? number # rows per second, where there is no time: a number, or its name in a MAT or HDF5 file
---@field interval? number # the same as the time between rows
---@field derivative? lunid.derivative # of what of v and a was not measured: lunid.derivative.savitzky_golay {} by default. fourier and total_variation need the whole record; spline and kalman give its numbers to 1e-9 of a deviation
---@field smooth? boolean # smooth measured y, v and a too, by the same method
---@field window? lunid.window # part of the record to keep
---@param fields lunid.stream.fields
---@return lunid.stream
function lunid.stream(fields) end

---A part of a record's time, from <= t <= to.
---@class lunid.window.fields
---@field from number # first time kept
---@field to number # last time kept
---@param fields lunid.window.fields
---@return lunid.window
function lunid.window(fields) end

---Writes the time and the channels in SI with their units, below the out directory: as HDF5 (.h5, .hdf5), for MATLAB (.mat) or else as CSV. Derived channels are called v_derived in the file, and are derived ones again where it is read. Whole or not at all. Also run:save.
---@class lunid.record.save.fields
---@field path string # below the out directory
---@field version? "5"|"7.3" # of a MAT file: 5 is read by all programs and holds 2 GB a channel, 7.3 can be a stream
---@param fields lunid.record.save.fields
---@return string
function record:save(fields) end

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
---@field value? number # first guess; lunid.discover reads one off the data where there is none, and regress and fit_curve search between min and max; runs and fits on the trajectory need one
---@field min? number # least admissible value
---@field max? number # largest admissible value
---@field unit? string # SI unit, such as "N/m"; one of another size, such as kN/m, is refused
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
---@field anchored? boolean # a fit takes it to be `initial` where the first record begins: for a state that only adds up, such as a path
---@param fields lunid.state.fields
---@return lunid.expression
function lunid.state(fields) end

---An entry of the catalogue, for lunid.discover { effects = { ... } }. Its names are private to it. Called with values, as magnet { k = 3, p = 40 }, it is an element of a model, as those of lunid.effects.
---@class lunid.effect.fields
---@field name string # snake_case, as results will call it
---@field family "stiffness"|"damping"|"friction"|"hysteresis"|"soil"|"inertia"|"extra_dof"|"time_variation"|"input"|"sensor" # kind of physics
---@field contribution? any # what it adds to the restoring force, as text or expression; a list: its forms, such as mirror images
---@field measures? lunid.table # of a sensor's fault: { y = "y + b" }, what the channel shows of the true motion; a list: the forms that it may have
---@field any_motion? boolean # what it measures of y holds of v or a too, where one of these was recorded
---@field separate? any # its parameters are those of one record, such as a drift: a test record has its own, found on it while all others are held; { phi = "shaft_angle" }: phi alone, where the records do not hold that channel
---@field repeats? boolean # may stand several times at one place, as stops on either side; the names of the second end in _b
---@field acts? lunid.table # of a fault of the force: { F = "g*F" }, the force that acts, of what its channel shows, of force_rate, the rate of that, and of y and v (a coil that leaves its field: "F*(1 - b*y^2)"); affine in F
---@field delay? any # by which the force acts later than its channel says
---@field formula? any # as an engineer writes it, one for all forms or one for each; else the text of each contribution
---@field parameters table # rows { "k", min =, max =, unit =, fixed = }; a fixed one stays at its first guess; a form has those that it holds
---@field states? lunid.table # z = { rate = "...", initial = 0, min =, max =, unit =, anchored =, absolute = }; anchored: as in lunid.state; absolute: the velocity of a mass of its own, against which a base that moves acts
---@field requires? table # what holds between parameters, as "Fs >= Fc"
---@field guess? function # function(scale, variant) returning a list of { name = value }: first guesses of the shape parameters, within their bounds
---@field range? function # function(scale, variant) returning { name = { least, most } }: where a record can show a shape parameter
---@field passive? any # false where it can create energy over a cycle; "where c >= 0" where that depends
---@field signature? string # parity, harmonics, loop: how it shows in a record
---@field sentence? string # what an engineer would say about it
---@field note? string # how the formula was made into equations, and its error
---@field confusers? table # entries that look like it
---@field special_case_of? table # entries that contain it, exactly or as a limit
---@field acts_on? table # entries that it modifies
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

---Least squares with a penalty on absolute coefficients and on squares: keeps features that resemble one another together.
---@class lunid.elastic_net.fields
---@field mixture? number # share of the penalty on absolute values; 1 is the lasso
---@field lambda? number # weight of the penalty, dimensionless; or chosen over left-out blocks of time
---@field path? integer # values of lambda that are tried
---@field refit? boolean # refit what was kept by least squares
---@param fields lunid.elastic_net.fields
---@return lunid.solver
function lunid.elastic_net(fields) end

---Least squares with every coefficient >= 0.
---@class lunid.non_negative.fields
---@param fields lunid.non_negative.fields
---@return lunid.solver
function lunid.non_negative(fields) end

---Sparse relaxed regularised regression: a sparse copy of the coefficients is kept near them.
---@class lunid.sr3.fields
---@field threshold? number # contribution at which a coefficient is cut
---@field relaxation? number # how far the sparse copy may be from the coefficients
---@field absolute? boolean # shrink by the threshold (l1) in place of cutting (l0)
---@field refit? boolean # refit what was kept by least squares
---@param fields lunid.sr3.fields
---@return lunid.solver
function lunid.sr3(fields) end

---Forward regression by orthogonal least squares: takes up the feature of largest error reduction ratio, one after another.
---@class lunid.frols.fields
---@field threshold? number # least error reduction ratio of a term
---@field max_terms? integer # at most so many; 0: all
---@param fields lunid.frols.fields
---@return lunid.solver
function lunid.frols(fields) end

---Adds or drops one feature at a time while that lowers an information criterion.
---@class lunid.stepwise.fields
---@field criterion? "bic"|"aicc" # what is to be least
---@field max_terms? integer # at most so many; 0: all
---@param fields lunid.stepwise.fields
---@return lunid.solver
function lunid.stepwise(fields) end

---The best of all subsets of up to 30 features, by branch and bound; fit.steps holds the best of each size.
---@class lunid.best_subset.fields
---@field terms? integer # how many; 0: by the criterion
---@field criterion? "bic"|"aicc" # what is to be least
---@param fields lunid.best_subset.fields
---@return lunid.solver
function lunid.best_subset(fields) end

---Bayesian selection: the probability of each feature to belong to the model, and the features above a cut.
---@class lunid.spike_slab.fields
---@field prior? number # probability of a feature before the data
---@field cut? number # least probability of a feature that is kept
---@field sweeps? integer # of the sampler, with more than 15 features
---@param fields lunid.spike_slab.fields
---@return lunid.solver
function lunid.spike_slab(fields) end

---Solves many times on blocks of time drawn with replacement, and keeps what most members keep.
---@class lunid.ensemble_of.fields
---@field solver? lunid.solver # of each member; stlsq by default
---@field members? integer # how many
---@field features? number # share of the features that a member sees
---@field inclusion? number # least share of members that keep a feature
---@param fields lunid.ensemble_of.fields
---@return lunid.solver
function lunid.ensemble_of(fields) end

---Counts the noise of the features as that of the target: errors in variables, from the noise of the channels.
---@class lunid.total_least_squares.fields
---@field noise? lunid.table # standard deviations, such as { y = 1e-5, F = 2 }; else as estimated
---@param fields lunid.total_least_squares.fields
---@return lunid.solver
function lunid.total_least_squares(fields) end

---Two-stage least squares: noise that enters the features linearly leaves no bias where the instruments are functions of signals that it does not enter, such as the reference of a controller.
---@class lunid.instrumental_variables.fields
---@field instruments table # one or more for each coefficient, as the features are made but of the reference
---@param fields lunid.instrumental_variables.fields
---@return lunid.solver
function lunid.instrumental_variables(fields) end

---Robust regression: residuals beyond a threshold count linearly; outliers are reported. Several passes over the data.
---@class lunid.huber.fields
---@field threshold? number # in deviations of the residual
---@field outlier? number # residuals beyond so many deviations are reported
---@param fields lunid.huber.fields
---@return lunid.solver
function lunid.huber(fields) end

---Runs a model freely under a force, from a first state. A run that explodes is a result that says when and why.
---@class lunid.simulate.fields
---@field model lunid.model # what moves
---@field excitation any # a record or an excitation, whose channels drive the model, an expression of lunid.time (the force), or a table of expressions by channel, such as { F1 = ..., yb = ... }
---@field from? "record"|table # first state { y, v, ... }, { y1, v1, y2, v2, ... }, or 'record': that of the record; else the record's, else rest
---@field duration? number # length of the run; of a record, else all
---@field dt? number # sample time of the result; of a record its own, else a whole part of that
---@field solver? "auto"|"fixed"|"bdf"|"adams"|"rk23"|"rk45"|"rk78"|"esdirk" # how to integrate
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what the force does between samples; else what the record says (its formula), or the model, or straight lines
---@field rtol? number # relative tolerance of SUNDIALS
---@field atol? number # absolute tolerance of SUNDIALS, for all states; else rtol times the scale of each
---@field substeps? integer # of the fixed path, per sample; else chosen
---@field sensitivities? boolean # exact ones of every state and acceleration to every parameter and first state: run:sensitivity('y', 'k'), run:sensitivity('v', 'y(0)'); by fixed, bdf or adams
---@field max_memory? number # a run that needs more is refused
---@field regularise? number # smooth the branches over so much, in the unit of what switches: sign(v) becomes tanh(v/width), and so on; the run says so. Else every switch is located
---@field stop_when? number|lunid.expression # the run ends where this rises above 0, such as lunid.displacement - 0.1; looked at four times per sample, then located
---@param fields lunid.simulate.fields
---@return lunid.run
function lunid.simulate(fields) end

---Refines a model's parameters on the trajectory: least squares between free runs and the measured motion, first states included (these begin at what fits the first rows, then ever more of them, with the parameters as guessed).
---@class lunid.fit_trajectory.fields
---@field model lunid.model # with first guesses and bounds
---@field record any # one record or several; cut at gaps that were interpolated, but where some parameters are separate
---@field window? lunid.window # part of the records
---@field channels? table # the displacements, velocities and accelerations to fit, each weighted by its noise; else of each coordinate what was measured: y, or v or a where that alone was
---@field separate? table # names of parameters that each record has for itself
---@field loss? "squared"|"huber" # 'huber': residuals beyond 1.345 standard deviations count linearly, so that outliers do not pull
---@field segment? number # length of free runs with first states of their own (multiple shooting); else the whole record
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what the force does between samples; else what the record says (its formula), or the model, or straight lines
---@field solver? "auto"|"fixed"|"bdf"|"adams" # what integrates the runs and their sensitivities; auto: fixed, or bdf where the model is stiff at the start
---@field gradient? "auto"|"forward"|"adjoint" # forward: sensitivities and Levenberg-Marquardt; adjoint: one backward sweep for all parameters and NLopt's L-BFGS; auto: adjoint from 40 parameters on, or beyond 64 states
---@field max_iterations? integer # of Levenberg-Marquardt; L-BFGS may take 25 evaluations for each
---@field check? boolean # compare the final runs of the fixed path with SUNDIALS': summary.checked
---@param fields lunid.fit_trajectory.fields
---@return lunid.trajectory_fit
function lunid.fit_trajectory(fields) end

---A function in Lua as a last resort, where the language has no words for it: damper(y, v) then stands in models and regressions like any expression. It is slow, runs on one thread, and is taken for smooth.
---@class lunid.lua_function.fields
---@field name string # how it is written in equations
---@field call function # function of 1 to 4 numbers that returns a number
---@field gradient? function # function of the same numbers that returns the derivative by each; else by central differences
---@field scale? table # size of each argument below which differences take it for 0; else 1e-3
---@param fields lunid.lua_function.fields
---@return lunid.function
function lunid.lua_function(fields) end

---A table of values as a function of one or two variables. Beyond its ends it goes on straight.
---@class lunid.lookup.fields
---@field name string # how it is written in equations
---@field axes table # one list of increasing values, or two
---@field values table # one number for each point; with two axes a list over the second axis for each point of the first
---@field between? "linear"|"cubic" # the points: straight lines, or a spline without a jump in its first and second derivatives
---@param fields lunid.lookup.fields
---@return lunid.function
function lunid.lookup(fields) end

---Central differences of any even order of accuracy, one-sided at the ends.
---@class lunid.derivative.finite_differences.fields
---@field accuracy? integer # even: the error falls as its power of dt; else chosen from the noise
---@field step? integer # rows between the samples that are used; else chosen from the noise
---@param fields lunid.derivative.finite_differences.fields
---@return lunid.derivative
function lunid.derivative.finite_differences(fields) end

---A polynomial through a moving window.
---@class lunid.derivative.savitzky_golay.fields
---@field rows? integer # of the window, an odd number; else chosen from the noise
---@field order? integer # of the polynomial; else chosen from the noise
---@param fields lunid.derivative.savitzky_golay.fields
---@return lunid.derivative
function lunid.derivative.savitzky_golay(fields) end

---In the frequency domain, continued beyond the ends so that the record need not be periodic. Without a cut-off the gain is Wiener's, from the record's own spectrum and noise.
---@class lunid.derivative.fourier.fields
---@field cutoff? number # what lies above it is taken for noise
---@param fields lunid.derivative.fourier.fields
---@return lunid.derivative
function lunid.derivative.fourier(fields) end

---A smoothing spline with a knot at each row.
---@class lunid.derivative.spline.fields
---@field degree? integer # 3: penalises the square of the acceleration; 5: that of the jerk
---@field by? "noise"|"cross_validation" # how the weight is chosen: by the known noise, or by generalised cross-validation without it
---@field weight? number # of the penalty's integral; else chosen
---@param fields lunid.derivative.spline.fields
---@return lunid.derivative
function lunid.derivative.spline(fields) end

---Keeps jumps: one of the derivatives is constant in pieces, as few as the noise allows. Slow on long records.
---@class lunid.derivative.total_variation.fields
---@field order? integer # which is constant in pieces: 1 velocity, 2 acceleration, 3 jerk
---@field weight? number # of the jumps' sizes, in the channel's unit; else chosen from the noise
---@param fields lunid.derivative.total_variation.fields
---@return lunid.derivative
function lunid.derivative.total_variation(fields) end

---Finite differences after a Savitzky-Golay filter.
---@class lunid.derivative.smoothed_differences.fields
---@field rows? integer # of the window, an odd number; else chosen from the noise
---@field order? integer # of the polynomial; else chosen from the noise
---@field accuracy? integer # of the differences, an even number
---@param fields lunid.derivative.smoothed_differences.fields
---@return lunid.derivative
function lunid.derivative.smoothed_differences(fields) end

---A Kalman smoother over y, v and a jointly, from all of them that were measured. Each channel has its noise; a higher derivative is white, and as strong as is most likely.
---@class lunid.derivative.kalman.fields
---@field order? integer # which derivative is white: 3 the jerk, 4 the snap; higher ones for smoother motions
---@field density? number # of the white derivative; else most likely
---@param fields lunid.derivative.kalman.fields
---@return lunid.derivative
function lunid.derivative.kalman(fields) end

---Velocity and acceleration where they were not measured. Derived channels remember how (`record.channels.a.derivation`).
---@class lunid.record.derive.fields
---@field method? lunid.derivative # lunid.derivative.fourier {} by default
---@field channels? table # to make, such as { "a" }; else what of v and a was not measured
---@field from? string # channel to differentiate; else the nearest measured one (kalman: all of them)
---@field smooth? boolean # replace measured channels too by what the method makes of them
---@param fields lunid.record.derive.fields
---@return lunid.record
function record:derive(fields) end

---A Butterworth filter forwards and backwards, so that nothing is delayed. The amplitude at a cut-off is halved. Also stream:filter, which gives a stream.
---@class lunid.record.filter.fields
---@field from? number # passes what lies above
---@field to? number # passes what lies below; with from: a band
---@field stop? boolean # passes all but that
---@field order? integer # of the filter in each direction
---@field channels? table # such as { "y", "F" }; else all
---@param fields lunid.record.filter.fields
---@return lunid.record
function record:filter(fields) end

---Takes off the least-squares polynomial of each channel. Also stream:detrend.
---@class lunid.record.detrend.fields
---@field degree? integer # 0 the mean, 1 a line, 2 a parabola ...
---@field channels? table # such as { "y", "F" }; else all
---@param fields lunid.record.detrend.fields
---@return lunid.record
function record:detrend(fields) end

---Every row of so many, after a filter that keeps the rest from folding in. Also stream:decimate.
---@class lunid.record.decimate.fields
---@field factor integer # rows that become one
---@param fields lunid.record.decimate.fields
---@return lunid.record
function record:decimate(fields) end

---The same time at another rate, by band-limited interpolation. Also stream:resample.
---@class lunid.record.resample.fields
---@field rate number # rows per second
---@param fields lunid.record.resample.fields
---@return lunid.record
function record:resample(fields) end

---Moves a record onto the time of another by the largest correlation of one channel, to a part of a row. Also gives the delay taken off [s] and the correlation.
---@class lunid.record.align.fields
---@field with lunid.record # whose rows it gets
---@field channel? string # that both hold
---@field most? number # largest delay looked for; else half of the shorter record
---@param fields lunid.record.align.fields
---@return lunid.record
function record:align(fields) end

---Velocity and displacement from an acceleration, or displacement from a velocity, rid of drift. Also stream:integrate.
---@class lunid.record.integrate.fields
---@field from? string # channel to integrate; else the measured v or a
---@field below? number # drift is what lies below: taken off by a high pass after each integration
---@field degree? integer # without below: of the polynomial taken off the first integral, one more off the second
---@param fields lunid.record.integrate.fields
---@return lunid.record
function record:integrate(fields) end

---Power spectral density by Welch's method. Columns: frequency [Hz], density [unit^2/Hz], and its 95 % limits low, high.
---@class lunid.record.spectrum.fields
---@field channel? string # whose
---@field length? integer # of a segment, a power of two; else an eighth of the record or less
---@param fields lunid.record.spectrum.fields
---@return lunid.spectrum
function record:spectrum(fields) end

---Frequency response from an input to an output, with coherence and 95 % limits. H1 holds for noise in the output, H2 for noise in the input. Columns: frequency [Hz], real, imaginary, magnitude, phase [rad], coherence, magnitude_low, magnitude_high, phase_std [rad].
---@class lunid.record.transfer.fields
---@field input? string # channel that drives
---@field output? string # channel that answers
---@field estimator? "h1"|"h2" # Sxy/Sxx or Syy/Syx
---@field length? integer # of a segment, a power of two; else an eighth of the record or less
---@param fields lunid.record.transfer.fields
---@return lunid.transfer
function record:transfer(fields) end

---Power spectral densities along the record. Columns over its segments: time [s], ridge, the frequency of the largest density [Hz]; `:at(segment)` is the density over `.frequency`.
---@class lunid.record.spectrogram.fields
---@field channel? string # whose
---@field length? integer # of a segment, a power of two; else an eighth of the record or less
---@field hop? integer # from one segment to the next; else a quarter of one
---@param fields lunid.record.spectrogram.fields
---@return lunid.spectrogram
function record:spectrogram(fields) end

---Amplitude and instantaneous frequency of a motion of one frequency at a time, without its noise. Columns: time [s], amplitude, frequency [Hz], phase [rad].
---@class lunid.record.envelope.fields
---@field channel? string # whose
---@param fields lunid.record.envelope.fields
---@return lunid.envelope
function record:envelope(fields) end

---Cycle by cycle, between upward crossings of the record's line. Columns: time [s] of the first crossing, period [s], frequency [Hz], amplitude, mean.
---@class lunid.record.cycles.fields
---@field channel? string # whose
---@param fields lunid.record.cycles.fields
---@return lunid.cycles
function record:cycles(fields) end

---The noise under a channel. Fields: white (the lowest level of its spectrum, which the record works with), robust (by the median of its sixth differences, which outliers do not reach), outliers, exponent and exponent_std of the background 1/f^exponent under tones and resonances, background (its deviation), coloured. Columns: frequency [Hz], density.
---@class lunid.record.noise.fields
---@field channel? string # whose
---@param fields lunid.record.noise.fields
---@return lunid.noise_report
function record:noise(fields) end

---Rows, rate, start, duration and the statistics of each channel. `summary.channels.y` has min, max, mean, std, noise, missing (rows that are no numbers) and held (the longest run that repeats a value).
---@class lunid.record.summary.fields
---@param fields lunid.record.summary.fields
---@return lunid.summary
function record:summary(fields) end

---The equation of motion m*a + restoring = F, or one of them for each of several coordinates. With imposed motion, y and v drive it and F is its output.
---@class lunid.model.fields
---@field mass number|lunid.expression # a number, a parameter, or an expression; for several coordinates a list, or the rows of a matrix
---@field restoring number|lunid.expression # restoring force; 0 for none; for several coordinates a list
---@field forces? table # the coordinates that a force acts on, such as { 1 }; else all
---@field delay? number|lunid.expression # the forces act so much later than they are recorded; a number or a parameter, >= 0; what came before a record is predicted from its rows, a formula's force follows the formula
---@field measures? lunid.table # what displacements, velocities and accelerations show in a record where it is not their true value: { y = y + b }; fits and gaps compare with that, runs give the true motion
---@field acts? lunid.table # the force that acts where it is not what its channel shows: { F = g*F }, or { F = F*(1 - b*y^2) } of a coil that leaves its field; affine in F
---@field states? table # internal states that the restoring force does not name
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what recorded forces do between their rows, where neither the call nor the record says it; else straight lines. Models that discover returns have what was found
---@field motion? "free"|"imposed" # 'imposed': the measured motion drives the model; the mass may then be 0
---@param fields lunid.model.fields
---@return lunid.model
function lunid.model(fields) end

---Masses in a row with an element between neighbours: y1 ... yn, each element a function of its elongation and the rate of it.
---@class lunid.chain.fields
---@field masses table # one for each coordinate
---@field element function # function(elongation, rate, index) that returns the force, positive in tension; index 1 stands before the first mass and n + 1 behind the last, whatever is tied
---@field ends? "fixed"|"left"|"right"|"free"|"base" # which ends an element ties to the ground: both, the first mass, the last, none; base: the first, to a base that moves (yb, vb)
---@field forces? table # the coordinates that a force acts on; else all
---@param fields lunid.chain.fields
---@return lunid.model
function lunid.chain(fields) end

---Loads a model that model:save wrote, or that is written by hand in the same form.
---@class lunid.load.fields
---@field path string # a Lua file that returns a lunid.model, or a lunid.history_model
---@param fields lunid.load.fields
---@return lunid.model
function lunid.load(fields) end

---All products of powers of the variables up to an order, without the constant unless asked for.
---@param variables table # such as { y, v }
---@param order integer # largest sum of the powers
---@param options? any # true: the constant 1 first; or a table: constant = true, keep = "odd" or "even" (sum of the powers), degree = "tensor" (each power up to the order)
---@return lunid.features
function lunid.polynomials(variables, order, options) end

---Products of Chebyshev polynomials of the variables, each normalised to -1 to 1 over its range; without the constant.
---@param variables table # such as { y, v }
---@param order integer # largest sum of the orders
---@param kind? "T"|"U" # first or second kind
---@param range? table # { { least, largest }, ... } of each variable; else that of the data
---@return lunid.features
function lunid.chebyshev(variables, order, kind, range) end

---sin(k*w*x) and cos(k*w*x) for k from 1 to the order.
---@param variable number|lunid.expression # such as y
---@param order integer # number of harmonics
---@param wave number|lunid.expression # w: a number, or a parameter to be searched for
---@return lunid.features
function lunid.fourier(variable, order, wave) end

---tanh(s*x) for each s: springs that yield, smoothed friction.
---@param variable number|lunid.expression # such as y
---@param slopes table # numbers, or parameters to be searched for
---@return lunid.features
function lunid.tanhs(variable, slopes) end

---exp(r*x) for each r.
---@param variable number|lunid.expression # such as y
---@param rates table # numbers, or parameters to be searched for
---@return lunid.features
function lunid.exponentials(variable, rates) end

---sign(x)*abs(x)^p for each exponent p: odd powers that need not be whole.
---@param variable number|lunid.expression # such as y
---@param exponents table # such as { 0.5, 1.5 }
---@return lunid.features
function lunid.powers(variable, exponents) end

---What bends, or jumps, at each knot: max(x - knot, 0)^degree, or for degree 0 a step. Clearances and stops.
---@param variable number|lunid.expression # such as y
---@param knots table # places in units of the variable
---@param degree? integer # 1: the slope changes; 0: the value jumps
---@return lunid.features
function lunid.piecewise(variable, knots, degree) end

---Gaussian bumps on an even grid over the range of the variables, as wide as their distance times the width.
---@param variables table # such as { y, v }
---@param count integer # bumps along each variable
---@param width? number # in distances between neighbours
---@param range? table # { { least, largest }, ... } of each variable; else that of the data
---@return lunid.features
function lunid.radial(variables, count, width, range) end

---A signal as it was so many samples ago: the features y_lag1, y_lag2 ... of a sampled regression. A regression that keeps one has no continuous model.
---@param variable number|lunid.expression # a signal: y, v, a or the force F
---@param samples table # such as { 1, 2, 3 }
---@return lunid.features
function lunid.lags(variable, samples) end

---Your own expressions as a set, which remembers its line and can be multiplied.
---@param list table # expressions
---@return lunid.features
function lunid.features(list) end

---The coefficient of a feature, for linear relations between coefficients; sums, differences and multiples of them may stand where a feature may.
---@param feature number|lunid.expression # the feature whose coefficient is meant
---@return lunid.coefficient
function lunid.coefficient(feature) end

---The coefficient is at least a bound.
---@param feature number|lunid.expression # a feature, whose coefficient is meant, or a sum of coefficients
---@param bound number|lunid.expression # a number, another feature, or a sum of coefficients
---@return lunid.constraint
function lunid.at_least(feature, bound) end

---The coefficient is at most a bound.
---@param feature number|lunid.expression # a feature, whose coefficient is meant, or a sum of coefficients
---@param bound number|lunid.expression # a number, another feature, or a sum of coefficients
---@return lunid.constraint
function lunid.at_most(feature, bound) end

---The coefficient has a known value.
---@param feature number|lunid.expression # a feature, whose coefficient is meant, or a sum of coefficients
---@param value number # its value
---@return lunid.constraint
function lunid.fixed(feature, value) end

---The coefficient lies between two values.
---@param feature number|lunid.expression # a feature, whose coefficient is meant, or a sum of coefficients
---@param lower number # least value
---@param upper number # largest value
---@return lunid.constraint
function lunid.between(feature, lower, upper) end

---At most one of these features, or `at_most` of them, has a coefficient; every choice is tried and the one of least BIC is taken.
---@param features table # features of the regression
---@param at_most? integer # how many of them
---@return lunid.constraint
function lunid.one_of(features, at_most) end

---The force creates no energy: v*(f(y, v) - f(y, 0)) >= 0 at the points of a grid over the range of the data.
---@class lunid.passive.fields
---@field points? table # along displacement and velocity
---@field impose? boolean # false: it is looked at and reported only
---@param fields lunid.passive.fields
---@return lunid.constraint
function lunid.passive(fields) end

---Integrates the equation against bumps of short support, so that no derivative of the data is needed.
---@class lunid.weak_form.fields
---@field half_width? number # of the bumps; 0: from the dominant frequency
---@field order? integer # of the bumps (1 - (t/half_width)^2)^order
---@field spacing? number # from bump to bump, in half widths
---@param fields lunid.weak_form.fields
---@return lunid.form
function lunid.weak_form(fields) end

---How parameters inside features are searched for between their bounds. Whatever the method, it ends with a local descent along the exact gradient.
---@class lunid.search.fields
---@field method? "slsqp"|"lbfgs"|"mlsl"|"direct"|"esch"|"crs"|"isres"|"stogo"|"annealing"|"particle_swarm"|"puddle_jumping"|"monte_carlo"|"stochastic_gradient" # local from several starts: slsqp, lbfgs; of NLopt: mlsl, direct, esch, crs, isres, stogo; Lunid's own: annealing, particle_swarm, puddle_jumping, monte_carlo, stochastic_gradient
---@field starts? integer # of the local methods, the first guess among them
---@field evaluations? integer # passes over the data of the other methods
---@field seed? integer # of the methods that draw random numbers; else that of the run
---@param fields lunid.search.fields
---@return lunid.search
function lunid.search(fields) end

---Fits the coefficients of features to the restoring force F - m*a along the measured motion.
---@class lunid.regress.fields
---@field record any # one record or several
---@field mass? number|lunid.expression # without it the target is F itself
---@field features table # functions of displacement, velocity, time; sets of them are laid flat
---@field known? number|lunid.expression # part of the restoring force that is known
---@field constraints? table # what is known about the coefficients
---@field window? lunid.window # part of the records
---@field solver? lunid.solver # least squares by default
---@field objective? lunid.table # { mean_force = 0.25 }: so much of what is minimised is the square of the mean residual in each block of time, which keeps the force from shifting; the rest is the mean square
---@field search? lunid.search # for parameters inside features; local from 4 starts by default
---@field form? lunid.form # integrals in place of the rows themselves
---@field blocks? integer # blocks of time in each record, for cross-validation and standard errors; 8, or 32 for the bootstrap
---@field bootstrap? integer # intervals from so many resamplings of the blocks
---@param fields lunid.regress.fields
---@return lunid.regression
function lunid.regress(fields) end

---A channel of a record, or a column of a table, by its name: what lunid.displacement is for y.
---@param name string # as the record has it
---@return lunid.expression
function lunid.channel(name) end

---Nonlinear least squares: fits the parameters of a formula to measured columns, by Levenberg-Marquardt with exact derivatives. What moves is fitted on its trajectory instead: lunid.fit_trajectory.
---@class lunid.fit_curve.fields
---@field record? any # one record or several; or else data
---@field data? lunid.table # columns by name, such as { x = { 1, 2, 3 }, y = { 1, 4, 9 } }, of equal length
---@field response number|lunid.expression # what was measured, such as lunid.force
---@field formula number|lunid.expression # what it shall be: channels, lunid.time and parameters with first guesses, or with min and max
---@field weight? number|lunid.expression # of a row's squared residual, an expression of channels; else 1
---@field window? lunid.window # part of the records
---@field max_iterations? integer # of Levenberg-Marquardt
---@param fields lunid.fit_curve.fields
---@return lunid.curve_fit
function lunid.fit_curve(fields) end

---The next output as a linear sum of past outputs and inputs, by least squares. Noise that is measured with the output biases it: see armax, and model:free_run.
---@class lunid.arx.fields
---@field record any # one record or several
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field outputs? integer # past samples of the output: y_1, y_2
---@field inputs? integer # samples of the input, beginning with delay
---@field delay? integer # first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)
---@field constant? boolean # a constant among the terms
---@field window? lunid.window # part of the records
---@param fields lunid.arx.fields
---@return lunid.history_model
function lunid.arx(fields) end

---An ARX model with past prediction errors, which describe coloured noise, by extended least squares.
---@class lunid.armax.fields
---@field record any # one record or several
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field outputs? integer # past samples of the output: y_1, y_2
---@field inputs? integer # samples of the input, beginning with delay
---@field delay? integer # first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)
---@field noise? integer # past prediction errors: e_1, e_2
---@field constant? boolean # a constant among the terms
---@field max_passes? integer # of extended least squares
---@field window? lunid.window # part of the records
---@param fields lunid.armax.fields
---@return lunid.history_model
function lunid.armax(fields) end

---The next output as a polynomial, or as given terms, of past outputs and inputs.
---@class lunid.narx.fields
---@field record any # one record or several
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field outputs? integer # past samples of the output: y_1, y_2
---@field inputs? integer # samples of the input, beginning with delay
---@field delay? integer # first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)
---@field degree? integer # of the polynomial in all lagged samples
---@field features? table # terms in place of the polynomial: expressions of lunid.channel "y_1", "F_1", "e_1" ...
---@field constant? boolean # a constant among the terms
---@field window? lunid.window # part of the records
---@param fields lunid.narx.fields
---@return lunid.history_model
function lunid.narx(fields) end

---A NARX model with past prediction errors, by extended least squares.
---@class lunid.narmax.fields
---@field record any # one record or several
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field outputs? integer # past samples of the output: y_1, y_2
---@field inputs? integer # samples of the input, beginning with delay
---@field delay? integer # first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)
---@field noise? integer # past prediction errors: e_1, e_2
---@field degree? integer # of the polynomial in all lagged samples
---@field features? table # terms in place of the polynomial: expressions of lunid.channel "y_1", "F_1", "e_1" ...
---@field constant? boolean # a constant among the terms
---@field max_passes? integer # of extended least squares
---@field window? lunid.window # part of the records
---@param fields lunid.narmax.fields
---@return lunid.history_model
function lunid.narmax(fields) end

---Compares ARX models of all orders on the same rows, the one with the least BIC first.
---@class lunid.history_orders.fields
---@field record any # one record or several
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field outputs? integer # past outputs, at most
---@field inputs? integer # inputs, at most
---@field delay? integer # first lag of the input: 1 for a force held between samples (F_1, F_2), 0 for a straight one (F_0, F_1 ...)
---@field window? lunid.window # part of the records
---@param fields lunid.history_orders.fields
---@return lunid.orders
function lunid.history_orders(fields) end

---A history model by its terms, as model:save writes it.
---@class lunid.history_model.fields
---@field output? string # channel that is predicted
---@field input? string # channel that drives it
---@field dt number # time between samples
---@field between? "hold"|"linear"|"cubic"|"band_limited" # what the input does between samples
---@field residual_std? number # of one-step predictions
---@field terms table # entries { "y_1", 1.97, std = 1e-3 }
---@param fields lunid.history_model.fields
---@return lunid.history_model
function lunid.history_model(fields) end

---Chooses a model out of a library of features: candidates from regressions on the motion smoothed to several widths, judged by free runs, refined on the trajectory. What runs away is rejected, with the reason.
---@class lunid.select.fields
---@field record any # one record or several, to learn from
---@field holdout? any # records on which free runs judge; else the last part of the records
---@field holdout_part? number # of each record that is kept from the fits to judge, where no holdout is given
---@field test? any # opened once, after the choice
---@field mass number|lunid.expression # of the moving body
---@field features table # the library; parameters inside them need min and max
---@field known? number|lunid.expression # part of the restoring force that is known
---@field most_terms? integer # of a candidate that is run
---@field cut_off? number # least rms of a term over that of the restoring force; below it a candidate is rejected
---@field channels? table # fitted on the trajectory; else y, and v where it was measured
---@field widths? table # half widths of the smoothing filters in samples; else parts of the motion's period
---@field search? lunid.search # for parameters inside features
---@field iterations? integer # of each trajectory fit
---@param fields lunid.select.fields
---@return lunid.selection
function lunid.select(fields) end

---A bilinear or bicubic spline over equal cells, by least squares; cells without data stay empty.
---@class lunid.grid.fields
---@field cells? table # number of cells along displacement and velocity
---@field least_count? integer # cells with fewer points have no data
---@field smoothness? number # weight of the squared second differences
---@field between? "linear"|"cubic" # the corners of the cells: straight lines, or a spline without a jump in its first and second derivatives
---@param fields lunid.grid.fields
---@return lunid.interpolator
function lunid.grid(fields) end

---The mean of the nearest points, weighted by one over their distance.
---@class lunid.nearest.fields
---@field neighbours? integer # how many points
---@param fields lunid.nearest.fields
---@return lunid.interpolator
function lunid.nearest(fields) end

---Planes over Delaunay triangles between cell means; no value outside their hull.
---@class lunid.triangulation.fields
---@field cells? integer # along each axis: one corner each
---@param fields lunid.triangulation.fields
---@return lunid.interpolator
function lunid.triangulation(fields) end

---A neural network: layers of tanh units, fitted to cell means by L-BFGS.
---@class lunid.mlp.fields
---@field hidden? table # units in each hidden layer, 1 to 4 layers
---@field penalty? number # weight of the mean square of the weights
---@field evaluations? integer # at most so many of the loss
---@field seed? integer # the same seed gives the same surface
---@param fields lunid.mlp.fields
---@return lunid.interpolator
function lunid.mlp(fields) end

---A Gaussian process about a plane; lengths and noise by maximum likelihood. Knows its own deviation.
---@class lunid.gaussian_process.fields
---@field centres? integer # at most so many cell means; time grows with their cube
---@param fields lunid.gaussian_process.fields
---@return lunid.interpolator
function lunid.gaussian_process(fields) end

---Support vector regression with a Gaussian kernel on cell means.
---@class lunid.support_vectors.fields
---@field cost? number # of a point outside the tube, for a force of unit variance
---@field epsilon? number # half width of the tube, for a force of unit variance
---@field width? number # of the kernel, in half ranges of the data; else by cross-validation
---@field centres? integer # at most so many cell means; time grows with their cube
---@param fields lunid.support_vectors.fields
---@return lunid.interpolator
function lunid.support_vectors(fields) end

---The mean of regression trees on resampled points.
---@class lunid.random_forest.fields
---@field trees? integer # how many
---@field least_leaf? integer # points in a leaf
---@field seed? integer # the same seed gives the same surface
---@param fields lunid.random_forest.fields
---@return lunid.interpolator
function lunid.random_forest(fields) end

---The restoring force surface of a record: by one kind of interpolation or several side by side, and as a Chebyshev polynomial.
---@class lunid.rfs.fields
---@field record any # one record or several
---@field mass? number|lunid.expression # without it the surface is that of F itself
---@field window? lunid.window # part of the records
---@field interpolate? any # how it is drawn: one kind, several (the best on left-out blocks is drawn) or "all"; else by the polynomial
---@field order? table # of the polynomial in displacement and in velocity
---@field expand? "regression"|"quadrature" # the polynomial's coefficients: from the points, or from the surface by Gauss-Chebyshev quadrature
---@field blocks? integer # blocks of time left out in turn, for the score and the deviation
---@field name? string # how it is written in equations
---@field between? "linear"|"cubic" # what surface(y, v) is between the corners of the drawn surface's cells: straight, or a spline without a jump in its first and second derivatives; else cubic where the drawn kind is smooth (mlp, gaussian_process, support_vectors, a cubic grid)
---@param fields lunid.rfs.fields
---@return lunid.surface
function lunid.rfs(fields) end

---A cut through a surface along one axis: columns place, f and std of the cut, points_place and points_f of the measured points near it.
---@class lunid.section.fields
---@field surface lunid.surface # what to cut
---@field v? number # cuts along y at this velocity
---@field y? number # cuts along v at this displacement
---@field count? integer # places along the cut
---@field half_width? number # of the band from which points come; else a twentieth of the range
---@param fields lunid.section.fields
---@return lunid.section
function lunid.section(fields) end

---A cosine: amplitude*cos(2*pi*frequency*t + phase).
---@class lunid.excitation.harmonic.fields
---@field amplitude number # largest force
---@field frequency number # cycles per second
---@field phase? number # at t = 0; -pi/2 makes a sine
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.harmonic.fields
---@return lunid.record
function lunid.excitation.harmonic(fields) end

---A sum of cosines of equal amplitude at the multiples of 1/period in a band. Give rms or amplitude.
---@class lunid.excitation.multisine.fields
---@field from number # lowest frequency
---@field to number # highest frequency
---@field rms? number # of the whole force over a period
---@field amplitude? number # of each cosine
---@field period? number # time after which it repeats; else the duration
---@field phases? "random"|"schroeder" # 'schroeder': a low peak for its rms
---@field odd? boolean # odd multiples alone: even lines of a response then come from the structure
---@field seed? integer # of its random numbers; else that of the run (--seed)
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.multisine.fields
---@return lunid.record
function lunid.excitation.multisine(fields) end

---A cosine whose frequency runs from one value to another over the duration, up or down.
---@class lunid.excitation.swept_sine.fields
---@field amplitude number # largest force
---@field from number # frequency at the start
---@field to number # frequency at the end
---@field law? "linear"|"logarithmic" # even in Hz per second, or in octaves per second
---@field phase? number # at the start
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.swept_sine.fields
---@return lunid.record
function lunid.excitation.swept_sine(fields) end

---A cosine that dwells at each of several frequencies in turn, without a jump of its phase.
---@class lunid.excitation.stepped_sine.fields
---@field amplitude number # largest force
---@field frequencies table # in the order in which they come, each for the same time
---@field phase? number # at the start
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.stepped_sine.fields
---@return lunid.record
function lunid.excitation.stepped_sine(fields) end

---Any force that is an expression of lunid.time.
---@class lunid.excitation.formula.fields
---@field force number|lunid.expression # an expression of lunid.time alone
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.formula.fields
---@return lunid.record
function lunid.excitation.formula(fields) end

---A force that is switched on and stays.
---@class lunid.excitation.step.fields
---@field height number # the force from then on
---@field at? number # time of the jump, at the nearest sample; else the start
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.step.fields
---@return lunid.record
function lunid.excitation.step(fields) end

---A force for a short time: rectangular, or half a sine.
---@class lunid.excitation.pulse.fields
---@field height number # largest force
---@field width number # how long it lasts
---@field at? number # when it begins, at the nearest sample; else the start
---@field shape? "rectangular"|"half_sine" # its course
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.pulse.fields
---@return lunid.record
function lunid.excitation.pulse(fields) end

---A blow: a given impulse within one sample, so that a mass at rest leaves with impulse/mass.
---@class lunid.excitation.impulse.fields
---@field impulse number # force times time
---@field at? number # when, at the nearest sample; else the start
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.impulse.fields
---@return lunid.record
function lunid.excitation.impulse(fields) end

---Independent random forces at the samples. Gaussian ones have the rms in the mean; uniform ones a half-width.
---@class lunid.excitation.white_noise.fields
---@field rms number # standard deviation that the numbers are drawn from
---@field distribution? "gaussian"|"uniform" # 'uniform': within -sqrt(3)*rms to sqrt(3)*rms
---@field seed? integer # of its random numbers; else that of the run (--seed)
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.white_noise.fields
---@return lunid.record
function lunid.excitation.white_noise(fields) end

---Gaussian noise of even power density within a band and none outside, scaled to its rms.
---@class lunid.excitation.band_limited_noise.fields
---@field from number # lowest frequency
---@field to number # highest frequency
---@field rms number # root mean square of the force
---@field seed? integer # of its random numbers; else that of the run (--seed)
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.band_limited_noise.fields
---@return lunid.record
function lunid.excitation.band_limited_noise(fields) end

---Gaussian noise whose power density falls as 1/f^exponent, scaled to its rms.
---@class lunid.excitation.coloured_noise.fields
---@field exponent number # 0 white, 1 pink, 2 brown, -1 blue
---@field rms number # root mean square of the force
---@field seed? integer # of its random numbers; else that of the run (--seed)
---@field dt number # sample time
---@field duration number # from the first sample to the last
---@field start? number # time of the first sample
---@field taper? number # part of the duration over which the force rises and falls as a cosine (Tukey window); 1: Hann window
---@param fields lunid.excitation.coloured_noise.fields
---@return lunid.record
function lunid.excitation.coloured_noise(fields) end

---Several excitations at once, on one time base: { parts = { a, b } }, or { a, b } for short.
---@class lunid.excitation.sum.fields
---@field parts table # of equal dt, start and number of rows
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # of the parts without a formula; else what they agree on, or straight lines
---@param fields lunid.excitation.sum.fields
---@return lunid.record
function lunid.excitation.sum(fields) end

---Independent Gaussian noise on every row.
---@class lunid.noise.gaussian.fields
---@field std? number # standard deviation, in the channel's unit
---@field relative? number # the same as a part of the channel's standard deviation
---@param fields lunid.noise.gaussian.fields
---@return lunid.noise
function lunid.noise.gaussian(fields) end

---Independent noise on every row, even within -half_width to half_width.
---@class lunid.noise.uniform.fields
---@field half_width? number # largest error, in the channel's unit
---@field relative? number # the same as a part of the channel's standard deviation
---@param fields lunid.noise.uniform.fields
---@return lunid.noise
function lunid.noise.uniform(fields) end

---Noise that depends on itself: power density 1/f^exponent, or an autoregression of its rows. Give one of them.
---@class lunid.noise.coloured.fields
---@field exponent? number # 0 white, 1 pink, 2 brown, -1 blue
---@field ar? table # x[i] = ar[1]*x[i-1] + ar[2]*x[i-2] + ... + white noise
---@field std? number # standard deviation, in the channel's unit
---@field relative? number # the same as a part of the channel's standard deviation
---@param fields lunid.noise.coloured.fields
---@return lunid.noise
function lunid.noise.coloured(fields) end

---A gain that is not constant: every row times 1 + std*N(0, 1).
---@class lunid.noise.multiplicative.fields
---@field std number # standard deviation of the gain
---@param fields lunid.noise.multiplicative.fields
---@return lunid.noise
function lunid.noise.multiplicative(fields) end

---Counting noise: values come in counts, whose number is random about its mean. The variance is count*abs(x).
---@class lunid.noise.poisson.fields
---@field count? number # value of one count, in the channel's unit
---@field relative? number # the same as a part of the channel's standard deviation
---@param fields lunid.noise.poisson.fields
---@return lunid.noise
function lunid.noise.poisson(fields) end

---Single rows that are far off, upwards or downwards.
---@class lunid.noise.outliers.fields
---@field fraction number # probability of a row to be hit
---@field size? number # how far off, in the channel's unit
---@field relative? number # the same as a part of the channel's standard deviation
---@param fields lunid.noise.outliers.fields
---@return lunid.noise
function lunid.noise.outliers(fields) end

---Samples that are lost. The time base stays even: a lost row is filled, and the record's warnings count them.
---@class lunid.noise.dropped.fields
---@field fraction number # probability of a row to be hit
---@field fill? "hold"|"linear"|"gap" # the value before it, as a converter repeats it; a straight line; 'gap': not a number, to test with
---@param fields lunid.noise.dropped.fields
---@return lunid.noise
function lunid.noise.dropped(fields) end

---Values in steps, as a converter gives them. Give step, or bits over -range to range.
---@class lunid.noise.quantised.fields
---@field step? number # distance of two values, in the channel's unit
---@field bits? integer # of the converter
---@field range? number # with bits: largest value; else the channel's largest magnitude
---@param fields lunid.noise.quantised.fields
---@return lunid.noise
function lunid.noise.quantised(fields) end

---A sensor at its limit: values held within -level to level.
---@class lunid.noise.clipped.fields
---@field level? number # largest value that it shows, in the channel's unit
---@field relative? number # the same as a part of the channel's largest magnitude
---@param fields lunid.noise.clipped.fields
---@return lunid.noise
function lunid.noise.clipped(fields) end

---Mass, spring and dashpot: m*a + k*y + c*v = F.
---@class lunid.systems.linear.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field c? number # viscous damping
---@param fields lunid.systems.linear.fields
---@return lunid.model
function lunid.systems.linear(fields) end

---A spring that hardens: m*a + k*y + k3*y^3 + c*v = F. The defaults are case 1.
---@class lunid.systems.duffing.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field k3? number # cubic stiffness
---@field c? number # viscous damping
---@param fields lunid.systems.duffing.fields
---@return lunid.model
function lunid.systems.duffing(fields) end

---The destabilising Duffing oscillator: m*a + k*y - k3*y^3 + c*v = F. It runs away beyond y = sqrt(k/k3).
---@class lunid.systems.softening_duffing.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field k3? number # cubic softening; chosen to show at 20 Hz: the figure is lost
---@field c? number # viscous damping
---@param fields lunid.systems.softening_duffing.fields
---@return lunid.model
function lunid.systems.softening_duffing(fields) end

---Case 2: m*a + k*y + k3*y^3 + k5*y^5 + e*y^3*v^n + c*v = F. Most of the terms lie near the noise.
---@class lunid.systems.modified_duffing.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness
---@field k3? number # cubic stiffness
---@field k5? number # stiffness of fifth order
---@field e? number # of y^3*v^n
---@field c? number # viscous damping
---@field velocity_power? integer # n: 2 as in the results of section 2.4; 3 as printed in table 2.1, which runs away at 20 Hz unless e is small
---@param fields lunid.systems.modified_duffing.fields
---@return lunid.model
function lunid.systems.modified_duffing(fields) end

---Case 3: a spring that yields smoothly, m*a + c*v + e1*tanh(e2*y) = F.
---@class lunid.systems.tanh_yield.fields
---@field mass? number # parameter m of the model, fixed
---@field e1? number # force at full yield; chosen so that the motion reaches it and e2 can be seen
---@field e2? number # 1/e2 is where it yields; chosen near the 84.9 that the thesis found
---@field c? number # viscous damping
---@param fields lunid.systems.tanh_yield.fields
---@return lunid.model
function lunid.systems.tanh_yield(fields) end

---A spring that yields at once and on one side. Its force is k*y up to y = edge and e1 beyond, with a jump.
---@class lunid.systems.harsh_yield.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field e1? number # force beyond the edge; chosen: the figure is lost
---@field edge? number # where it yields
---@field c? number # viscous damping
---@param fields lunid.systems.harsh_yield.fields
---@return lunid.model
function lunid.systems.harsh_yield(fields) end

---Damping that changes its sign at |y| = 1: m*a + k*y + c*(y^2 - 1)*v = F, which swings by itself.
---@class lunid.systems.van_der_pol.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field c? number # viscous damping
---@field sign? "usual"|"printed" # 'printed': c*(1 - y^2)*v as in table 2.1, damped within -1 < y < 1 and unstable beyond
---@param fields lunid.systems.van_der_pol.fields
---@return lunid.model
function lunid.systems.van_der_pol(fields) end

---Masses in a row on springs and dashpots, the first one tied to the ground, one of the springs hardening (appendix J and case 4). Coordinates are y1 y2 ..., forces F1 F2 ...
---@class lunid.systems.chain.fields
---@field masses? table # one for each coordinate
---@field k? number # stiffness k1, k2 ... of each spring; one number for all
---@field c? number # damping c1, c2 ... of each dashpot; one number for all
---@field cubic? number # cubic stiffness of one spring
---@field cubic_at? integer # which spring: 1 to the ground, 2 between the first two masses; chosen: the figure is lost
---@param fields lunid.systems.chain.fields
---@return lunid.model
function lunid.systems.chain(fields) end

---A mass that depends on the velocity (section 2.7): (m + A*v)*a + k*y + c*v = F.
---@class lunid.systems.velocity_mass.fields
---@field mass? number # parameter m of the model, fixed
---@field k? number # linear stiffness (case 1)
---@field c? number # viscous damping
---@field A? number # mass per velocity; chosen: the text gives none. m + A*v must stay > 0
---@param fields lunid.systems.velocity_mass.fields
---@return lunid.model
function lunid.systems.velocity_mass(fields) end

---A rigid pile that is driven into soil; y is its penetration. Shaft friction slips beyond a quake; the toe yields, lifts off and comes back (Smith 1960, J. Soil Mech. Found. Div. ASCE 86, 35).
---@class lunid.systems.pile.fields
---@field mass? number # parameter m of the model, fixed
---@field shaft? number # shaft friction at slip; chosen, as all of the soil: the measurements are not public
---@field shaft_quake? number # movement at which the shaft slips
---@field shaft_damping? number # Smith's J: the friction times 1 + J*abs(v)
---@field toe? number # resistance of the toe at yield
---@field toe_quake? number # movement at which the toe yields
---@field toe_damping? number # Smith's J of the toe
---@field push? number # weight that the crane leaves to the pile, 49 kg times gravity
---@param fields lunid.systems.pile.fields
---@return lunid.model
function lunid.systems.pile(fields) end

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

---Evenly spaced values from the first to the last, for lunid.ensemble { vary = { ... } }.
---@param from number # first value
---@param to number # last value
---@param count integer # number of values
---@param spacing? "linear"|"log" # of the values or of their logarithms
---@return lunid.list
function lunid.range(from, to, count, spacing) end

---A random quantity between two values, for lunid.ensemble { draw = { ... } }.
---@param from number # least value
---@param to number # greatest value
---@return lunid.distribution
function lunid.uniform(from, to) end

---A random quantity whose logarithm is uniform between two positive values.
---@param from number # least value
---@param to number # greatest value
---@return lunid.distribution
function lunid.log_uniform(from, to) end

---A random quantity with a normal distribution, for lunid.ensemble { draw = { ... } }.
---@param mean number # mean
---@param std number # standard deviation
---@return lunid.distribution
function lunid.normal(mean, std) end

---Runs many members of one model that differ in parameters, first state or excitation, side by side on all cores (and on all ranks under mpirun). A member that explodes is a result.
---@class lunid.ensemble.fields
---@field model lunid.model # what moves; its values hold where not varied
---@field vary? lunid.table # name = list of values or lunid.range: the full grid of all of them
---@field draw? lunid.table # name = lunid.uniform, lunid.normal or lunid.log_uniform: random members
---@field samples? integer # members to draw
---@field method? "latin_hypercube"|"sobol"|"random" # how the members are spread
---@field seed? integer # of the draw; else that of the run (--seed)
---@field excitation any # a record, an expression of lunid.time and of parameters that may be varied, or function(case) giving a record for each member
---@field from? table # first state { y, v, ... } of all members; else rest
---@field duration? number|lunid.expression # length of a run, where the force is an expression; may hold what is varied
---@field dt? number|lunid.expression # sample time, where the force is an expression; may hold what is varied
---@field interpolation? "hold"|"linear"|"cubic"|"band_limited" # what a record's force does between samples; else what the record says, or the model
---@field substeps? integer # per sample; else chosen by halving on a few members
---@field outputs? table # max, min, mean, std, rms, amplitude or last of a signal: "rms_y"; else rms and max of the displacements
---@field settled? number # part of each run before the outputs begin
---@field keep? "summaries"|"trajectories" # 'trajectories' keeps the outputs' signals whole
---@param fields lunid.ensemble.fields
---@return lunid.sweep
function lunid.ensemble(fields) end

---Reads the columns of a CSV, HDF5 or MAT file of numbers, such as sweep:save wrote; an empty cell is no number (NaN).
---@class lunid.table.fields
---@field path string # file, beside the study or from the current directory
---@param fields lunid.table.fields
---@return lunid.table
function lunid.table(fields) end

---A system's test by the thesis' data protocol, one record for each frequency. F = amplitude*cos(2*pi*frequency*t) with noise that the system feels, noisy y and v, the acceleration derived from v, the beginning cut off.
---@class lunid.thesis_record.fields
---@field system any # the truth
---@field frequency number # 20 and 30 in the thesis; a list gives a list of records
---@field amplitude? number # of the force
---@field force_noise? number # the force gets amplitude times this times U(-1, 1), straight into the system and the record
---@field noise? number # Gaussian noise of y and of v, over their own std
---@field trim? number # cut off at the beginning
---@field dt? number # sample time
---@field duration? number # from t = 0, before the trimming
---@field from? table # first state { y, v } or { y1, v1, y2, v2 ... }
---@field seed? integer # of the noise, one more for each frequency; else that of the run (--seed)
---@param fields lunid.thesis_record.fields
---@return lunid.record
function lunid.thesis_record(fields) end

---The thesis' validation record, without noise. No force up to 2.2 s, then amplitude*(sin(w*t) + sin(2*w*t) + sin(3*w*t)).
---@class lunid.thesis_validation.fields
---@field system any # the truth
---@field from any # first state { y, v ... }, or the trimmed record whose first row it is
---@field amplitude? number # of each of the three sines
---@field frequency? number # w is 2*pi times this
---@field quiet? number # how long there is no force
---@field dt? number # sample time
---@field duration? number # from t = 0, before the trimming
---@param fields lunid.thesis_validation.fields
---@return lunid.record
function lunid.thesis_validation(fields) end

---Where a model and its records disagree, what effect is missing, and how far the gap shrinks with it.
---@class lunid.discover.fields
---@field model lunid.model # the baseline
---@field train any # record or list of records, used for every choice
---@field test? any # opened once, when the training records have chosen; else the last part of each record is held out
---@field window? lunid.window # part of the training records
---@field test_window? lunid.window # part of the test records; of the training files where no test is given
---@field catalogue? table # names of entries to try, any of `lunid list effects`; else those marked * there, and all where these leave it open
---@field without? table # names of entries that are not tried: what you know cannot be there
---@field effects? table # entries of your own, beside the catalogue
---@field alpha? number # level of false alarms of the whole search
---@field minimum_gain? number # least relative drop of the left-out gap for which an effect is named, unless the test bears it out whole; five times that where 1.5 times the noise and more stays open
---@field max_effects? integer # named one after another
---@field blocks? integer # left-out blocks of the training records
---@field holdout? number # part held out when no test is given
---@field criterion? function # function(set) of your own: false keeps it from being named; a set has name, gap (of its fit) and model, as those of `lunid.rank`
---@field out? string # folder for report, model, discovery.json and figures, below the run's out directory (--out); else that directory itself, for a second discovery of the run discovery_2, and so on
---@param fields lunid.discover.fields
---@return lunid.discovery
function lunid.discover(fields) end

---Where a model fails: the force that it leaves unexplained along the smoothed measured motion, over time, displacement, velocity, the phase plane, amplitude, harmonic order, frequency and slow time, each with the level that noise of any colour stays below (95 %, over all bins at once).
---@class lunid.locate.fields
---@field model lunid.model # the baseline, fitted first
---@field record any # one record or several; all rows are used
---@field window? lunid.window # part of the records
---@field place? string # with several coordinates where to look, "y2" or "y1 - y2"; else where most is left
---@param fields lunid.locate.fields
---@return lunid.location
function lunid.locate(fields) end

---Which entries of the catalogue would help: each one's effect on the trajectory, projected orthogonal to what the model's own parameters and first states can do, and on the force along the motion. Best first, by the larger of both gains. To first order: lunid.rank fits them.
---@class lunid.propose.fields
---@field model lunid.model # the baseline, fitted first
---@field record any # one record or several; all rows are used
---@field window? lunid.window # part of the records
---@field catalogue? table # names of entries, any of `lunid list effects`; else those marked * there
---@field without? table # names of entries that are not tried
---@field effects? table # entries of your own, beside the catalogue
---@param fields lunid.propose.fields
---@return lunid.proposals
function lunid.propose(fields) end

---How given sets of effects compare: each is fitted with the baseline on the trajectory and judged by free runs over left-out blocks and by a likelihood with the noise's colour. The baseline takes part. Best left-out gap first.
---@class lunid.rank.fields
---@field model lunid.model # the baseline, fitted first
---@field record any # one record or several; all rows are used
---@field sets table # names, and lists of names for several effects at once; with several coordinates "cubic_stiffness at y2", or that name alone for each place
---@field window? lunid.window # part of the records
---@field effects? table # entries of your own, beside the catalogue
---@field blocks? integer # left-out blocks of the records
---@field criterion? function # function(row) of your own: false rejects a set, a number orders them, least first
---@param fields lunid.rank.fields
---@return lunid.ranking
function lunid.rank(fields) end

---The experiment that would tell rival models apart: of a small family of excitations (multisine, swept sine up and down, steps of amplitude, a low and a high level, offsets, steps, pull and release), each simulated with every rival, the one whose answers stay farthest apart, in standard deviations of the noise, when each rival may refit its parameters to the other's answer. Give models that have values, or a discovery.
---@class lunid.design_experiment.fields
---@field models? table # the rivals, each with values for all parameters
---@field names? table # of the models; else model 1, model 2 ...
---@field from? lunid.discovery # takes the model that it found and what its records cannot tell from it, else the best rival; limits, rate and noise of its records where they are not given
---@field limits? lunid.table # what the machine can do: { force = largest [N], displacement = largest [m], frequency = { lowest, highest } [Hz] }
---@field duration? number # else 16 periods of the lowest frequency
---@field rate? number # else 20 rows in a period of the highest frequency
---@field measured? "y"|"v"|"a" # of each coordinate: displacement, velocity or acceleration; else what the discovery's records had, or y
---@field noise? number # standard deviation of the noise of what is measured, in SI; of the force's where the motion is imposed
---@param fields lunid.design_experiment.fields
---@return lunid.experiment_design
function lunid.design_experiment(fields) end

---A curve or a cloud of points.
---@class lunid.figure.series.fields
---@field x any # a column, such as record:column "t", or a list
---@field y any # of the same length
---@field label? string # in the legend
---@field role? "measured"|"baseline"|"final"|"residual"|"effect"|"noise"|"first"|"second"|"third"|"fourth"|"fifth"|"sixth" # what it means; decides its colour
---@field style? "line"|"dashed"|"dotted"|"dash_dot"|"points"|"line_points"|"stems"|"columns" # how it is drawn
---@field colour? any # a value for each point, shown by colour and a bar beside the chart
---@param fields lunid.figure.series.fields
---@return lunid.series
function lunid.figure.series(fields) end

---A chart of curves over common axes.
---@class lunid.figure.lines.fields
---@field series table # its curves
---@field x? string # axis with its unit: "time [s]"
---@field y? string # axis with its unit: "displacement [m]"
---@field x_scale? "linear"|"log" # 'log' shows positive values only
---@field y_scale? "linear"|"log" # the same
---@field colour? string # what the colours of its curves stand for, with its unit
---@field note? string # one short line above the chart, on the right
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.lines.fields
---@return lunid.figure
function lunid.figure.lines(fields) end

---The panels of several figures in one, row by row.
---@class lunid.figure.grid.fields
---@field figures table # whose panels it takes
---@field columns? integer # of panels
---@field share_x? boolean # panels of one column that show the same quantity have one range, and labels under the lowest
---@field share_y? boolean # the same of panels side by side
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.grid.fields
---@return lunid.figure
function lunid.figure.grid(fields) end

---Quantiles of a residual, or of any column, over those of a normal distribution or of another column.
---@class lunid.figure.qq.fields
---@field of any # a column, a comparison or the points of lunid.statistics.qq
---@field expected? any # a sample to compare with; else a normal distribution
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.qq.fields
---@return lunid.figure
function lunid.figure.qq(fields) end

---How often values occur, as a density, with the normal distribution of the same mean and deviation.
---@class lunid.figure.histogram.fields
---@field of any # a column, or a comparison, whose residual is shown
---@field bins? integer # else by the rule of Freedman and Diaconis
---@field normal? boolean # draw the normal distribution
---@field axis? string # what the values are, with their unit
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.histogram.fields
---@return lunid.figure
function lunid.figure.histogram(fields) end

---Autocorrelations of a column, or its correlations with an input, over the lag, beside their 95 % bounds.
---@class lunid.figure.correlogram.fields
---@field of any # a column, a comparison or a test of lags
---@field input? any # what the column may follow; else it is compared with itself
---@field lags? integer # largest lag, rows
---@field dt? number # between rows: shows the lag in seconds
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.correlogram.fields
---@return lunid.figure
function lunid.figure.correlogram(fields) end

---Root of the mean squared error, in the unit of the columns.
---@param measured any # what was measured
---@param model any # what the model says, row by row
---@return number
function lunid.statistics.rmse(measured, model) end

---RMSE over the standard deviation of the measurement.
---@param measured any # what was measured
---@param model any # what the model says, row by row
---@return number
function lunid.statistics.nrmse(measured, model) end

---Share of the measured variance that the model explains, 1 - nrmse^2; below 0 it is worse than the mean.
---@param measured any # what was measured
---@param model any # what the model says, row by row
---@return number
function lunid.statistics.r2(measured, model) end

---100 (1 - nrmse) %: 100 for a perfect model, 0 for the measured mean.
---@param measured any # what was measured
---@param model any # what the model says, row by row
---@return number
function lunid.statistics.fit(measured, model) end

---Pearson's correlation. A second value is the probability of one as far from 0 by chance, by a block bootstrap that holds for coloured rows.
---@param a any # one column
---@param b any # another of the same length
---@return number
function lunid.statistics.correlation(a, b) end

---Spearman's rank correlation. A second value is the probability of one as far from 0 by chance if the rows were independent.
---@param a any # one column
---@param b any # another of the same length
---@return number
function lunid.statistics.spearman(a, b) end

---Kendall's rank correlation tau-b. A second value is the probability of one as far from 0 by chance if the rows were independent.
---@param a any # one column
---@param b any # another of the same length
---@return number
function lunid.statistics.kendall(a, b) end

---What one column tells about another in any form, in nat, by nearest neighbours. 0 where they are independent, give or take 1/sqrt(rows).
---@param x any # such as a feature
---@param target any # such as the force
---@param neighbours? integer # nearest neighbours: fewer for less bias, more for less scatter
---@return number
function lunid.statistics.mutual_information(x, target, neighbours) end

---What one column tells about another beyond what given columns tell, in nat.
---@param x any # such as a feature
---@param target any # such as the force
---@param given table # the columns that are known already
---@param neighbours? integer # nearest neighbours: fewer for less bias, more for less scatter
---@return number
function lunid.statistics.conditional_mutual_information(x, target, given, neighbours) end

---Mutual information of a term and the force, times the term's largest force.
---@param information number # of feature and target [nat]
---@param coefficient number # of the feature in the fit
---@param feature any # its values along the record
---@return number
function lunid.statistics.significance_index(information, coefficient, feature) end

---Dynamic time warping: the least sum of distances between two curves over all ways to run through both.
---@param a table # the columns of one curve, such as { y, v }, in comparable units
---@param b table # as many columns of the other; it may be longer or shorter
---@param band? integer # rows that a pairing may stray from the diagonal; else any
---@return number
function lunid.statistics.dtw(a, b, band) end

---The pairing of rows behind dtw: columns a and b of row numbers, counted from 1, and the distance; pairing:figure() draws it.
---@param a table # the columns of one curve, such as { y, v }, in comparable units
---@param b table # as many columns of the other; it may be longer or shorter
---@param band? integer # rows that a pairing may stray from the diagonal; else any
---@return lunid.pairing
function lunid.statistics.dtw_pairing(a, b, band) end

---The points of a quantile-quantile plot: against the normal distribution of the column's own mean and deviation, or against another column. Fields expected, found, qqcc; qq:figure() draws it.
---@param found any # such as a residual
---@param expected? any # a sample to compare with; else a normal distribution
---@return lunid.quantiles
function lunid.statistics.qq(found, expected) end

---The correlation of the quantile-quantile plot's points: 1 where the distributions have one shape.
---@param found any # such as a residual
---@param expected? any # a sample to compare with; else a normal distribution
---@return number
function lunid.statistics.qqcc(found, expected) end

---Largest distance of two distribution functions: of a column and any normal distribution, a known one (std =), or another column. A second value is the probability of as much by chance, for independent rows.
---@class lunid.statistics.kolmogorov_smirnov.fields
---@field x any # the column
---@field other? any # another column
---@field mean? number # of a normal distribution known beforehand; else 0
---@field std? number # of a normal distribution known beforehand; else those of the column itself
---@param fields lunid.statistics.kolmogorov_smirnov.fields
---@return number
function lunid.statistics.kolmogorov_smirnov(fields) end

---The directions along which columns vary most: fields mean, scale, variances, shares, directions, scores (lists of columns).
---@class lunid.statistics.principal_components.fields
---@field columns table # of one length
---@field standardise? boolean # bring each column to deviation 1 first
---@param fields lunid.statistics.principal_components.fields
---@return lunid.components
function lunid.statistics.principal_components(fields) end

---Is a column white? The statistic of its autocorrelations at lags 1 to `lags`, and its probability by chance.
---@class lunid.statistics.ljung_box.fields
---@field x any # such as a residual
---@field lags? integer # largest lag, rows
---@field fitted? integer # parameters of the autoregression whose innovations these are
---@param fields lunid.statistics.ljung_box.fields
---@return number
function lunid.statistics.ljung_box(fields) end

---Are the signs about the median in random order? The normal deviate of the number of runs, and its probability.
---@param x any # such as a residual
---@return number
function lunid.statistics.runs_test(x) end

---Autocorrelations of a column beside their 95 % bound: fields lags, coefficients, bound, beyond (how many), statistic, p_value.
---@class lunid.statistics.whiteness.fields
---@field x any # such as a residual
---@field lags? integer # largest lag, rows
---@field fitted? integer # parameters of the autoregression whose innovations these are
---@param fields lunid.statistics.whiteness.fields
---@return lunid.lag_test
function lunid.statistics.whiteness(fields) end

---Correlation of a residual with an input that came so many rows before, beside its 95 % bound, which takes account of the colour of both. The fields are those of whiteness.
---@class lunid.statistics.cross_correlation.fields
---@field residual any # what is left
---@field input any # what it may follow
---@field lags? integer # from -lags to lags; negative lags show a feedback
---@param fields lunid.statistics.cross_correlation.fields
---@return lunid.lag_test
function lunid.statistics.cross_correlation(fields) end

---An interval for any statistic of columns, one of these or a function of your own, that holds for coloured rows: blocks of rows are resampled, or left out in turn. Fields value, low, high, std, level, block.
---@class lunid.statistics.interval.fields
---@field of function # gets the columns, returns a number
---@field columns table # of one length; their rows are resampled together
---@field level? number # probability that it holds the truth
---@field method? "bootstrap"|"jackknife" # 'jackknife' for mutual information, which repeated rows mislead
---@field draws? integer # of the bootstrap
---@field block? integer # rows that stay together; else chosen by the columns' correlation
---@field seed? integer # of the draws; else that of the run (--seed)
---@param fields lunid.statistics.interval.fields
---@return lunid.interval
function lunid.statistics.interval(fields) end

---How good is a model on a record? RMSE, R2, fit, QQCC, DTW of the phase portraits, mutual information, rank correlations and tests of the residual, with the mode, the data and the window they hold for.
---@class lunid.compare.fields
---@field record lunid.record # what was measured
---@field run? lunid.run # a free run on the record
---@field model? lunid.model # a model: run freely from the record's first state, or as `mode` says
---@field regression? lunid.regression # its model: by equation error, or as `mode` says
---@field predicted? any # a prediction of your own, row by row in the window
---@field mode? "free_run"|"one_step"|"equation_error" # 'one_step': each row from the measured state before it; 'equation_error': the restoring force along the measured motion beside F - m*a
---@field data? "train"|"test" # what the record was to the model
---@field window? lunid.window # part of the time that run and record have
---@field channel? string # the displacement that is compared
---@field interval? number # such as 0.95: intervals by block bootstrap, for coloured errors
---@field draws? integer # of the bootstrap
---@field band? number # that the time warping may bend; else any, for long records less
---@field neighbours? integer # of the mutual information
---@field lags? integer # of the residual's tests, rows
---@param fields lunid.compare.fields
---@return lunid.comparison
function lunid.compare(fields) end

---Features by what they tell about the restoring force: mutual information, rank correlations, and with a regression the thesis' significance index MI*max|c f|. A list in falling order of information, each found by its name too.
---@class lunid.rank_features.fields
---@field record? lunid.record # what was measured
---@field features? table # functions of displacement, velocity, time; else those of the regression
---@field mass? number|lunid.expression # without it the target is F itself
---@field known? number|lunid.expression # part of the restoring force that is known
---@field window? lunid.window # part of the record
---@field given? table # features that are chosen already: adds what each tells beyond them
---@field regression? lunid.regression # whose coefficients the significance index takes
---@field target? any # in place of a record: any column
---@field columns? table # its features, as { { "y", column }, ... }
---@field given_columns? table # those that are chosen already
---@field neighbours? integer # of the mutual information
---@param fields lunid.rank_features.fields
---@return lunid.feature_ranking
function lunid.rank_features(fields) end

---Several models of one system side by side: terms, the force along the measured motion, free runs over a test record. board:terms(), board:measures() are tables for lunid.report, board:figures() its figures, board:result(name) what results.json says of one model.
---@class lunid.scoreboard.fields
---@field models table # entries { name, model }
---@field record any # training records
---@field test lunid.record # for the free runs, which start from its first state
---@field truth? lunid.model # where it is known: false terms are told
---@field channel? string # the displacement that is compared
---@param fields lunid.scoreboard.fields
---@return lunid.scoreboard
function lunid.scoreboard(fields) end

---Figures on one page of HTML on which charts zoom and surfaces turn, without a network: page:save "figures.html".
---@class lunid.figure.page.fields
---@field figures table # in their order
---@field title? string # above them
---@field captions? table # one under each
---@param fields lunid.figure.page.fields
---@return lunid.page
function lunid.figure.page(fields) end

---What a study found, in the terminal, in report.html and in results.json: report:section(title), report:text(words), report:verbatim(text), report:table { head =, rows =, caption = } (no row longer than the head), report:figure(name, figure, caption), report:results { ... }, report:progress(what, done, total), and at the end report:save().
---@class lunid.report.fields
---@field title string # above the page
---@param fields lunid.report.fields
---@return lunid.report
function lunid.report(fields) end

---Channels over time, the whole above and parts of it enlarged below.
---@class lunid.figure.history.fields
---@field of any # records, runs, comparisons or series of plain columns: one or a list
---@field channels? table # one panel for each
---@field window? lunid.window # part of the time that is shown
---@field zoom? any # parts that are enlarged
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.history.fields
---@return lunid.figure
function lunid.figure.history(fields) end

---Velocity over displacement, or any channel over another; a lone record or run is coloured by its cycles.
---@class lunid.figure.phase_portrait.fields
---@field of any # records, runs, comparisons or series of plain columns: one or a list
---@field x? string # channel across
---@field y? string # channel upward
---@field window? lunid.window # part of the records
---@field cycles? boolean # colour a lone curve by its cycles
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.phase_portrait.fields
---@return lunid.figure
function lunid.figure.phase_portrait(fields) end

---The loops of force over displacement and over velocity; those of a lone record or run are coloured by their cycles.
---@class lunid.figure.loop.fields
---@field of any # records, runs, comparisons or series of plain columns: one or a list
---@field mass? number # shows the restoring force F - m*a; else the force itself
---@field force? string # channel of the force
---@field over? table # channels across, one panel for each
---@field window? lunid.window # part of the records
---@field cycles? boolean # colour a lone curve by its cycles
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.loop.fields
---@return lunid.figure
function lunid.figure.loop(fields) end

---A Poincare section: the states once per period of the excitation.
---@class lunid.figure.poincare.fields
---@field of any # what to draw
---@field x? string # column across
---@field y? string # column upward
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.poincare.fields
---@return lunid.figure
function lunid.figure.poincare(fields) end

---Which rows of two curves dynamic time warping pairs: the curves one above the other with links, and the pairing itself, straight where the paces are alike.
---@class lunid.figure.alignment.fields
---@field of lunid.pairing # what to draw
---@field dt? number # between rows: shows seconds in place of rows
---@field labels? table # of the two curves
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.alignment.fields
---@return lunid.figure
function lunid.figure.alignment(fields) end

---Power spectral densities by Welch's method; a lone one with its 95 % limits.
---@class lunid.figure.spectrum.fields
---@field of any # records or spectra: one or a list
---@field channel? string # of the records
---@field labels? table # of each; else the records' names
---@field log_frequency? boolean # logarithmic axis of the frequency
---@field length? integer # of a segment; else as the record's method says
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.spectrum.fields
---@return lunid.figure
function lunid.figure.spectrum(fields) end

---Power spectral density over frequency and time.
---@class lunid.figure.spectrogram.fields
---@field of any # a record or its spectrogram
---@field channel? string # of the record
---@field length? integer # of a segment; else as the record's method says
---@field to? number # highest frequency shown; else all
---@field decades? number # of density below the largest that are shown
---@field ridge? boolean # mark the frequency of the largest density
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.spectrogram.fields
---@return lunid.figure
function lunid.figure.spectrogram(fields) end

---The part of an output that follows an input linearly, over frequency.
---@class lunid.figure.coherence.fields
---@field of any # a record or its transfer function
---@field input? string # channel that drives
---@field output? string # channel that answers
---@field length? integer # of a segment; else as the record's method says
---@field to? number # highest frequency shown; else all
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.coherence.fields
---@return lunid.figure
function lunid.figure.coherence(fields) end

---A measured frequency response: magnitude with its 95 % limits, phase and coherence.
---@class lunid.figure.transfer.fields
---@field of any # a record or its transfer function
---@field input? string # channel that drives
---@field output? string # channel that answers
---@field length? integer # of a segment; else as the record's method says
---@field to? number # highest frequency shown; else all
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.transfer.fields
---@return lunid.figure
function lunid.figure.transfer(fields) end

---A frequency response: stable branches solid, unstable ones dashed, folds and bifurcations marked.
---@class lunid.figure.response.fields
---@field response lunid.response # what to draw
---@field quantity? string # a column of the response, such as "amplitude_3" or "phase_1"
---@field state? string # whose motion; else the first displacement
---@field backbone? lunid.backbone # drawn with it
---@field series? table # curves to compare with
---@field log? boolean # logarithmic axis of the quantity
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.response.fields
---@return lunid.figure
function lunid.figure.response(fields) end

---A restoring force surface over displacement and velocity, with the measured points near it.
---@class lunid.figure.surface.fields
---@field surface lunid.surface # what to draw
---@field points? boolean # draw the measured points too
---@field azimuth? number # where it is seen from, about the upright axis
---@field elevation? number # where it is seen from, above the plane
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.surface.fields
---@return lunid.figure
function lunid.figure.surface(fields) end

---Any numbers on a grid as a surface in space.
---@class lunid.figure.relief.fields
---@field x any # increasing, one for each column of z
---@field y any # increasing, one for each row of z
---@field z table # rows; what is not a number is no data
---@field x_axis? string # axis with its unit
---@field y_axis? string # axis with its unit
---@field z_axis? string # axis with its unit
---@field diverging? boolean # colours on both sides of 0; else from low to high
---@field azimuth? number # where it is seen from, about the upright axis
---@field elevation? number # where it is seen from, above the plane
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.relief.fields
---@return lunid.figure
function lunid.figure.relief(fields) end

---Any numbers on a grid by colour, seen from above; cells without data are hatched.
---@class lunid.figure.map.fields
---@field x any # increasing, one for each column of z
---@field y any # increasing, one for each row of z
---@field z table # rows; what is not a number is no data
---@field x_axis? string # axis with its unit
---@field y_axis? string # axis with its unit
---@field z_axis? string # axis with its unit
---@field diverging? boolean # colours on both sides of 0; else from low to high
---@field contours? boolean # lines of equal z
---@field numbers? boolean # written into the cells
---@field z_scale? "linear"|"log" # of the colours
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.map.fields
---@return lunid.figure
function lunid.figure.map(fields) end

---A restoring force surface from above: lines of equal force, and hatched where there are no data.
---@class lunid.figure.contour.fields
---@field surface lunid.surface # what to draw
---@field points? boolean # draw the measured points too
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.contour.fields
---@return lunid.figure
function lunid.figure.contour(fields) end

---A restoring force surface from both sides: all measured points over displacement and over velocity, coloured by the other, and the range of the surface behind them.
---@class lunid.figure.side_views.fields
---@field surface lunid.surface # what to draw
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.side_views.fields
---@return lunid.figure
function lunid.figure.side_views(fields) end

---Cuts through a restoring force surface with the measured points near them.
---@class lunid.figure.sections.fields
---@field surface lunid.surface # what to draw
---@field v? table # cuts along displacement at these velocities
---@field y? table # cuts along velocity at these displacements
---@field half_width? number # of the band from which points come; else a twentieth of the range
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.sections.fields
---@return lunid.figure
function lunid.figure.sections(fields) end

---The coefficients of a lasso, each over its largest size, as the penalty falls; below, the error on left-out blocks.
---@class lunid.figure.coefficient_path.fields
---@field of lunid.regression # fitted by lunid.lasso or lunid.elastic_net
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.coefficient_path.fields
---@return lunid.figure
function lunid.figure.coefficient_path(fields) end

---A score over the number of terms: the steps of a stepwise regression, or the free runs of a selection.
---@class lunid.figure.score.fields
---@field of any # a regression that went step by step, a selection, or series of terms and scores
---@field y? string # axis of plain series, with its unit
---@field log? boolean # logarithmic axis of the score
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.score.fields
---@return lunid.figure
function lunid.figure.score(fields) end

---Candidates by two costs, both better when smaller, and the front of those that none beats in both.
---@class lunid.figure.pareto.fields
---@field of any # a selection, or a series of two costs
---@field x? string # axis across, with its unit
---@field y? string # axis upward, with its unit
---@field log? boolean # logarithmic axis upward
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.pareto.fields
---@return lunid.figure
function lunid.figure.pareto(fields) end

---What each term contributes to the restoring force, in per cent of its rms, the largest on top.
---@class lunid.figure.contributions.fields
---@field of any # a regression, or a list of { name, per cent }
---@field cut_off? number # drawn as a line
---@field axis? string # what the bars are, with their unit
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.contributions.fields
---@return lunid.figure
function lunid.figure.contributions(fields) end

---Parameters of one fit or of several with their 95 % intervals, each as its deviation from the truth, or from the first fit's value; terms that are not there in truth by themselves, in per cent of their value.
---@class lunid.figure.intervals.fields
---@field of any # regressions, models or trajectory fits
---@field truth? lunid.table # true values by name: { k = 2e4 }; 0 for a term that is not there
---@field labels? table # of each fit
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.intervals.fields
---@return lunid.figure
function lunid.figure.intervals(fields) end

---What each channel or feature tells about each other, as a matrix of mutual information.
---@class lunid.figure.information_matrix.fields
---@field of any # a record, or a list of { name, column }
---@field channels? table # of the record
---@field features? table # functions of its channels beside them
---@field rows? integer # of a longer record, every n-th is taken
---@field neighbours? integer # of the estimate
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.information_matrix.fields
---@return lunid.figure
function lunid.figure.information_matrix(fields) end

---The correlations between the parameters of a fit: near 1 or -1, the data do not tell two apart.
---@class lunid.figure.correlation_matrix.fields
---@field of lunid.trajectory # a fit of one record
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.correlation_matrix.fields
---@return lunid.figure
function lunid.figure.correlation_matrix(fields) end

---Where a model leaves force unexplained: over displacement and velocity, or over slow time. Of a discovery, the map before and after.
---@class lunid.figure.residual_map.fields
---@field discovery? lunid.discovery # what was found; or else record and model, or columns
---@field record? lunid.record # a measured record
---@field model? lunid.model # whose residual F - m*a - f(y, v, t) is shown
---@field residual? any # plain columns: the residual, and displacement, velocity and time
---@field y? any # displacement
---@field v? any # velocity
---@field t? any # time; else the rows' numbers
---@field over? "phase_plane"|"time" # 'time': displacement over slow time
---@field cells? integer # along each axis
---@field least_count? integer # rows in a cell; others have no data
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.residual_map.fields
---@return lunid.figure
function lunid.figure.residual_map(fields) end

---The force that a discovery's baseline leaves unexplained, over time, slow time, displacement, velocity, amplitude, harmonic order, frequency and the phase plane, each with the level that noise of its colour stays below (95 %), and what the final model leaves.
---@class lunid.figure.where_it_fails.fields
---@field discovery lunid.discovery # what was found
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.where_it_fails.fields
---@return lunid.figure
function lunid.figure.where_it_fails(fields) end

---The gap of free runs after each named effect, on train and test, against what noise alone leaves.
---@class lunid.figure.gaps.fields
---@field discovery lunid.discovery # what was found
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.gaps.fields
---@return lunid.figure
function lunid.figure.gaps(fields) end

---The gap of each rival's fit over the training record, beside that of what was named and the baseline's free run.
---@class lunid.figure.rivals.fields
---@field discovery lunid.discovery # what was found
---@field most? integer # rivals that are shown
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.rivals.fields
---@return lunid.figure
function lunid.figure.rivals(fields) end

---Measured, baseline and final run over time: the errors over the whole record, the runs where the baseline is worst, and the force that is left.
---@class lunid.figure.failures.fields
---@field discovery lunid.discovery # what was found
---@field record? integer # which of the training and test records; of several coordinates each output is one
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.failures.fields
---@return lunid.figure
function lunid.figure.failures(fields) end

---The force of what was named over what it is a function of, against what the rest of the model would leave.
---@class lunid.figure.named_force.fields
---@field discovery lunid.discovery # what was found
---@field title? string # above the figure
---@field theme? "light"|"dark" # of paper and ink
---@field width? number # printed; text is legible down to half of 16 cm
---@field height? number # else as the panels need
---@field dpi? integer # of PNG files
---@param fields lunid.figure.named_force.fields
---@return lunid.figure
function lunid.figure.named_force(fields) end

---A surface that turns once about its upright axis, as PNG frames: animation:save "folder".
---@class lunid.figure.turn.fields
---@field figure lunid.figure # with a surface in its first panel
---@field frames? integer # PNG files, frame_0001.png and so on
---@param fields lunid.figure.turn.fields
---@return lunid.animation
function lunid.figure.turn(fields) end

---A motion that runs along its phase portrait and its history, as PNG frames: animation:save "folder".
---@class lunid.figure.motion.fields
---@field of any # a record or a run
---@field window? lunid.window # part of a record
---@field x? string # channel across
---@field y? string # channel upward
---@field frames? integer # PNG files, frame_0001.png and so on
---@param fields lunid.figure.motion.fields
---@return lunid.animation
function lunid.figure.motion(fields) end

return lunid

-- Frequency response of case 1 (thesis, figures 2.18 to 2.20, appendix B): the published models beside the truth and Lunid's answer,
-- stepped as in the thesis, and continued through the unstable branch that the thesis could not get. Appendix B loses the
-- damping term in (B.8) and (B.9); (B.10) has it, and its closed form of one harmonic is drawn here.
local lunid = require "lunid"
local published = require "published"
local y, v = lunid.displacement, lunid.velocity
local quick, seed = lunid.option { "quick", false }, lunid.option { "seed", 1 }

local report = lunid.report { title = "Frequency response of case 1" }
local m, c, k, k3 = 1, 10, 2e4, 1e6
local system = lunid.systems.duffing { mass = m, k = k, k3 = k3, c = c }
local train = lunid.thesis_record { system = system, frequency = { 20, 30 }, seed = 10*seed }
local found = lunid.select { record = train, mass = m, features = { lunid.polynomials({ y, v }, 5) } }

--- Frequencies at which one harmonic of amplitude a balances the force by (B.10): a quadratic in w^2.
local function one_harmonic(force, top)
  local frequencies, amplitudes = {}, {}
  for i = 1, 200 do
    local a = 0.35*i/200
    local spring = k + 0.75*k3*a^2
    local middle = spring/m - c^2/(2*m^2)
    local rest = middle^2 - (spring/m)^2 + (force/(m*a))^2
    for _, sign in ipairs { -1, 1 } do
      local square = rest >= 0 and middle + sign*math.sqrt(rest) or -1
      if square > 0 and square < (2*math.pi*top)^2 then
        frequencies[#frequencies + 1], amplitudes[#amplitudes + 1] = math.sqrt(square)/(2*math.pi), a
      end
    end
  end
  return frequencies, amplitudes
end

--- The largest amplitude of a response and its fold points.
local function row_of(name, force, response)
  local amplitude, frequency = response:column "amplitude", response:column "frequency"
  local top, at, unstable = 0, 0, 0
  local stable = response:column "stable"
  for i = 1, #amplitude do
    if amplitude[i] > top then top, at = amplitude[i], frequency[i] end
    unstable = unstable + (stable[i] == 0 and 1 or 0)
  end
  local folds = {}
  for _, point in ipairs(response.curves[1].special) do
    if point.kind == "fold" then folds[#folds + 1] = ("%.2f"):format(point.frequency) end
  end
  return { name, force, 1e3*top, at, table.concat(folds, ", "), unstable }
end

local rows, runs = {}, {}
for _, each in ipairs { { 300, 150 }, { 1000, 150 }, { 300, 1400 } } do
  local force, top = each[1], each[2]
  local exact = lunid.frequency_response { model = system, amplitude = force, from = 0.5, to = top }
  local answer = lunid.frequency_response { model = found.model, amplitude = force, from = 0.5, to = top }
  rows[#rows + 1] = row_of("truth", force, exact)
  rows[#rows + 1] = row_of("Lunid", force, answer)
  local frequencies, amplitudes = one_harmonic(force, top)
  local series = { lunid.figure.series { frequencies, amplitudes, label = "one harmonic, (B.10)", role = "fifth", style = "points" },
    lunid.figure.series { answer:column "frequency", answer:column "amplitude", label = "Lunid's answer",
      role = "measured", style = "dotted" } }
  if top == 150 then
    for _, model in ipairs { { "thesis, custom RX", published.case1.rx, "baseline" }, { "PySINDy as published", published.case1.pysindy, "effect" } } do
      local stepped = lunid.frequency_response { model = published.model(model[2]), amplitude = force, from = 5, to = top,
        method = "stepped_up", points = quick and 30 or 120, stability = false }
      series[#series + 1] = lunid.figure.series { stepped:column "frequency", stepped:column "amplitude", label = model[1] .. ", stepped up",
        role = model[3], style = "line_points" }
    end
  end
  report:figure(("frf_%d_N_to_%d_Hz"):format(force, top), lunid.figure.response { exact, log = top > 150, series = series,
    title = ("%d N, 0 to %d Hz"):format(force, top) }, "Frequency response: the truth with stable and unstable branches, the closed form of "
    .. "one harmonic, the answers")
  runs[#runs + 1] = { seed = seed, force = force, to = top, peak_truth = rows[#rows - 1][3], peak = rows[#rows][3] }
  report:progress("curves", #runs, 3)
end
report:table { head = { "model", "force [N]", "peak [mm]", "at [Hz]", "folds at [Hz]", "points on the unstable branch" }, rows = rows,
  caption = "By harmonic balance and continuation; stability by Floquet multipliers" }

-- ---- at one frequency between the folds ----

--- Amplitude of the published closed form with and without the damping term, at its largest real root.
local w = 2*math.pi*40
local function root(damping)
  local best
  for i = 1, 40000 do
    local a = 0.4*i/40000
    local value = a^2*((k/m - w^2 + 0.75*k3/m*a^2)^2 + (damping*w/m)^2) - (300/m)^2
    if value < 0 then best = a end
  end
  return best
end
report:text(("At 40 Hz and 300 N the upper branch of one harmonic is at %.2f mm with the damping term of (B.10); (B.8), which has lost it, "
  .. "gives %.2f mm, and no end to the branch at any frequency."):format(1e3*root(c), 1e3*root(0)))

report:results { case = "frf", variant = "1", runs = runs }
report:save()

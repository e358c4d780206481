-- Every solver on one noisy record of case 1 (m*a + 2e4*y + 1e6*y^3 + 10*v = F) with the same 9 features: what each
-- keeps, and how near k, c and k3 come. The acceleration is derived from noisy data, so that all share its bias; the weak
-- form needs no derivative and has less of it. All of them are first guesses: the trajectory fit is the result.
-- (instrumental_variables needs a reference: closed_loop.lua.)
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local record = lunid.thesis_record { system = lunid.systems.duffing {}, frequency = 20, seed = 1 }
local truth = { y = 2e4, v = 10, ["y^3"] = 1e6 }

local solvers = {
  { "least squares", lunid.least_squares {} },
  { "ridge", lunid.ridge { lambda = 1e-3 } },
  { "stlsq", lunid.stlsq { threshold = 0.02 } },
  { "lasso", lunid.lasso { refit = true } },
  { "elastic net", lunid.elastic_net { mixture = 0.5, refit = true } },
  { "sr3", lunid.sr3 { threshold = 0.02 } },
  { "frols", lunid.frols {} },
  { "stepwise BIC", lunid.stepwise {} },
  { "best subset of 3", lunid.best_subset { terms = 3 } },
  { "non-negative", lunid.non_negative {} },
  { "spike and slab", lunid.spike_slab {} },
  { "ensemble", lunid.ensemble_of { solver = lunid.stlsq { threshold = 0.02 }, members = 50 } },
  { "total", lunid.total_least_squares {} },
  { "huber", lunid.huber {} },
}

local function row(name, solver, form)
  local fit = lunid.regress {
    record = record,
    mass = 1,
    features = { lunid.polynomials({ y, v }, 3) },
    solver = solver,
    form = form,
  }
  local kept = 0
  for _, term in ipairs(fit.terms) do kept = kept + (term.value ~= 0 and 1 or 0) end
  local function off(term) return 100*(fit.terms[term].value/truth[term] - 1) end
  print(("%-18s%-8s%5d%10.1f%10.1f%10.1f%9.4f"):format(name, form and "weak" or "strong", kept, off "y", off "v",
    off "y^3", fit.r2))
end

print "solver            form    terms   k off %   c off %  k3 off %       R2"
for _, each in ipairs(solvers) do row(each[1], each[2]) end
row("best subset of 3", lunid.best_subset { terms = 3 }, lunid.weak_form {})
row("frols", lunid.frols {}, lunid.weak_form {})

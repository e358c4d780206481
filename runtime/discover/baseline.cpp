#include "discover/baseline.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "expr/joined.hpp"

namespace lunid {

FitOptions full_fit(const Study& study, int iterations) {
  FitOptions o;
  o.max_iterations = iterations;
  o.tolerance = 1e-6;
  o.threads = study.options->threads;
  o.cancelled = study.options->cancelled;
  return o;
}

namespace {

/// A baseline that cannot be run, or whose parameters sit at bounds, is said before anything else.
void say_first(const Candidate& c, std::vector<std::string>& warnings) {
  std::vector<std::string> said;
  if (!c.ran()) said.push_back("the baseline cannot be simulated over the training records (" + c.fit.stopped + ")");
  const auto& table = c.system->model().parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (i < c.fit.at_bound.size() && c.fit.at_bound[i] && !table[i].fixed)
      said.push_back("the baseline's " + table[i].name + " sits at its bound " +
                     number(c.fit.theta[static_cast<Eigen::Index>(i)], 4) +
                     ": widen it, or see what the baseline's other terms leave to it");
  warnings.insert(warnings.begin(), said.begin(), said.end());
}

void from_given_guess(const Study& study, const Model& model, Candidate& baseline) {
  const std::vector<double> values = model.values();
  if (values.empty() || !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return;
  const Eigen::VectorXd guess =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  FitResult again = fit_trajectory(*baseline.system, guess, study.train, full_fit(study, 40));
  if (again.cost < baseline.fit.cost) baseline.fit = std::move(again);
}

void warn_of_collinear(const Eigen::MatrixXd& gram, Eigen::Index j, const std::vector<Parameter>& table,
                       std::vector<std::string>& warnings) {
  for (Eigen::Index i = 0; i < j; ++i) {
    if (table[static_cast<std::size_t>(i)].fixed || table[static_cast<std::size_t>(j)].fixed) continue;
    const double cosine = gram(i, j) / std::sqrt(gram(i, i) * gram(j, j));
    const double left = 1 - cosine * cosine;
    const auto &a = table[static_cast<std::size_t>(i)].name, &b = table[static_cast<std::size_t>(j)].name;
    if (left < 1e-12)
      throw InputError("discover: the data do not excite parameters '" + a + "' and '" + b +
                           "' separately: their terms are one column on this record; fix one of them, or use a record "
                           "with another frequency or amplitude (a name that is no signal, as y v a t are, is taken "
                           "for a parameter)",
                       {}, Fault::data);
    if (left < 2e-3)
      warnings.push_back(
          "the terms of " + a + " and " + b +
          " are nearly one column on this record (a single frequency?): only their combination is well seen");
  }
}

/// A channel that comes late makes damping negative on the force, and the free run grows without bound.
void from_damped_start(const Study& study, Candidate& baseline) {
  if (baseline.ran()) return;
  const Eigen::VectorXd start = without_signs(*baseline.system, baseline.starts.front());
  FitResult again = fit_trajectory(*baseline.system, start, study.train, full_fit(study, 40));
  if (std::isfinite(again.cost)) baseline.fit = std::move(again);
}

/// Shape parameters without a first guess, from which no fit can begin.
void refuse_without_guess(const Candidate& baseline) {
  std::string names;
  const auto& table = baseline.system->model().parameters;
  for (std::size_t j = 0; j < table.size(); ++j)
    if (!baseline.linear[j] && std::isnan(table[j].value)) append_item(names, table[j].name);
  if (names.empty()) return;
  throw InputError(
      "discover: the baseline's force has no finite slopes where the search for its parameters begins: give "
      "first guesses of " +
          names + ", of the size that they have in your units",
      {}, Fault::data);
}

/// Parameters that this record does not excite, and columns that are one on it, are said before anything is fitted.
void check_excitation(const Study& study, const Model& model, const Candidate& baseline,
                      std::vector<std::string>& warnings) {
  const auto& table = baseline.system->model().parameters;
  const Eigen::Index p = baseline.parameters();
  const Eigen::MatrixXd gram = gram_of_force(study, baseline, baseline.starts.front());
  // the regression may have put the factor of a term at zero, which hides what is within it
  Eigen::VectorXd guess = baseline.starts.front();
  for (Eigen::Index j = 0; j < p; ++j)
    if (std::isfinite(table[static_cast<std::size_t>(j)].value)) guess[j] = table[static_cast<std::size_t>(j)].value;
  const Eigen::MatrixXd given = gram_of_force(study, baseline, guess);
  if (!gram.allFinite() && !given.allFinite()) refuse_without_guess(baseline);
  double force = 0;
  for (const auto& data : study.force) force += acting_forces(model, data.record).squaredNorm();
  bool mass_free = false;
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto& name = table[static_cast<std::size_t>(j)].name;
    mass_free = mass_free || in_a_mass(model, model.pool->parameter(name));
    if (table[static_cast<std::size_t>(j)].fixed) continue;
    if (!(gram(j, j) > 0) && !(given(j, j) > 0))
      throw InputError("discover: the data do not excite parameter '" + name +
                           "': its term is zero on every row of the training records; fix it, leave it out, or use a "
                           "record that reaches it",
                       {}, Fault::data);
  }
  bool scaled = false;  // by a mass that is known: others are ratios to it
  for (int i = 0; i < model.degrees(); ++i) scaled = scaled || model.coordinate(i).mass.is_constant();
  if (mass_free && !scaled && !(force > 0))
    throw InputError("discover: with F = 0 throughout only ratios to the mass can be seen; give --mass as a number", {},
                     Fault::data);
  for (Eigen::Index j = 0; j < p; ++j) warn_of_collinear(gram, j, table, warnings);
}

/// Of an element of the model that is an entry of the catalogue: the entry's guesses of its shape, in all forms that it
/// may have there, for what is given no value.
std::vector<Guess> guesses_of(const Study& study, const Model& model, const Effect& entry) {
  std::vector<Guess> out;
  if (!entry.guess || !is_element_of(model, entry)) return out;
  RecordScales scale = scales(study, 0, entry.place);
  scale.residual_std = scale.force_std;  // nothing is explained yet
  for (int variant = 0; variant < std::ssize(entry.variants); ++variant)
    for (Guess guess : entry.guess(scale, variant)) {
      std::erase_if(guess, [&](const auto& named) {
        const Parameter* p = model.find(named.first);
        return !p || std::isfinite(p->value);
      });
      if (!guess.empty() && std::ranges::find(out, guess) == out.end()) out.push_back(std::move(guess));
    }
  return out;
}

}  // namespace

void check_excitation_of_linear(const Study& study, const Model& model) {
  Candidate baseline = compile(study, model, {});
  if (!std::ranges::all_of(baseline.linear, [](std::uint8_t each) { return each != 0; })) return;
  find_starts(study, baseline, Eigen::VectorXd(), {});
  std::vector<std::string> warnings;
  if (!baseline.starts.empty()) check_excitation(study, model, baseline, warnings);
}

Candidate fit_baseline(const Study& study, const Model& model, std::vector<std::string>& warnings,
                       std::span<const Effect> catalogue) {
  Candidate baseline = compile(study, model, {});
  std::vector<std::vector<Guess>> guesses;
  for (const Effect& entry : catalogue) guesses.push_back(guesses_of(study, model, entry));
  find_starts(study, baseline, Eigen::VectorXd(), guesses);
  if (baseline.starts.empty())
    throw InputError(
        "discover: the baseline's force is not finite along the measured motion; check its terms and first guesses");
  check_excitation(study, model, baseline, warnings);
  fit(study, baseline, full_fit(study, 40));
  from_given_guess(study, model, baseline);
  from_damped_start(study, baseline);
  say_first(baseline, warnings);
  return baseline;
}

}  // namespace lunid

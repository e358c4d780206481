#include "discover/closed_loop.hpp"

#include <Eigen/LU>
#include <cmath>

#include "discover/judge.hpp"
#include "record/autoregression.hpp"
#include "simulate/one_step.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index lags = 20;
constexpr Index most_rows = 20000;  ///< of a record that other gaps are asked of

/// Innovations of a series, of length one, in step with their rows; zero in the first `lags` rows. None of a constant.
VectorXd own_innovations(const VectorXd& x) {
  if (!x.allFinite() || x.size() < 6 * lags || !(standard_deviation(view(x)) > 0)) return {};
  const AutoregressiveFit fit = fit_autoregression(view(x), static_cast<int>(lags));
  const MatrixXd rest = innovations(x.array() - fit.mean, fit);
  VectorXd out = VectorXd::Zero(x.size());
  const Index rows = x.size() - lags;
  out.tail(rows) = rest.col(0).tail(rows);
  const double size = out.norm();
  if (!(size > 0)) return {};
  return out / size;
}

/// Sum of squared correlations of a with b, so many rows later.
double later_correlation(const VectorXd& a, const VectorXd& b, Index from, Index to) {
  double sum = 0;
  for (Index k = from; k <= to; ++k) sum += std::pow(a.head(a.size() - k).dot(b.tail(b.size() - k)), 2);
  return sum;
}

/// Columns of a model's force along a record, of these parameters.
MatrixXd columns_of_force(const Candidate& model, const Record& record, const std::vector<Index>& free) {
  MatrixXd jacobian;
  imposed_force(*model.force_system, view(model.fit.theta), record, &jacobian);
  return jacobian(Eigen::all, free);
}

/// Rows without a kernel's edges.
struct Inner {
  Index first, count;
};
Inner inside(const SavitzkyGolay& kernel, const Record& record) {
  const Index edge = std::min<Index>(edge_of(kernel, Slopes::of_column), record.rows() / 10);
  return {edge, record.rows() - 2 * edge};
}

/// The samples of a mass's acceleration under this force alone, as differences of its sampled displacement show them:
/// means over an interval on either side, with weights that fall to its ends, give second differences, whose bias at
/// frequency w, (w dt)^2/12, is taken off. A force that is held is half an interval late in them.
VectorXd as_it_accelerates(const Excitation& force) {
  constexpr int points = 8;  // on either side
  const Index rows = force.rows();
  const double dt = force.dt();
  VectorXd mean = VectorXd::Zero(rows);
  for (Index i = 0; i < rows; ++i)
    for (int k = 0; k < points; ++k) {
      const double part = (k + 0.5) / points, t = force.t0() + static_cast<double>(i) * dt;
      mean[i] += (1 - part) / points * (force.at(t - part * dt) + force.at(t + part * dt));
    }
  VectorXd out = mean;
  out.segment(1, rows - 2) -= (mean.head(rows - 2) - 2 * mean.segment(1, rows - 2) + mean.tail(rows - 2)) / 12;
  return out;
}

/// A record of one coordinate, its force in step with the displacement's derivatives.
Record in_step(const Study& study, const Record& record) {
  Channel force = record.channel(study.forces.front());
  force.values = as_it_accelerates(fit_data(study, record).excitation[0]);
  return record.with(std::move(force));
}

Record smooth_by_columns(const Study& study, const Record& record, const SavitzkyGolay& kernel) {
  return smooth_motion(study, record, kernel, Slopes::of_column);
}

/// A record with another motion.
Record moving(const Study& study, const Record& record, VectorXd motion) {
  Channel shown = record.channel(study.measured);
  shown.values = std::move(motion);
  return with_motion(study, record.with(std::move(shown)));
}

/// What noise and smoothing make of a force that the model explains whole, along its own run: of a force that is no
/// straight line (friction at the reversals) noise in its motion leaves a mean. Over drawn noise of the sensor's level.
VectorXd open_by_noise(const Study& study, const Candidate& model, const Record& record, const FreeRun& run,
                       const SavitzkyGolay& kernel) {
  constexpr int draws = 16;
  const double noise = record.channel(study.measured).noise;
  VectorXd motion = as_vector(record[study.measured]), mean = VectorXd::Zero(record.rows());
  for (int draw = 0; draw < draws; ++draw) {
    Philox random(study.options->seed, static_cast<std::uint64_t>(5000 + draw));
    for (Index i = run.lead; i < motion.size(); ++i) motion[i] = run.model[i] + noise * random.normal();
    const Record smooth = smooth_by_columns(study, moving(study, record, motion), kernel);
    mean += open_force(model, model.fit.theta, smooth) / draws;
  }
  return mean;
}

/// Of each training record the equations columns * step = left, and the instruments that solve them.
struct Equations {
  std::vector<MatrixXd> instruments, columns;
  std::vector<VectorXd> left;
  VectorXd size;  ///< of a column, which is of length one here

  bool gather(const Study& study, const Candidate& model, std::span<const FreeRun> runs,
              const std::vector<Index>& free);
  MatrixXd covariance(const Study& study, const VectorXd& step, const MatrixXd& inverse) const;

 private:
  /// Of each matrix's columns over all records.
  static VectorXd lengths(const std::vector<MatrixXd>& parts) {
    VectorXd squares = VectorXd::Zero(parts.front().cols());
    for (const MatrixXd& part : parts) squares += part.colwise().squaredNorm().transpose();
    return squares.cwiseSqrt();
  }
};

/// False where they are not finite, or a column is zero.
bool Equations::gather(const Study& study, const Candidate& model, std::span<const FreeRun> runs,
                       const std::vector<Index>& free) {
  for (const Record& given : study.full) {
    const Record record = in_step(study, given);
    const SavitzkyGolay kernel = smoothing_kernel(study, given);
    const Inner rows = inside(kernel, given);
    const Record smooth = smooth_by_columns(study, record, kernel),
                 reference =
                     smooth_by_columns(study, moving(study, record, as_vector(record[study.reference()])), kernel);
    const VectorXd open =
        open_force(model, model.fit.theta, smooth) - open_by_noise(study, model, record, runs[left.size()], kernel);
    instruments.push_back(columns_of_force(model, reference, free).middleRows(rows.first, rows.count));
    columns.push_back(columns_of_force(model, smooth, free).middleRows(rows.first, rows.count));
    left.push_back(open.segment(rows.first, rows.count));
    if (!instruments.back().allFinite() || !columns.back().allFinite() || !left.back().allFinite()) return false;
  }
  const VectorXd of_instrument = lengths(instruments);
  size = lengths(columns);
  if (!(of_instrument.minCoeff() > 0) || !(size.minCoeff() > 0)) return false;
  for (MatrixXd& part : instruments) part *= of_instrument.cwiseInverse().asDiagonal();
  for (MatrixXd& part : columns) part *= size.cwiseInverse().asDiagonal();
  return true;
}

/// From sums of the scores over blocks of two periods.
MatrixXd Equations::covariance(const Study& study, const VectorXd& step, const MatrixXd& inverse) const {
  MatrixXd scores = MatrixXd::Zero(step.size(), step.size());
  for (std::size_t r = 0; r < left.size(); ++r) {
    const Index block = bootstrap_block(study, study.full[r].dt(), left[r].size());
    const VectorXd rest = left[r] - columns[r] * step;
    for (Index from = 0; from < rest.size(); from += block) {
      const Index rows = std::min(block, rest.size() - from);
      const VectorXd score = instruments[r].middleRows(from, rows).transpose() * rest.segment(from, rows);
      scores += score * score.transpose();
    }
  }
  return inverse * scores * inverse.transpose();
}

/// The parameters that were fitted, each by one step of the instrumental-variable equations from the fit (exact where
/// the force is linear in them): the columns of the force along the smoothed motion, the same along the reference's
/// motion for instruments, less what drawn noise leaves along the model's own `runs` over the training records;
/// deviations from sums of scores over blocks of two periods. (Janot, Vandanjon & Gautier 2014, IEEE Trans. Control
/// Syst. Technol. 22, 132.) Empty with several coordinates, for models whose readings a sensor falsifies, and where the
/// reference does not tell the parameters apart.
std::vector<Parameter> by_instruments(const Study& study, const Candidate& model, std::span<const FreeRun> runs) {
  if (study.imposed || !model.ran() || !model.seen_by_force || study.degrees() > 1) return {};
  const auto& table = model.system->model().parameters;
  std::vector<Index> free;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (!std::isnan(model.fit.deviation(static_cast<Index>(i)))) free.push_back(static_cast<Index>(i));
  if (free.empty()) return {};
  Equations equations;
  if (!equations.gather(study, model, runs, free)) return {};
  const auto p = static_cast<Index>(free.size());
  MatrixXd system = MatrixXd::Zero(p, p);
  VectorXd right = VectorXd::Zero(p);
  for (std::size_t r = 0; r < equations.left.size(); ++r) {
    system += equations.instruments[r].transpose() * equations.columns[r];
    right += equations.instruments[r].transpose() * equations.left[r];
  }
  const Eigen::FullPivLU<MatrixXd> lu(system);
  constexpr double dependent = 1e-4;
  if (!(lu.rcond() > dependent)) return {};
  const VectorXd step = lu.solve(right);
  const MatrixXd covariance = equations.covariance(study, step, lu.inverse());
  std::vector<Parameter> out;
  for (Index j = 0; j < p; ++j) {
    const Index own = free[static_cast<std::size_t>(j)];
    out.push_back(table[static_cast<std::size_t>(own)]);
    out.back().value = model.fit.theta[own] + step[j] / equations.size[j];
    out.back().std = std::sqrt(covariance(j, j)) / equations.size[j];
  }
  return out;
}

/// Of each of these models, pooled over records, of no more than the first 20 000 rows of each. One step is not asked
/// of models with internal states; neither is asked of several coordinates.
std::vector<OtherGaps> other_gaps(const Study& study, const std::vector<const Candidate*>& models,
                                  const std::vector<Record>& records) {
  struct Sums {
    double open = 0, missed = 0;
  };
  std::vector<OtherGaps> out(models.size(), OtherGaps{NAN, NAN});
  if (study.imposed || study.degrees() > 1) return out;
  std::vector<Sums> sums(models.size());
  double acting = 0, moved = 0;
  const auto square = [](const auto& x) { return (x.array() - x.mean()).square().sum(); };
  const auto steps = [&](const Candidate& model) {
    return study.measured == "y" && model.system->model().states.empty() && model.seen_by_force;
  };
  for (const Record& whole : records) {
    const Record record = whole.slice(0, std::min(whole.rows(), most_rows));
    const SavitzkyGolay kernel = smoothing_kernel(study, record);
    const Inner rows = inside(kernel, record);
    const Record smooth = smooth_by_columns(study, in_step(study, record), kernel),
                 start = smooth_motion(study, record, kernel);
    const Excitations excitation = fit_data(study, record).excitation;
    const auto y = as_vector(smooth[study.measured]).segment(rows.first + 1, rows.count - 1);
    acting += square(as_vector(smooth[study.forces.front()]).segment(rows.first, rows.count));
    moved += square(y);
    for (std::size_t i = 0; i < models.size(); ++i) {
      const Candidate& model = *models[i];
      if (!model.ran()) continue;
      const VectorXd open = open_force(model, model.fit.theta, smooth);
      sums[i].open += open.segment(rows.first, rows.count).squaredNorm();
      if (!steps(model)) continue;
      const OneStep next =
          predict_one_step(*model.system, view(model.fit.theta), start, excitation, study.options->cancelled);
      sums[i].missed += (y - next.y.segment(rows.first + 1, rows.count - 1)).squaredNorm();
    }
  }
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!models[i]->ran()) continue;
    out[i].force = std::sqrt(sums[i].open / acting);
    if (steps(*models[i])) out[i].one_step = std::sqrt(sums[i].missed / moved);
  }
  return out;
}

}  // namespace

double answer_of_force(const Study& study, std::span<const FreeRun> runs) {
  if (study.imposed || study.run_length > 0) return 0;
  constexpr double least = 0.01, beyond_chance = 6, beyond_earlier = 3;
  const Index first = study.measured == "a" ? 1 : 0;  // an acceleration follows the force at once
  const std::size_t outputs = study.outputs().size();
  double answer = 0;
  for (std::size_t c = 0; c < outputs; ++c) {
    for (const std::string& force : study.forces) {
      double later = 0, earlier = 0, rows = 0, chance = 0;
      for (std::size_t r = 0; r < study.full.size(); ++r) {
        const FreeRun& run = runs[r * outputs + c];
        const Record& record = study.full[r];
        const Index count = record.rows() - run.lead;
        const VectorXd left = own_innovations((as_vector(record[run.output]) - run.model).tail(count)),
                       acting = own_innovations(as_vector(record[force]).tail(count));
        if (left.size() == 0 || acting.size() == 0) continue;
        const auto n = static_cast<double>(count);
        later += n * later_correlation(left, acting, first, lags);
        earlier += n * later_correlation(acting, left, 1, lags);
        rows += n;
        chance += static_cast<double>(lags);
      }
      if (later > std::max({beyond_chance * chance, beyond_earlier * earlier, least * rows}))
        answer = std::max(answer, later / rows);
    }
  }
  return answer;
}

std::optional<ClosedLoop> look_for_loop(const Study& study, const SearchResult& found, std::span<const FreeRun> runs) {
  const auto has_reference = [&](const Record& record) { return record.has(study.reference()); };
  const bool referenced = !study.imposed && std::ranges::all_of(study.full, has_reference);
  ClosedLoop loop;
  loop.answer = answer_of_force(study, runs);
  if (!referenced && !(loop.answer > 0)) return {};
  if (referenced) {
    loop.reference = study.reference();
    loop.by_instruments = by_instruments(study, found.chosen, runs);
  }
  std::vector<const Candidate*> models{&found.chosen};  // the baseline, where nothing is named
  if (!found.chosen.choices.empty()) models.insert(models.begin(), &found.baseline);
  const std::vector<OtherGaps> train = other_gaps(study, models, study.full),
                               test = other_gaps(study, models, study.test);
  loop.baseline_train = train.front();
  loop.baseline_test = test.front();
  loop.final_train = train.back();
  loop.final_test = test.back();
  return loop;
}

std::string sentence_of(const ClosedLoop& loop) {
  char text[160];
  std::snprintf(text, sizeof text, "closed: %.2g %% of what is new in the force follows what the model leaves",
                100 * loop.answer);
  std::string out = loop.answer > 0 ? text
                                    : loop.reference +
                                          " says that it is closed; the force is not seen to answer what the "
                                          "model leaves";
  if (loop.reference.empty())
    out += "; what the controller was to follow (a channel y_reference) would serve as instrument";
  return out;
}

}  // namespace lunid

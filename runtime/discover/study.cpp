#include "discover/study.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "discover/accept.hpp"
#include "discover/sensor.hpp"
#include "expr/digits.hpp"
#include "record/derive.hpp"
#include "record/spectrum.hpp"
#include "record/treat.hpp"

namespace lunid {

namespace {

/// The share of the force's power in the last tenth of its band: nothing there means that the record holds the whole
/// signal (sampling theorem), however few samples a period has.
double power_at_band_edge(std::span<const double> f) {
  Eigen::Index length = 64;
  while (length * 8 <= static_cast<Eigen::Index>(f.size()) && length < 4096) length *= 2;
  const Eigen::VectorXd density = welch(f, length).density;
  const Eigen::Index edge = density.size() / 10;
  const double total = density.tail(density.size() - 2).sum();
  return total > 0 ? density.tail(edge).sum() / total : 1;
}

/// A force that stands still between its jumps (random bits, a staircase): whoever set it held it.
bool jumps_and_stays(std::span<const double> f) {
  constexpr double large = 0.3, small = 0.1;  // of the largest step, and of the step between
  constexpr int fewest = 5;
  const auto step = [&](std::size_t i) { return std::abs(f[i] - f[i - 1]); };
  double largest = 0;
  for (std::size_t i = 1; i < f.size(); ++i) largest = std::max(largest, step(i));
  int jumps = 0, alone = 0;
  for (std::size_t i = 2; i + 1 < f.size(); ++i) {
    if (!(step(i) > large * largest)) continue;
    ++jumps;
    alone += step(i - 1) < small * step(i) && step(i + 1) < small * step(i);
  }
  return jumps >= fewest && alone > 0.9 * jumps;
}

/// Which straight or curved line through its neighbours predicts a sample of the force best.
Interpolation guess_interpolation(std::span<const double> f) {
  double hold = 0, line = 0, cubic = 0;
  for (std::size_t i = 3; i + 3 < f.size(); ++i) {
    hold += std::pow(f[i] - f[i - 1], 2);
    line += std::pow(f[i] - 0.5 * (f[i - 1] + f[i + 1]), 2);
    cubic += std::pow(f[i] - (9 * (f[i - 1] + f[i + 1]) - f[i - 3] - f[i + 3]) / 16, 2);
  }
  const double power = std::pow(standard_deviation(f), 2) * static_cast<double>(f.size());
  if (!(power > 0)) return Interpolation::linear;
  if (jumps_and_stays(f)) return Interpolation::hold;
  if (cubic < line && cubic < hold) return cubic > 1e-4 * power ? Interpolation::band_limited : Interpolation::cubic;
  if (power_at_band_edge(f) < 1e-4) return Interpolation::band_limited;
  return line <= hold ? Interpolation::linear : Interpolation::hold;
}

/// What the baseline says, else of the largest of the forces.
Interpolation guess_interpolation(const Study& study, const Record& record) {
  if (study.model.interpolation) return *study.model.interpolation;
  const auto smaller = [&](const std::string& a, const std::string& b) {
    return standard_deviation(record[a]) < standard_deviation(record[b]);
  };
  return guess_interpolation(record[*std::max_element(study.forces.begin(), study.forces.end(), smaller)]);
}

Interpolation between_samples(const Study& study, Interpolation guess) {
  return study.between.alike || guess == study.guesses.front() ? study.between.kind : guess;
}

/// The part of three means' second difference by which the middle one differs from the value in its middle.
double curvature_part(Eigen::Index rows) {
  const auto own = static_cast<double>(rows);
  return (own * own - 1) / (24 * own * own);
}

/// What a channel is so much later [s] than at its rows.
Eigen::VectorXd values_later(const Record& record, const std::string& name, Interpolation between, double time) {
  const Excitation signal(record.start(), record.dt(), record[name], between);
  Eigen::VectorXd values(record.rows());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = signal.at(record.time(i) + time);
  return values;
}

/// Beside a held force, where signals have to be held: one that is smooth at the middle of each interval.
Excitation held(const Record& record, const std::string& name) {
  Eigen::VectorXd values = as_vector(record[name]);
  if (!jumps_and_stays(record[name])) values = values_later(record, name, Interpolation::cubic, 0.5 * record.dt());
  return {record.start(), record.dt(), view(values), Interpolation::hold};
}

/// Means of so many rows each, one from every row on that has enough after it: as values in their middle. Of a curve
/// a mean differs by its second derivative, of which the next means tell. A nonlinear force of a mean is not the mean
/// of the force: of 40 means a period, taken as they are, a cubic spring would be off by some tenths of a percent.
Eigen::VectorXd middle_values(std::span<const double> x, Eigen::Index rows) {
  const Eigen::Index count = std::ssize(x) / rows * rows - rows + 1;
  Eigen::VectorXd mean(count);
  for (Eigen::Index i = 0; i < count; ++i) mean[i] = as_vector(x).segment(i, rows).mean();
  Eigen::VectorXd out = mean;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index j = std::clamp(i, rows, count - 1 - rows);
    out[i] -= curvature_part(rows) * (mean[j - rows] - 2 * mean[j] + mean[j + rows]);
  }
  return out;
}

/// The noise of a middle value over that of a row.
double noise_of_middle(Eigen::Index rows) {
  const double part = curvature_part(rows);
  return std::sqrt(((1 + 2 * part) * (1 + 2 * part) + 2 * part * part) / static_cast<double>(rows));
}

/// How a channel is read between its rows.
using Reader = std::function<Excitation(const std::string& name, Interpolation between)>;

/// What drives the model of a study: the forces, and the channels beside them.
Excitations drives(const Study& study, const Record& record, Interpolation interpolation, const Reader& read) {
  Excitations out;
  for (const std::string& force : study.forces) out.add(force, read(force, interpolation));
  if (study.forces.size() == 1) out.offer("force_rate", rate_of(out[0]));
  const bool held_there = out.interpolation() == Interpolation::hold;
  const bool band_limited = interpolation == Interpolation::band_limited;
  for (const std::string& name : side_channels(record)) {
    const bool turns = name.starts_with("shaft");  // on and on, in no band
    const Interpolation smooth = band_limited && !turns ? Interpolation::band_limited : Interpolation::cubic;
    out.offer(name, held_there ? held(record, name) : read(name, smooth));
  }
  return out;
}

/// The rows of a record, as they were recorded, with what drives them.
FitData with_force(const Study& study, const Record& record, Interpolation interpolation) {
  if (study.imposed) return {record, {}, {}};
  const auto read = [&](const std::string& name, Interpolation between) {
    return Excitation(record.start(), record.dt(), record[name], between);
  };
  return {record, drives(study, record, interpolation, read), {}};
}

/// What drives rows that were joined of so many each: between them by what was recorded there. All that is linear in an
/// equation of motion averages alike, so that means of the force drive means of the motion.
Excitations joined_drives(const Study& study, const Record& recorded, Eigen::Index rows, Interpolation interpolation) {
  const double first = recorded.start() + 0.5 * recorded.dt() * static_cast<double>(rows - 1);
  const auto read = [&](const std::string& name, Interpolation between) {
    const Eigen::VectorXd values = middle_values(recorded[name], rows);
    return Excitation(first, recorded.dt(), view(values), between).joined(rows);
  };
  return drives(study, recorded, interpolation, read);
}

/// The part of these that drives a record.
Excitations part_of(const Excitations& whole, const Record& record) {
  const double first = (record.start() - whole.t0()) / whole.dt();
  return whole.part(static_cast<Eigen::Index>(std::lround(first)), record.rows());
}

FitData force_data(const Record& record, Eigen::Index edge) {
  FitData data{record, {}, std::vector<std::uint8_t>(static_cast<std::size_t>(record.rows()), 1)};
  edge = std::min(edge, record.rows() / 10);
  for (Eigen::Index i = 0; i < edge; ++i)
    data.use[static_cast<std::size_t>(i)] = data.use[data.use.size() - 1 - static_cast<std::size_t>(i)] = 0;
  return data;
}

/// The highest angular frequency [rad/s] of a coordinate's motion in a record; 0 of one that rests.
double upper_frequency(const Study& study, const Record& record) {
  double highest = 0;
  for (int i = 0; i < study.degrees(); ++i) {
    const double v = standard_deviation(record[study.channel('v', i)]);
    if (v > 0) highest = std::max(highest, standard_deviation(record[study.channel('a', i)]) / v);
  }
  return highest;
}

/// A floor that no model comes near to.
void warn_of_no_noise(Study& study, const Record& record) {
  constexpr double least = 1e-5;
  for (const std::string& output : study.imposed ? std::vector<std::string>{"F"} : study.outputs()) {
    const double part = record.channel(output).noise / standard_deviation(record[output]);
    if (part < least)
      study.warnings.push_back(output + " of " + record.name() + " has no noise to speak of (" + number(part, 2) +
                               " of its size): it was computed, or a filter took away what lies above the motion. What "
                               "noise alone would leave is no measure then: give the rows as they were measured");
  }
}

/// Of a force that answers an imposed motion: friction jumps where that turns back.
Record with_noise_between_jumps(const Record& record) {
  if (!record.has("F")) return record;
  Channel force = of_window(record, "F");
  force.noise = std::min(force.noise, noise_between_jumps(view(force.values)));
  return record.with(std::move(force));
}

/// Down to 40 samples per period of the motion's upper frequency, never under 1500 rows: what lies above holds noise
/// alone, and F and y are averaged alike.
Record thinned(const Study& study, const Record& record) {
  const double upper = upper_frequency(study, record);
  if (!(upper > 0)) return record;
  const auto most = std::max<Eigen::Index>(1, record.rows() / 1500);
  const auto rows = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(2 * M_PI / upper / record.dt() / 40), 1, most);
  if (rows == 1) return record;
  std::vector<Channel> channels;
  std::vector<std::string> names = side_channels(record);
  const std::vector<std::string> outputs = study.outputs();
  names.insert(names.begin(), outputs.begin(), outputs.end());
  names.insert(names.begin(), study.forces.begin(), study.forces.end());
  if (const std::string reference = study.reference(); record.has(reference)) names.push_back(reference);
  for (const std::string& name : names) {
    Channel c = record.channel(name);
    c.values = middle_values(record[name], rows)(Eigen::seq(0, Eigen::placeholders::last, rows)).eval();
    c.noise *= noise_of_middle(rows);
    channels.push_back(std::move(c));
  }
  const double half = 0.5 * record.dt() * static_cast<double>(rows - 1);
  return with_motion(study, Record(record.name(), record.start() + half, record.dt() * static_cast<double>(rows),
                                   std::move(channels)));
}

}  // namespace

std::vector<std::string> side_channels(const Record& record) {
  std::vector<std::string> names;
  for (const char* name : {"yb", "vb", "ab", "shaft_angle", "shaft_speed", "shaft_rate"})
    if (record.has(name)) names.emplace_back(name);
  return names;
}

Record with_motion(const Study& study, const Record& record) {
  if (study.measured == "y") return derive_motion(record);
  Record out = record;
  for (const std::string& output : study.outputs()) out = integrate(out, {output, 1, study.slow});
  return derive_motion(out);
}

SavitzkyGolay smoothing_kernel(const Study& study, const Record& record) {
  std::optional<SavitzkyGolay> widest;
  for (const std::string& from : study.outputs()) {
    const SavitzkyGolay own =
        choose_savitzky_golay(record[from], record.channel(from).noise, study.measured == "y" ? 1 : 0);
    if (!widest || own.half_width > widest->half_width) widest = own;
  }
  return *widest;
}

namespace {

constexpr int difference_accuracy = 8;

/// The derivative of a smooth column.
Eigen::VectorXd differences(Eigen::VectorXd x, double dt, int order) {
  if (order == 0) return x;
  return differentiate(view(x), dt, 0, order, FiniteDifferences{difference_accuracy, 1}).values;
}

Slopes slopes_of(const Study& study) { return study.degrees() > 1 ? Slopes::of_column : Slopes::of_window; }

}  // namespace

Record smooth_motion(const Study& study, const Record& record, const SavitzkyGolay& kernel) {
  return smooth_motion(study, record, kernel, slopes_of(study));
}

Eigen::Index edge_of(const SavitzkyGolay& kernel, Slopes slopes) {
  return kernel.half_width + (slopes == Slopes::of_column ? difference_accuracy / 2 : 0);
}

/// What lies above the measured channel are its derivatives, what lies below its integrals, smoothed.
Record smooth_motion(const Study& study, const Record& record, const SavitzkyGolay& kernel, Slopes slopes) {
  auto channel = [](const std::string& name, const std::string& unit, Eigen::VectorXd values) {
    Channel c;
    c.name = c.source = name;
    c.unit = unit;
    c.values = std::move(values);
    c.derived = true;
    return c;
  };
  const Units units = study.units();
  const int known = study.measured_order();
  std::vector<Channel> channels;
  for (const std::string& force : study.forces)
    channels.push_back(channel(force, units.force, savitzky_golay(record[force], record.dt(), 0, kernel)));
  for (int i = 0; i < study.degrees(); ++i) {
    const std::string names[] = {study.channel('y', i), study.channel('v', i), study.channel('a', i)};
    const auto smoothed = [&](int rank, int derivative) {
      return savitzky_golay(record[names[rank]], record.dt(), derivative, kernel);
    };
    for (int rank = 0; rank < 3; ++rank) {
      const int order = std::max(0, rank - known);
      if (slopes == Slopes::of_window)
        channels.push_back(channel(names[rank], units.of(names[rank]), smoothed(std::min(rank, known), order)));
      else
        channels.push_back(channel(names[rank], units.of(names[rank]),
                                   differences(smoothed(std::min(rank, known), 0), record.dt(), order)));
    }
  }
  for (const std::string& name : side_channels(record))
    channels.push_back(channel(name, record.channel(name).unit, savitzky_golay(record[name], record.dt(), 0, kernel)));
  return Record(record.name(), record.start(), record.dt(), std::move(channels));
}

Eigen::Index Study::rows() const {
  Eigen::Index sum = 0;
  for (const FitData& data : train) sum += data.record.rows();
  return sum;
}

std::string Study::channel(char quantity, int coordinate) const { return model.channel(quantity, coordinate); }

Units Study::units() const { return units_of(full.front(), channel('y', 0), forces.front()); }

std::vector<std::string> Study::outputs() const {
  if (imposed) return {"F"};
  std::vector<std::string> out;
  for (int i = 0; i < degrees(); ++i) out.push_back(channel(measured[0], i));
  return out;
}

std::string Study::reference() const { return measured + "_reference"; }

std::vector<double> Study::weights(const Record& record) const {
  if (degrees() == 1) return {1};
  std::vector<double> out;
  for (const FittedChannel& fitted : fitted_channels(model, record)) out.push_back(fitted.weight);
  return out;
}

namespace {

/// Root mean square of a number of each output and training record, weighted.
double pooled(const Study& study, const std::function<double(const Record&, const std::string&)>& number) {
  double sum = 0;
  Eigen::Index rows = 0;
  const std::vector<std::string> outputs = study.outputs();
  for (const auto& d : study.train) {
    const std::vector<double> weights = study.weights(d.record);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const double s = weights[i] * number(d.record, outputs[i]);
      sum += s * s * static_cast<double>(d.record.rows());
      rows += d.record.rows();
    }
  }
  return std::sqrt(sum / static_cast<double>(rows));
}

}  // namespace

double Study::measured_std() const {
  return pooled(*this, [](const Record& r, const std::string& output) { return standard_deviation(r[output]); });
}

double Study::sensor_noise() const {
  const auto noise = [](const Record& r, const std::string& output) { return r.channel(output).noise; };
  return std::hypot(pooled(*this, noise), motion_noise);
}

Eigen::VectorXd motion_at(const Record& record, const std::optional<Place>& place, char quantity) {
  const auto of = [&](int coordinate) {
    return as_vector(record[place ? quantity + std::to_string(coordinate + 1) : std::string(1, quantity)]);
  };
  if (!place) return of(0);
  if (place->joint()) return of(place->of) - of(place->from);
  return of(place->of);
}

Eigen::VectorXd force_at(const Eigen::VectorXd& forces, Eigen::Index rows, const std::optional<Place>& place) {
  if (!place) return forces;
  if (place->joint()) return 0.5 * (forces.segment(place->of * rows, rows) - forces.segment(place->from * rows, rows));
  return forces.segment(place->of * rows, rows);
}

void smooth_all(Study& study) {
  study.smooth.clear();
  study.force.clear();
  for (const FitData& data : study.train) {
    const SavitzkyGolay kernel = smoothing_kernel(study, data.record);
    study.smooth.push_back(study.imposed ? data.record : smooth_motion(study, data.record, kernel));
    study.force.push_back(force_data(study.smooth.back(), study.imposed ? 0 : edge_of(kernel, slopes_of(study))));
  }
}

Study prepare(const Model& baseline, std::vector<Record> train, std::vector<Record> test,
              const DiscoverOptions& options) {
  if (train.empty()) throw InputError("discover: expected at least one training record, got none", {}, Fault::usage);
  Study study;
  study.options = &options;
  study.most_effects = options.max_effects;
  study.imposed = baseline.imposed_motion;
  study.model = complete(baseline);
  if (!study.imposed) study.forces = study.model.inputs();
  const bool decays = !study.imposed && are_decays(study, train);
  for (auto* list : {&train, &test})
    for (Record& record : *list)
      record = study.imposed
                   ? with_noise_between_jumps(record)
                   : with_known_forces(study, without_wild_rows(record, study.warnings), decays, study.warnings);
  std::vector<Record> kept;
  for (const auto& record : train) {
    check_record(study, record);
    if (!test.empty()) {
      kept.push_back(record);
      continue;
    }
    const auto rows = static_cast<Eigen::Index>(std::floor(static_cast<double>(record.rows()) * (1 - options.holdout)));
    if (rows < least_rows_of_record)
      throw InputError("discover: expected at least " + std::to_string(least_rows_of_record) +
                           " rows in a record without what is held out of it, got " + std::to_string(rows) + " of " +
                           std::to_string(record.rows()) + ": give a longer one, or a test record (--test)",
                       {record.name(), 0, 0}, Fault::data);
    kept.push_back(record.slice(0, rows));
    study.test.push_back(record.slice(rows, record.rows() - rows));
    check_record(study, kept.back());
  }
  if (test.empty())
    study.warnings.push_back("no test record given: the last " +
                             std::to_string(static_cast<int>(std::lround(options.holdout * 100))) +
                             " % of each record is held out, and opened once when the rest has chosen");
  for (const auto& record : test) {
    check_record(study, record);
    study.test.push_back(record);
  }
  if (!study.imposed) choose_output(study, kept);
  for (const auto& record : kept) {
    if (!study.imposed) compare_sensors(study, record, study.warnings);
    warn_of_no_noise(study, record);
    const Record moved = with_shaft(with_motion(study, record));
    for (int i = 0; i < study.degrees(); ++i)
      study.omega = std::max(study.omega, dominant_frequency(moved[study.channel(study.measured[0], i)], moved.dt()));
    study.full.push_back(moved);
    study.train.push_back({study.imposed ? moved : thinned(study, moved), {}, {}});
    const bool joined = study.train.back().record.rows() < moved.rows();
    study.recorded.push_back(joined ? std::make_shared<const Record>(moved) : nullptr);
  }
  smooth_all(study);
  for (auto& record : study.test) record = with_shaft(with_motion(study, record));
  for (const auto& record : study.full) study.guesses.push_back(guess_interpolation(study, record));
  read_force(study, {study.guesses.front()});
  return study;
}

FitData fit_data(const Study& study, const Record& record) {
  return with_force(study, record, between_samples(study, guess_interpolation(study, record)));
}

bool look_alike(const Study& study, const std::vector<Record>& records) {
  return study.imposed || std::ranges::all_of(records, [&](const Record& record) {
           return guess_interpolation(study, record) == study.guesses.front();
         });
}

void read_force(Study& study, BetweenSamples between) {
  study.between = between;
  std::map<std::pair<const Record*, Interpolation>, Excitations> joined;  // pieces share what they were cut from
  for (std::size_t i = 0; i < study.train.size(); ++i) {
    const Record record = study.train[i].record;
    const Record* recorded = study.recorded[i].get();
    const Interpolation interpolation = between_samples(study, study.guesses[i]);
    if (!recorded) {
      study.train[i] = with_force(study, record, interpolation);
      continue;
    }
    Excitations& whole = joined[{recorded, interpolation}];
    if (whole.empty())
      whole = joined_drives(study, *recorded, std::lround(record.dt() / recorded->dt()), interpolation);
    study.train[i] = {record, part_of(whole, record), {}};
  }
}

Study as_recorded(const Study& whole) {
  Study out = whole;
  for (std::size_t i = 0; i < out.train.size(); ++i)
    if (const auto recorded = std::exchange(out.recorded[i], nullptr)) out.train[i].record = *recorded;
  smooth_all(out);
  read_force(out, whole.between);
  return out;
}

double upper_frequency(const Study& study) {
  double highest = 0;
  for (const auto& record : study.smooth) highest = std::max(highest, upper_frequency(study, record));
  return highest;
}

RecordScales scales(const Study& study, double residual_std, const std::optional<Place>& place) {
  RecordScales s{};
  s.y_max = s.shown_max = -INFINITY;
  s.y_min = s.shown_min = INFINITY;
  double force = 0, inertia = 0, rows = 0, y2 = 0, v2 = 0, shown2 = 0;
  const Expr mass = study.model.coordinate(place ? place->of : 0).mass;
  const double known_mass = mass.is_constant() ? mass.value() : 1;
  for (const auto& record : study.smooth) {
    inertia += (known_mass * motion_at(record, place, 'a')).squaredNorm();
    const Eigen::VectorXd y = motion_at(record, place, 'y'), v = motion_at(record, place, 'v');
    s.y_max = std::max(s.y_max, y.maxCoeff());
    s.y_min = std::min(s.y_min, y.minCoeff());
    s.v_max = std::max(s.v_max, v.cwiseAbs().maxCoeff());
    const Eigen::VectorXd shown = motion_at(record, place, study.imposed ? 'y' : study.measured[0]);
    s.shown_max = std::max(s.shown_max, shown.maxCoeff());
    s.shown_min = std::min(s.shown_min, shown.minCoeff());
    shown2 += (shown.array() - shown.mean()).square().sum();
    const auto n = static_cast<double>(y.size());
    y2 += (y.array() - y.mean()).square().sum();
    v2 += v.squaredNorm();
    for (const std::string& name : study.forces) {
      const auto f = as_vector(record[name]);
      force += (f.array() - f.mean()).square().sum();
    }
    rows += n;
  }
  s.y_std = std::sqrt(y2 / rows);
  s.v_std = std::sqrt(v2 / rows);
  s.shown_std = std::sqrt(shown2 / rows);
  s.force_std = std::max(std::sqrt((force > 0 ? force : inertia) / rows), residual_std);
  s.residual_std = residual_std;
  s.omega = study.omega;
  s.stiffness = s.force_std / s.y_std;
  s.interval = study.train.front().record.dt();
  for (const auto& data : study.train) s.duration = std::max(s.duration, data.record.duration());
  return s;
}

ExperimentOptions same_experiment(const Study& study) {
  ExperimentOptions out;
  out.limits.displacement = 0;
  double time = 0, dt = INFINITY;
  for (const auto& data : study.train) {
    for (int i = 0; i < study.degrees(); ++i)
      out.limits.displacement =
          std::max(out.limits.displacement, as_vector(data.record[study.channel('y', i)]).cwiseAbs().maxCoeff());
    for (const std::string& force : study.forces)
      out.limits.force = std::max(out.limits.force, as_vector(data.record[force]).cwiseAbs().maxCoeff());
    time = std::max(time, data.record.duration());
    dt = std::min(dt, data.record.dt());
  }
  const double middle = std::max(study.omega / (2 * M_PI), 5 / time);
  out.rate = 1 / dt;
  out.limits.to = std::min(std::max(2.5 * middle, 2 * upper_frequency(study) / (2 * M_PI)), out.rate / 8);
  out.limits.from = std::min(0.25 * middle, 0.5 * out.limits.to);
  // as long as the record, but with no more rows than a design needs
  constexpr double most_rows = 6000;
  out.duration = std::max(std::min(time, most_rows * dt), 5 / out.limits.from);
  out.measured = study.measured;
  out.units = study.units();
  out.noise = std::max(study.sensor_noise(), 1e-6 * study.measured_std());
  out.seed = study.options->seed;
  out.threads = study.options->threads;
  out.cancelled = study.options->cancelled;
  return out;
}

}  // namespace lunid

#include "discover/experiment.hpp"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "discover/candidate.hpp"
#include "discover/views.hpp"
#include "expr/digits.hpp"
#include "record/parallel.hpp"
#include "simulate/fit.hpp"

namespace lunid {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Parts of the highest level that are tried too: friction is told apart at small motions, stiffness at large ones.
constexpr double level_parts[] = {1, 0.4, 0.15};
constexpr int level_tries = 14;
constexpr double contained = 1e-2;    ///< part of the other way's separation at which a rival holds the other within it
constexpr double least_level = 1e-4;  ///< of the force limit

struct Rival {
  std::shared_ptr<const System> system;
  VectorXd theta;
};

/// What one rival does under one excitation.
struct Answer {
  Record record;  ///< with the drive and its motion, free of noise
  bool completed = false;
  std::string cause;
};

Channel channel(const Units& units, const std::string& name, VectorXd values, double noise, Interpolation between) {
  Channel c;
  c.name = c.source = name;
  c.unit = units.of(name);
  c.values = std::move(values);
  c.noise = noise;
  c.between = between;
  return c;
}

class Designer {
 public:
  Designer(const std::vector<Model>& models, const std::vector<std::string>& names, const ExperimentOptions& options)
      : options_(options), imposed_(models.front().imposed_motion) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i].imposed_motion != imposed_)
        throw InputError("design_experiment: models: expected all with free motion or all with imposed motion");
      rivals_.push_back(compiled(models[i], i));
    }
    base_.dt = 1 / options.rate;
    base_.rows = static_cast<Index>(std::floor(options.duration * options.rate + 1e-6)) + 1;
    base_.from = options.limits.from;
    base_.to = options.limits.to;
    base_.seed = options.seed;
    out_.rivals = names;
    out_.options = options;
  }

  ExperimentDesign run() {
    base_.frequency = frequency_of_largest_answer();
    const std::vector<ExcitationShape> family = excitation_family(base_, imposed_);
    out_.candidates.resize(family.size());
    parallel_for(static_cast<int>(family.size()), options_.threads, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      out_.candidates[k] = judged(family[k]);
    });
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                     [](const auto& a, const auto& b) { return a.separation > b.separation; });
    return std::move(out_);
  }

 private:
  static Rival compiled(const Model& model, std::size_t index) {
    Rival rival;
    rival.system = std::make_shared<const System>(model);
    const std::vector<double> values = rival.system->model().values();
    rival.theta = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
    for (std::size_t j = 0; j < values.size(); ++j)
      if (!std::isfinite(values[j]))
        throw InputError("design_experiment: models: entry " + std::to_string(index + 1) + ": parameter '" +
                         rival.system->model().parameters[j].name + "' has no value; fit the model first");
    return rival;
  }

  double limit_of_drive() const { return imposed_ ? options_.limits.displacement : options_.limits.force; }

  // ---- runs ----
  Record drive(const ExcitationShape& shape, double level) const {
    const VectorXd values = level * shape.values;
    if (!imposed_) return Record(shape.words, 0, base_.dt, {channel(options_.units, "F", values, 0, shape.between)});
    return derive_motion(Record(shape.words, 0, base_.dt, {channel(options_.units, "y", values, 0, shape.between)}));
  }

  Answer answer(const Rival& rival, const Record& driven) const {
    return imposed_ ? force_answer(rival, driven) : motion_answer(rival, driven);
  }

  Answer motion_answer(const Rival& rival, const Record& driven) const {
    const Model& model = rival.system->model();
    SimulateOptions options;
    options.solver = Solver::fixed;  // as rivals are fitted; a stiff solver may take minutes over one of many drives
    options.cancelled = options_.cancelled;
    VectorXd x0 = VectorXd::Zero(rival.system->states());
    for (std::size_t i = 0; i < model.states.size(); ++i)
      x0[2 * model.degrees() + static_cast<Index>(i)] = model.states[i].initial;
    const Run run = simulate(*rival.system, view(rival.theta), excitation_of(driven), x0, options);
    Answer out;
    out.completed = run.summary.completed;
    out.cause = run.summary.cause;
    if (!out.completed) return out;
    std::vector<Channel> channels = driven.channels();
    for (int i = 0; i < model.degrees(); ++i) {
      const auto add = [&](char quantity, VectorXd values) {
        const double noise = options_.measured[0] == quantity ? options_.noise : 0;
        channels.push_back(
            channel(options_.units, model.channel(quantity, i), std::move(values), noise, Interpolation::cubic));
      };
      add('y', shown(*rival.system, view(rival.theta), run, model.channel('y', i)));
      add('v', run.x.col(2 * i + 1));
      add('a', run.a.col(i));
    }
    out.record = Record(driven.name(), 0, base_.dt, std::move(channels));
    return out;
  }

  Answer force_answer(const Rival& rival, const Record& driven) const {
    Answer out;
    VectorXd force = imposed_force(*rival.system, view(rival.theta), driven);
    out.completed = force.allFinite();
    if (!out.completed) out.cause = "the force is not finite along this motion";
    if (out.completed)
      out.record = driven.with(channel(options_.units, "F", std::move(force), options_.noise, Interpolation::cubic));
    return out;
  }

  std::vector<Answer> answers(const Record& driven) const {
    std::vector<Answer> out;
    for (const Rival& rival : rivals_) {
      out.push_back(answer(rival, driven));
      if (!out.back().completed) break;
    }
    return out;
  }

  std::vector<std::string> outputs(const Rival& rival) const {
    if (imposed_) return {"F"};
    std::vector<std::string> names;
    for (int i = 0; i < rival.system->degrees(); ++i) names.push_back(rival.system->model().channel('y', i));
    return names;
  }

  double peak(const std::vector<Answer>& all) const {
    double largest = 0;
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const std::string& name : imposed_ ? std::vector<std::string>{"y"} : outputs(rivals_[k]))
        for (const double y : all[k].record[name]) largest = std::max(largest, std::abs(y));
    return largest;
  }

  /// The highest level at which every rival stays within the limits; 0 where none was found.
  double highest_level(const ExcitationShape& shape, std::string& remark) const {
    double level = limit_of_drive();
    if (imposed_) return level;
    for (int attempt = 0; attempt < level_tries && level > least_level * limit_of_drive(); ++attempt) {
      const std::vector<Answer> all = answers(drive(shape, level));
      if (!all.back().completed) {
        remark = all.back().cause;
        level *= 0.5;
        continue;
      }
      const double reached = peak(all);
      if (reached <= options_.limits.displacement) return level;
      remark = "the motion goes beyond the limit";
      level *= std::clamp(0.97 * options_.limits.displacement / reached, 0.1, 0.97);
    }
    return 0;
  }

  double frequency_of_largest_answer() const {
    const double middle = std::sqrt(base_.from * base_.to);
    std::string remark;
    const ExcitationShape shape = multisine_shape(base_);
    const double level = imposed_ ? 0 : highest_level(shape, remark);
    if (!(level > 0)) return middle;
    const Answer first = answer(rivals_.front(), drive(shape, level));
    const double omega = dominant_frequency(first.record[outputs(rivals_.front()).front()], base_.dt);
    return omega > 0 ? std::clamp(omega / (2 * M_PI), base_.from, base_.to) : middle;
  }

  // ---- separation ----
  /// What rival b leaves of rival a's answer after its best refit; infinite where its run stops.
  double refitted(const Rival& b, const Answer& a, const Record& driven) const {
    FitData data{a.record, {}, {}};
    if (!imposed_) data.excitation = excitation_of(driven);
    FitOptions options;
    options.max_iterations = 30;
    options.tolerance = 1e-4;
    options.cancelled = options_.cancelled;
    for (int i = 0; !imposed_ && i < b.system->degrees(); ++i)
      options.channels.push_back(b.system->model().channel(options_.measured[0], i));
    const FitResult fit = fit_trajectory(*b.system, b.theta, {data}, options);
    if (!std::isfinite(fit.cost)) return INFINITY;
    return std::sqrt(fit.cost / static_cast<double>(std::max<Index>(1, fit.rows))) / options_.noise;
  }

  /// The smaller of the two ways. A rival that holds the other within it follows it anywhere: there simplicity decides,
  /// and the experiment must show the larger one where that is the truth.
  static double separation(const Rival& a, const Rival& b, double b_of_a, double a_of_b) {
    const int more = free_parameters(b.system->model().parameters) - free_parameters(a.system->model().parameters);
    if (more > 0 && b_of_a < contained * a_of_b) return a_of_b;
    if (more < 0 && a_of_b < contained * b_of_a) return b_of_a;
    return std::min(b_of_a, a_of_b);
  }

  ExperimentCandidate judged(const ExcitationShape& shape) const {
    ExperimentCandidate best;
    best.name = shape.name;
    best.words = shape.words;
    const double highest = highest_level(shape, best.remark);
    if (!(highest > 0)) {
      best.excitation = drive(shape, least_level * limit_of_drive());
      return best;
    }
    best.remark.clear();
    best.separation = -1;
    for (const double part : level_parts) {
      ExperimentCandidate c = best;
      c.level = part * highest;
      c.excitation = drive(shape, c.level);
      measure(c);
      if (c.separation > best.separation) best = std::move(c);
    }
    return best;
  }

  void measure(ExperimentCandidate& out) const {
    out.separation = 0;
    out.pairs.clear();
    const std::vector<Answer> all = answers(out.excitation);
    out.remark = all.back().cause;
    if (!all.back().completed) return;
    out.peak = peak(all);
    out.separation = INFINITY;
    for (std::size_t a = 0; a < rivals_.size(); ++a)
      for (std::size_t b = a + 1; b < rivals_.size(); ++b) {
        const double apart = separation(rivals_[a], rivals_[b], refitted(rivals_[b], all[a], out.excitation),
                                        refitted(rivals_[a], all[b], out.excitation));
        if (!std::isfinite(apart)) {  // how far a run that stops is from another says no excitation
          out.separation = 0;
          out.pairs.clear();
          out.remark = "a fit of one rival to the other's motion stops";
          return;
        }
        out.pairs.push_back({static_cast<int>(a), static_cast<int>(b), apart});
        out.separation = std::min(out.separation, apart);
      }
    // The log-likelihoods of a row differ by separation^2/2 in the mean, with a deviation of the separation itself.
    out.expected_z = 0.5 * out.separation * std::sqrt(static_cast<double>(base_.rows));
  }

  const ExperimentOptions& options_;
  bool imposed_;
  std::vector<Rival> rivals_;
  ShapeBase base_;
  ExperimentDesign out_;
};

std::string level_of(const ExperimentDesign& design, const ExperimentCandidate& c) {
  const Units& units = design.options.units;
  const std::string drive = number(c.level, 3) + " " + (c.excitation.has("F") ? units.force : units.y);
  if (!c.excitation.has("F") || !(design.options.limits.force > 0)) return drive;
  return drive + ", motion up to " + number(c.peak, 3) + " " + units.y;
}

}  // namespace

void validate(const ExperimentOptions& o, bool imposed) {
  auto refuse = [](const std::string& field, const std::string& expected, double got) {
    throw InputError("design_experiment: " + field + ": expected " + expected + ", got " + number(got, 3), {},
                     Fault::usage);
  };
  if (!imposed && !(o.limits.force > 0 && std::isfinite(o.limits.force)))
    refuse("limits.force", "> 0 N", o.limits.force);
  if (!(o.limits.displacement > 0) || (imposed && !std::isfinite(o.limits.displacement)))
    refuse("limits.displacement", "> 0 m", o.limits.displacement);
  if (!(o.limits.from > 0)) refuse("limits.frequency", "a lower end > 0 Hz", o.limits.from);
  if (!(o.limits.to > o.limits.from))
    refuse("limits.frequency", "an upper end > " + number(o.limits.from, 3) + " Hz", o.limits.to);
  if (!(o.rate >= 8 * o.limits.to))
    refuse("rate", ">= " + number(8 * o.limits.to, 3) + " Hz, eight rows in a period of limits.frequency[2]", o.rate);
  if (!(o.duration * o.limits.from >= 5))
    refuse("duration", ">= " + number(5 / o.limits.from, 3) + " s, five periods of limits.frequency[1]", o.duration);
  if (o.duration * o.rate > 1e6) refuse("duration", "at most 1e6 rows", o.duration * o.rate);
  if (o.measured != "y" && o.measured != "v" && o.measured != "a")
    throw InputError("design_experiment: measured: expected y, v or a, got '" + o.measured + "'", {}, Fault::usage);
  if (!(o.noise > 0 && std::isfinite(o.noise))) refuse("noise", "> 0", o.noise);
  if (o.threads < 0) refuse("threads", ">= 0", o.threads);
}

ExperimentDesign design_experiment(const std::vector<Model>& rivals, const std::vector<std::string>& names,
                                   const ExperimentOptions& options) {
  if (rivals.size() < 2)
    throw InputError("design_experiment: models: expected at least two rivals, got " + std::to_string(rivals.size()));
  validate(options, rivals.front().imposed_motion);
  return Designer(rivals, names, options).run();
}

std::string sentence_of(const ExperimentDesign& design) {
  if (design.empty()) return {};
  const ExperimentCandidate& best = design.best();
  const std::string what = best.name + " (" + best.words + ", up to " + level_of(design, best) + ", " +
                           number(design.options.duration, 3) + " s)";
  const std::string beyond =
      design.beyond > 1 ? " at " + number(design.beyond, 3) + " times the force and displacement of these records" : "";
  const std::string apart = "predicted separation " + number(best.separation, 3) +
                            " standard deviations of the noise, " + "expected z " + number(best.expected_z, 3);
  if (best.decides()) return what + beyond + " would decide: " + apart;
  constexpr double hardly = 0.1;
  if (best.expected_z < hardly)
    return "no excitation of this family" + beyond +
           " tells them apart: they move alike; what would is another channel, "
           "or a number known beforehand (weigh the mass, calibrate the gauge)";
  return "none within these limits of force, displacement and band" + beyond + " would surely decide; nearest is " +
         what + ": " + apart + ", where 4 is needed";
}

std::string to_terminal(const ExperimentDesign& design) {
  std::string out = "rivals     ";
  for (std::size_t i = 0; i < design.rivals.size(); ++i) out += (i ? " | " : "") + design.rivals[i];
  char line[256];
  const Units& units = design.options.units;
  const std::string force = design.best().excitation.has("F") ? "force [" + units.force + "]" : "";
  std::snprintf(line, sizeof line, "\n%-18s %10s %10s %11s %11s  %s\n", "excitation", "separation", "expected z",
                force.c_str(), ("motion [" + units.y + "]").c_str(), "what");
  out += line;
  for (const auto& c : design.candidates) {
    if (!c.remark.empty() && c.pairs.empty()) {
      std::snprintf(line, sizeof line, "%-18s not run: %s\n", c.name.c_str(), c.remark.c_str());
    } else {
      const std::string force = c.excitation.has("F") ? number(c.level, 3) : "";
      std::snprintf(line, sizeof line, "%-18s %10.3g %10.3g %11s %11.3g  %s\n", c.name.c_str(), c.separation,
                    c.expected_z, force.c_str(), c.peak, c.words.c_str());
    }
    out += line;
  }
  return out + "decides    " + sentence_of(design) + "\n";
}

}  // namespace lunid

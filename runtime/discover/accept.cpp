#include "discover/accept.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "discover/views.hpp"
#include "expr/digits.hpp"
#include "expr/joined.hpp"
#include "expr/words.hpp"
#include "record/columns.hpp"
#include "record/motion.hpp"
#include "record/spectra.hpp"
#include "record/spectrum.hpp"
#include "record/treat.hpp"

namespace lunid {

namespace {

/// "displacement", with several coordinates "displacement y2".
std::string words_of(const std::string& channel) {
  const std::string words = channel[0] == 'y' ? "displacement" : channel[0] == 'v' ? "velocity" : "acceleration";
  return channel.size() > 1 ? words + " " + channel : words;
}

/// A coordinate of several whose velocity or acceleration stands in the record.
bool has_motion_of(const Record& record, const std::string& y) {
  return y[0] == 'y' && y.size() > 1 && (record.has("v" + y.substr(1)) || record.has("a" + y.substr(1)));
}

/// A force that is predicted from the motion needs all of it: an integral has lost its slow part.
void refuse_integrated(const Record& record, const SourceSpan& where) {
  if (measured_channel(record) == "y") return;
  throw InputError("discover: imposed motion: the displacement is known from the " +
                       words_of(measured_channel(record)) +
                       " alone: its slow part is lost, and the force needs it; record y too",
                   where, Fault::data);
}

/// What stands behind y, v or a in the name of a coordinate's channels.
std::string suffix_of(const Study& study, int coordinate) { return study.channel('y', coordinate).substr(1); }

/// What all records hold of the motion of all coordinates; those that hold something else are named.
std::string measured_in(const Study& study, const std::vector<const Record*>& records) {
  const std::string first = measured_channel(*records.front(), suffix_of(study, 0));
  for (const Record* record : records)
    for (int i = 0; i < study.degrees(); ++i)
      if (const std::string own = measured_channel(*record, suffix_of(study, i)); own[0] != first[0])
        throw InputError(record == records.front()
                             ? "discover: expected one quantity of the motion at all coordinates, got " + first +
                                   " and " + own +
                                   ": leave one out or give it another name, and take y, v or a throughout"
                             : "discover: expected all records to measure one channel of the motion, got " + first +
                                   " in " + records.front()->name() + " and " + own + " here",
                         {record->name(), 0, 0}, Fault::data);
  return first.substr(0, 1);
}

/// The lowest frequency [Hz] above which the integrals of what was measured hold little noise, from two periods in the
/// record up to a third of the motion's own frequency; 0 where y was measured.
double slow_limit(const Record& record, const std::string& measured) {
  if (measured[0] == 'y') return 0;
  constexpr double tolerable = 0.02;  // of the displacement
  const double most = dominant_frequency(record[measured], record.dt()) / (2 * M_PI) / 3;
  double below = 2 / record.duration();
  for (; below < most; below *= 1.5) {
    const Record moved = integrate(record, {measured, 1, below});
    const std::string y = "y" + measured.substr(1);
    if (moved.channel(y).noise < tolerable * standard_deviation(moved[y])) break;
  }
  return std::min(below, std::max(most, 2 / record.duration()));
}

void check_moves(const Record& record, const std::string& measured, const SourceSpan& where) {
  const auto motion = record[measured];
  const auto [low, high] = std::minmax_element(motion.begin(), motion.end());
  if (!(*high > *low))
    throw InputError("discover: the " + words_of(measured) + " is constant (" + number(*low) + " " +
                         units_of(record, "y" + measured.substr(1)).of(measured) +
                         " in every row); nothing can be learned from a record without motion",
                     where, Fault::data);
}

Channel no_force(const std::string& name, const Record& record) {
  Channel force;
  force.name = force.source = name;
  force.unit = unit_of_force(record);
  force.values = Eigen::VectorXd::Zero(record.rows());
  return force;
}

/// To half from the first quarter to the last, or by a tenth and never up from one part to the next, eight or fewer of
/// two whole periods and more.
bool falls(std::span<const double> y, double dt) {
  constexpr double periods = 2, fewest = 3, most = 8;
  const std::size_t quarter = y.size() / 4;
  const double first = standard_deviation(y.first(quarter)), last = standard_deviation(y.last(quarter));
  if (last < 0.5 * first) return true;
  const double period = 2 * M_PI / dominant_frequency(y, dt) / dt, all = static_cast<double>(y.size()) / period;
  const double own = std::floor(all / std::clamp(std::floor(all / periods), fewest, most));
  if (!(own >= 1)) return false;
  const auto part = static_cast<std::size_t>(std::lround(own * period));
  double before = INFINITY;
  for (std::size_t at = 0; at + part <= y.size(); at += part) {
    const double now = standard_deviation(y.subspan(at, part));
    if (!(now < before)) return false;
    before = now;
  }
  return last < 0.9 * first;
}

bool dies_away(const Study& study, const Record& record) {
  if (record.rows() < 30) return false;
  for (int i = 0; i < study.degrees(); ++i) {
    const std::string channel = measured_channel(record, suffix_of(study, i));
    if (!record.has(channel)) return false;
    if (!falls(record[channel], record.dt())) return false;
  }
  return true;
}

bool has_force(const Study& study, const Record& record) {
  const auto shown = [&](const std::string& force) { return record.has(force); };
  return record.has("F") || std::ranges::any_of(study.forces, shown);
}

/// A record without a force is that of a free decay where its motion dies away or `decays`; any other is returned as it
/// is.
Record with_force_of_decay(const Study& study, const Record& record, bool decays, std::vector<std::string>& warnings) {
  if (has_force(study, record)) return record;
  const bool dies = dies_away(study, record);
  if (!dies && !decays) return record;
  warnings.push_back(record.name() + " has no force and " +
                     (dies ? "its motion dies away" : "the training records are free decays") +
                     ": taken for a free decay, F = 0");
  Record out = record;
  for (const std::string& force : study.forces) out = out.with(no_force(force, record));
  return out;
}

/// The largest difference within half a period of a motion from a row on: three rows of it.
double swing(std::span<const double> x, Eigen::Index first, Eigen::Index half) {
  const auto at = [&](Eigen::Index row) { return x[static_cast<std::size_t>(std::min(row, std::ssize(x) - 1))]; };
  const double a = at(first), b = at(first + half / 2), c = at(first + half);
  return std::max({std::abs(a - b), std::abs(b - c), std::abs(a - c)});
}

/// A free decay without what follows when it swings no more, but for a period: rows that hold nothing but the sensor's
/// noise would choose how the motion is smoothed, and a fit of the place of rest; and what creeps on there (friction
/// that is no more than steep at rest) is told of by no entry.
Record until_rest(const Study& study, const Record& record, std::vector<std::string>& warnings) {
  constexpr double deviations = 7, small = 0.01, worth_it = 0.8;
  constexpr Eigen::Index least = 60;
  if (!is_free(study, record)) return record;
  Eigen::Index moves = least, half = 1;
  for (int i = 0; i < study.degrees(); ++i) {
    const std::string channel = measured_channel(record, suffix_of(study, i));
    if (!record.has(channel)) return record;
    const auto x = record[channel];
    const double omega = dominant_frequency(x, record.dt());
    if (!(omega > 0)) return record;
    const auto own = std::max<Eigen::Index>(1, std::lround(M_PI / omega / record.dt()));
    double most = 0;
    for (Eigen::Index row = 0; row < std::ssize(x); ++row) most = std::max(most, swing(x, row, own));
    const double level = std::max(deviations * record.channel(channel).noise, small * most);
    Eigen::Index last = std::ssize(x);
    while (last > moves && !(swing(x, last - 1, own) > level)) --last;
    moves = std::max(moves, last);
    half = std::max(half, own);
  }
  const Eigen::Index kept = moves + 2 * half;
  if (!(static_cast<double>(kept) < worth_it * static_cast<double>(record.rows()))) return record;
  char text[120];
  std::snprintf(text, sizeof text, ": a free decay at rest from t = %.4g s on: rows after %.4g s are left out",
                record.start() + record.dt() * static_cast<double>(moves - 1),
                record.start() + record.dt() * static_cast<double>(kept - 1));
  warnings.push_back(record.name() + text);
  return record.slice(0, kept);
}

/// With several coordinates: F is the force of the one that is driven, and a driven coordinate whose force the record
/// does not hold has none, where it holds that of another.
Record with_all_forces(const Study& study, const Record& record, std::vector<std::string>& warnings) {
  if (study.degrees() == 1) return record;
  const auto& forces = study.forces;
  const auto shown = [&](const std::string& force) { return record.has(force); };
  Record out = record;
  if (std::none_of(forces.begin(), forces.end(), shown)) {
    if (!record.has("F")) return record;
    if (forces.size() > 1)
      throw InputError("discover: the record has one force F, and the model is driven at " +
                           std::to_string(forces.size()) + " coordinates: name the column " + forces.front() +
                           " or another of them, or give the model forces = { 1 }",
                       {record.name(), 0, 0}, Fault::data);
    Channel force = of_window(record, "F");
    force.name = forces.front();
    return out.with(std::move(force));
  }
  for (const std::string& force : forces) {
    if (record.has(force)) continue;
    warnings.push_back(record.name() + " has no " + force + ": taken for 0");
    out = out.with(no_force(force, record));
  }
  return out;
}

/// At the same times.
bool have_rows_in_common(const Record& a, const Record& b) {
  if (a.dt() > b.dt()) return have_rows_in_common(b, a);
  constexpr Eigen::Index enough = 20;  // that measured values are alike by chance
  const double ratio = b.dt() / a.dt(), first = std::max(a.start(), b.start()),
               row_b = std::ceil((first - b.start()) / b.dt() - 0.01),
               row_a = (b.start() + row_b * b.dt() - a.start()) / a.dt();
  const auto step = static_cast<Eigen::Index>(std::lround(ratio)),
             from_a = static_cast<Eigen::Index>(std::lround(row_a)), from_b = static_cast<Eigen::Index>(row_b);
  const Eigen::Index rows = std::min((a.rows() - from_a + step - 1) / step, b.rows() - from_b);
  const bool aligned = std::abs(row_a - static_cast<double>(from_a)) < 0.01;
  if (std::abs(ratio - static_cast<double>(step)) > 1e-9 * ratio || !aligned || rows < enough) return false;
  bool moves = false;
  for (const Channel& channel : a.channels()) {
    if (channel.derived) continue;  // of every second row others
    if (!b.has(channel.name)) return false;
    const auto own = as_vector(a[channel.name])(Eigen::seqN(from_a, rows, step));
    if (own != as_vector(b[channel.name]).segment(from_b, rows)) return false;
    moves = moves || (own.array() != own[0]).any();
  }
  return moves;
}

}  // namespace

bool is_free(const Study& study, const Record& record) {
  return std::all_of(study.forces.begin(), study.forces.end(), [&](const std::string& force) {
    return record.has(force) && std::ranges::all_of(record[force], [](double f) { return f == 0; });
  });
}

Record without_wild_rows(const Record& record, std::vector<std::string>& warnings) {
  Record out = record;
  bool any = false;
  for (const Channel& known : record.channels()) {
    const std::string& name = known.name;
    if (known.derived || (name[0] != 'y' && name[0] != 'v') || name.ends_with("_reference")) continue;
    const std::vector<WildRow> wild = wild_rows(record[name]);
    if (wild.empty()) continue;
    any = true;
    Channel channel = of_window(record, name);
    for (const auto& [row, value] : wild) channel.values[row] = value;
    channel.noise = noise_level(view(channel.values));
    out = out.with(channel);
    warnings.push_back(record.name() + ": " + std::to_string(wild.size()) +
                       (wild.size() == 1 ? " row of " : " single rows of ") + name +
                       " off all neighbours, first at t = " + number(record.time(wild.front().row)) +
                       " s: taken for wild points and for what the neighbours say");
  }
  return any ? derive_motion_anew(out) : record;
}

void compare_sensors(const Study& study, const Record& record, std::vector<std::string>& warnings) {
  constexpr double alike = 0.03, least_correlation = 0.9;
  const std::string quantities = "yva";
  const auto first = quantities.find(study.measured[0]);
  for (int i = 0; i < study.degrees(); ++i)
    for (std::size_t other = first + 1; other < quantities.size(); ++other) {
      const std::string lower = study.channel(quantities[first], i), upper = study.channel(quantities[other], i);
      if (!record.has(lower) || !record.has(upper) || record.channel(upper).derived) continue;
      const int order = static_cast<int>(other - first);
      const SavitzkyGolay kernel = choose_savitzky_golay(record[lower], record.channel(lower).noise, order);
      const Eigen::Index edge = kernel.half_width, rows = record.rows() - 2 * edge;
      if (rows < 30) continue;
      const Eigen::VectorXd slope = savitzky_golay(record[lower], record.dt(), order, kernel).segment(edge, rows),
                            shown = savitzky_golay(record[upper], record.dt(), 0, kernel).segment(edge, rows);
      const double both = slope.dot(shown), own = slope.squaredNorm(), others = shown.squaredNorm();
      if (!(std::abs(both) > least_correlation * std::sqrt(own * others))) continue;
      // The noise of either makes one of the two regressions too flat: the ratio is between them.
      const auto [low, high] = std::minmax({both / own, others / both});
      if (high > 1 - alike && low < 1 + alike) continue;
      warnings.push_back(record.name() + ": " + upper + " is " + number(low, 3) + " to " + number(high, 3) +
                         " times the " + (order == 2 ? "second " : "") + "derivative of " + lower +
                         ": the gain of one of the sensors is off, or a unit. The fits are of " + lower + " alone");
    }
}

bool warn_of_known_rows(const std::vector<Record>& train, const std::vector<Record>& test,
                        std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < train.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (have_rows_in_common(train[j], train[i]))
        warnings.push_back("the training record " + train[i].name() + " holds rows of the training record " +
                           train[j].name() + ": they count twice, and deviations come out too small. Give them once");
  bool any = false;
  for (const Record& record : test)
    for (const Record& known : train)
      if (have_rows_in_common(known, record)) {
        any = true;
        warnings.push_back("the test record " + record.name() + " holds rows of the training record " + known.name() +
                           ": it confirms nothing. Give another record, or windows that do not overlap; without a test "
                           "the last part of each record is held out");
      }
  return any;
}

bool are_free(const Study& study, const std::vector<Record>& records) {
  return std::ranges::all_of(records, [&](const Record& record) { return is_free(study, record); });
}

namespace {

bool is_free_to_name(const Channel& channel) {
  return !channel.derived && !is_channel_name(channel.name) && !channel.name.ends_with("_reference");
}

/// As --columns names the channel's column; what is no column of the file has its own name.
std::string header_of(const Channel& channel) {
  return channel.source.empty() ? channel.name : parse_column(channel.name, channel.source).header;
}

/// "y=Y" of a channel Y, and "y=y mm [mm]" of a column `y mm` or `y_mm`; "" of others.
std::string alike_in_name(const Channel& channel, const std::string& missing) {
  const std::string name = lower_case(channel.name);
  if (name == lower_case(missing) || (missing == "y" && name == "x")) return missing + "=" + header_of(channel);
  const std::string rest = name.starts_with(lower_case(missing)) ? channel.name.substr(missing.size()) : "";
  if (rest.size() < 2 || (rest[0] != ' ' && rest[0] != '_') || !si_unit(rest.substr(1))) return "";
  return missing + "=" + header_of(channel) + " [" + rest.substr(1) + "]";
}

/// "a=head" where one column alone may be the motion that is missing, or the force, by its name or unit; else "y=header
/// [unit]".
std::string column_for(const Record& record, const std::string& missing) {
  std::string found;
  if (missing.size() == 1)
    for (const Channel& channel : record.channels())
      if (const std::string named = is_free_to_name(channel) ? alike_in_name(channel, missing) : ""; !named.empty())
        return named;
  for (const Channel& channel : record.channels()) {
    const char quantity = channel_of_unit(channel.unit);
    const bool alike = quantity && (missing[0] == 'F') == (quantity == 'F');
    if (missing.size() > 1 || !alike || !is_free_to_name(channel)) continue;
    if (!found.empty()) return missing + "=header [unit]";
    found = quantity + ("=" + header_of(channel));
  }
  return found.empty() ? missing + "=header [unit]" : found;
}

/// The motions of several coordinates that are missing, as the quantity that is measured at others, and columns for
/// them: those that are in its unit, where there are as many.
struct MissingMotions {
  std::vector<std::string> names;
  std::string columns;
};

MissingMotions missing_motions(const Record& record, std::vector<std::string> names) {
  std::vector<const Channel*> free;
  char quantity = 0;
  for (const Channel& channel : record.channels()) {
    const bool numbered = channel.name.size() > 1 && std::isdigit(static_cast<unsigned char>(channel.name[1]));
    if (!channel.derived && numbered && std::string_view("yva").find(channel.name[0]) != std::string_view::npos)
      quantity = channel.name[0];
  }
  for (const Channel& channel : record.channels()) {
    const char own = channel_of_unit(channel.unit);
    if (!is_free_to_name(channel) || own == 0 || own == 'F' || (quantity && own != quantity)) continue;
    if (!quantity) quantity = own;
    free.push_back(&channel);
  }
  MissingMotions out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (quantity) names[i][0] = quantity;
    append_item(out.columns,
                names[i] + "=" + (free.size() == names.size() ? header_of(*free[i]) : std::string("header [unit]")));
  }
  out.names = std::move(names);
  return out;
}

/// What a record lacks, what it has instead, and what to do.
std::string words_of_missing(const Study& study, const Record& record, std::vector<std::string> missing) {
  const bool of_several = missing.front()[0] == 'y' && study.degrees() > 1;
  std::string names, columns, has;
  if (of_several) {
    const auto forces = std::ranges::find(missing, 'F', [](const std::string& name) { return name[0]; });
    MissingMotions motions = missing_motions(record, {missing.begin(), forces});
    std::ranges::move(motions.names, missing.begin());
    columns = motions.columns;
  }
  for (const std::string& name : missing) {
    names += (names.empty() ? "'" : ", '") + name + "'";
    if (!of_several || name[0] == 'F') append_item(columns, column_for(record, name));
  }
  for (const Channel& channel : record.channels()) append_item(has, channel.name);
  const std::string what =
      std::string("the record has no channel") + (missing.size() > 1 ? "s " : " ") + names + " (it has " + has + "); ";
  if (of_several)
    return what + "the motion of every coordinate of the model has to be measured: name its column, e.g. --columns \"" +
           columns + "\" (in a study columns = \"...\"), or take a model without it";
  const bool drives = missing.front()[0] == 'F',
             shaken = drives && (record.has("yb") || record.has("vb") || record.has("ab"));
  return what + "name its column, e.g. --columns \"" + columns + "\" (in a study columns = \"...\")" +
         (drives && !shaken ? ", or say F=0 there where nothing drives it" : "") +
         (shaken ? "; where the base drives, the baseline holds differences to it, as k*(y - yb) + c*(v - vb), or m*ab"
                 : "");
}

}  // namespace

void check_record(const Study& study, const Record& record) {
  const SourceSpan where{record.name(), 0, 0};
  if (record.rows() < least_rows_of_record)
    throw InputError("discover: expected at least " + std::to_string(least_rows_of_record) + " rows in a record, got " +
                         std::to_string(record.rows()) +
                         "; a motion of a few periods is needed to tell one effect from another",
                     where, Fault::data);
  std::vector<std::string> needed;
  for (int i = 0; i < study.degrees(); ++i) needed.push_back(study.channel('y', i));
  needed.insert(needed.end(), study.forces.begin(), study.forces.end());
  std::erase_if(needed, [&](const std::string& name) { return record.has(name) || has_motion_of(record, name); });
  if (!needed.empty()) throw InputError("discover: " + words_of_missing(study, record, needed), where, Fault::data);
  if (study.imposed) refuse_integrated(record, where);
  for (int i = 0; i < study.degrees(); ++i) check_moves(record, measured_channel(record, suffix_of(study, i)), where);
  const auto f = record[study.forces.front()];
  const auto [least, most] = std::minmax_element(f.begin(), f.end());
  if (study.imposed && !(*most > *least))
    throw InputError("discover: imposed motion: the force is constant; it is what the model has to predict", where,
                     Fault::data);
}

Record with_known_forces(const Study& study, const Record& record, bool decays, std::vector<std::string>& warnings) {
  const Record driven = with_all_forces(study, with_force_of_decay(study, record, decays, warnings), warnings);
  return until_rest(study, driven, warnings);
}

bool are_decays(const Study& study, const std::vector<Record>& records) {
  return std::ranges::all_of(
      records, [&](const Record& record) { return !has_force(study, record) && dies_away(study, record); });
}

void choose_output(Study& study, const std::vector<Record>& train) {
  std::vector<const Record*> all;
  for (const Record& record : train) all.push_back(&record);
  for (const Record& record : study.test) all.push_back(&record);
  study.measured = measured_in(study, all);
  for (const Record& record : train)
    for (const std::string& output : study.outputs()) study.slow = std::max(study.slow, slow_limit(record, output));
  if (study.measured == "y") return;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "the records hold the %s alone: free runs are held against it; y is its integral without what lies below "
      "%.3g Hz, and serves for first guesses and figures",
      words_of(study.measured).c_str(), study.slow);
  study.warnings.emplace_back(text);
}

}  // namespace lunid

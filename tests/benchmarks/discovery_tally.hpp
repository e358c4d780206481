#pragma once
// What `lunid discover` answered, against the truth, and how often it was what.
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "discovery_settings.hpp"

namespace matrix {

/// Named first; in the equivalence class: in a tie with what was named that is said, or equal to it on this record;
/// wrong: another name; silent: no name. Where no name is right (nothing missing, outside the catalogue) `first` is
/// the right verdict, `silent` the other one. Of a tie: `first` is the verdict ambiguous with the truth and a rival
/// that equals it in the class, `in_class` another tie that is said, `wrong` one name alone, be it the truth.
enum class Answer { first, in_class, wrong, silent, failed };
constexpr int answers = 5;
const char* to_string(Answer);

struct Outcome {
  std::string verdict = "failed", named;
  bool right = false, tie = false, equivalent = false;
  bool physics = false;  ///< of a fault: physics was named first, without a word of the fault
  bool some = false;     ///< all that was named is there, and not all that is there was named
  bool tells = false;    ///< of a tie: this record tells the rivals from the truth, so that nothing is asked
  double share = NAN;    ///< rms of the hidden force over that of the restoring force
  int class_size = 0;
  int parameters = 0, inside = 0;
  double worst = 0;  ///< error of the worst parameter in its stated standard deviations
  double before = NAN, after = NAN, floor = NAN, seconds = 0;  ///< gaps on the test record; floor: as stated
  double noise = NAN;  ///< the gap of a run of the truth: the noise that was put on the test record
  int rows = 0;        ///< of the test record, as many as hold noise of their own: fewer where it is coloured

  Answer answer() const;
};

/// A field of a JSON object; NaN where it is no number.
double number(const nlohmann::json& object, const char* field);

Outcome judge(const Setting& setting, const nlohmann::json& discovery);
/// An outcome as it is kept for a run that goes on, and back; NaN is null there.
nlohmann::json kept(const Outcome& outcome);
Outcome outcome_of(const nlohmann::json& kept);
/// Of a tie, with the rivals that a fit of the benchmark found to be no other than the truth on this record.
void judge_tie(const Setting& setting, const nlohmann::json& discovery, const std::vector<std::string>& equals,
               Outcome& outcome);

/// Share of the gap that was closed, of what the noise allows: (before - after)/(before - noise), gaps above 1 as 1,
/// in plain gaps as the report says it, with the noise that the benchmark knows in place of the floor that the program
/// states. NaN where the baseline is no further from the noise than chance: nothing is to be closed there.
double closure(const Outcome& outcome);
/// Three deviations, as a part of the floor, by which a gap over so many rows may lie below a floor estimated from as
/// many: each is an rms of n values, known to 1/sqrt(2 n). One run in 700.
double chance(int rows);
double median(std::vector<double> values);
/// Upper 95 % limit of a rate of which `count` of `all` were seen (Clopper and Pearson 1934).
double upper_limit(int count, int all);

/// Answers of one kind, and the closures of their runs.
struct Counts {
  int of[answers] = {};
  std::vector<double> closures;
  int all() const;
  int good() const { return of[0] + of[1]; }  ///< first or in the class
};

class Tally {
 public:
  void add(const Setting& setting, const Outcome& outcome);
  /// All is as it should be.
  bool clean() const;
  /// Final gaps that lie below the stated floor by more than chance.
  int below_floor() const { return below_floor_; }
  /// The tables, and the contract's last line.
  void print(const std::string& alpha) const;

 private:
  void print_table() const;
  void print_gaps() const;
  void print_notes(const std::string& alpha) const;

  std::map<std::string, Counts> entries_;                                   // by the name of the setting
  std::map<std::string, std::map<double, Counts, std::greater<>>> levels_;  // by kind and noise
  std::map<std::string, Counts> excitations_;                               // of one hidden effect
  Counts kinds_[truth::kinds], faults_;
  std::vector<double> closures_, closures_of_named_;
  int physics_ = 0, false_names_ = 0, tells_ = 0;
  int parameters_ = 0, inside_ = 0, closed_ = 0, closable_ = 0, wild_ = 0;
  int classes_ = 0, members_ = 0;
  int gaps_ = 0, below_floor_ = 0, below_noise_ = 0;
  double longest_ = 0;
};

}  // namespace matrix

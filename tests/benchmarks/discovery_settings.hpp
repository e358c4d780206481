#pragma once
// What the matrix runs: a case or a fault of tests/truth, at a scale, under an excitation, at a level of noise.
#include <cstdint>
#include <string>
#include <vector>

#include "truth/faults.hpp"
#include "truth/truth.hpp"

namespace matrix {

struct Setting {
  const truth::Case* which;   ///< or
  const truth::Fault* fault;  ///< of a sensor or of the input; the other of the two is null
  const truth::Scale* scale;
  truth::RecordOptions options;
  std::string kind;  ///< of a null, beside its case
  bool mass_known = true;
  int repeat = 0;  ///< which of `--seeds`

  bool is(truth::Kind wanted) const { return which && which->kind == wanted; }
  std::string name() const { return fault ? "fault " + fault->name : which->name; }
  /// CASE-SCALE-EXCITATION-DB, of a fault fault_NAME-..., of a further seed ...-sN
  std::string folder() const;
  /// The restoring force that the study knows, with the number of k where it knows that.
  std::string baseline() const;
};

struct Plan {
  bool full = false, brief = false, check = false, resume = false;
  int nulls = 0, rows = 6400, draw = 0, seeds = 1;
  std::uint64_t seed = 1;
  std::string only, alpha = "0.01";
};

std::vector<Setting> settings(const Plan& plan);

}  // namespace matrix

#pragma once
// Records whose physics is known and whose sensors or input are at fault: the motion of tests/truth at eight times the
// rate, a fault put on it there, then samples and noise.
#include <string>
#include <vector>

#include "truth/truth.hpp"

namespace truth {

/// What is wrong, dimensionless: lengths in the rms of the training motion, times in radians of the oscillator.
struct Fault {
  std::string name, effect;  ///< of the case; of the catalogue's entry
  std::string baseline = "k*y + c*v";
  bool stiffness_known = false;  ///< the baseline's k is its true value, as a number
  Physics physics;
  double lag_y = 0, lag_force = 0;
  double delay = 0;              ///< of what acts behind the force's channel
  double offset = 0, trend = 0;  ///< trend: over the whole record
  double gain_y = 1, gain_force = 1;
  double clip_above = 0, clip_below = 0;  ///< 0: none
  double harmonic = 0;                    ///< a part of the force that its channel lacks, over the rest's lines
  double unbalance = 0;                   ///< a shaft that runs up through the resonance, with its speed as a channel
  double base = 0;                        ///< acceleration of the support, with its channel
  bool in_decay = false;                  ///< a free decay shows it
};
const std::vector<Fault>& faults();
const Fault& fault_named(const std::string& name);

struct FaultyColumns {
  Columns columns;
  std::string extra_name, extra_unit;  ///< a further channel; "" where there is none
  std::vector<double> extra;
};
struct FaultyRecords {
  FaultyColumns train, test;
  std::vector<FaultyColumns> more;  ///< further training records
  std::string baseline;
};
/// Excited as those of make_records(). A decay only where it shows the fault.
FaultyRecords make_faulty(const Fault& fault, const Scale& scale, const RecordOptions& options = {});

void write_csv(const FaultyColumns& record, const std::string& path);

}  // namespace truth

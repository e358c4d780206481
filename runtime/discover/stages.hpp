#pragma once
// The stages of discovery one by one: where the misfit is, which entries would lower it, how given sets compare.
#include "discover/discover.hpp"
#include "discover/residual_maps.hpp"

namespace lunid {

/// A baseline, fitted to the records, and where it fails.
struct Located {
  Model baseline;     ///< fitted
  double gap = 0;     ///< of its fit on these records
  std::string place;  ///< with several coordinates: what the maps' y is, "y2" or "y1 - y2"
  ResidualRows rows;
  ResidualMaps maps;
  std::vector<std::string> warnings;
};
/// Fits the baseline and maps the force that it leaves. `options.holdout` is not used: all rows are. `place`: with
/// several coordinates where to look, "y2" or "y1 - y2"; empty: where generic forces see most. Throws InputError as
/// discover() does.
Located locate(const Model& baseline, const std::vector<Record>& records, const DiscoverOptions& options = {},
               const std::string& place = "");

/// An entry held against the baseline's residual to first order.
struct Proposal {
  std::string name;  ///< with several coordinates its place too: "cubic_stiffness in y1 - y2"
  int variant = 0;
  double gain = 0;        ///< relative drop of the whitened residual's rms beside what the baseline itself can do
  double force_gain = 0;  ///< the same of the smoothed force
  double p_value = 1;     ///< F-test of the gain, not corrected for the number of entries
  std::string remark;     ///< why it has no gain
  std::vector<Parameter> parameters;  ///< first guesses, under the entry's own names
};
struct Proposed {
  Model baseline;
  double gap = 0;
  std::vector<Proposal> proposals;  ///< best first, by the larger of both gains; an entry's best variant
  std::vector<std::string> warnings;
};
/// Each entry's first guess is read off the force; its effect on the trajectory (exact sensitivities) is projected
/// orthogonal to what the baseline's parameters and first states can do.
Proposed propose(const Model& baseline, const std::vector<Effect>& catalogue, const std::vector<Record>& records,
                 const DiscoverOptions& options = {});

/// A set of effects refitted with the baseline on the trajectory.
struct Ranked {
  std::string name;  ///< "coulomb_friction + constant_force"; "baseline" for none
  double gap = 0;    ///< of the fit, training rows
  double left_out_gap = 0, log_likelihood = 0, bic = 0;
  double p_value = 1;  ///< that it is no better than the baseline (F-test), not corrected
  double z = 0;        ///< Vuong's, of the likeliest against it; > 2.3: told from it; NaN of sets that hold it and more
  std::string remark;
  Model model;  ///< fitted
};
/// The baseline and each set, best left-out gap first; the likelihood has the colour of the best fit's residual.
/// `sets`: names of entries of the catalogue, "cubic_stiffness at y2" of one place of several; without the place that
/// entry at each of them.
std::vector<Ranked> rank_sets(const Model& baseline, const std::vector<Effect>& catalogue,
                              const std::vector<std::vector<std::string>>& sets, const std::vector<Record>& records,
                              const DiscoverOptions& options = {});

}  // namespace lunid

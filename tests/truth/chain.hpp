#pragma once
// Several masses with links between them and to the ground, dimensionless as the oscillator is, and an integrator of
// their own: RK4 with a very small fixed step, dry friction by modes (which way it slides, whether it sticks), the end
// of a mode found by bisection.
#include <functional>
#include <string>
#include <vector>

#include "truth/truth.hpp"

namespace truth {

/// What acts between two masses, or between a mass and the ground (from = -1), on u = x_of - x_from. Zero: absent.
struct Link {
  int of = 0, from = -1;
  double k = 0, c = 0;
  double k3 = 0;                      ///< cubic stiffness
  double coulomb = 0;                 ///< dry friction, sticking included
  double drag = 0;                    ///< drag |w| w
  double stop_k = 0, stop_gap = 0;    ///< stop_k * max(u - stop_gap, 0)
  double maxwell_k = 0, maxwell = 0;  ///< s, s' = maxwell_k w - s / maxwell
  double bouc_k = 0, bouc_yield = 1;  ///< bouc_k z, z' = w - |z / yield| (0.5 |w| sign z + 0.5 w)
  std::function<double(double u, double w)> other;
};

struct Chain {
  std::vector<double> masses;
  std::vector<Link> links;
  std::vector<int> driven = {0};  ///< masses that a force acts on
};
/// Masses in a row, link i between mass i - 1 and mass i; the ground before the first, and behind the last where there
/// is one more link than masses.
Chain in_a_row(std::vector<double> masses, double k, double c, bool both_ends = false);

struct ChainMotion {
  std::vector<std::vector<double>> x, F;  ///< of each mass, of each driven mass
  double stuck = 0;                       ///< part of the time in which a friction sticks
};
/// From rest under `level` times a signal for each driven mass: after `early` rows, `rows` samples `spacing` apart.
ChainMotion integrate(const Chain& chain, const std::vector<Signal>& signals, double level, int early, int rows,
                      double spacing, int substeps);

/// A chain with something hidden: the study knows links of one k and c.
struct ChainCase {
  std::string name;
  Chain chain;
  std::vector<std::string> hidden;  ///< "cubic_stiffness in y1 - y2"; none: nothing is
  bool outside = false;             ///< of no entry of the catalogue
};
const std::vector<ChainCase>& chain_cases();
/// Throws std::invalid_argument for a name that there is not.
const ChainCase& chain_case(const std::string& name);

struct ChainColumns {
  std::vector<double> t;
  std::vector<std::vector<double>> F;  ///< of each driven mass
  std::vector<std::vector<double>> y;  ///< of each mass
  double stuck_share = 0;              ///< of the time
};
struct ChainRecords {
  ChainColumns train, test;
};
/// Train: a multisine that moves the masses with an rms of one length of the scale in the mean. Test: a swept sine,
/// 0.8 of that. Both from a motion that has run for a while.
ChainRecords make_chain_records(const Chain& chain, const Scale& scale, const RecordOptions& options = {});

/// t, the forces F1 ..., and y1 ...
void write_csv(const ChainColumns& record, const Chain& chain, const std::string& path);

}  // namespace truth

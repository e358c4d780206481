#pragma once
// Searches in a box for the parameters inside features: what may be chosen.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lunid {

/// Local methods start from several places; global ones end with a local descent (SLSQP) from their best point.
///   slsqp, lbfgs: NLopt's local methods with the exact gradient (Kraft 1994; Nocedal 1980)
///   mlsl: multi-level single linkage over a low-discrepancy sequence (Kucherenko & Sytsko 2005)
///   direct: dividing rectangles, locally biased (Gablonsky & Kelley 2001); takes no start and no seed
///   esch, isres: evolution (da Silva Santos et al. 2010; Runarsson & Yao 2005)
///   crs: controlled random search with local mutation (Kaelo & Ali 2006)
///   stogo: branch and bound with gradients (Madsen et al. 1998)
///   annealing: simulated annealing (Kirkpatrick et al. 1983)
///   particle_swarm: constricted particle swarm (Kennedy & Eberhart 1995; Clerc & Kennedy 2002)
///   puddle_jumping: a random jump of each parameter from the best local minimum, a descent, and so on
///   monte_carlo: uniform points
///   stochastic_gradient: gradient steps on blocks of time in random order, shorter and shorter
enum class SearchMethod {
  slsqp,
  lbfgs,
  mlsl,
  direct,
  esch,
  crs,
  isres,
  stogo,
  annealing,
  particle_swarm,
  puddle_jumping,
  monte_carlo,
  stochastic_gradient,
};

struct SearchOptions {
  SearchMethod method = SearchMethod::slsqp;
  int starts = 4;          ///< of the local methods, the first guess among them, >= 1
  int evaluations = 500;   ///< passes over the data of the global methods, before the last descent, >= 10
  std::uint64_t seed = 1;  ///< of the methods that draw random numbers
};
/// Throws InputError on counts out of range.
void validate(const SearchOptions& options);

/// "slsqp", "lbfgs" ... in the order of the enumeration.
const std::vector<std::string>& search_methods();
/// Throws InputError with the nearest name.
SearchMethod search_method(std::string_view name);
std::string to_text(SearchMethod method);

}  // namespace lunid

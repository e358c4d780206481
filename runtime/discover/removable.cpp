#include "discover/removable.hpp"

#include <cmath>
#include <cstdio>

namespace lunid {

std::vector<Removable> removable_terms(const Model& baseline, const Candidate& final_model) {
  constexpr double level = 0.05;
  std::vector<Removable> out;
  if (!final_model.ran()) return out;
  const FitResult& fit = final_model.fit;
  const Model& model = final_model.system->model();
  for (std::size_t j = 0; j < baseline.parameters.size(); ++j) {
    const Parameter& row = model.parameters[j];
    const auto k = static_cast<Eigen::Index>(j);
    const Expr p = model.pool->parameter(row.name);
    if (!final_model.linear[j] || row.fixed || in_a_mass(baseline, p)) continue;
    const bool at_zero = j < fit.at_bound.size() && fit.at_bound[j] && fit.theta[k] == 0;
    Removable term;
    term.parameter = row.name;
    term.value = fit.theta[k];
    term.std = at_zero ? 0 : fit.deviation(k);
    if (std::isnan(term.std)) continue;
    term.p_value = at_zero ? 1 : std::erfc(std::abs(term.value) / term.std / std::sqrt(2.0));
    if (term.p_value < level) continue;
    for (int i = 0; i < baseline.degrees() && term.term.empty(); ++i)
      if (const Expr force = baseline.coordinate(i).restoring; depends_on(force, p))
        term.term = to_text(p * derivative(force, p));
    char text[120];
    if (at_zero)
      std::snprintf(text, sizeof text, "its coefficient sits at its bound of zero");
    else
      std::snprintf(text, sizeof text, "its coefficient, %.3g with a standard deviation of %.2g, is not told from zero",
                    term.value, term.std);
    term.reason = text;
    out.push_back(std::move(term));
  }
  return out;
}

}  // namespace lunid

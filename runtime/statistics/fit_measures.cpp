#include "statistics/fit_measures.hpp"

#include <algorithm>
#include <cmath>

#include "expr/error.hpp"
#include "statistics/moments.hpp"

namespace lunid {
namespace {

void check_lengths(std::span<const double> measured, std::span<const double> model) {
  if (measured.size() != model.size())
    throw InputError("statistics: the measurement has " + std::to_string(measured.size()) + " rows, the model " +
                     std::to_string(model.size()));
}

}  // namespace

double rmse(std::span<const double> measured, std::span<const double> model) {
  check_lengths(measured, model);
  double sum = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) sum += (measured[i] - model[i]) * (measured[i] - model[i]);
  return measured.empty() ? 0 : std::sqrt(sum / static_cast<double>(measured.size()));
}

double nrmse(std::span<const double> measured, std::span<const double> model) {
  const double error = rmse(measured, model);
  if (error == 0) return 0;
  return error / moments::standard_deviation(measured);
}

double r_squared(std::span<const double> measured, std::span<const double> model) {
  const double ratio = nrmse(measured, model);
  return 1 - ratio * ratio;
}

double fit_percent(std::span<const double> measured, std::span<const double> model) {
  return 100 * (1 - nrmse(measured, model));
}

double gap(std::span<const double> measured, std::span<const double> model, std::size_t lead_in) {
  check_lengths(measured, model);
  const std::size_t lead = std::min(lead_in, measured.size());
  return nrmse(measured.subspan(lead), model.subspan(lead));
}

}  // namespace lunid

#pragma once
// A model in its present mode, as SUNDIALS integrates it. Internal to this room.
#include <optional>

#include "simulate/integrator.hpp"
#include "simulate/modes.hpp"

namespace lunid {

/// Where the integrator asked for the rate at a displacement beyond the bound.
struct Beyond {
  double t;
  Eigen::VectorXd x;
  int times;
};

class ModalOde : public Ode {
 public:
  /// With `sensitivities` those of x to (theta, x0) are carried along. All arguments must outlive it.
  ModalOde(const System& system, std::span<const double> theta, const Excitations& excitation,
           const Eigen::VectorXd& x0, const SimulateOptions& options, bool sensitivities);

  int states() const override { return n_; }
  int events() const override { return modes.events(); }
  void rate(double t, const double* x, double* f) override;
  const std::vector<Dynamics::Entry>* pattern() const override;
  void jacobian(double t, const double* x, double* j) override;
  void event_functions(double t, const double* x, double* g) override;
  void error_weights(const double* x, double* w) override;
  int columns() const override { return columns_; }
  void sensitivity_rate(double t, const double* x, const double* const* s, double* const* ds) override;
  void sensitivity_weights(int column, const double* s, double* w) override;

  Drive drive(double t) const;

  ModeMachine modes;
  double bound = 0;                                             ///< on |y|; 0: none
  std::optional<Beyond> beyond;                                 ///< since it was last reset
  double hold_until = std::numeric_limits<double>::infinity();  ///< no sample of a held force is used beyond this

 private:
  void share_scales();
  void free_rates(const Drive& d, const Eigen::VectorXd& x, Eigen::VectorXd& out);
  void first_scales(const Eigen::VectorXd& x0, double time);
  void size_columns(std::span<const double> theta);

  const Excitations& excitation_;
  const SimulateOptions& options_;
  int n_, columns_;
  Observation observation_;
  std::vector<double> scale_, in_, scratch_;
  std::vector<double> size_, column_scale_;  ///< per column: change that counts as whole; largest |s| so far of each s
  long calls_ = 0;
};

}  // namespace lunid

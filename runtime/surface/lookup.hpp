#pragma once
// Tables of values over one or two axes as external functions of the language: a force read off a table, or a surface
// that was fitted on a grid.
#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "expr/external.hpp"
#include "surface/surface.hpp"

namespace lunid {

/// Linear: straight between the points of one axis, bilinear between those of two. Cubic: a spline with a continuous
/// second derivative, the product of two on two axes; an integrator keeps its order to the fourth on it. Beyond its
/// ends each axis goes on straight. The gradient is exact, that of the linear kind one-sided at the points.
class Lookup final : public ExternalFunction {
 public:
  /// `axes`: one or two, each of 2 or more increasing values; `values`: (first axis, second axis), one column for one
  /// axis. Throws InputError: axes that do not increase, a wrong number of values, values that are not finite.
  Lookup(std::string name, std::vector<Eigen::VectorXd> axes, Eigen::MatrixXd values,
         Between between = Between::linear);
  const std::vector<Eigen::VectorXd>& axes() const { return axes_; }
  const Eigen::MatrixXd& values() const { return values_; }
  Between between() const { return between_; }
  std::string words() const override { return "table '" + name() + "'"; }
  bool has_gradient() const override { return true; }

 protected:
  double value(const double* x) const override;
  void gradient(const double* x, double* slopes) const override;

 private:
  double linear_value(const double* x) const;
  void linear_gradient(const double* x, double* slopes) const;
  /// Value, and the slopes where they are asked for.
  double cubic(const double* x, double* slopes) const;

  std::vector<Eigen::VectorXd> axes_;
  Eigen::MatrixXd values_;
  Between between_;
  Eigen::MatrixXd by_first_, by_second_, by_both_;  // cubic: derivatives of the spline at the points
};

/// A surface as a function of y and v: a grid by its corners, any other kind by its values at the corners of `cells`
/// cells along each axis. Corners without data are filled so that the squares of all second differences along y and
/// along v are least: the surface goes on as straight as it can.
std::shared_ptr<const Lookup> lookup_of(const ForceSurface& surface, std::string name, Between between, int cells = 60);

}  // namespace lunid

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

/// Linear between the points of one axis, bilinear between those of two; beyond its ends each axis goes on as in the
/// last cell. The gradient is exact, and one-sided at the points.
class Lookup final : public ExternalFunction {
 public:
  /// `axes`: one or two, each of 2 or more increasing values; `values`: (first axis, second axis), one column for one
  /// axis. Throws InputError: axes that do not increase, a wrong number of values, values that are not finite.
  Lookup(std::string name, std::vector<Eigen::VectorXd> axes, Eigen::MatrixXd values);
  const std::vector<Eigen::VectorXd>& axes() const { return axes_; }
  const Eigen::MatrixXd& values() const { return values_; }
  std::string words() const override { return "table '" + name() + "'"; }
  bool has_gradient() const override { return true; }

 protected:
  double value(const double* x) const override;
  void gradient(const double* x, double* slopes) const override;

 private:
  std::vector<Eigen::VectorXd> axes_;
  Eigen::MatrixXd values_;
};

/// A surface as a function of y and v: a grid by its corners, any other kind by its values at the corners of `cells`
/// cells along each axis. Corners without data are filled so that the squares of all second differences along y and
/// along v are least: the surface goes on as straight as it can.
std::shared_ptr<const Lookup> lookup_of(const ForceSurface& surface, std::string name, int cells = 60);

}  // namespace lunid

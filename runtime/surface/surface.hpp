#pragma once
// Restoring force surfaces: f(y, v) from scattered samples f = F - m*a (Masri & Caughey 1979, J. Appl. Mech. 46, 433).
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "expr/expr.hpp"
#include "record/record.hpp"

namespace lunid {

/// Samples of a surface, in the order of time. `y` [m], `v` [m/s], `f` [N]; all of one length.
struct SurfacePoints {
  Eigen::VectorXd y, v, f;
  Eigen::Index size() const { return y.size(); }
};

/// The points (y, v, F - m*a) of records, one after another. `mass` may depend on channels; empty: f = F.
/// Throws InputError: a channel that is missing, a parameter without a value, a value that is not finite.
SurfacePoints restoring_points(std::span<const Record> records, Expr mass);

/// A rectangle of the (y, v) plane in equal cells, with the number of points in each.
class Cells {
 public:
  Cells() = default;
  /// Over the range of the points. Throws InputError when they are not finite, or y or v is constant, or all lie on a
  /// line.
  Cells(const SurfacePoints& points, int cells_y, int cells_v);

  int cells_y() const { return static_cast<int>(count_.rows()); }
  int cells_v() const { return static_cast<int>(count_.cols()); }
  double y_min() const { return y_min_; }
  double y_max() const { return y_max_; }
  double v_min() const { return v_min_; }
  double v_max() const { return v_max_; }
  bool inside(double y, double v) const { return y >= y_min_ && y <= y_max_ && v >= v_min_ && v <= v_max_; }
  /// Index of the cell of a point inside, and the place in it, 0..1 each.
  struct Place {
    int i = 0, j = 0;
    double along_y = 0, along_v = 0;
  };
  Place place(double y, double v) const;
  const Eigen::MatrixXi& count() const { return count_; }  ///< (y index, v index)

 private:
  double y_min_ = 0, y_max_ = 0, v_min_ = 0, v_max_ = 0;
  Eigen::MatrixXi count_;
};

/// A scalar function over (y, v) that knows where its data were.
class ForceSurface {
 public:
  virtual ~ForceSurface() = default;
  virtual std::string name() const = 0;
  virtual double value(double y, double v) const = 0;  ///< [N]; NaN where a kind has none
  /// (df/dy, df/dv) [N/m, N s/m]: central differences over 1e-5 of the range of the data, unless a kind knows better.
  virtual Eigen::Vector2d gradient(double y, double v) const;
  /// Standard deviation of value() by the kind's own account [N]; NaN where it gives none (then see compare_surfaces).
  virtual double std(double y, double v) const;
  /// value(), and where it has none that of the nearest place which has, on the line to the middle of the data.
  double continued(double y, double v) const;
  bool has_data(double y, double v) const;  ///< its cell holds at least least_count() points
  const Cells& cells() const { return cells_; }
  int least_count() const { return least_count_; }

 protected:
  ForceSurface(Cells cells, int least_count) : cells_(std::move(cells)), least_count_(least_count) {}

 private:
  Cells cells_;
  int least_count_;
};

/// What a table or a grid is between its points: straight, or a cubic spline.
enum class Between { linear, cubic };
/// "linear" "cubic". Throws InputError with the choices. [lookup.cpp]
Between between_from(const std::string& name);
std::string to_string(Between between);

// ---- polynomial.cpp ----
struct PolynomialOptions {
  int order_y = 4, order_v = 4;    ///< 0..20 each; all products up to them: (order_y + 1) * (order_v + 1) coefficients
  int cells_y = 25, cells_v = 25;  ///< 1..1000, to mark where there is no data
};
void validate(const PolynomialOptions& options);

/// sum C(i, j) T_i(x_y) T_j(x_v), Chebyshev polynomials of the coordinates normalised to -1..1 over the data.
/// value() holds everywhere; where has_data() is false it is extrapolated.
class PolynomialSurface : public ForceSurface {
 public:
  PolynomialSurface(Cells cells, Eigen::MatrixXd chebyshev);
  std::string name() const override { return "polynomial"; }
  double value(double y, double v) const override;
  const Eigen::MatrixXd& chebyshev() const { return chebyshev_; }  ///< C(i, j) [N]
  /// M(i, j) of the same surface as sum M(i, j) y^i v^j, in SI units.
  Eigen::MatrixXd monomials() const;
  /// The same as an expression in the channels y and v, to be simulated.
  Expr expression(Pool& pool) const;

  double condition = 0;     ///< of the regression's columns, each scaled to length 1
  double rmse = 0, r2 = 0;  ///< on the points of the fit [N]

 private:
  Eigen::MatrixXd chebyshev_;
};

/// Least squares on all points, by Householder QR in blocks of rows.
/// Throws InputError: fewer points than coefficients; points that lie on a line or on a curve that cannot tell the
/// coefficients apart (a steady motion of one frequency is an ellipse).
PolynomialSurface fit_polynomial(const SurfacePoints& points, const PolynomialOptions& options = {});

// ---- grid.cpp ----
struct GridOptions {
  int cells_y = 20, cells_v = 20;  ///< 1..300
  int least_count = 3;             ///< >= 1: cells with fewer points have no data
  double smoothness = 1e-3;  ///< > 0: weight of squared second differences, over the mean number of points in a cell
  Between between = Between::linear;
};
void validate(const GridOptions& options);

/// A sum of products of B-splines over equal cells: bilinear between values at the corners, or bicubic, whose first and
/// second derivatives have no jump (de Boor 1978, chapter 9). value() is NaN in cells without data and outside.
class GridSurface : public ForceSurface {
 public:
  /// `coefficients`: (cells_y + 1) x (cells_v + 1), of which the value at a corner is its own; bicubic: + 3 each. NaN
  /// where no cell with data has them.
  GridSurface(Cells cells, int least_count, Between between, Eigen::MatrixXd coefficients);
  std::string name() const override { return between_ == Between::linear ? "bilinear grid" : "bicubic grid"; }
  double value(double y, double v) const override;
  Between between() const { return between_; }
  /// Values at the corners, (cells_y + 1) x (cells_v + 1); NaN at corners that no cell with data touches.
  Eigen::MatrixXd nodes() const;

  double rmse = 0, r2 = 0;  ///< on the points of the fit in cells with data [N]

 private:
  double value(const Cells::Place& at) const;

  Between between_;
  Eigen::MatrixXd coefficients_;
};

/// Least squares of the coefficients, smoothed lightly by their second differences along y and v.
/// Throws InputError: no cell with enough points, or points on a line.
GridSurface fit_grid(const SurfacePoints& points, const GridOptions& options = {});

// ---- expand.cpp ----
/// Chebyshev coefficients by Gauss-Chebyshev quadrature of the surface, continued where it has no data:
/// C(i, j) = (2 - d_i0)(2 - d_j0)/nodes^2 * sum f(x_p, x_q) T_i(x_p) T_j(x_q). (Masri & Caughey 1979, eqs. 9-12.)
struct Expansion {
  PolynomialSurface polynomial;
  double truncation = 0;  ///< rms of what the orders leave of the surface, at the cells with data [N]
  double continued = 0;   ///< part of the nodes where the surface has no data
};
/// `nodes` per axis, >= the larger order + 1 and <= 200. Throws InputError: orders as PolynomialOptions, nodes.
Expansion expand_by_quadrature(const ForceSurface& surface, int order_y, int order_v, int nodes = 40);
/// rms of what a polynomial leaves of a surface, at the cells with data [N].
double truncation(const PolynomialSurface& polynomial, const ForceSurface& surface);

// ---- section.cpp ----
/// A cut through a surface along one axis, with the points near it.
struct SurfaceSection {
  bool along_y = true;            ///< along y at v = `at`, else along v at y = `at`
  double at = 0, half_width = 0;  ///< of the band from which the points come
  Eigen::VectorXd place, f, std;  ///< f is NaN where there is no data, std where the kind gives none
  Eigen::VectorXd points_place, points_f;
};
/// `half_width` 0: a twentieth of the range of the other axis. Throws InputError: count < 2, at outside the data.
SurfaceSection section(const ForceSurface& surface, const SurfacePoints& points, bool along_y, double at,
                       int count = 200, double half_width = 0);

// ---- score.cpp ----
using SurfaceFit = std::function<std::shared_ptr<const ForceSurface>(const SurfacePoints&)>;

/// What fits that leave out a block of time each say of the block left out, and of the surface itself.
struct LeftOut {
  Eigen::VectorXd predicted;  ///< at each point, by the fit that did not see it; NaN where that fit has no data
  Eigen::MatrixXd std;        ///< at the centres of the cells, by the block jackknife [N]; NaN where a fit has no data
};
/// Leaves out each of `blocks` (>= 2) parts of nearly equal length in turn.
LeftOut leave_out(const SurfacePoints& points, int blocks, const Cells& cells, const SurfaceFit& fit);

/// Prediction of blocks of time that the fit has not seen.
struct SurfaceScore {
  double r2 = 0;       ///< about the mean of the points predicted
  double rmse = 0;     ///< [N]
  double covered = 0;  ///< part of the left-out points that lie where the surface has data; the others are not scored
};
/// Of predictions that are not NaN.
SurfaceScore score(const SurfacePoints& points, const Eigen::VectorXd& predicted);

/// For figures and tables: the surface at the centres of its cells.
struct SurfaceTable {
  Eigen::VectorXd y, v;   ///< centres
  Eigen::MatrixXd f;      ///< (y index, v index); NaN where there is no data
  Eigen::MatrixXi count;  ///< points in the cell
  /// One row for each cell: y, v, f, count; v runs fastest.
  Eigen::MatrixXd rows() const;
};
SurfaceTable tabulate(const ForceSurface& surface);

}  // namespace lunid

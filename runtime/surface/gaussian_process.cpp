// Gaussian process surfaces.
#include <nlopt.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <memory>

#include "surface/kinds.hpp"
#include "surface/normalised.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

/// Lengths along both axes (normalised) and the noise's variance at a cell of one point over the process' variance.
struct Shape {
  Vector2d rate;  ///< one over the lengths
  double noise;
  explicit Shape(const double* log) : rate(std::exp(-log[0]), std::exp(-log[1])), noise(std::exp(log[2])) {}

  double covariance(const Vector2d& a, const Vector2d& b) const {
    return std::exp(-0.5 * (a - b).cwiseProduct(rate).squaredNorm());
  }
  VectorXd covariances(const Vector2d& at, const Eigen::Matrix2Xd& centres) const {
    VectorXd k(centres.cols());
    for (Index i = 0; i < k.size(); ++i) k[i] = covariance(at, centres.col(i));
    return k;
  }
};

/// The factor of the covariance of centres under a shape, and the weights of their forces.
struct Solved {
  Eigen::LLT<MatrixXd> factor;
  VectorXd weights;
  double variance = 0;  ///< of the process, in units of the target
  double likelihood = -HUGE_VAL;

  Solved(const Centres& data, const VectorXd& target, const Shape& shape) {
    const Index n = data.size();
    MatrixXd k(n, n);
    for (Index j = 0; j < n; ++j) {
      // The last term keeps the factor real where two centres are one to rounding.
      k(j, j) = 1 + shape.noise / data.weight[j] + 1e-10;
      for (Index i = j + 1; i < n; ++i) k(i, j) = shape.covariance(data.at.col(i), data.at.col(j));
    }
    factor.compute(k);
    if (factor.info() != Eigen::Success) return;
    weights = factor.solve(target);
    variance = target.dot(weights) / static_cast<double>(n);
    if (!(variance > 0)) return;
    // The process' variance is eliminated (Rasmussen & Williams 2006, eq. 5.8 at its maximum over the variance).
    const double log_determinant = 2 * factor.matrixLLT().diagonal().array().log().sum();
    likelihood = -0.5 * (static_cast<double>(n) * std::log(variance) + log_determinant);
  }
};

/// The plane that a process falls back to far from data: weighted least squares.
Eigen::Vector3d plane(const Centres& data) {
  Eigen::MatrixX3d x(data.size(), 3);
  x << VectorXd::Ones(data.size()), data.at.transpose();
  const VectorXd root = data.weight.cwiseSqrt();
  return (root.asDiagonal() * x).colPivHouseholderQr().solve(root.cwiseProduct(data.f));
}

double on(const Eigen::Vector3d& plane, const Vector2d& x) { return plane[0] + plane.tail<2>().dot(x); }

VectorXd above(const Eigen::Vector3d& plane, const Centres& data) {
  VectorXd off(data.size());
  for (Index i = 0; i < off.size(); ++i) off[i] = data.f[i] - on(plane, data.at.col(i));
  return off;
}

class ProcessSurface : public ForceSurface {
 public:
  ProcessSurface(Cells cells, Centres data, Eigen::Vector3d plane, double spread, Shape shape, Solved solved)
      : ForceSurface(std::move(cells), 1),
        frame_(this->cells()),
        data_(std::move(data)),
        plane_(plane),
        spread_(spread),
        shape_(shape),
        solved_(std::move(solved)) {}

  std::string name() const override { return "Gaussian process"; }

  double value(double y, double v) const override {
    const Vector2d x = frame_(y, v);
    return on(plane_, x) + spread_ * shape_.covariances(x, data_.at).dot(solved_.weights);
  }

  Vector2d gradient(double y, double v) const override {
    const Vector2d x = frame_(y, v);
    Vector2d slope = Vector2d::Zero();
    for (Index i = 0; i < data_.size(); ++i)
      slope += solved_.weights[i] * shape_.covariance(x, data_.at.col(i)) * (data_.at.col(i) - x);
    slope = plane_.tail<2>() + spread_ * slope.cwiseProduct(shape_.rate.cwiseAbs2());
    return {slope[0] / frame_.y_half, slope[1] / frame_.v_half};
  }

  double std(double y, double v) const override {
    const VectorXd k = shape_.covariances(frame_(y, v), data_.at);
    const double left = 1 - solved_.factor.matrixL().solve(k).squaredNorm();
    return spread_ * std::sqrt(solved_.variance * std::max(0.0, left));
  }

 private:
  Frame frame_;
  Centres data_;
  Eigen::Vector3d plane_;
  double spread_;
  Shape shape_;
  Solved solved_;
};

/// What NLopt calls: minus the likelihood at the logarithms of the shape. Nothing in it throws but a lack of memory.
struct Call {
  const Centres* data;
  const VectorXd* target;
  nlopt_opt optimiser;
  std::exception_ptr fault;
};

double call_likelihood(unsigned, const double* log, double*, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    const double likelihood = Solved(*call.data, *call.target, Shape(log)).likelihood;
    return std::isfinite(likelihood) ? -likelihood : 1e300;
  } catch (...) {
    call.fault = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return HUGE_VAL;
  }
}

/// The shape of largest likelihood.
Shape most_likely(const Centres& data, const VectorXd& target) {
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> optimiser(
      nlopt_create(NLOPT_LN_BOBYQA, 3), nlopt_destroy);
  Call call{&data, &target, optimiser.get(), nullptr};
  const double least[] = {std::log(0.02), std::log(0.02), std::log(1e-8)};
  const double most[] = {std::log(50), std::log(50), std::log(1e3)};
  nlopt_set_lower_bounds(optimiser.get(), least);
  nlopt_set_upper_bounds(optimiser.get(), most);
  nlopt_set_initial_step1(optimiser.get(), 1);
  nlopt_set_min_objective(optimiser.get(), call_likelihood, &call);
  nlopt_set_xtol_abs1(optimiser.get(), 0.02);
  nlopt_set_maxeval(optimiser.get(), 100);
  double log[] = {std::log(0.7), std::log(0.7), std::log(0.1)}, value = 0;
  nlopt_optimize(optimiser.get(), log, &value);
  if (call.fault) std::rethrow_exception(call.fault);
  return Shape(log);
}

}  // namespace

Learnt gaussian_process(const SurfacePoints& points, const GaussianProcessOptions& options) {
  const Cells cells(points, kCells, kCells);
  const Frame frame(cells);
  // The shape is told by fewer centres than the surface.
  const Centres few = cell_means_at_most(points, frame, std::min(options.centres, 250));
  const Eigen::Vector3d trend = plane(few);
  const double spread = Level(above(trend, few), few.weight).spread;
  const Shape shape = most_likely(few, above(trend, few) / spread);
  const Centres all = cell_means_at_most(points, frame, options.centres);
  Solved solved(all, above(trend, all) / spread, shape);
  if (solved.factor.info() != Eigen::Success)
    throw InputError(
        "surface: Gaussian process: the covariance of the cell means has no factor: the force does not "
        "vary over the plane, take lunid.polynomial",
        {}, Fault::data);
  return {std::make_shared<ProcessSurface>(cells, all, trend, spread, shape, std::move(solved))};
}

}  // namespace lunid::detail

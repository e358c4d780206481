#include "discover/receptance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace lunid {

namespace {

// A spring that is not there, or no damping, would make the filter drift or ring through the whole record.
constexpr double least_frequency = 0.3, least_damping = 0.05;
constexpr double fastest = 2;  // [rad per row]: modes beyond it follow the force

/// Least squares from the normal equations, columns of length one.
Eigen::MatrixXd regress(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& right) {
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * (scale.asDiagonal() * gram * scale.asDiagonal())
                                  .completeOrthogonalDecomposition()
                                  .solve(scale.asDiagonal() * right);
}

/// By differences from row to row, from rest.
void differentiate(Eigen::Ref<Eigen::VectorXd> column, double dt) {
  const Eigen::Index last = column.size() - 1;
  column.tail(last) = (column.tail(last) - column.head(last)).eval() / dt;
  column[0] /= dt;
}

/// The masses of a model at rest; 1 where there is none.
Eigen::VectorXd masses(const Candidate& model) {
  const System& system = *model.force_system;
  const Eigen::VectorXd& theta = model.best_theta();
  std::vector<double> in(static_cast<std::size_t>(system.inertia().inputs()), 0.0),
      out(static_cast<std::size_t>(system.degrees())),
      scratch(static_cast<std::size_t>(system.inertia().registers()) + 1);
  std::copy(theta.begin(), theta.end(), in.end() - theta.size());
  system.inertia().run_point(in.data(), out.data(), scratch.data());
  Eigen::VectorXd mass = Eigen::VectorXd::Ones(system.degrees());
  for (Eigen::Index i = 0; i < mass.size(); ++i)
    if (out[static_cast<std::size_t>(i)] > 0) mass[i] = out[static_cast<std::size_t>(i)];
  return mass;
}

/// Mass, damping and stiffness of the linear system whose force is nearest to the measured one; in a free decay, whose
/// force shows no mass, beside the baseline's.
Eigen::Vector3d linear_system(const Study& study, const Candidate& baseline) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& data : study.force) {
    Eigen::MatrixXd x(data.record.rows(), 3);
    x << as_vector(data.record["a"]), as_vector(data.record["v"]), as_vector(data.record["y"]);
    gram += x.transpose() * x;
    right += x.transpose() * as_vector(data.record["F"]);
  }
  const Eigen::Vector3d found = regress(gram, right);
  if (found[0] > 0) return found;
  const double mass = masses(baseline)[0];
  const Eigen::Vector2d rest =
      regress(gram.bottomRightCorner(2, 2), right.tail(2) - mass * gram.bottomLeftCorner(2, 1));
  return {mass, rest[0], rest[1]};
}

}  // namespace

Receptance::Receptance(const Study& study, const Candidate& baseline, const std::vector<FitData>& data)
    : order_(study.measured_order()) {
  if (study.degrees() > 1) {
    find_modes(study, baseline, data);
    return;
  }
  const Eigen::Vector3d found = linear_system(study, baseline);
  const double m = found[0];
  const double w = std::max(std::sqrt(std::max(found[2] / m, 0.0)), least_frequency * study.omega);
  modes_.push_back(mode(m, w, found[1] / (2 * m * w), study.force.front().record.dt()));
}

/// Impulse invariance: poles exp(s dt).
Receptance::Mode Receptance::mode(double mass, double frequency, double damping, double dt) {
  Mode out;
  const double zeta = std::clamp(damping, least_damping, 1.0), decay = std::exp(-zeta * frequency * dt);
  const double damped = frequency * std::sqrt(std::max(1 - zeta * zeta, 1e-6));
  out.a[0] = -2 * decay * std::cos(damped * dt);
  out.a[1] = decay * decay;
  out.b[0] = 0;
  out.b[1] = dt * decay * std::sin(damped * dt) / (mass * damped);
  return out;
}

/// Of the linear system whose force along the motion is nearest to that of the baseline; damping between modes is
/// left out.
void Receptance::find_modes(const Study& study, const Candidate& baseline, const std::vector<FitData>& data_of) {
  const Eigen::Index n = study.degrees();
  const Eigen::VectorXd& theta = baseline.best_theta();
  const System& system = *baseline.force_system;
  const Eigen::VectorXd mass = masses(baseline);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(2 * n, 2 * n), right = Eigen::MatrixXd::Zero(2 * n, n);
  for (const auto& data : data_of) {
    const Eigen::Index rows = data.record.rows();
    const Eigen::VectorXd force = imposed_force(system, view(theta), data.record);
    if (!force.allFinite()) continue;
    Eigen::MatrixXd motion(rows, 2 * n), open(rows, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto coordinate = static_cast<int>(i);
      motion.col(i) = as_vector(data.record[study.channel('y', coordinate)]);
      motion.col(n + i) = as_vector(data.record[study.channel('v', coordinate)]);
      open.col(i) = force.segment(i * rows, rows) - mass[i] * as_vector(data.record[study.channel('a', coordinate)]);
    }
    gram += motion.transpose() * motion;
    right += motion.transpose() * open;
  }
  const Eigen::MatrixXd found = regress(gram, right);
  const Eigen::VectorXd root = mass.cwiseSqrt().cwiseInverse();
  const auto normal = [&](const Eigen::MatrixXd& part) -> Eigen::MatrixXd {
    return root.asDiagonal() * (0.5 * (part + part.transpose())) * root.asDiagonal();
  };
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(normal(found.topRows(n)));
  const Eigen::MatrixXd damping = normal(found.bottomRows(n));
  const double dt = study.force.front().record.dt();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd shape = modes.eigenvectors().col(k);
    const double w = std::max(std::sqrt(std::max(modes.eigenvalues()[k], 0.0)), least_frequency * study.omega);
    modes_.push_back(mode(1, w, shape.dot(damping * shape) / (2 * w), dt));
    if (w * dt > fastest) modes_.back() = {{1 / (w * w), 0}, {0, 0}, {}};
    modes_.back().shape = root.asDiagonal() * shape;
  }
  for (const auto& data : study.train) {
    const std::vector<double> weights = study.weights(data.record);
    weights_.push_back(Eigen::Map<const Eigen::VectorXd>(weights.data(), n));
  }
}

Eigen::VectorXd Receptance::Mode::filtered(const FitData& data, const Eigen::VectorXd& force) const {
  Eigen::VectorXd out(force.size());
  double last = 0, before = 0, input = 0;
  for (Eigen::Index i = 0; i < force.size(); ++i) {
    const double now = data.use[static_cast<std::size_t>(i)] ? force[i] : 0;
    const double value = b[0] * now + b[1] * input - a[0] * last - a[1] * before;
    input = now;
    before = last;
    last = value;
    out[i] = value;
  }
  return out;
}

Eigen::VectorXd Receptance::motion_of(const Eigen::VectorXd& force, const std::vector<FitData>& data,
                                      Eigen::Index degrees) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(force.size());
  Eigen::Index first = 0;
  for (std::size_t r = 0; r < data.size(); ++r) {
    const Eigen::Index rows = data[r].record.rows();
    const auto of = [&](auto& column, Eigen::Index i) { return column.segment(first + i * rows, rows); };
    if (modes_.empty()) {
      for (Eigen::Index i = 0; i < degrees; ++i) of(out, i) = Mode{}.filtered(data[r], of(force, i));
    } else if (degrees == 1) {
      of(out, 0) = modes_.front().filtered(data[r], of(force, 0));
    } else {
      for (const Mode& mode : modes_) {
        Eigen::VectorXd part = Eigen::VectorXd::Zero(rows);
        for (Eigen::Index i = 0; i < degrees; ++i) part += mode.shape[i] * of(force, i);
        part = mode.filtered(data[r], part);
        for (Eigen::Index i = 0; i < degrees; ++i) of(out, i) += weights_[r][i] * mode.shape[i] * part;
      }
    }
    const double dt = data[r].record.dt();
    for (Eigen::Index i = 0; i < degrees; ++i)
      for (int k = 0; k < order_; ++k) differentiate(of(out, i), dt);
    first += degrees * rows;
  }
  return out;
}

}  // namespace lunid

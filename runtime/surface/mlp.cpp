// Neural network surfaces.
#include <nlopt.h>

#include <cmath>
#include <memory>

#include "record/random.hpp"
#include "surface/kinds.hpp"
#include "surface/normalised.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The weights of a network from 2 inputs to 1 output, laid in one vector: for each layer the matrix, then the shifts.
class Network {
 public:
  explicit Network(const std::vector<int>& hidden) {
    sizes_.push_back(2);
    for (const int units : hidden) sizes_.push_back(units);
    sizes_.push_back(1);
    for (std::size_t l = 0; l + 1 < sizes_.size(); ++l) {
      first_.push_back(count_);
      count_ += sizes_[l + 1] * (sizes_[l] + 1);
    }
  }

  Index count() const { return count_; }
  std::size_t layers() const { return first_.size(); }
  Eigen::Map<const MatrixXd> matrix(const double* w, std::size_t l) const {
    return {w + first_[l], sizes_[l + 1], sizes_[l]};
  }
  Eigen::Map<const VectorXd> shift(const double* w, std::size_t l) const {
    return {w + first_[l] + sizes_[l + 1] * sizes_[l], sizes_[l + 1]};
  }
  Eigen::Map<MatrixXd> matrix(double* w, std::size_t l) const { return {w + first_[l], sizes_[l + 1], sizes_[l]}; }
  Eigen::Map<VectorXd> shift(double* w, std::size_t l) const {
    return {w + first_[l] + sizes_[l + 1] * sizes_[l], sizes_[l + 1]};
  }

  /// Uniform with the variance that keeps the size of signals through tanh. (Glorot & Bengio 2010.)
  VectorXd first_weights(std::uint64_t seed) const {
    Philox random(seed, stream_of("surface mlp"));
    VectorXd w = VectorXd::Zero(count_);
    for (std::size_t l = 0; l < layers(); ++l) {
      const double reach = std::sqrt(6.0 / static_cast<double>(sizes_[l] + sizes_[l + 1]));
      for (double& weight : matrix(w.data(), l).reshaped()) weight = reach * (2 * random.uniform() - 1);
      for (double& shift : this->shift(w.data(), l)) shift = 0.5 * (2 * random.uniform() - 1);
    }
    return w;
  }

  /// Signals of all layers for inputs (a column each); the last has one row, the output.
  void forward(const double* w, const MatrixXd& inputs, std::vector<MatrixXd>& signals) const {
    signals.resize(layers() + 1);
    signals[0] = inputs;
    for (std::size_t l = 0; l < layers(); ++l) {
      signals[l + 1].noalias() = matrix(w, l) * signals[l];
      signals[l + 1].colwise() += VectorXd(shift(w, l));
      if (l + 1 < layers()) signals[l + 1] = signals[l + 1].unaryExpr([](double x) { return std::tanh(x); });
    }
  }

 private:
  std::vector<Index> sizes_, first_;
  Index count_ = 0;
};

/// Mean of weight * (output - target)^2 plus the penalty, and its gradient by back-propagation.
class Loss {
 public:
  Loss(const Network& network, const Centres& data, const VectorXd& target, double penalty)
      : network_(network),
        inputs_(data.at),
        target_(target),
        weight_(data.weight / data.weight.sum()),
        penalty_(penalty) {}

  double operator()(const double* w, double* gradient) {
    network_.forward(w, inputs_, signals_);
    const Eigen::Map<const VectorXd> all(w, network_.count());
    const VectorXd off = signals_.back().row(0).transpose() - target_;
    const double scale = penalty_ / static_cast<double>(network_.count());
    const double value = weight_.dot(off.cwiseAbs2()) + scale * all.squaredNorm();
    if (!gradient) return value;
    Eigen::Map<VectorXd>(gradient, network_.count()) = 2 * scale * all;
    MatrixXd slope = (2 * weight_.cwiseProduct(off)).transpose(), before;
    for (std::size_t l = network_.layers(); l-- > 0;) {
      network_.matrix(gradient, l).noalias() += slope * signals_[l].transpose();
      network_.shift(gradient, l) += slope.rowwise().sum();
      if (l == 0) break;
      before.noalias() = network_.matrix(w, l).transpose() * slope;
      slope = before.array() * (1 - signals_[l].array().square());
    }
    return value;
  }

 private:
  const Network& network_;
  MatrixXd inputs_;
  VectorXd target_, weight_;
  double penalty_;
  std::vector<MatrixXd> signals_;
};

/// What crosses NLopt's frame: an exception is kept and thrown after it. The best point is kept as well, because a
/// line search may end on a worse one.
struct Call {
  Loss* loss;
  nlopt_opt optimiser;
  double least = HUGE_VAL;
  VectorXd best;
  std::exception_ptr fault;
};

double call_loss(unsigned n, const double* w, double* gradient, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    const double value = (*call.loss)(w, gradient);
    if (value < call.least) {
      call.least = value;
      call.best = Eigen::Map<const VectorXd>(w, n);
    }
    return value;
  } catch (...) {
    call.fault = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return HUGE_VAL;
  }
}

class MlpSurface : public ForceSurface {
 public:
  MlpSurface(Cells cells, Network network, VectorXd weights, Level level)
      : ForceSurface(std::move(cells), 1),
        frame_(this->cells()),
        network_(std::move(network)),
        weights_(std::move(weights)),
        level_(level) {}

  std::string name() const override { return "neural network"; }

  double value(double y, double v) const override {
    VectorXd signal = frame_(y, v);
    for (std::size_t l = 0; l < network_.layers(); ++l) signal = layer(l, signal);
    return level_.mean + level_.spread * signal[0];
  }

  Eigen::Vector2d gradient(double y, double v) const override {
    VectorXd signal = frame_(y, v);
    MatrixXd slope = MatrixXd::Identity(2, 2);
    for (std::size_t l = 0; l < network_.layers(); ++l) {
      signal = layer(l, signal);
      slope = (network_.matrix(weights_.data(), l) * slope).eval();
      if (l + 1 < network_.layers()) slope = (1 - signal.array().square()).matrix().asDiagonal() * slope;
    }
    return level_.spread * Eigen::Vector2d(slope(0, 0) / frame_.y_half, slope(0, 1) / frame_.v_half);
  }

 private:
  VectorXd layer(std::size_t l, const VectorXd& signal) const {
    const VectorXd sum = network_.matrix(weights_.data(), l) * signal + network_.shift(weights_.data(), l);
    return l + 1 < network_.layers() ? VectorXd(sum.unaryExpr([](double x) { return std::tanh(x); })) : sum;
  }

  Frame frame_;
  Network network_;
  VectorXd weights_;
  Level level_;
};

std::string reason(nlopt_result code, int evaluations) {
  if (code == NLOPT_MAXEVAL_REACHED)
    return "stopped after " + std::to_string(evaluations) + " evaluations, not at rest";
  return "the loss changes by less than 1e-5 of itself in a step";
}

}  // namespace

Learnt mlp(const SurfacePoints& points, const MlpOptions& options) {
  constexpr int most = 1500;  // cell means: more of them cost time and hardly move the surface
  const Cells cells(points, kCells, kCells);
  const Centres data = cell_means_at_most(points, Frame(cells), most);
  const Level level(data.f, data.weight);
  const VectorXd target = (data.f.array() - level.mean) / level.spread;
  Network network(options.hidden);
  Loss loss(network, data, target, options.penalty);

  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> optimiser(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(network.count())), nlopt_destroy);
  Call call{&loss, optimiser.get(), HUGE_VAL, {}, nullptr};
  nlopt_set_min_objective(optimiser.get(), call_loss, &call);
  nlopt_set_vector_storage(optimiser.get(), 20);
  nlopt_set_ftol_rel(optimiser.get(), 1e-5);
  nlopt_set_maxeval(optimiser.get(), options.evaluations);
  VectorXd w = network.first_weights(options.seed);
  double value = 0;
  const nlopt_result code = nlopt_optimize(optimiser.get(), w.data(), &value);
  if (call.fault) std::rethrow_exception(call.fault);
  // A negative code is a line search at its limit of rounding: the best point is as good as it gets.
  return {std::make_shared<MlpSurface>(cells, network, call.best, level), reason(code, options.evaluations),
          code != NLOPT_MAXEVAL_REACHED};
}

}  // namespace lunid::detail

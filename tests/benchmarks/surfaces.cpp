// The surface kinds that a library learns beside that library called directly, with the same options on the same
// points; those of our own (the network, the Gaussian process) beside their loss and likelihood written by hand under
// the same optimiser.
#include <benchmark/benchmark.h>
#include <dlib/random_forest.h>
#include <dlib/svm.h>
#include <nlopt.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <memory>
#include <nanoflann.hpp>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "benchmarks/work.hpp"
#include "record/random.hpp"
#include "surface/interpolation.hpp"
#include "surface/normalised.hpp"

namespace bench {
namespace {

using Sample = dlib::matrix<double, 0, 1>;
using Kernel = dlib::radial_basis_kernel<Sample>;

constexpr Eigen::Index rows = 6000;
constexpr double width = 0.4;

lunid::SurfacePoints points() {
  lunid::Philox random(5, 0);
  lunid::SurfacePoints p{Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = 5e-3 * static_cast<double>(i);
    p.y[i] = 2e-3 * (std::sin(7 * t) + 0.5 * std::sin(11.3 * t));
    p.v[i] = 2e-3 * (7 * std::cos(7 * t) + 5.65 * std::cos(11.3 * t));
    p.f[i] = 2e4 * p.y[i] + 1e9 * std::pow(p.y[i], 3) + 50 * p.v[i] + random.normal();
  }
  return p;
}

/// Points as dlib takes them, the force at deviation 1.
struct Samples {
  std::vector<Sample> at;
  std::vector<double> target;
  explicit Samples(const lunid::detail::Centres& centres) {
    const lunid::detail::Level level(centres.f, centres.weight);
    for (Eigen::Index i = 0; i < centres.size(); ++i) {
      at.emplace_back(2);
      at.back()(0) = centres.at(0, i);
      at.back()(1) = centres.at(1, i);
      target.push_back((centres.f[i] - level.mean) / level.spread);
    }
  }
};

/// The force of all points by what was learnt, as a fit looks at them too.
template <class Function>
double sum_over(const Function& function, const Samples& samples) {
  double sum = 0;
  for (const Sample& at : samples.at) sum += function(at);
  return sum;
}

double forest_by_hand(const Samples& all) {
  dlib::random_forest_regression_trainer<dlib::dense_feature_extractor> trainer;
  const lunid::ForestOptions options;
  trainer.set_num_trees(static_cast<std::size_t>(options.trees));
  trainer.set_min_samples_per_leaf(static_cast<std::size_t>(options.least_leaf));
  trainer.set_feature_subsampling_fraction(1);
  trainer.set_seed("1");
  return sum_over(trainer.train(all.at, all.target), all);
}

double support_vectors_by_hand(const Samples& centres, const Samples& all) {
  const lunid::SupportVectorOptions options;
  dlib::svr_trainer<Kernel> trainer;
  trainer.set_kernel(Kernel(1 / (2 * width * width)));
  trainer.set_c(options.cost);
  trainer.set_epsilon_insensitivity(options.epsilon);
  trainer.set_epsilon(1e-3);
  return sum_over(trainer.train(centres.at, centres.target), all);
}

/// Points as nanoflann reads them.
struct Cloud {
  const Eigen::Matrix2Xd& at;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(at.cols()); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return at(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// The mean of the twelve nearest points of every point, by nanoflann.
double nearest_by_hand(const lunid::detail::Centres& data) {
  const Cloud cloud{data.at};
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 2>;
  Tree tree(2, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree.buildIndex();
  constexpr std::size_t count = 12;
  std::uint32_t index[count];
  double square[count], sum = 0;
  for (Eigen::Index k = 0; k < data.size(); ++k) {
    tree.knnSearch(data.at.col(k).data(), count, index, square);
    double mean = 0, weights = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double weight = 1 / (std::sqrt(square[i]) + 1e-6);
      mean += weight * data.f[static_cast<Eigen::Index>(index[i])];
      weights += weight;
    }
    sum += mean / weights;
  }
  return sum;
}

/// Delaunay's triangles by Qhull.
double triangles_by_hand(const Eigen::Matrix2Xd& corners) {
  qhT state;
  qh_zero(&state, stderr);
  std::vector<double> at(corners.data(), corners.data() + corners.size());
  char command[] = "qhull d Qt Qbb Qc Qz";
  qh_new_qhull(&state, 2, static_cast<int>(corners.cols()), at.data(), False, command, nullptr, stderr);
  const double facets = state.num_facets;
  qh_freeqhull(&state, !qh_ALL);
  int left = 0, total = 0;
  qh_memfreeshort(&state, &left, &total);
  return facets;
}

/// Calls an objective of n numbers from NLopt.
template <class Objective>
double call(unsigned n, const double* x, double* gradient, void* data) {
  return (*static_cast<Objective*>(data))(n, x, gradient);
}

constexpr int network_evaluations = 60;

/// Mean square error of a network of 2, 20, 20 and 1 units and its gradient: the two products with a matrix of weights
/// in each direction, and the tanh of all units.
struct NetworkByHand {
  static constexpr int units = 20;
  const lunid::detail::Centres& data;
  Eigen::MatrixXd one{units, data.size()}, two{units, data.size()}, back{units, data.size()};
  Eigen::RowVectorXd off{data.size()};

  double operator()(unsigned, const double* w, double* g) {
    const Eigen::Map<const Eigen::MatrixXd> a(w, units, 2), b(w + 3 * units, units, units),
        c(w + 4 * units + units * units, 1, units);
    const Eigen::Map<const Eigen::VectorXd> shift_a(w + 2 * units, units),
        shift_b(w + 3 * units + units * units, units);
    const double shift_c = w[5 * units + units * units];
    one = ((a * data.at).colwise() + shift_a).unaryExpr([](double x) { return std::tanh(x); });
    two = ((b * one).colwise() + shift_b).unaryExpr([](double x) { return std::tanh(x); });
    off = (c * two).array() + shift_c - data.f.transpose().array();
    const double scale = 1.0 / static_cast<double>(data.size());
    if (g) {
      Eigen::Map<Eigen::MatrixXd>(g + 4 * units + units * units, 1, units) = 2 * scale * off * two.transpose();
      g[5 * units + units * units] = 2 * scale * off.sum();
      back = (c.transpose() * off).cwiseProduct((1 - two.array().square()).matrix()) * (2 * scale);
      Eigen::Map<Eigen::MatrixXd>(g + 3 * units, units, units) = back * one.transpose();
      Eigen::Map<Eigen::VectorXd>(g + 3 * units + units * units, units) = back.rowwise().sum();
      back = (b.transpose() * back).cwiseProduct((1 - one.array().square()).matrix()).eval();
      Eigen::Map<Eigen::MatrixXd>(g, units, 2) = back * data.at.transpose();
      Eigen::Map<Eigen::VectorXd>(g + 2 * units, units) = back.rowwise().sum();
    }
    return scale * off.squaredNorm();
  }
};

double network_by_hand(const lunid::detail::Centres& centres, const lunid::detail::Centres& all) {
  constexpr unsigned count = 5 * NetworkByHand::units + NetworkByHand::units * NetworkByHand::units + 1;
  NetworkByHand loss{centres};
  lunid::Philox random(3, 0);
  std::vector<double> w(count);
  for (double& each : w) each = 0.6 * random.uniform() - 0.3;
  nlopt_opt optimiser = nlopt_create(NLOPT_LD_LBFGS, count);
  nlopt_set_min_objective(optimiser, call<NetworkByHand>, &loss);
  nlopt_set_vector_storage(optimiser, 20);
  nlopt_set_maxeval(optimiser, network_evaluations);
  double value = 0;
  nlopt_optimize(optimiser, w.data(), &value);
  nlopt_destroy(optimiser);
  NetworkByHand last{all};  // the error at all points
  return last(count, w.data(), nullptr);
}

/// The likelihood of a squared exponential: a kernel and its factor.
struct ProcessByHand {
  const lunid::detail::Centres& data;
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd weights;

  double operator()(unsigned, const double* log, double*) {
    const Eigen::Index n = data.size();
    const Eigen::Array2d inverse(std::exp(-log[0]), std::exp(-log[1]));
    const Eigen::Matrix2Xd at = data.at.array().colwise() * inverse;
    Eigen::MatrixXd k(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) k(i, j) = std::exp(-0.5 * (at.col(i) - at.col(j)).squaredNorm());
      k(j, j) += std::exp(log[2]) / data.weight[j] + 1e-10;
    }
    factor.compute(k);
    weights = factor.solve(data.f);
    const double variance = data.f.dot(weights) / static_cast<double>(n);
    return 0.5 * static_cast<double>(n) * std::log(variance) + factor.matrixLLT().diagonal().array().log().sum();
  }
};

double process_by_hand(const lunid::detail::Centres& few, const lunid::detail::Centres& most,
                       const lunid::detail::Centres& all) {
  ProcessByHand likelihood{few, {}, {}}, last{most, {}, {}};
  double log[] = {std::log(0.7), std::log(0.7), std::log(0.1)}, value = 0;
  const double low[] = {std::log(0.02), std::log(0.02), std::log(1e-8)};
  const double high[] = {std::log(50), std::log(50), std::log(1e3)};
  nlopt_opt optimiser = nlopt_create(NLOPT_LN_BOBYQA, 3);
  nlopt_set_lower_bounds(optimiser, low);
  nlopt_set_upper_bounds(optimiser, high);
  nlopt_set_min_objective(optimiser, call<ProcessByHand>, &likelihood);
  nlopt_set_initial_step1(optimiser, 1);
  nlopt_set_xtol_abs1(optimiser, 0.02);
  nlopt_set_maxeval(optimiser, 100);
  nlopt_optimize(optimiser, log, &value);
  nlopt_destroy(optimiser);
  last(3, log, nullptr);
  const Eigen::Array2d inverse(std::exp(-log[0]), std::exp(-log[1]));
  double sum = 0;
  for (Eigen::Index k = 0; k < all.size(); ++k)
    for (Eigen::Index i = 0; i < most.size(); ++i)
      sum += last.weights[i] * std::exp(-0.5 * ((most.at.col(i) - all.at.col(k)).array() * inverse).square().sum());
  return sum;
}

/// Rid of their plane, as the process is about one: then its likelihood takes as many evaluations.
lunid::detail::Centres without_plane(lunid::detail::Centres data) {
  Eigen::MatrixX3d x(data.size(), 3);
  x << Eigen::VectorXd::Ones(data.size()), data.at.transpose();
  const Eigen::VectorXd root = data.weight.cwiseSqrt();
  data.f -= x * (root.asDiagonal() * x).colPivHouseholderQr().solve(root.cwiseProduct(data.f)).eval();
  return data;
}

/// At mean 0 and deviation 1.
lunid::detail::Centres standard(lunid::detail::Centres data) {
  const lunid::detail::Level level(data.f, data.weight);
  data.f = (data.f.array() - level.mean) / level.spread;
  return data;
}

}  // namespace

std::vector<Work> surface_works() {
  const auto measured = std::make_shared<lunid::SurfacePoints>(points());
  const lunid::Cells cells(*measured, 25, 25);
  const lunid::detail::Frame frame(cells);
  lunid::detail::Centres raw{Eigen::Matrix2Xd(2, rows), measured->f, Eigen::VectorXd::Ones(rows)};
  for (Eigen::Index k = 0; k < rows; ++k) raw.at.col(k) = frame(measured->y[k], measured->v[k]);
  const auto all = std::make_shared<Samples>(raw);
  const auto centres = std::make_shared<Samples>(
      lunid::detail::cell_means_at_most(*measured, frame, lunid::SupportVectorOptions{}.centres));
  const auto ours = [measured](lunid::Interpolator how) {
    return [=] { benchmark::DoNotOptimize(lunid::fit_surface(*measured, how).rmse); };
  };
  using lunid::detail::Centres;
  const auto means = [&](int most) {
    return std::make_shared<Centres>(
        standard(without_plane(lunid::detail::cell_means_at_most(*measured, frame, most))));
  };
  const auto points_in_frame = std::make_shared<Centres>(standard(raw));
  const auto corners =
      std::make_shared<Centres>(lunid::detail::cell_means(*measured, frame, lunid::TriangulationOptions{}.cells));
  const auto network = means(1500), few = means(250), most = means(lunid::GaussianProcessOptions{}.centres);
  return {{"surface-random-forest", 1.5, ours(lunid::ForestOptions{}),
           [=] { benchmark::DoNotOptimize(forest_by_hand(*all)); }, 0, 3},
          {"surface-support-vectors", 1.5, ours(lunid::SupportVectorOptions{.width = width}),
           [=] { benchmark::DoNotOptimize(support_vectors_by_hand(*centres, *all)); }, 0, 3},
          {"surface-nearest", 1.5, ours(lunid::NearestOptions{}),
           [=] { benchmark::DoNotOptimize(nearest_by_hand(*points_in_frame)); }, 0, 3},
          // By hand without the values at all points, which are no work of Qhull's: hence 2.
          {"surface-triangulation", 2, ours(lunid::TriangulationOptions{}),
           [=] { benchmark::DoNotOptimize(triangles_by_hand(corners->at)); }, 0, 3},
          {"surface-network", 1.5, ours(lunid::MlpOptions{.evaluations = network_evaluations}),
           [=] { benchmark::DoNotOptimize(network_by_hand(*network, *points_in_frame)); }, 0, 3},
          {"surface-gaussian-process", 1.5, ours(lunid::GaussianProcessOptions{}),
           [=] { benchmark::DoNotOptimize(process_by_hand(*few, *most, *points_in_frame)); }, 0, 3}};
}

}  // namespace bench

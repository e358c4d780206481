// The surface kinds that a library learns beside that library called directly, with the same options on the same
// points.
#include <benchmark/benchmark.h>
#include <dlib/random_forest.h>
#include <dlib/svm.h>

#include <cmath>
#include <memory>

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
  return {{"surface-random-forest", 1.5, ours(lunid::ForestOptions{}),
           [=] { benchmark::DoNotOptimize(forest_by_hand(*all)); }, 0, 3},
          {"surface-support-vectors", 1.5, ours(lunid::SupportVectorOptions{.width = width}),
           [=] { benchmark::DoNotOptimize(support_vectors_by_hand(*centres, *all)); }, 0, 3}};
}

}  // namespace bench

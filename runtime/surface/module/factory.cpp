// The module's one exported function, and the wall that no other library's exception passes.
#include <dlib/random_forest.h>
#include <dlib/svm.h>

#include "surface/learners.hpp"
#include "surface/module/delaunay.hpp"

namespace lunid::detail {
namespace {

using Sample = dlib::matrix<double, 0, 1>;
using Kernel = dlib::radial_basis_kernel<Sample>;

Sample sample(const Eigen::Vector2d& x) {
  Sample out(2);
  out(0) = x[0];
  out(1) = x[1];
  return out;
}

std::vector<Sample> samples(const Eigen::Matrix2Xd& points) {
  std::vector<Sample> out;
  for (Eigen::Index k = 0; k < points.cols(); ++k) out.push_back(sample(points.col(k)));
  return out;
}

/// Anything that dlib makes and calls with a sample.
template <class Function>
class DlibLearner : public Learner {
 public:
  explicit DlibLearner(Function function) : function_(std::move(function)) {}
  double value(const Eigen::Vector2d& x) const override { return function_(sample(x)); }

 private:
  Function function_;
};

template <class Work>
auto guarded(const char* kind, Work work) {
  try {
    return work();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(std::string("surface: ") + kind + ": " + e.what(), {}, Fault::data);
  }
}

class Library : public Learners {
 public:
  std::vector<std::array<int, 3>> triangulate(const Eigen::Matrix2Xd& points) override { return delaunay(points); }

  std::unique_ptr<Learner> support_vectors(const Eigen::Matrix2Xd& points, const Eigen::VectorXd& target, double cost,
                                           double epsilon, double width) override {
    return guarded("support vectors", [&]() -> std::unique_ptr<Learner> {
      dlib::svr_trainer<Kernel> trainer;
      trainer.set_kernel(Kernel(1 / (2 * width * width)));
      trainer.set_c(cost);
      trainer.set_epsilon_insensitivity(epsilon > 0 ? epsilon : 1e-9);
      trainer.set_epsilon(1e-3);  // of the optimality conditions, for targets of unit variance
      const std::vector<double> y(target.begin(), target.end());
      auto function = trainer.train(samples(points), y);
      return std::make_unique<DlibLearner<decltype(function)>>(std::move(function));
    });
  }

  std::unique_ptr<Learner> forest(const Eigen::Matrix2Xd& points, const Eigen::VectorXd& target,
                                  const ForestOptions& options) override {
    return guarded("random forest", [&]() -> std::unique_ptr<Learner> {
      dlib::random_forest_regression_trainer<dlib::dense_feature_extractor> trainer;
      trainer.set_num_trees(static_cast<std::size_t>(options.trees));
      trainer.set_min_samples_per_leaf(static_cast<std::size_t>(options.least_leaf));
      trainer.set_feature_subsampling_fraction(1);  // of two coordinates none can be spared
      trainer.set_seed(std::to_string(options.seed));
      const std::vector<double> y(target.begin(), target.end());
      auto function = trainer.train(samples(points), y);
      return std::make_unique<DlibLearner<decltype(function)>>(std::move(function));
    });
  }
};

}  // namespace
}  // namespace lunid::detail

extern "C" __attribute__((visibility("default"))) lunid::detail::Learners* lunid_learners(int version) {
  return version == lunid::detail::learners_version ? new lunid::detail::Library : nullptr;
}

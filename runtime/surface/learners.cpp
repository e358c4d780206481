#include "surface/learners.hpp"

#include <algorithm>
#include <cmath>

#include "record/module_file.hpp"
#include "surface/kinds.hpp"
#include "surface/normalised.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

class LearntSurface : public ForceSurface {
 public:
  LearntSurface(std::string name, Cells cells, std::unique_ptr<Learner> learner, Level level)
      : ForceSurface(std::move(cells), 1),
        name_(std::move(name)),
        frame_(this->cells()),
        learner_(std::move(learner)),
        level_(level) {}

  std::string name() const override { return name_; }
  double value(double y, double v) const override {
    return level_.mean + level_.spread * learner_->value(frame_(y, v));
  }

 private:
  std::string name_;
  Frame frame_;
  std::unique_ptr<Learner> learner_;
  Level level_;
};

/// Every `folds`-th centre, or all others.
Centres part(const Centres& all, int fold, int folds, bool inside) {
  std::vector<Index> chosen;
  for (Index i = 0; i < all.size(); ++i)
    if ((i % folds == fold) == inside) chosen.push_back(i);
  return {all.at(Eigen::all, chosen), all.f(chosen), all.weight(chosen)};
}

VectorXd standard(const Centres& data, const Level& level) { return (data.f.array() - level.mean) / level.spread; }

/// The width that predicts left-out centres best.
double best_width(Learners& learners, const Centres& data, const Level& level, const SupportVectorOptions& options) {
  constexpr int folds = 4;
  double best = 0.4, least = HUGE_VAL;
  for (const double width : {0.1, 0.2, 0.4, 0.8, 1.6}) {
    double rss = 0;
    for (int fold = 0; fold < folds; ++fold) {
      const Centres seen = part(data, fold, folds, false), left = part(data, fold, folds, true);
      const auto learner =
          learners.support_vectors(seen.at, standard(seen, level), options.cost, options.epsilon, width);
      const VectorXd target = standard(left, level);
      for (Index i = 0; i < left.size(); ++i)
        rss += left.weight[i] * std::pow(target[i] - learner->value(left.at.col(i)), 2);
    }
    if (rss < least) {
      least = rss;
      best = width;
    }
  }
  return best;
}

}  // namespace

std::unique_ptr<Learners> open_learners() {
  constexpr ModuleFile file{"surface", "the module of learners", "liblunid_learners.so", "LUNID_LEARNERS_MODULE",
                            learners_factory};
  std::unique_ptr<Learners> made(reinterpret_cast<LearnersFactory*>(open_module(file))(learners_version));
  if (!made) throw InputError("surface: the module of learners belongs to another version of Lunid");
  return made;
}

Learnt support_vectors(const SurfacePoints& points, const SupportVectorOptions& options) {
  const Cells cells(points, kCells, kCells);
  const Centres data = cell_means_at_most(points, Frame(cells), options.centres);
  const Level level(data.f, data.weight);
  const std::unique_ptr<Learners> learners = open_learners();
  // The width is told by fewer centres than the surface.
  const Centres few = cell_means_at_most(points, Frame(cells), std::min(options.centres, 200));
  const double width = options.width ? *options.width : best_width(*learners, few, level, options);
  return {std::make_shared<LearntSurface>(
      "support vectors", cells,
      learners->support_vectors(data.at, standard(data, level), options.cost, options.epsilon, width), level)};
}

Learnt forest(const SurfacePoints& points, const ForestOptions& options) {
  const Cells cells(points, kCells, kCells);
  const Frame frame(cells);
  Centres data{Eigen::Matrix2Xd(2, points.size()), points.f, VectorXd::Ones(points.size())};
  for (Index k = 0; k < points.size(); ++k) data.at.col(k) = frame(points.y[k], points.v[k]);
  const Level level(data.f, data.weight);
  return {std::make_shared<LearntSurface>("random forest", cells,
                                          open_learners()->forest(data.at, standard(data, level), options), level)};
}

}  // namespace lunid::detail

// Nearest neighbours by a k-d tree.
#include <cmath>
#include <nanoflann.hpp>

#include "surface/kinds.hpp"
#include "surface/normalised.hpp"

namespace lunid::detail {

using Eigen::Index;

namespace {

/// Points (y, v) of a frame as nanoflann reads them.
struct Cloud {
  Eigen::Matrix2Xd at;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(at.cols()); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return at(static_cast<Index>(axis), static_cast<Index>(index));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

class NearestSurface : public ForceSurface {
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 2, std::uint32_t>;

 public:
  NearestSurface(const SurfacePoints& points, Cells cells, int neighbours)
      : ForceSurface(std::move(cells), 1),
        frame_(this->cells()),
        cloud_{Eigen::Matrix2Xd(2, points.size())},
        f_(points.f),
        neighbours_(std::min<std::size_t>(neighbours, static_cast<std::size_t>(points.size()))),
        tree_(2, filled(points), nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    tree_.buildIndex();
  }

  std::string name() const override { return "nearest neighbours"; }

  double value(double y, double v) const override {
    const Eigen::Vector2d x = frame_(y, v);
    std::vector<std::uint32_t> index(neighbours_);
    std::vector<double> square(neighbours_);
    const std::size_t found = tree_.knnSearch(x.data(), neighbours_, index.data(), square.data());
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < found; ++k) {
      // No point weighs more than a thousand times one at a thousandth of the range.
      const double weight = 1 / (std::sqrt(square[k]) + 1e-6);
      sum += weight * f_[static_cast<Index>(index[k])];
      weights += weight;
    }
    return sum / weights;
  }

 private:
  const Cloud& filled(const SurfacePoints& points) {
    for (Index k = 0; k < points.size(); ++k) cloud_.at.col(k) = frame_(points.y[k], points.v[k]);
    return cloud_;
  }

  Frame frame_;
  Cloud cloud_;
  Eigen::VectorXd f_;
  std::size_t neighbours_;
  Tree tree_;
};

}  // namespace

Learnt nearest(const SurfacePoints& points, const NearestOptions& options) {
  return {std::make_shared<NearestSurface>(points, Cells(points, kCells, kCells), options.neighbours)};
}

}  // namespace lunid::detail

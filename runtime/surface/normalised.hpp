#pragma once
// Inside surface: points in coordinates of -1..1, and cell means.
#include "surface/surface.hpp"

namespace lunid::detail {

/// Map of the rectangle of the data to -1..1 along both axes.
struct Frame {
  double y_middle, y_half, v_middle, v_half;
  explicit Frame(const Cells& cells)
      : y_middle((cells.y_max() + cells.y_min()) / 2),
        y_half((cells.y_max() - cells.y_min()) / 2),
        v_middle((cells.v_max() + cells.v_min()) / 2),
        v_half((cells.v_max() - cells.v_min()) / 2) {}
  Eigen::Vector2d operator()(double y, double v) const { return {(y - y_middle) / y_half, (v - v_middle) / v_half}; }
};

/// Points in a frame: a column (x, z) each, with the mean force and the number of measured points that they stand for.
struct Centres {
  Eigen::Matrix2Xd at;
  Eigen::VectorXd f, weight;
  Eigen::Index size() const { return f.size(); }
};
/// The mean point of each cell of a grid of so many cells along each axis that holds points; in a fixed order.
Centres cell_means(const SurfacePoints& points, const Frame& frame, int cells);
/// The same on the finest grid of no more than `most` cells with points (and 300 along an axis).
Centres cell_means_at_most(const SurfacePoints& points, const Frame& frame, int most);

/// Mean and standard deviation of forces, weighted; the deviation is 1 where all are equal.
struct Level {
  double mean, spread;
  Level(const Eigen::VectorXd& f, const Eigen::VectorXd& weight);
};

}  // namespace lunid::detail

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "expr/tape.hpp"
#include "surface/surface.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

void check(const SurfacePoints& points) {
  if (points.size() == 0 || points.v.size() != points.size() || points.f.size() != points.size())
    throw InputError("surface: expected y, v and f of one length, got " + std::to_string(points.y.size()) + ", " +
                         std::to_string(points.v.size()) + " and " + std::to_string(points.f.size()) + " values",
                     {}, Fault::data);
  for (Index i = 0; i < points.size(); ++i)
    if (!std::isfinite(points.y[i] + points.v[i] + points.f[i]))
      throw InputError("surface: point " + std::to_string(i + 1) + " is not finite", {}, Fault::data);
}

/// Points that lie on a line to rounding have no surface over them.
void check_spread(const SurfacePoints& p) {
  const VectorXd y = p.y.array() - p.y.mean(), v = p.v.array() - p.v.mean();
  const double yy = y.squaredNorm(), vv = v.squaredNorm(), yv = y.dot(v);
  const double off = (v - (yv / yy) * y).squaredNorm();  // what of v the line through y leaves
  if (off > 1e-20 * vv) return;
  const double slope = yv / yy, start = p.v.mean() - slope * p.y.mean();
  throw InputError("surface: all points lie on the line v = " + number(slope, 4) + "*y" + (start < 0 ? " - " : " + ") +
                       number(std::abs(start), 4) + ": a surface needs points beside it",
                   {}, Fault::data);
}

int position(double x, double min, double max, int cells, double& along) {
  const double at = (x - min) / (max - min) * cells;
  const int cell = std::clamp(static_cast<int>(at), 0, cells - 1);
  along = at - cell;
  return cell;
}

}  // namespace

Cells::Cells(const SurfacePoints& points, int cells_y, int cells_v) : count_(Eigen::MatrixXi::Zero(cells_y, cells_v)) {
  check(points);
  y_min_ = points.y.minCoeff();
  y_max_ = points.y.maxCoeff();
  v_min_ = points.v.minCoeff();
  v_max_ = points.v.maxCoeff();
  if (!(y_min_ < y_max_)) throw InputError("surface: y is constant (" + number(y_min_) + ")", {}, Fault::data);
  if (!(v_min_ < v_max_)) throw InputError("surface: v is constant (" + number(v_min_) + ")", {}, Fault::data);
  check_spread(points);
  for (Index k = 0; k < points.size(); ++k) {
    const Place at = place(points.y[k], points.v[k]);
    ++count_(at.i, at.j);
  }
}

Cells::Place Cells::place(double y, double v) const {
  Place at;
  at.i = position(y, y_min_, y_max_, cells_y(), at.along_y);
  at.j = position(v, v_min_, v_max_, cells_v(), at.along_v);
  return at;
}

bool ForceSurface::has_data(double y, double v) const {
  if (!cells_.inside(y, v)) return false;
  const Cells::Place at = cells_.place(y, v);
  return cells_.count()(at.i, at.j) >= least_count_;
}

Eigen::Vector2d ForceSurface::gradient(double y, double v) const {
  const double dy = 1e-5 * (cells_.y_max() - cells_.y_min()), dv = 1e-5 * (cells_.v_max() - cells_.v_min());
  return {(value(y + dy, v) - value(y - dy, v)) / (2 * dy), (value(y, v + dv) - value(y, v - dv)) / (2 * dv)};
}

double ForceSurface::std(double, double) const { return std::nan(""); }

double ForceSurface::continued(double y, double v) const {
  const double here = value(y, v);
  if (!std::isnan(here)) return here;
  const double y_middle = (cells_.y_min() + cells_.y_max()) / 2, v_middle = (cells_.v_min() + cells_.v_max()) / 2;
  const auto along = [&](double part) {
    return value(y_middle + part * (y - y_middle), v_middle + part * (v - v_middle));
  };
  constexpr int steps = 50;
  for (int k = 1; k <= steps; ++k) {  // inwards; where the middle itself is empty, outwards
    const double inward = along(1 - static_cast<double>(k) / steps);
    if (!std::isnan(inward)) return inward;
  }
  for (int k = 1; k <= 4 * steps; ++k) {
    const double outward = along(1 + static_cast<double>(k) / steps);
    if (!std::isnan(outward)) return outward;
  }
  return here;
}

SurfacePoints restoring_points(std::span<const Record> records, Expr mass) {
  std::vector<Expr> inputs;
  Tape tape;
  if (mass.valid() && !mass.is_constant(0)) {
    Pool& pool = mass.pool();
    const Expr force = pool.channel("F") - mass * pool.channel("a");
    for (const Expr& s : symbols(force)) {
      if (s.kind() != SymbolKind::channel)
        throw InputError("surface: the mass holds '" + s.name() + "', which has no value here");
      inputs.push_back(s);
    }
    tape = Tape(std::span(&force, 1), inputs);
  }
  Index total = 0;
  for (const Record& record : records) total += record.rows();
  SurfacePoints out{VectorXd(total), VectorXd(total), VectorXd(total)};
  Index at = 0;
  for (const Record& record : records) {
    const Index rows = record.rows();
    const auto column = [&](const std::string& name) { return Eigen::Map<const VectorXd>(record[name].data(), rows); };
    out.y.segment(at, rows) = column("y");
    out.v.segment(at, rows) = column("v");
    if (inputs.empty()) {
      out.f.segment(at, rows) = column("F");
    } else {
      std::vector<const double*> in;
      for (const Expr& s : inputs) in.push_back(record[s.name()].data());
      const std::vector<int> stride(in.size(), 1);
      double* const f = out.f.data() + at;
      tape.run_columns(in, stride, static_cast<std::size_t>(rows), std::span(&f, 1));
    }
    at += rows;
  }
  check(out);
  return out;
}

}  // namespace lunid

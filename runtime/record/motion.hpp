#pragma once
// Inside record: the coordinates of a record's motion and what its derivatives and integrals are called.
#include <span>
#include <string>
#include <vector>

#include "record/record.hpp"

namespace lunid {

/// What stands behind y, v or a in the names of the channels: "" of one coordinate, "1" "2" ... of several, "b" of a
/// base; in order of appearance.
std::vector<std::string> coordinates(const Record& record);
/// The unit of the derivative of this rank (0: y, 1: v, 2: a) where a channel of the coordinate has the unit `from`.
std::string motion_unit(const std::string& from, int rank);
/// The record with its derived motion made anew (derive_motion) from what is measured, where that has changed since.
Record derive_motion_anew(const Record& record);
/// The derivative of a channel that is constant: zero, without the rounding errors that a filter would make of it.
Channel at_rest(Channel channel, const std::string& from, Eigen::Index rows);
/// Rows [first, first + count) of an integral by cubics through four samples, which is `start` at row `first`; of a
/// signal of `rows` rows, of which x holds those from `low` on: one before `first` and one after the last at least, as
/// far as there are any.
Eigen::VectorXd continued_integral(double start, const Eigen::VectorXd& x, Eigen::Index low, Eigen::Index first,
                                   Eigen::Index count, Eigen::Index rows, double dt);
/// Integral from 0 by cubics through four samples (error of order dt^4), rid of its least-squares polynomial; degree
/// -1: as it is.
Eigen::VectorXd integrate(std::span<const double> x, double dt, int degree);

}  // namespace lunid

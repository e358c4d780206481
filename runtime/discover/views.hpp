#pragma once
// Columns as vectors, and vectors as the records and models take them; the data stay where they are.
#include <Eigen/Core>
#include <span>
#include <string>

#include "record/record.hpp"

namespace lunid {

inline Eigen::Map<const Eigen::VectorXd> as_vector(std::span<const double> x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}
inline std::span<const double> view(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// A channel with its rows in the record's window alone.
inline Channel of_window(const Record& record, const std::string& name) {
  Channel out = record.channel(name);
  out.values = as_vector(record[name]);
  return out;
}

}  // namespace lunid

#pragma once
// Models whose branches are smoothed over a width, for those who ask for it: Lunid itself locates every switch.
#include <string>
#include <vector>

#include "simulate/model.hpp"

namespace lunid {

struct Regularised {
  Model model;
  std::vector<std::string> replaced;  ///< "sign(v)", each once
};

/// sign(g) becomes tanh(g/width), abs(g) g*tanh(g/width), max and min their means with abs so taken, a > b and its kin
/// (1 + tanh((a - b)/width))/2, by which where() mixes its two values. `width` is in the unit of g. Bounds of states
/// stay what they are. Adds nodes to the model's pool. Throws InputError for a width that is not > 0.
Regularised regularised(const Model& model, double width);

}  // namespace lunid

#pragma once
// What the test records say of the names that the training records gave.
#include "discover/conclusion.hpp"
#include "discover/ground.hpp"

namespace lunid {

/// Opens the test records once. They can take names back, leave what the training records held beside them (ties, and
/// common names that rarer ones displaced), and bear out the one effect that these show by less than the least gain;
/// they add no other. Sets the verdict of `round`, and fills the gaps, p-value and warnings of `out`.
ModelRuns judge_on_test(Ground& ground, Round& round, Discovery& out);

}  // namespace lunid

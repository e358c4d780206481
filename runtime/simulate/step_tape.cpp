#include "simulate/step_tape.hpp"

#include <algorithm>
#include <utility>

#include "expr/chain.hpp"

namespace lunid {
namespace {

namespace dp = dormand_prince;
using Number = TapeChain::Number;
using Numbers = std::vector<Number>;

/// More instructions than this are code that the first cache does not hold beside the lanes.
constexpr int most_instructions = 1200;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

/// Puts the stages together. Works on the places of a StepTape that has no tape yet.
class StepTape::Builder {
 public:
  Builder(StepTape& step, const Dynamics& d, const TimeTape* force)
      : step_(step),
        d_(d),
        force_(force),
        values_(step.turns_ ? static_cast<int>(force->values().size()) : 0),
        chain_(step.turns_ ? step.end_value() + values_ : step.drive(dp::nodes + 1)),
        h_(chain_.input(step.h())),
        x_(inputs(step.x(), d.n)),
        theta_(inputs(step.theta(), d.p)) {}

  Tape build() {
    k_ = {inputs(step_.k(), d_.n)};
    for (int i = 0; i < d_.n; ++i)
      if (const int speed = speed_of(d_, i); speed >= 0) k_[0][at(i)] = x_[at(speed)];
    for (int stage = 1; stage < dp::stages; ++stage) {
      const Numbers out = rates(stage_state(stage), stage, dp::place[at(stage)]).outputs;
      look_at(out, stage == 1 ? 0 : d_.n);
      k_.emplace_back(out.begin(), out.begin() + d_.n);
    }
    const Numbers next = stage_state(dp::stages);
    const TapeChain::Run last = rates(next, dp::nodes, 1);
    look_at(last.outputs, 0);
    Numbers outputs = next;
    for (const int i : step_.kept_) outputs.push_back(last.outputs[at(i)]);
    if (!d_.smooth()) add_events(outputs, next, last);
    return chain_.tape(outputs);
  }

 private:
  Numbers inputs(int first, int count) {
    Numbers list;
    for (int i = 0; i < count; ++i) list.push_back(chain_.input(first + i));
    return list;
  }

  /// x + h * (weights of a stage) . k, in the order of dormand_prince::stage_state.
  Numbers stage_state(int stage) {
    Numbers out;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const auto part = [&](int j) { return chain_.product(chain_.constant(dp::weight[stage][j]), k_[at(j)][i]); };
      Number sum = part(0);
      for (int j = 1; j < stage; ++j)
        if (dp::weight[stage][j] != 0) sum = chain_.sum(sum, part(j));
      out.push_back(chain_.sum(x_[i], chain_.product(h_, sum)));
    }
    return out;
  }

  /// The exogenous inputs at node 1 to 5, as LaneForce::values and the rest of its tape.
  Numbers exogenous_at(int node) {
    if (!step_.turns_) return inputs(step_.drive(node), d_.exogenous);
    Numbers in = {chain_.input(step_.time())};
    for (const Number number : inputs(step_.q(), step_.q_)) in.push_back(number);
    for (int i = 0; i < values_; ++i)
      in.push_back(node > inner_nodes ? chain_.input(step_.end_value() + i) : turned(node, force_->values()[at(i)]));
    return chain_.run(force_->rest(), in).outputs;
  }
  Number turned(int node, const TimeTape::Value& value) {
    const int wave = step_.wave(value.wave), turn = step_.turn(node, value.wave);
    const Number c = chain_.input(wave), s = chain_.input(wave + 1), rc = chain_.input(turn),
                 rs = chain_.input(turn + 1);
    return value.sine ? chain_.sum(chain_.product(s, rc), chain_.product(c, rs))
                      : chain_.difference(chain_.product(c, rc), chain_.product(s, rs));
  }

  /// What a tape of the system takes at a node.
  Numbers point(const Numbers& x, int node, double place) {
    Numbers in = {chain_.sum(chain_.input(step_.time()), chain_.product(chain_.constant(place), h_))};
    const Numbers exogenous = exogenous_at(node);
    for (const Numbers* part : {&exogenous, &x, &theta_}) in.insert(in.end(), part->begin(), part->end());
    return in;
  }
  Numbers modes(const Dynamics::SwitchMap& map) {
    Numbers list;
    for (std::size_t i = 0; i < map.surface.size(); ++i) {
      const Number mode = chain_.input(step_.mode() + map.surface[i]);
      list.push_back(map.orientation[i] > 0 ? mode : chain_.negative(mode));
    }
    return list;
  }
  TapeChain::Run rates(const Numbers& x, int node, double place) {
    return chain_.run(d_.rate, point(x, node, place), modes(d_.rate_switches));
  }

  /// A rate that is not finite makes the next x so, but for the second one, which has no weight there, the last one,
  /// and gaps.
  void look_at(const Numbers& rates, int from) {
    if (d_.smooth()) return;
    for (std::size_t i = at(from); i < rates.size(); ++i) {
      const Number part = chain_.product(chain_.constant(0), rates[i]);
      sound_ = looked_ ? chain_.sum(sound_, part) : part;
      looked_ = true;
    }
  }

  /// As ModeMachine::observe.
  void add_events(Numbers& outputs, const Numbers& x, const TapeChain::Run& last) {
    outputs.push_back(sound_);
    const Numbers gradients = chain_.run(d_.gradients, point(x, dp::nodes, 1), modes(d_.gradient_switches)).outputs;
    for (std::size_t s = 0; s < d_.surfaces.size(); ++s) {
      const Number mode = chain_.input(step_.mode() + static_cast<int>(s));
      const auto row = gradients.begin() + static_cast<std::ptrdiff_t>(s) * d_.inputs();
      Number rate = row[0];
      for (int i = 0; i < d_.n; ++i)
        rate = chain_.sum(rate, chain_.product(row[1 + d_.exogenous + i], last.outputs[at(i)]));
      outputs.push_back(chain_.product(mode, last.switches[at(d_.surfaces[s].switch_index)]));
      outputs.push_back(rate);
      outputs.push_back(chain_.product(mode, rate));
    }
    for (std::size_t j = 0; j < d_.bounds.size(); ++j) {
      const Number rate = last.outputs[at(d_.n) + d_.bounds.size() + j];
      outputs.insert(outputs.end(), {last.outputs[at(d_.n) + j], rate, rate});
    }
  }

  StepTape& step_;
  const Dynamics& d_;
  const TimeTape* force_;
  const int values_;
  TapeChain chain_;
  const Number h_;
  const Numbers x_, theta_;
  std::vector<Numbers> k_;  ///< by stage, then by state
  Number sound_ = 0;
  bool looked_ = false;
};

int speed_of(const Dynamics& d, int state) {
  const int speed = d.rate.copy_of(state) - 1 - d.exogenous;
  const bool displacement = state < 2 * d.degrees && state % 2 == 0;
  return displacement && speed > state && speed < d.n ? speed : -1;
}

bool StepTape::tells_events(const Dynamics& d) {
  const auto& surface = d.gradient_switches.surface;
  return !d.input_rates && std::all_of(surface.begin(), surface.end(), [](int s) { return s >= 0; });
}

StepTape::StepTape(const Dynamics& d, const TimeTape* force)
    : n_(d.n), p_(d.p), exogenous_(d.exogenous), surfaces_(static_cast<int>(d.surfaces.size())) {
  turns_ = force && !force->rest().reads(0);
  if (turns_) waves_ = force->waves(), q_ = force->inputs() - 1;
  for (int i = 0; i < n_; ++i)
    if (speed_of(d, i) < 0) kept_.push_back(i);
  tape_ = Builder(*this, d, force).build();
}

namespace {

/// Doubles from one register to the next: as Machine::lane_row where the lanes fit.
std::size_t row_of(int width) { return static_cast<std::size_t>(std::max(width, 64) + 8); }

}  // namespace

std::size_t StepTape::memory(int width) const {
  return row_of(width) * static_cast<std::size_t>(std::max(tape_.registers(), tape_.inputs()) + 1);
}

std::vector<double*> StepTape::place(double* memory, int width) const {
  std::vector<double*> place(this->memory(width) / row_of(width));
  for (double*& row : place) row = std::exchange(memory, memory + row_of(width));
  return place;
}

bool StepTape::worthwhile() const { return tape_.instructions() <= most_instructions && tape_.lanes_compiled(); }

}  // namespace lunid

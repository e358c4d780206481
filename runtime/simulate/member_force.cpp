#include "simulate/ensemble.hpp"

namespace lunid {

using Eigen::Index;
using Eigen::VectorXd;

MemberForce MemberForce::of(Excitations excitation) {
  const Index rows = excitation.rows();
  MemberForce force = of(rows, [excitation = std::move(excitation)](Index) { return excitation; });
  force.shared_ = true;
  return force;
}

MemberForce MemberForce::of(Index rows, std::function<Excitations(Index)> make) {
  MemberForce force;
  force.rows_ = rows;
  force.make_ = std::move(make);
  return force;
}

MemberForce MemberForce::of(std::vector<std::string> channels, TimeTape tape, Eigen::MatrixXd q, double t0, VectorXd dt,
                            Index rows) {
  MemberForce force;
  force.rows_ = rows;
  force.channels_ = std::move(channels);
  force.tape_ = std::move(tape);
  force.q_ = std::move(q);
  force.t0_ = t0;
  force.dt_ = std::move(dt);
  return force;
}

Excitations MemberForce::excitation(Index member) const {
  if (make_) return make_(member);
  const std::vector<double> q(this->q(member), this->q(member) + tape_.inputs() - 1);
  Excitations all;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    all.add(channels_[i], Excitation(t0_, dt_[member], rows_, function_of_time(tape_, q, static_cast<int>(i))));
  return all;
}

}  // namespace lunid

#include "discover/one_motion.hpp"

#include <Eigen/Dense>

#include <cmath>

#include "discover/views.hpp"

namespace lunid {

namespace {

using Eigen::Index;

Tone tone_at(const Eigen::VectorXd& x, double dt, double omega) {
  Eigen::MatrixX3d waves(x.size(), 3);
  for (Index i = 0; i < x.size(); ++i) {
    const double phase = omega * dt * static_cast<double>(i);
    waves.row(i) << std::cos(phase), std::sin(phase), 1;
  }
  const Eigen::Vector3d part = (waves.transpose() * waves).ldlt().solve(waves.transpose() * x);
  const double left = (x - waves * part).squaredNorm();
  return {omega, part.head<2>().norm(), 1 - left / (x.array() - x.mean()).square().sum()};
}

}  // namespace

Tone strongest_tone(std::span<const double> x, double dt) {
  const Eigen::VectorXd moved = as_vector(x);
  const double centre = dominant_frequency(x, dt);
  if (!(centre > 0) || !((moved.array() - moved.mean()).square().sum() > 0)) return {};
  Tone best = tone_at(moved, dt, centre);
  double reach = 2 * M_PI / (dt * static_cast<double>(x.size()));  // a line of the spectrum
  for (int pass = 0; pass < 8; ++pass, reach /= 3)
    for (const double off : {-reach, reach})
      for (Tone next = tone_at(moved, dt, best.omega + off); next.share > best.share;
           next = tone_at(moved, dt, best.omega + off))
        best = next;
  return best;
}

double one_motion(const Study& study, const std::vector<Record>& records) {
  constexpr double nearly_all = 0.97, frequency = 0.02, level = 0.1;
  if (study.degrees() > 1) return 0;
  const std::string moves = study.imposed ? "y" : study.output();
  double omega = 0, amplitude = 0;  // of the first
  for (const Record& record : records) {
    const Tone tone = strongest_tone(record[moves], record.dt());
    if (!(tone.share > nearly_all)) return 0;
    if (omega == 0) omega = tone.omega, amplitude = tone.amplitude;
    if (!(std::abs(tone.omega - omega) < frequency * omega && std::abs(tone.amplitude - amplitude) < level * amplitude))
      return 0;
  }
  return omega;
}

}  // namespace lunid

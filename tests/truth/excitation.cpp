#include "truth/excitation.hpp"

#include <cmath>
#include <random>
#include <vector>

namespace truth {

Signal multisine(double from, double to, int lines, std::uint64_t seed) {
  struct Line {
    double frequency, phase;
  };
  std::mt19937_64 bits(seed);
  const auto uniform = [&bits] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  const double spacing = (to - from) / lines;
  std::vector<Line> table(lines);
  for (int i = 0; i < lines; ++i) {
    table[i].frequency = from + spacing * (i + uniform());
    table[i].phase = 2 * M_PI * uniform();
  }
  return [table](double tau) {
    double sum = 0;
    for (const Line& line : table) sum += std::cos(line.frequency * tau + line.phase);
    return sum;
  };
}

Signal chirp(double from, double to, double duration) {
  const double rate = (to - from) / duration;
  return [=](double tau) {
    if (tau <= duration) return std::cos((from + 0.5 * rate * tau) * tau);
    const double late = tau - duration, phase = (from + 0.5 * rate * duration) * duration;
    return std::cos(phase + (to - 0.5 * rate * late) * late);
  };
}

Signal step(double start) {
  return [=](double tau) { return 0.5 * (1 + std::tanh(4 * (tau - start))); };
}

Signal tone(double frequency) {
  return [=](double tau) { return std::cos(frequency * tau); };
}

Signal none() {
  return [](double) { return 0.0; };
}

}  // namespace truth

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "expr/joined.hpp"
#include "record/checks.hpp"
#include "record/extension.hpp"
#include "record/method_parts.hpp"
#include "record/treat_parts.hpp"

namespace lunid {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXd;

enum class Kind { low, high, pass, stop };

Kind kind_of(const Band& band) {
  const bool both = band.from > 0 && band.to > 0;
  if (both) return band.stop ? Kind::stop : Kind::pass;
  return (band.to > 0) != band.stop ? Kind::low : Kind::high;
}

void check(const Band& band, int order, double dt) {
  const double nyquist = 0.5 / dt;
  const auto fail = [](const std::string& text) { refuse("filter", text); };
  if (order < 1 || order > 12) fail("order: expected 1 to 12, got " + std::to_string(order));
  if (!(band.from > 0) && !(band.to > 0)) fail("give from, to or both");
  for (const auto& [name, value] : {std::pair{"from", band.from}, {"to", band.to}})
    if (value < 0 || value >= nyquist)
      fail(std::string(name) + ": expected < " + short_number(nyquist) + " Hz, the Nyquist frequency, got " +
           short_number(value));
  if (band.from > 0 && band.to > 0 && band.to <= band.from)
    fail("to: expected > from, which is " + short_number(band.from) + ", got " + short_number(band.to));
}

double warped(double frequency, double dt) { return std::tan(std::numbers::pi * frequency * dt); }

/// From s to z by the bilinear transformation s = (z - 1)/(z + 1).
Complex to_z(Complex s) { return (1.0 + s) / (1.0 - s); }

/// The poles of the analogue low pass of cut-off 1 with an imaginary part >= 0.
std::vector<Complex> prototype(int order) {
  std::vector<Complex> poles;
  for (int k = 0; k < (order + 1) / 2; ++k) {
    const double angle = std::numbers::pi * (2 * k + 1) / (2.0 * order);
    poles.push_back(2 * k + 1 == order ? Complex(-1, 0) : Complex(-std::sin(angle), std::cos(angle)));
  }
  return poles;
}

/// A section with these two poles in z and the zeros given by the numerator 1, b1, b2; amplitude 1 at `at` (on the unit
/// circle).
Section section(Complex p, Complex q, double b1, double b2, Complex at) {
  Section s{1, b1, b2, -(p + q).real(), (p * q).real()};
  const Complex inverse = 1.0 / at;
  const double size = std::abs((1.0 + inverse * (b1 + inverse * b2)) / (1.0 + inverse * (s.a1 + inverse * s.a2)));
  s.b0 /= size, s.b1 /= size, s.b2 /= size;
  return s;
}

/// A low-pass pole becomes two in a band around `centre` of width `width` (or in a stop band).
std::pair<Complex, Complex> split(Complex pole, double centre, double width, bool stop) {
  const Complex half = 0.5 * width * (stop ? 1.0 / pole : pole);
  const Complex root = std::sqrt(half * half - centre * centre);
  return {half + root, half - root};
}

/// Its rows in place, from rest.
void run(const std::vector<Section>& sections, VectorXd& x) {
  for (const Section& s : sections) {
    double one = 0, two = 0;  // transposed form
    for (double& value : x) {
      const double in = value, out = s.b0 * in + one;
      one = s.b1 * in - s.a1 * out + two;
      two = s.b2 * in - s.a2 * out;
      value = out;
    }
  }
}

std::string words(const Band& band) {
  const std::string range = band.from > 0 && band.to > 0
                                ? short_number(band.from) + " to " + short_number(band.to) + " Hz"
                            : band.to > 0 ? "below " + short_number(band.to) + " Hz"
                                          : "above " + short_number(band.from) + " Hz";
  return (band.stop ? "without " : "") + range;
}

}  // namespace

std::vector<Section> butterworth(const Band& band, int order, double dt) {
  check(band, order, dt);
  const Kind kind = kind_of(band);
  std::vector<Section> sections;
  if (kind == Kind::low || kind == Kind::high) {
    const double cut = warped(band.to > 0 ? band.to : band.from, dt), zero = kind == Kind::low ? 1 : -1;
    for (const Complex pole : prototype(order)) {
      const Complex p = to_z(kind == Kind::low ? cut * pole : cut / pole);
      const Complex at(zero, 0);
      sections.push_back(pole.imag() == 0 ? section(p, 0, zero, 0, at) : section(p, std::conj(p), 2 * zero, 1, at));
    }
    return sections;
  }
  const double low = warped(band.from, dt), high = warped(band.to, dt), centre = std::sqrt(low * high);
  const bool stop = kind == Kind::stop;
  const Complex middle = to_z(Complex(0, centre)), reference = stop ? Complex(1, 0) : middle;
  const double b1 = stop ? -2 * middle.real() : 0, b2 = stop ? 1 : -1;
  for (const Complex pole : prototype(order)) {
    const auto [one, two] = split(pole, centre, high - low, stop);
    const Complex p = to_z(one), q = to_z(two);
    if (pole.imag() == 0) {  // its two poles are a pair already, conjugate or real
      sections.push_back(section(p, q, b1, b2, reference));
    } else {
      sections.push_back(section(p, std::conj(p), b1, b2, reference));
      sections.push_back(section(q, std::conj(q), b1, b2, reference));
    }
  }
  return sections;
}

double amplitude_at(const std::vector<Section>& sections, double frequency, double dt) {
  const Complex inverse = std::polar(1.0, -2 * std::numbers::pi * frequency * dt);
  double size = 1;
  for (const Section& s : sections)
    size *= std::abs((s.b0 + inverse * (s.b1 + inverse * s.b2)) / (1.0 + inverse * (s.a1 + inverse * s.a2)));
  return size;
}

Index filter_reach(const std::vector<Section>& sections, Index most) {
  VectorXd response = VectorXd::Zero(most + 1);
  response[0] = 1;
  run(sections, response);
  const double all = response.cwiseAbs().sum();
  double rest = 0;
  Index reach = most + 1;
  while (reach > 0 && (rest += std::abs(response[reach - 1])) < 1e-13 * all) --reach;
  return reach;
}

Index filter_extension(const std::vector<Section>& sections, Index rows) {
  double slowest = 0;
  for (const Section& s : sections) {
    const Complex root = std::sqrt(Complex(s.a1 * s.a1 - 4 * s.a2));
    slowest = std::max({slowest, std::abs(-s.a1 + root) / 2, std::abs(-s.a1 - root) / 2});
  }
  const double memory = std::ceil(std::log(1e-10) / std::log(std::min(slowest, 1 - 1e-9)));
  return std::min(static_cast<Index>(std::min(1e7, memory)) + 8, std::max<Index>(4 * rows, 1024));
}

void run_zero_phase(const std::vector<Section>& sections, VectorXd& x) {
  for (int direction = 0; direction < 2; ++direction) {
    run(sections, x);
    x.reverseInPlace();
  }
}

bool passes_line(const Band& band) {
  const Kind kind = kind_of(band);
  return kind == Kind::low || kind == Kind::stop;
}

double noise_passed(const std::vector<Section>& sections, double dt) {
  constexpr int points = 2048;
  double power = 0;
  for (int i = 0; i < points; ++i)
    power += std::pow(amplitude_at(sections, 0.5 / dt * (i + 0.5) / points, dt), 4) / points;
  return std::sqrt(power);
}

std::string filter_note(const std::vector<std::string>& channels, const FilterOptions& options) {
  return "filter: " + joined(channels) + " " + words(options.band) + ", Butterworth of order " +
         std::to_string(options.order) + " forwards and backwards";
}

VectorXd filter_zero_phase(std::span<const double> x, const Band& band, int order, double dt) {
  const std::vector<Section> sections = butterworth(band, order, dt);
  const auto n = static_cast<Index>(x.size());
  Extended extended = extend(x, filter_extension(sections, n));
  run_zero_phase(sections, extended.values);
  VectorXd result = extended.values.segment(extended.reach, n);
  if (passes_line(band)) result += extended.line;
  return result;
}

Record filter(const Record& record, const FilterOptions& options) {
  const double passed = noise_passed(butterworth(options.band, options.order, record.dt()), record.dt());
  const std::vector<std::string> names = names_or_all(record.channels(), options.channels, "filter");
  Record result = record;
  for (const std::string& name : names) {
    const auto x = numbers(record, name, "filter");
    Channel channel = with_values(record, name, filter_zero_phase(x, options.band, options.order, record.dt()));
    channel.noise *= passed;
    result = result.with(std::move(channel));
  }
  result.note(filter_note(names, options));
  return result;
}

}  // namespace lunid

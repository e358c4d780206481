// lunid_nist [DIR]: the NIST StRD regression problems. Linear ones beside Householder QR in double, nonlinear ones from
// both starts; digits are those of the worst parameter and of the worst standard deviation. Last line
// `nist linear A/11 nonlinear B/54`; exit 1 unless all are reached.
#include <Eigen/QR>
#include <cstdio>
#include <exception>

#include "nist/problems.hpp"
#include "regress/fit.hpp"

namespace {

constexpr double kLinear = 9, kValues = 6, kDeviations = 4;  // digits to reach

/// Digits of the coefficients and, where the fit is not exact, of the standard deviations.
bool linear(const std::filesystem::path& folder, const std::string& name) {
  const nist::LinearProblem p = nist::read_linear(folder, name);
  lunid::Statistic data(p.features);
  data.add(p.x, p.y);
  const lunid::Fit fit = least_squares(data);
  const Eigen::VectorXd plain = p.x.householderQr().solve(p.y);
  const double ours = nist::digits(fit.coefficients, p.certified.values);
  const double theirs = nist::digits(plain, p.certified.values);
  const bool good = ours >= std::min(kLinear, theirs);
  const bool exact = p.certified.deviations.maxCoeff() == 0;
  std::printf("%-10s linear      digits %4.1f   std ", name.c_str(), ours);
  if (exact)
    std::printf("   -");
  else
    std::printf("%4.1f", nist::digits(fit.std, p.certified.deviations));
  std::printf("   Householder QR in double %4.1f%s\n", theirs, good ? "" : "   MISSED");
  return good;
}

bool nonlinear(const std::filesystem::path& folder, const nist::Formula& formula, int start) {
  const nist::Solved solved = nist::solve(nist::read_nonlinear(folder, formula.name), formula, start);
  const bool good = solved.values >= kValues && solved.deviations >= kDeviations;
  std::printf("%-10s from start %d digits %4.1f   std %4.1f   %d iterations, %d evaluations: %s%s\n", formula.name,
              start + 1, solved.values, solved.deviations, solved.iterations, solved.evaluations,
              solved.stopped.c_str(), good ? "" : "   MISSED");
  return good;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path folder = argc > 1 ? argv[1] : LUNID_SHARED_DATA "/nist";
  int reached[2] = {0, 0}, count[2] = {0, 0};
  for (const std::string& name : nist::linear_names()) {
    ++count[0];
    reached[0] += linear(folder / "linear", name);
  }
  for (const nist::Formula& formula : nist::formulas())
    for (int start = 0; start < 2; ++start) {
      ++count[1];
      reached[1] += nonlinear(folder / "nonlinear", formula, start);
    }
  std::printf("nist linear %d/%d nonlinear %d/%d\n", reached[0], count[0], reached[1], count[1]);
  return reached[0] == count[0] && reached[1] == count[1] ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "lunid_nist: %s\n", error.what());
  return 3;
}

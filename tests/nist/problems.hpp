#pragma once
// The NIST StRD regression problems as the tests and `scripts/bench nist` run them. Data and certified values are read
// from a folder (shared/data/README.md); the formulas are here.
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "record/record.hpp"

namespace nist {

/// Significant digits that agree: -log10 of the relative error, of the absolute one where the truth is 0; 0 to 15.
double digits(double got, double certified);
double digits(const Eigen::VectorXd& got, const Eigen::VectorXd& certified);  ///< of the worst entry

struct Certified {
  Eigen::VectorXd values, deviations;
};

struct LinearProblem {
  std::string name;
  std::vector<std::string> features;
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
  Certified certified;
};
/// Names of the 11 problems.
const std::vector<std::string>& linear_names();
/// Throws std::runtime_error when a file is absent.
LinearProblem read_linear(const std::filesystem::path& folder, const std::string& name);

/// A nonlinear problem: its formula of x (x1, x2) and b1, b2 ...
struct Formula {
  const char* name;
  const char* text;
  const char* response = "y";
};
const std::vector<Formula>& formulas();

struct NonlinearProblem {
  Eigen::VectorXd starts[2];
  Certified certified;
  double rss = 0;
  lunid::Record data;
};
NonlinearProblem read_nonlinear(const std::filesystem::path& folder, const std::string& name);

/// One problem solved from one start: digits of the worst parameter and of the worst standard deviation.
struct Solved {
  double values = 0, deviations = 0;
  int iterations = 0, evaluations = 0;
  std::string stopped;
};
Solved solve(const NonlinearProblem& problem, const Formula& formula, int start);

}  // namespace nist

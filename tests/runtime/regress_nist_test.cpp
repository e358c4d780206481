// NIST StRD, linear least squares: certified values computed in exact rational arithmetic (shared/data/README.md).
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "regress/fit.hpp"

using namespace lunid;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const std::filesystem::path kFolder = std::filesystem::path(LUNID_SHARED_DATA) / "nist/linear";

/// Relative errors allowed: the Householder class, condition * 1e-16 and, for coefficients, condition^2 * 1e-16 *
/// |residual| / |fit|. Wampler's scaled columns have condition 2e3 (and Wampler 5 a residual 50 times the fit),
/// Longley's 4e4, Filip's 5e9: rounding its powers to double alone moves its coefficients by 2.5e-8.
struct Limit {
  const char* name;
  double coefficients, deviations;
  friend std::ostream& operator<<(std::ostream& out, const Limit& limit) { return out << limit.name; }
};
const Limit kLimits[] = {{"norris", 1e-13, 1e-13}, {"pontius", 1e-12, 1e-12}, {"noint1", 1e-14, 1e-14},
                         {"noint2", 1e-14, 1e-14}, {"filip", 1e-7, 1e-7},     {"longley", 1e-10, 1e-10},
                         {"wampler1", 1e-9, 1e-9}, {"wampler2", 1e-9, 1e-9},  {"wampler3", 1e-9, 1e-9},
                         {"wampler4", 1e-9, 1e-9}, {"wampler5", 1e-9, 1e-9}};

MatrixXd read_table(const std::string& name) {
  std::ifstream in(kFolder / (name + ".csv"));
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(std::stod(cell));
  }
  MatrixXd table(static_cast<Index>(rows.size()), static_cast<Index>(rows.front().size()));
  for (Index i = 0; i < table.rows(); ++i)
    for (Index j = 0; j < table.cols(); ++j)
      table(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return table;
}

/// Features as the problem's model says: powers of x1, or the columns; with or without a constant.
struct Problem {
  std::vector<std::string> names;
  MatrixXd x;
  VectorXd y;
};
Problem read_problem(const std::string& name, const nlohmann::json& certified) {
  const MatrixXd table = read_table(name);
  const std::string model = certified["model"];
  const Index n = static_cast<Index>(certified["coefficients"].size());
  const bool constant = model.find("with intercept") != std::string::npos;
  const bool powers = model.find("polynomial") != std::string::npos;
  Problem p{{}, MatrixXd(table.rows(), n), table.col(0)};
  for (Index j = 0; j < n; ++j) {
    p.names.push_back("x" + std::to_string(j));
    const Index degree = constant ? j : j + 1;
    if (degree == 0)
      p.x.col(j).setOnes();
    else if (powers)
      p.x.col(j) = table.col(1).array().pow(static_cast<double>(degree));
    else
      p.x.col(j) = table.col(degree);
  }
  return p;
}

/// In blocks of p + 1 rows, in random order, by two threads whose halves are merged block by block in random order.
Statistic in_random_blocks(const Problem& p, unsigned seed) {
  const Index size = p.x.cols() + 1, count = (p.x.rows() + size - 1) / size;
  std::vector<Index> order(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) order[static_cast<std::size_t>(i)] = i;
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Statistic> half(2, Statistic(p.names));
  const auto work = [&](std::size_t which) {
    for (std::size_t i = which; i < order.size(); i += 2) {
      const Index first = order[i] * size, rows = std::min(size, p.x.rows() - first);
      Statistic block(p.names);
      block.add(p.x.middleRows(first, rows), p.y.segment(first, rows));
      half[which].merge(block);
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  const std::size_t first = seed % 2;
  half[first].merge(half[1 - first]);
  return half[first];
}

double worst(const VectorXd& got, const std::vector<double>& certified) {
  double error = 0;
  for (Index j = 0; j < got.size(); ++j) {
    const double truth = certified[static_cast<std::size_t>(j)];
    error = std::max(error, truth == 0 ? std::abs(got[j]) : std::abs(got[j] / truth - 1));
  }
  return error;
}

class Nist : public testing::TestWithParam<Limit> {
 protected:
  void SetUp() override {
    std::ifstream in(kFolder / "certified.json");
    if (!in) GTEST_SKIP() << "no ../shared/data/nist/linear: the NIST problems are not run";
    certified = nlohmann::json::parse(in)[GetParam().name];
  }

  void check(const Statistic& data, const Problem& p) {
    const Limit& limit = GetParam();
    const Fit fit = least_squares(data);
    // 9 digits, or where double does not allow them no fewer than Householder QR.
    const VectorXd plain = p.x.householderQr().solve(p.y);
    EXPECT_LE(worst(fit.coefficients, certified["coefficients"]),
              std::max(1e-9, worst(plain, certified["coefficients"])));
    const double residual = certified["residual_standard_deviation"];
    EXPECT_EQ(fit.rows, certified["observations"].get<Index>());
    EXPECT_TRUE(fit.unexcited.empty());
    EXPECT_LE(worst(fit.coefficients, certified["coefficients"]), limit.coefficients);
    const double target = data.rms()[data.features()];
    if (residual == 0) {  // an exact polynomial: what is left is rounding
      EXPECT_LE(fit.residual_std, 1e-13 * target);
      EXPECT_LE((fit.std.array() / fit.coefficients.array().abs()).maxCoeff(), 1e-10);
    } else {
      EXPECT_NEAR(fit.residual_std / residual, 1, limit.deviations);
      EXPECT_LE(worst(fit.std, certified["standard_deviations"]), limit.deviations);
    }
    // Filip's rounded powers move RSS by 5e-10 of itself, and 1 - R2 is 3e-3 there; elsewhere it is rounding.
    EXPECT_NEAR(fit.r2, certified["r_squared"].get<double>(), 1e-11);
  }

  nlohmann::json certified;
};

TEST_P(Nist, all_rows_at_once) {
  const Problem p = read_problem(GetParam().name, certified);
  Statistic data(p.names);
  data.add(p.x, p.y);
  check(data, p);
}

TEST_P(Nist, small_blocks_in_random_order_by_two_threads) {
  const Problem p = read_problem(GetParam().name, certified);
  for (unsigned seed = 1; seed <= 20; ++seed) check(in_random_blocks(p, seed), p);
}

INSTANTIATE_TEST_SUITE_P(Regress, Nist, testing::ValuesIn(kLimits),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace

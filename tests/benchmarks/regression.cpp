// 21 features (all monomials of y and v up to degree 5) over 1e6 rows: the whole regression against building
// the features and their Gram matrix by hand, in blocks.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <memory>

#include "benchmarks/work.hpp"
#include "record/container.hpp"
#include "regress/regress.hpp"

namespace bench {
namespace {

constexpr Eigen::Index rows = 1000000, block = 1024;
constexpr int features = 21, degree = 5;

struct Data {
  Eigen::VectorXd y{rows}, v{rows}, target{rows};
  Data() {
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double t = 1e-3 * static_cast<double>(i);
      y[i] = std::sin(7 * t) + 0.5 * std::sin(11.3 * t + 1);
      v[i] = std::cos(7 * t) + 0.8 * std::cos(11.3 * t + 1);
      target[i] = 2 * y[i] + 0.3 * v[i] + 0.7 * y[i] * y[i] * y[i] + 1e-3 * std::sin(1e4 * t);
    }
  }
};

/// Features and Gram matrix of [features, target], nothing else: what any regression on normal equations
/// costs at least.
double by_hand(const Data& data) {
  Eigen::MatrixXd x(block, features + 1), gram = Eigen::MatrixXd::Zero(features + 1, features + 1);
  for (Eigen::Index first = 0; first < rows; first += block) {
    const Eigen::Index count = std::min(block, rows - first);
    const auto y = data.y.segment(first, count).array(), v = data.v.segment(first, count).array();
    auto part = x.topRows(count);
    part.col(0).setOnes();
    int column = 1;
    for (int power = 1; power <= degree; ++power) {
      const int before = column - power;  // the monomials of one degree less
      for (int i = 0; i < power; ++i) part.col(column + i) = part.col(before + i).array() * y;
      part.col(column + power) = part.col(column - 1).array() * v;
      column += power + 1;
    }
    part.col(features) = data.target.segment(first, count);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
  }
  return gram(features, features);
}

/// The same data as a record, for whole regressions.
lunid::Record record_of(const Data& data) {
  return lunid::Record("bench", 0, 1e-3,
                       {{"F", "N", "", "", data.target}, {"y", "m", "", "", data.y}, {"v", "m/s", "", "", data.v}});
}

/// From y and v to coefficients with their deviations.
lunid::Regression regress(const lunid::Stream& record, int threads, int bootstrap,
                          const lunid::RegressionSolver& solver = {}, int blocks = 32) {
  lunid::Pool pool;
  const lunid::Expr y = pool.channel("y"), v = pool.channel("v");
  lunid::RegressOptions options;
  for (int power = 0; power <= degree; ++power)
    for (int j = 0; j <= power; ++j) options.features.push_back(pow(y, power - j) * pow(v, j));
  options.blocks = blocks;
  options.solver = solver;
  options.threads = threads;
  options.bootstrap = bootstrap;
  lunid::Regression result = lunid::regress(std::span(&record, 1), options);
  result.restoring = {};  // its pool ends here
  result.terms.clear();
  return result;
}

/// The data in an HDF5 file that goes when nobody needs it any more.
class DataFile {
 public:
  explicit DataFile(const lunid::Record& record)
      : path_(std::filesystem::temp_directory_path() / ("lunid_bench_" + std::to_string(::getpid()) + ".h5")) {
    lunid::write_hdf5(record, path_);
  }
  ~DataFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

std::vector<Work> regression_works() {
  const auto data = std::make_shared<Data>();
  const auto record = std::make_shared<lunid::Record>(record_of(*data));
  const auto file = std::make_shared<DataFile>(*record);
  const auto hand = [=] { benchmark::DoNotOptimize(by_hand(*data)); };
  return {
      {"regress-stlsq", 2, [=] { benchmark::DoNotOptimize(regress(*record, 1, 0, lunid::StlsqOptions{}, 8).rmse); },
       hand},
      {"regress-lasso-100", 2,  // a path of 100 values
       [=] { benchmark::DoNotOptimize(regress(*record, 1, 0, lunid::LassoOptions{.lambda = 1e-3}, 8).rmse); }, hand},
      // Two threads over one: 1.8 times as fast is 0.56 of the time.
      {"regress-2-threads", 1 / 1.8, [=] { benchmark::DoNotOptimize(regress(*record, 2, 0).rmse); },
       [=] { benchmark::DoNotOptimize(regress(*record, 1, 0).rmse); }},
      // From the file, block by block in a few megabytes, over the same file read whole.
      {"regress-stream", 2, [=] { benchmark::DoNotOptimize(regress(lunid::open_stream(file->path()), 1, 0).rmse); },
       [=] { benchmark::DoNotOptimize(regress(lunid::read_record(file->path()), 1, 0).rmse); }},
      // 1000 replicates of the block bootstrap over the fit alone.
      {"regress-bootstrap-1000", 2, [=] { benchmark::DoNotOptimize(regress(*record, 1, 1000).rmse); },
       [=] { benchmark::DoNotOptimize(regress(*record, 1, 0).rmse); }}};
}

}  // namespace bench

#include "regress/curve_pass.hpp"

#include <algorithm>
#include <cmath>

#include "expr/digits.hpp"
#include "regress/curve_extended.hpp"

namespace lunid::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index kRows = 1024;  // built and folded in together
/// Blocks of at most so many rows are folded in extended precision: small problems are often the ill-conditioned ones.
constexpr Index kExtended = 512;

std::vector<Expr> channels_of(const std::vector<Expr>& outputs) {
  std::vector<Expr> found;
  for (const Expr& f : outputs) {
    const std::vector<Expr> states = symbols(f, SymbolKind::state);
    if (!states.empty())
      throw InputError("fit_curve: state '" + states.front().name() +
                       "' is not measured: fit such a model on its trajectory");
    for (const Expr& s : symbols(f, SymbolKind::channel))
      if (std::find(found.begin(), found.end(), s) == found.end()) found.push_back(s);
  }
  return found;
}

/// Runs a tape over rows of a record: channels, then constants; a column of `out` for each output.
void run_rows(const Tape& tape, const Record& record, const std::vector<std::string>& channels,
              std::span<const double> constants, Index first, MatrixXd& out) {
  const Index rows = out.rows();
  std::vector<double> time;
  std::vector<const double*> in;
  std::vector<int> stride;
  for (const std::string& name : channels) {
    stride.push_back(1);
    if (name == "t" && !record.has("t")) {
      for (Index i = 0; i < rows; ++i) time.push_back(record.time(first + i));
      in.push_back(time.data());
    } else {
      in.push_back(record[name].data() + first);
    }
  }
  for (const double& value : constants) {
    stride.push_back(0);
    in.push_back(&value);
  }
  std::vector<double*> columns;
  for (Index j = 0; j < out.cols(); ++j) columns.push_back(out.col(j).data());
  tape.run_columns(in, stride, static_cast<std::size_t>(rows), columns);
}

}  // namespace

CurvePass::CurvePass(std::span<const Record> records, const CurveOptions& options) : records_(records) {
  Pool& pool = options.formula.pool();
  const Expr root = options.weight.valid() ? pool.apply(Op::sqrt, {options.weight}) : Expr();
  const auto weighted = [&](Expr f) { return root.valid() ? root * f : f; };
  std::vector<Expr> outputs, inputs;
  for (const CurveParameter& p : options.parameters) {
    inputs.push_back(pool.parameter(p.name));
    outputs.push_back(weighted(derivative(options.formula, inputs.back())));
  }
  parameters_ = static_cast<Index>(inputs.size());
  residual_ = weighted(options.response - options.formula);
  outputs.push_back(residual_);
  for (const auto& [name, value] : options.values) {
    inputs.push_back(pool.parameter(name));
    known_.push_back(value);
  }
  const std::vector<Expr> channels = channels_of(outputs);
  for (const Expr& c : channels) channels_.push_back(c.name());
  std::vector<Expr> all = channels;
  all.insert(all.end(), inputs.begin(), inputs.end());
  tape_ = Tape(outputs, all);
  inputs_ = all;
  for (const Record& record : records) rows_ += record.rows();
  sum_response(options);
}

void CurvePass::sum_response(const CurveOptions& options) {
  const Expr weight = options.weight.valid() ? options.weight : options.formula.pool().constant(1);
  const std::vector<Expr> outputs = {options.response, weight}, inputs = channels_of(outputs);
  std::vector<std::string> names;
  for (const Expr& c : inputs) names.push_back(c.name());
  const Tape tape(outputs, inputs);
  long double weights = 0, mean = 0, squares = 0;  // West 1979: stable for a large mean
  for (const Record& record : records_) {
    MatrixXd out(record.rows(), 2);
    run_rows(tape, record, names, {}, 0, out);
    for (Index i = 0; i < out.rows(); ++i) {
      if (!(out(i, 1) >= 0))
        throw InputError("fit_curve: weight: expected >= 0, got " + exact_number(out(i, 1)) + " in row " +
                             std::to_string(i + 1) + " of " + record.name(),
                         {}, Fault::data);
      weights += out(i, 1);
      if (weights == 0) continue;
      const long double change = out(i, 0) - mean, part = change * out(i, 1) / weights;
      mean += part;
      squares += (weights - out(i, 1)) * change * part;
    }
  }
  total_ = static_cast<double>(squares);
}

void CurvePass::run(const Record& record, Index first, const VectorXd& theta, MatrixXd& work) const {
  std::vector<double> constants(theta.begin(), theta.end());
  constants.insert(constants.end(), known_.begin(), known_.end());
  run_rows(tape_, record, channels_, constants, first, work);
}

Tangent CurvePass::at(const VectorXd& theta) {
  ++evaluations_;
  const Index k = parameters_ + 1;
  Tangent tangent{LongMatrix::Zero(k, k), true};
  MatrixXd work;
  for (const Record& record : records_)
    for (Index first = 0; first < record.rows(); first += kRows) {
      work.resize(std::min(kRows, record.rows() - first), k);
      run(record, first, theta, work);
      if (!work.allFinite()) {
        tangent.finite = false;
        return tangent;
      }
      if (work.rows() <= kExtended) {
        triangularise(tangent.factor, work.cast<long double>());
      } else {
        MatrixXd r = MatrixXd::Zero(k, k);
        triangularise(r, work);
        triangularise(tangent.factor, r.triangularView<Eigen::Upper>().toDenseMatrix().cast<long double>());
      }
    }
  tangent.finite = tangent.factor.allFinite();
  return tangent;
}

Tangent CurvePass::refined(const VectorXd& theta) {
  Extended residual(residual_, inputs_);
  const Index k = parameters_ + 1;
  Tangent tangent{LongMatrix::Zero(k, k), true};
  MatrixXd work;
  std::vector<double> in;
  for (const Record& record : records_)
    for (Index first = 0; first < record.rows(); first += kRows) {
      work.resize(std::min(kRows, record.rows() - first), k);
      run(record, first, theta, work);
      LongMatrix rows = work.cast<long double>();
      for (Index i = 0; i < rows.rows(); ++i) {
        in.clear();
        for (const std::string& name : channels_)
          in.push_back(name == "t" && !record.has("t") ? record.time(first + i)
                                                       : record[name][static_cast<std::size_t>(first + i)]);
        in.insert(in.end(), theta.begin(), theta.end());
        in.insert(in.end(), known_.begin(), known_.end());
        rows(i, k - 1) = residual.run(in);
      }
      triangularise(tangent.factor, std::move(rows));
    }
  tangent.finite = tangent.factor.allFinite();
  return tangent;
}

void CurvePass::refuse(const VectorXd& theta) {
  MatrixXd work;
  for (const Record& record : records_)
    for (Index first = 0; first < record.rows(); first += kRows) {
      work.resize(std::min(kRows, record.rows() - first), parameters_ + 1);
      run(record, first, theta, work);
      for (Index i = 0; i < work.rows(); ++i)
        if (!work.row(i).allFinite())
          throw InputError("fit_curve: at the first guess the formula or a derivative of it is not finite in row " +
                               std::to_string(first + i + 1) + " of " + record.name() +
                               ": choose another guess, or leave such rows out",
                           {}, Fault::data);
    }
  throw InputError("fit_curve: the residual overflows at the first guess: choose another one", {}, Fault::data);
}

}  // namespace lunid::detail

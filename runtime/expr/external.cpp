#include "expr/external.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "expr/walk.hpp"
#include "expr/words.hpp"

namespace lunid {

ExternalPart ExternalPart::by(int i) const {
  if (order() == 0) return ExternalPart(static_cast<std::uint8_t>(1 + i));
  const int low = std::min(first(), i), high = std::max(first(), i);  // the order of two derivatives does not matter
  return ExternalPart(static_cast<std::uint8_t>(1 + most + most * low + high));
}

std::string ExternalPart::digits() const {
  if (order() == 0) return {};
  return std::to_string(first() + 1) + (order() == 2 ? std::to_string(second() + 1) : "");
}

std::string ExternalPart::suffix() const { return order() == 0 ? "" : "_d" + digits(); }

ExternalFunction::ExternalFunction(std::string name, int arity) : name_(std::move(name)), arity_(arity) {
  if (!is_identifier(name_))
    throw InputError("name '" + name_ + "': expected a letter or _, then letters, digits or _");
  if (arity < 1 || arity > Expr::most_arguments)
    throw InputError(words() + ": expected 1 to " + std::to_string(Expr::most_arguments) + " arguments, got " +
                     std::to_string(arity));
}

double ExternalFunction::call(ExternalPart part, const double* x) const noexcept {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (failed_.load(std::memory_order_relaxed)) return nan;
  for (int i = 0; i < arity_; ++i)
    if (!std::isfinite(x[i])) return nan;
  try {
    return evaluate(part, x);
  } catch (...) {
    const std::lock_guard lock(guard_);
    if (!fault_) fault_ = std::current_exception();
    failed_ = true;
    return nan;
  }
}

void ExternalFunction::rethrow() const {
  if (!failed_) return;
  std::exception_ptr fault;
  {
    const std::lock_guard lock(guard_);
    std::swap(fault, fault_);
    failed_ = false;
  }
  if (fault) std::rethrow_exception(fault);
}

void ExternalFunction::forget() const {
  const std::lock_guard lock(guard_);
  fault_ = nullptr;
  failed_ = false;
}

void ExternalFunction::gradient(const double*, double*) const {}

double ExternalFunction::evaluate(ExternalPart part, const double* x) const {
  if (part.order() == 0) return value(x);
  const auto slope = [this, i = part.first()](const double* at) {
    double slopes[Expr::most_arguments] = {};
    gradient(at, slopes);
    return slopes[i];
  };
  if (part.order() == 2) return difference(slope, part.second(), x);
  if (has_gradient()) return slope(x);
  return difference([this](const double* at) { return value(at); }, part.first(), x);
}

/// A central difference, whose step balances its own error (h^2) with that of rounding (1/h).
template <class F>
double ExternalFunction::difference(F f, int i, const double* x) const {
  ++differences_;
  double at[Expr::most_arguments] = {};
  std::copy_n(x, arity_, at);
  const double step = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(std::fabs(x[i]), scale(i));
  const double above = x[i] + step, below = x[i] - step;  // the steps that are taken, rounding included
  at[i] = above;
  const double high = f(at);
  at[i] = below;
  return (high - f(at)) / (above - below);
}

Expr partial_derivative(Expr node, int i) {
  const ExternalPart part(node.part());
  const ExternalFunction& function = *node.function();
  if (part.order() == 1 && !function.has_gradient())
    throw InputError(function.words() + ": has no second derivative, because its gradient is not known: give it one");
  if (part.order() == 2) throw InputError(function.words() + ": has no third derivative");
  return node.pool().call(node.function(), node.arguments(), part.by(i).code());
}

std::vector<std::shared_ptr<const ExternalFunction>> external_functions(std::span<const Expr> expressions) {
  std::vector<Expr> roots;
  std::copy_if(expressions.begin(), expressions.end(), std::back_inserter(roots), [](Expr f) { return f.valid(); });
  std::vector<std::shared_ptr<const ExternalFunction>> found;
  for (const Expr& node : post_order(roots))
    if (node.op() == Op::external && std::find(found.begin(), found.end(), node.function()) == found.end())
      found.push_back(node.function());
  return found;
}

ExternalWatch::ExternalWatch(const Pool& pool) {
  for (const auto& function : pool.functions()) {
    function->forget();
    rows_.push_back({function, function->calls(), function->differences()});
  }
}

void ExternalWatch::rethrow() const {
  for (const Row& row : rows_) row.function->rethrow();
}

std::vector<std::string> ExternalWatch::notes() const {
  std::vector<std::string> notes;
  for (const Row& row : rows_) {
    const long calls = row.function->calls() - row.calls;
    const long differences = row.function->differences() - row.differences;
    if (calls == 0 && differences == 0) continue;
    std::string text = row.function->words() + ": ";
    if (calls > 0)
      text += std::to_string(calls) + (calls == 1 ? " call" : " calls") +
              (row.function->thread_safe() ? "" : ", all on one thread") +
              "; an expression of the language would be faster";
    if (differences > 0)
      text += std::string(calls > 0 ? "; " : "") + std::to_string(differences) +
              " derivatives by central differences, for want of a gradient";
    notes.push_back(text);
  }
  return notes;
}

}  // namespace lunid

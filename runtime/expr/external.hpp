#pragma once
// External functions: what a user or another room computes, as an operation of the language. A surface or a function
// in Lua is then an Expr like any other, without expr knowing surfaces or Lua.
//
// A tape calls them as they come and takes them for smooth: they have no switches. An error that one raises never
// crosses the frames of a library: the call gives NaN, as do all later ones, and whoever started the work rethrows it
// (ExternalWatch).
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "expr/expr.hpp"

namespace lunid {

/// What of an external function a node or an instruction stands for: its value, its derivative by argument i, or that
/// by i and j (from 0).
class ExternalPart {
 public:
  explicit ExternalPart(std::uint8_t code = 0) : code_(code) {}
  int order() const { return code_ == 0 ? 0 : code_ <= most ? 1 : 2; }
  int first() const { return order() == 1 ? code_ - 1 : (code_ - 1 - most) / most; }
  int second() const { return (code_ - 1 - most) % most; }
  /// Of an order below 2: its derivative by argument i.
  ExternalPart by(int i) const;
  std::uint8_t code() const { return code_; }
  std::string digits() const;  ///< "", "1", "12": the arguments, from 1
  std::string suffix() const;  ///< "", "_d1", "_d12"

 private:
  static constexpr int most = Expr::most_arguments;
  std::uint8_t code_;
};

/// A function of 1 to 4 numbers. Immutable but for its record of calls and errors; shared between threads.
class ExternalFunction {
 public:
  /// Throws InputError when the arity is not 1 to 4 or the name no identifier.
  ExternalFunction(std::string name, int arity);
  virtual ~ExternalFunction() = default;
  ExternalFunction(const ExternalFunction&) = delete;
  ExternalFunction& operator=(const ExternalFunction&) = delete;

  const std::string& name() const { return name_; }
  int arity() const { return arity_; }
  /// "Lua function 'damper'", for messages.
  virtual std::string words() const { return "function '" + name_ + "'"; }
  /// False: all calls must come from the thread that made it; whoever has threads runs on one then.
  virtual bool thread_safe() const { return true; }
  /// False: derivatives are central differences of the value.
  virtual bool has_gradient() const { return false; }
  /// Calls of the value or the gradient so far, where they cost so much that it is worth a warning; else 0.
  virtual long calls() const { return 0; }
  long differences() const { return differences_; }  ///< derivatives that were taken by differences

  /// The part at x[0 .. arity()). NaN where an argument is not finite or an error was raised, now or before. The
  /// second derivatives are central differences of the gradient.
  double call(ExternalPart part, const double* x) const noexcept;
  bool failed() const { return failed_; }
  /// Rethrows the error that a call raised, if one did, and forgets it.
  void rethrow() const;
  void forget() const;

 protected:
  /// May throw.
  virtual double value(const double* x) const = 0;
  /// slopes[0 .. arity()); called where has_gradient().
  virtual void gradient(const double* x, double* slopes) const;
  /// The size below which argument i counts as 0 when a step is chosen for differences.
  virtual double scale(int i) const { return 1e-3; }

 private:
  double evaluate(ExternalPart part, const double* x) const;
  template <class F>
  double difference(F f, int i, const double* x) const;

  std::string name_;
  int arity_;
  mutable std::atomic<long> differences_{0};
  mutable std::atomic<bool> failed_{false};
  mutable std::mutex guard_;
  mutable std::exception_ptr fault_;
};

/// A call as a tape holds it.
struct ExternalCall {
  std::shared_ptr<const ExternalFunction> function;
  std::uint8_t part = 0;
  double operator()(double a, double b, double c, double d) const noexcept {
    const double x[] = {a, b, c, d};
    return function->call(ExternalPart(part), x);
  }
  friend bool operator==(const ExternalCall&, const ExternalCall&) = default;
};

/// The derivative of a node of Op::external by its argument i, the others held. Throws InputError for a second
/// derivative without a gradient, and for a third.
Expr partial_derivative(Expr node, int i);

/// The external functions that expressions call, each once.
std::vector<std::shared_ptr<const ExternalFunction>> external_functions(std::span<const Expr> expressions);

/// Watches the external functions of a pool over one piece of work, which begins where it is made: errors of the work
/// before are forgotten.
class ExternalWatch {
 public:
  explicit ExternalWatch(const Pool& pool);
  /// Rethrows the error of a function that failed.
  void rethrow() const;
  /// A sentence on each function whose calls were costly or that was derived by differences.
  std::vector<std::string> notes() const;

 private:
  struct Row {
    std::shared_ptr<const ExternalFunction> function;
    long calls, differences;
  };
  std::vector<Row> rows_;
};

}  // namespace lunid

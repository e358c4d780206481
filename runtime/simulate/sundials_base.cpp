#include "simulate/sundials_base.hpp"

#include <sunmatrix/sunmatrix_dense.h>

#include <stdexcept>

#include "simulate/fixed.hpp"

namespace lunid {
namespace {

/// Positive: SUNDIALS tries again with a smaller step. Negative: it gives up.
constexpr int recoverable = 1;
constexpr int unrecoverable = -1;

SUNContext new_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw std::runtime_error("SUNContext_Create failed");
  return context;
}

}  // namespace

SundialsBase::SundialsBase(Ode& ode, const Eigen::VectorXd& x0)
    : ode_(ode),
      context_(new_context()),
      x_(N_VNew_Serial(x0.size(), context_.get())),
      row_major_(static_cast<std::size_t>(x0.size() * x0.size())) {
  check(x_.get(), "N_VNew_Serial");
  load(x0);
}

void SundialsBase::check(int flag, const char* call) {
  if (flag < 0) throw std::runtime_error(std::string(call) + ": code " + std::to_string(flag));
}

void SundialsBase::check(const void* handle, const char* call) {
  if (!handle) throw std::runtime_error(std::string(call) + ": no memory");
}

void SundialsBase::rethrow() {
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void SundialsBase::load(const Eigen::VectorXd& x) noexcept {
  std::copy(x.begin(), x.end(), N_VGetArrayPointer(x_.get()));
}

void SundialsBase::store(Eigen::VectorXd& x) const noexcept {
  std::copy_n(N_VGetArrayPointer(x_.get()), x.size(), x.begin());
}

template <class Body>
int SundialsBase::guarded(void* self, Body body) noexcept {
  auto& base = *static_cast<SundialsBase*>(self);
  try {
    return body(base);
  } catch (...) {
    base.thrown_ = std::current_exception();
    return unrecoverable;
  }
}

int SundialsBase::rate(double t, N_Vector x, N_Vector f, void* self) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    double* out = N_VGetArrayPointer(f);
    base.ode_.rate(t, N_VGetArrayPointer(x), out);
    return all_finite(out, base.ode_.states()) ? 0 : recoverable;
  });
}

int SundialsBase::events(double t, N_Vector x, double* g, void* self) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    base.ode_.event_functions(t, N_VGetArrayPointer(x), g);
    return 0;
  });
}

int SundialsBase::weights(N_Vector x, N_Vector w, void* self) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    base.ode_.error_weights(N_VGetArrayPointer(x), N_VGetArrayPointer(w));
    return 0;
  });
}

int SundialsBase::jacobian(double t, N_Vector x, N_Vector, SUNMatrix j, void* self, N_Vector, N_Vector,
                           N_Vector) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    const int n = base.ode_.states();
    double* entries = base.row_major_.data();
    base.ode_.jacobian(t, N_VGetArrayPointer(x), entries);
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        // an infinite slope (a root at zero) would end Newton's iteration, which a rough Jacobian does not
        const double slope = entries[row * n + column];
        SM_ELEMENT_D(j, row, column) = std::isfinite(slope) ? slope : 0;
      }
    return 0;
  });
}

}  // namespace lunid

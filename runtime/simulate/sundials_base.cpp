#include "simulate/sundials_base.hpp"

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
    : ode_(ode), context_(new_context()), x_(N_VNew_Serial(x0.size(), context_.get())) {
  check(x_.get(), "N_VNew_Serial");
  load(x0);
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
    const bool second = base.weight_calls_ == 1 && base.ode_.columns() > 0;
    if (base.weight_calls_ < 2) ++base.weight_calls_;
    if (second) base.scaled_ = x;
    if (x != base.scaled_) {
      base.next_column_ = 0;
      base.ode_.error_weights(N_VGetArrayPointer(x), N_VGetArrayPointer(w));
    } else {
      base.ode_.sensitivity_weights(base.next_column_, N_VGetArrayPointer(x), N_VGetArrayPointer(w));
      base.next_column_ = (base.next_column_ + 1) % base.ode_.columns();
    }
    return 0;
  });
}

int SundialsBase::sensitivity_rates(int count, double t, N_Vector x, N_Vector, N_Vector* s, N_Vector* ds, void* self,
                                    N_Vector, N_Vector) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    base.columns_.resize(static_cast<std::size_t>(count));
    base.column_rates_.resize(static_cast<std::size_t>(count));
    for (int c = 0; c < count; ++c) {
      base.columns_[c] = N_VGetArrayPointer(s[c]);
      base.column_rates_[c] = N_VGetArrayPointer(ds[c]);
    }
    base.ode_.sensitivity_rate(t, N_VGetArrayPointer(x), base.columns_.data(), base.column_rates_.data());
    for (double* rates : base.column_rates_)
      if (!all_finite(rates, base.ode_.states())) return recoverable;
    return 0;
  });
}

int SundialsBase::jacobian(double t, N_Vector x, N_Vector, SUNMatrix j, void* self, N_Vector, N_Vector,
                           N_Vector) noexcept {
  return guarded(self, [&](SundialsBase& base) {
    base.ode_.jacobian(t, N_VGetArrayPointer(x), base.newton_->entries());
    base.newton_->fill(j);
    return 0;
  });
}

}  // namespace lunid

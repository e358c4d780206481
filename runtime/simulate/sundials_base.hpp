#pragma once
// What the CVODE and the ARKODE wrapper share: context, vector, callbacks, return codes. Internal to this room.
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <exception>
#include <memory>

#include "simulate/integrator.hpp"
#include "simulate/newton_matrix.hpp"

namespace lunid {

struct VectorDeleter {
  void operator()(N_Vector v) const noexcept { N_VDestroy(v); }
};
struct ContextDeleter {
  void operator()(SUNContext c) const noexcept { SUNContext_Free(&c); }
};
/// Context, state vector and callbacks. The user data that SUNDIALS carries is this object.
class SundialsBase : public Integrator {
 protected:
  SundialsBase(Ode& ode, const Eigen::VectorXd& x0);

  static void check(int flag, const char* call) { check_sundials(flag, call); }
  static void check(const void* handle, const char* call) { check_sundials(handle, call); }
  void make_newton() {
    newton_ = std::make_unique<NewtonMatrix>(ode_.states(), ode_.pattern(), x_.get(), context_.get());
  }
  /// Throws what a callback threw, once.
  void rethrow();
  void load(const Eigen::VectorXd& x) noexcept;
  void store(Eigen::VectorXd& x) const noexcept;

  static int rate(double t, N_Vector x, N_Vector f, void* self) noexcept;
  static int events(double t, N_Vector x, double* g, void* self) noexcept;
  static int weights(N_Vector x, N_Vector w, void* self) noexcept;
  static int jacobian(double t, N_Vector x, N_Vector f, SUNMatrix j, void* self, N_Vector, N_Vector, N_Vector) noexcept;
  static void silent(int, const char*, const char*, char*, void*) noexcept {}

  Ode& ode_;
  SundialsHandle<SUNContext, ContextDeleter> context_;
  SundialsHandle<N_Vector, VectorDeleter> x_;
  std::unique_ptr<NewtonMatrix> newton_;  ///< of implicit methods
  std::exception_ptr thrown_;

 private:
  template <class Body>
  static int guarded(void* self, Body body) noexcept;
};

}  // namespace lunid

#pragma once
// What the CVODES and the ARKODE wrapper share: context, vector, callbacks, return codes. Internal to this room.
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
  static int sensitivity_rates(int, double t, N_Vector x, N_Vector, N_Vector* s, N_Vector* ds, void* self, N_Vector,
                               N_Vector) noexcept;
  static int jacobian(double t, N_Vector x, N_Vector f, SUNMatrix j, void* self, N_Vector, N_Vector, N_Vector) noexcept;
  static void silent(int, const char*, const char*, char*, void*) noexcept {}

  Ode& ode_;
  SundialsHandle<SUNContext, ContextDeleter> context_;
  SundialsHandle<N_Vector, VectorDeleter> x_;
  std::unique_ptr<NewtonMatrix> newton_;  ///< of implicit methods
  std::exception_ptr thrown_;

 private:
  /// CVODES asks for the weights of the state, then for those of each column in turn, which it hands over in one vector
  /// of its own: the second that it ever asks for.
  N_Vector scaled_ = nullptr;
  int weight_calls_ = 0, next_column_ = 0;
  std::vector<const double*> columns_;  ///< of a call of sensitivity_rates
  std::vector<double*> column_rates_;
  template <class Body>
  static int guarded(void* self, Body body) noexcept;
};

}  // namespace lunid

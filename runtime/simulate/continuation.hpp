#pragma once
// Pseudo-arclength continuation of r(x, lambda) = 0 (Keller 1977; Seydel 2010, Practical bifurcation and stability
// analysis, chapter 4): passes folds, at which lambda turns back.
#include <Eigen/Core>
#include <functional>
#include <vector>

namespace lunid {

/// As many equations as unknowns, and one parameter.
class Curve {
 public:
  virtual ~Curve() = default;
  virtual Eigen::Index size() const = 0;
  /// r at (x, lambda) with its derivatives (both or none). False where it has no value.
  virtual bool evaluate(const Eigen::VectorXd& x, double lambda, Eigen::VectorXd& r, Eigen::MatrixXd* dx,
                        Eigen::VectorXd* dlambda) = 0;
  /// Weights of the unknowns, so that |w.x| of the present solution is near 1: a step of 0.1 changes it by a tenth.
  virtual Eigen::VectorXd weights(const Eigen::VectorXd& x, double lambda) = 0;
  /// Called with each new solution: may change the number of unknowns, and takes every given vector along. True when
  /// the solution has to be corrected again.
  virtual bool adapt(const Eigen::VectorXd& x, double lambda, const std::vector<Eigen::VectorXd*>& vectors) {
    return false;
  }
};

struct ContinuationOptions {
  double first_step = 0.01;
  double max_step = 0.1;    ///< of the weighted arc length; lambda has weight 1
  double min_step = 1e-8;   ///< below it the continuation gives up
  int iterations = 10;      ///< of Newton's method, per step
  double tolerance = 1e-9;  ///< weighted size of the last correction; quadratic, so the error is far below it
};

/// A solution with the direction of the branch, of unit weighted length.
struct BranchPlace {
  Eigen::VectorXd x, tangent;
  double lambda = 0, tangent_lambda = 0;
};

class Continuation {
 public:
  Continuation(Curve& curve, const ContinuationOptions& options) : curve_(curve), options_(options) {}

  /// Newton's method at a fixed parameter, from x.
  bool solve_at(double lambda, Eigen::VectorXd& x, int iterations);
  /// Starts at a solution near x, going to larger (+1) or smaller (-1) lambda.
  bool begin(const Eigen::VectorXd& x, double lambda, int direction);
  /// The next place on the branch; false when no step of at least min_step leads on.
  bool advance();
  /// The place at a part (0 to 1) of the way from the previous place to the present one.
  bool between(double part, BranchPlace& place);
  /// Solution at a parameter between the last two.
  bool between_at(double lambda, BranchPlace& place);

  const BranchPlace& here() const { return here_; }
  const BranchPlace& previous() const { return previous_; }
  long corrections() const { return corrections_; }  ///< iterations of Newton's method so far

 private:
  bool newton(BranchPlace& place, const Eigen::VectorXd& direction, double direction_lambda, int iterations);
  bool take_step(BranchPlace& next);
  bool adapt();

  Curve& curve_;
  ContinuationOptions options_;
  BranchPlace here_, previous_;
  Eigen::VectorXd weights_, r_, dlambda_;
  Eigen::MatrixXd dx_, matrix_;
  double step_ = 0, last_correction_ = 0;
  int last_iterations_ = 0;
  long corrections_ = 0;
};

/// Root of f on [0, 1], f(0) and f(1) being of different sign (Illinois variant of regula falsi), to 1e-10.
double root_between(double f0, double f1, const std::function<double(double)>& f);

}  // namespace lunid

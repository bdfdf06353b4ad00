// How much of an adapter's time is its own: whitening, the callbacks the library makes into it, the reading of the
// answer. The program defines the libraries' entry points itself and calls the real ones behind them, so that nothing
// in the adapters knows of the clock.

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <nlopt.h>
#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>

#include <algorithm>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/problem/cpu_clock.h>
#include <zwang/solvers/ipopt/ipopt_method.h>
#include <zwang/solvers/rivals/nlopt.h>

namespace {

using zwang::thread_cpu_seconds;

double in_library = 0, in_callbacks = 0;

// Adds the time of a scope.
struct Timed {
  explicit Timed(double& sum) : sum(sum), start(thread_cpu_seconds()) {}
  ~Timed() { sum += thread_cpu_seconds() - start; }
  double& sum;
  double start;
};

// The library's own function of this name; looked up once a place of use.
#define BEHIND(type, name)                                                   \
  [] {                                                                       \
    static const auto real = reinterpret_cast<type>(dlsym(RTLD_NEXT, name)); \
    return real;                                                             \
  }()

// ---- NLopt: functions that the library calls are replaced by timed ones ----

struct Scalar {
  nlopt_func function;
  void* data;
  static double call(unsigned n, const double* x, double* gradient, void* self) {
    const Timed timed(in_callbacks);
    auto& my = *static_cast<Scalar*>(self);
    return my.function(n, x, gradient, my.data);
  }
};
struct Rows {
  nlopt_mfunc function;
  void* data;
  static void call(unsigned m, double* result, unsigned n, const double* x, double* gradient, void* self) {
    const Timed timed(in_callbacks);
    auto& my = *static_cast<Rows*>(self);
    my.function(m, result, n, x, gradient, my.data);
  }
};
Scalar objective;
Rows equalities, inequalities;

// ---- Ipopt: the problem is wrapped ----

class TimedProblem : public Ipopt::TNLP {
 public:
  explicit TimedProblem(const Ipopt::SmartPtr<Ipopt::TNLP>& inner) : inner_(inner) {}
  bool get_nlp_info(int& n, int& m, int& nonzeros_jacobian, int& nonzeros_hessian, IndexStyleEnum& style) override {
    const Timed timed(in_callbacks);
    return inner_->get_nlp_info(n, m, nonzeros_jacobian, nonzeros_hessian, style);
  }
  bool get_bounds_info(int n, double* lower, double* upper, int m, double* g_lower, double* g_upper) override {
    const Timed timed(in_callbacks);
    return inner_->get_bounds_info(n, lower, upper, m, g_lower, g_upper);
  }
  bool get_starting_point(int n, bool init_x, double* x, bool init_z, double* z_l, double* z_u, int m, bool init_lambda,
                          double* lambda) override {
    const Timed timed(in_callbacks);
    return inner_->get_starting_point(n, init_x, x, init_z, z_l, z_u, m, init_lambda, lambda);
  }
  bool eval_f(int n, const double* x, bool fresh, double& value) override {
    const Timed timed(in_callbacks);
    return inner_->eval_f(n, x, fresh, value);
  }
  bool eval_grad_f(int n, const double* x, bool fresh, double* gradient) override {
    const Timed timed(in_callbacks);
    return inner_->eval_grad_f(n, x, fresh, gradient);
  }
  bool eval_g(int n, const double* x, bool fresh, int m, double* g) override {
    const Timed timed(in_callbacks);
    return inner_->eval_g(n, x, fresh, m, g);
  }
  bool eval_jac_g(int n, const double* x, bool fresh, int m, int nonzeros, int* row, int* column,
                  double* value) override {
    const Timed timed(in_callbacks);
    return inner_->eval_jac_g(n, x, fresh, m, nonzeros, row, column, value);
  }
  bool eval_h(int n, const double* x, bool fresh, double weight, int m, const double* lambda, bool fresh_lambda,
              int nonzeros, int* row, int* column, double* value) override {
    const Timed timed(in_callbacks);
    return inner_->eval_h(n, x, fresh, weight, m, lambda, fresh_lambda, nonzeros, row, column, value);
  }
  bool intermediate_callback(Ipopt::AlgorithmMode mode, int iteration, double objective, double primal, double dual,
                             double mu, double step, double regularization, double alpha_dual, double alpha_primal,
                             int trials, const Ipopt::IpoptData* data,
                             Ipopt::IpoptCalculatedQuantities* quantities) override {
    const Timed timed(in_callbacks);
    return inner_->intermediate_callback(mode, iteration, objective, primal, dual, mu, step, regularization, alpha_dual,
                                         alpha_primal, trials, data, quantities);
  }
  void finalize_solution(Ipopt::SolverReturn status, int n, const double* x, const double* z_l, const double* z_u,
                         int m, const double* g, const double* lambda, double objective, const Ipopt::IpoptData* data,
                         Ipopt::IpoptCalculatedQuantities* quantities) override {
    const Timed timed(in_callbacks);
    inner_->finalize_solution(status, n, x, z_l, z_u, m, g, lambda, objective, data, quantities);
  }

 private:
  Ipopt::SmartPtr<Ipopt::TNLP> inner_;
};

}  // namespace

extern "C" {

nlopt_result nlopt_set_min_objective(nlopt_opt opt, nlopt_func function, void* data) {
  objective = {function, data};
  return BEHIND(decltype(&nlopt_set_min_objective), "nlopt_set_min_objective")(opt, Scalar::call, &objective);
}
nlopt_result nlopt_add_equality_mconstraint(nlopt_opt opt, unsigned m, nlopt_mfunc function, void* data,
                                            const double* tolerance) {
  equalities = {function, data};
  return BEHIND(decltype(&nlopt_add_equality_mconstraint), "nlopt_add_equality_mconstraint")(opt, m, Rows::call,
                                                                                             &equalities, tolerance);
}
nlopt_result nlopt_add_inequality_mconstraint(nlopt_opt opt, unsigned m, nlopt_mfunc function, void* data,
                                              const double* tolerance) {
  inequalities = {function, data};
  return BEHIND(decltype(&nlopt_add_inequality_mconstraint), "nlopt_add_inequality_mconstraint")(
      opt, m, Rows::call, &inequalities, tolerance);
}
nlopt_result nlopt_optimize(nlopt_opt opt, double* x, double* value) {
  const Timed timed(in_library);
  return BEHIND(decltype(&nlopt_optimize), "nlopt_optimize")(opt, x, value);
}

}  // extern "C"

Ipopt::ApplicationReturnStatus Ipopt::IpoptApplication::OptimizeTNLP(const SmartPtr<TNLP>& problem) {
  using Real = ApplicationReturnStatus (*)(IpoptApplication*, const SmartPtr<TNLP>&);
  const SmartPtr<TNLP> wrapped = new TimedProblem(problem);
  const Timed timed(in_library);
  return BEHIND(Real, "_ZN5Ipopt16IpoptApplication12OptimizeTNLPERKNS_8SmartPtrINS_4TNLPEEE")(this, wrapped);
}

namespace zwang {
namespace {

// The share of a solve that is spent outside the library or in what it calls back, the least disturbed of several
// solves in thread CPU time: copying rows waits for memory, so other programs on the machine raise it (4.2 to 5.1 %).
double own_share(AnySolver solver, const Problem& problem) {
  const std::string name(solver.name());
  Solution solution;
  solver.solve(problem, {}, solution);
  EXPECT_EQ(solution.status, Status::solved) << name << ": " << solution.message;
  std::vector<double> shares;
  for (int i = 0; i < 25; ++i) {
    in_library = in_callbacks = 0;
    const double start = thread_cpu_seconds();
    solver.solve(problem, {}, solution);
    const double whole = thread_cpu_seconds() - start;
    EXPECT_GT(in_library, 0) << name << ": the library was not called through this program's entry point";
    EXPECT_GT(in_callbacks, 0) << name << ": the library called nothing back";
    EXPECT_GE(whole, in_library);
    shares.push_back((whole - in_library + in_callbacks) / whole);
  }
  const double least = *std::min_element(shares.begin(), shares.end());
  std::printf("%s on %s: %.1f %% of the time is the adapter's own\n", name.c_str(), problem.name.c_str(), 100 * least);
  return least;
}

TEST(Adapters, OfSlsqpAndIpoptSpendAtMostATwentiethOfTheirTimeThemselves) {
#ifndef NDEBUG
  GTEST_SKIP() << "the libraries are optimized and this build is not";
#endif
  for (const Instance& hand : make_scenes("hand(contacts=16,64,200)"))
    for (const AnySolver& solver : {AnySolver(NloptSlsqp()), AnySolver(IpoptMethod())})
      EXPECT_LE(own_share(solver, hand.problem), 0.05) << solver.name();
}

}  // namespace
}  // namespace zwang

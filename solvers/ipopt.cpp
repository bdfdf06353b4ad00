#include "solvers/ipopt.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <sstream>

#include "solvers/farkas.h"
#include "solvers/kkt_check.h"
#include "solvers/stop.h"

namespace ip = ::Ipopt;

namespace zwang {
namespace {

constexpr double unbounded = 2e19;  // Ipopt takes anything beyond 1e19 as no bound

// The whitened problem in Ipopt's terms: minimize 1/2 |y|^2, 0 <= G y - h (<= 0 on equality rows), over the rows of
// `rows` only. Ipopt's Lagrangian is f + lambda'g, so its multipliers are ours with the sign turned.
class WhitenedQp : public ip::TNLP {
 public:
  const UnitProgram* program = nullptr;
  std::vector<Index> rows;
  Vector start;
  Deadline deadline{std::numeric_limits<double>::infinity()};
  std::function<void(int, const Vector&, const Vector&)> observe;

  Vector y, lambda;  // the answer, lambda over all unit rows
  struct Iterate {
    Vector y, lambda;
    double residual = std::numeric_limits<double>::infinity();  // of kkt_check
  } best;
  int iterations = 0;

  bool get_nlp_info(ip::Index& n, ip::Index& m, ip::Index& nonzeros_G, ip::Index& nonzeros_hessian,
                    IndexStyleEnum& style) override {
    n = nonzeros_hessian = static_cast<int>(program->size());
    m = static_cast<int>(rows.size());
    nonzeros_G = 0;
    for (const Index i : rows) nonzeros_G += row_size(i);
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(ip::Index n, double* lower, double* upper, ip::Index m, double* g_lower,
                       double* g_upper) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    std::fill_n(g_lower, m, 0);
    for (int i = 0; i < m; ++i) g_upper[i] = program->is_equality(rows[static_cast<std::size_t>(i)]) ? 0 : unbounded;
    return true;
  }

  bool get_starting_point(ip::Index n, bool, double* x, bool, double*, double*, ip::Index, bool, double*) override {
    std::copy_n(start.data(), n, x);
    return true;
  }

  bool eval_f(ip::Index n, const double* x, bool, double& value) override {
    value = 0.5 * Eigen::Map<const Vector>(x, n).squaredNorm();
    return true;
  }

  bool eval_grad_f(ip::Index n, const double* x, bool, double* gradient) override {
    std::copy_n(x, n, gradient);
    return true;
  }

  bool eval_g(ip::Index, const double* x, bool, ip::Index, double* g) override {
    for (const Index i : rows) {
      double value = -program->h()[i];
      for (UnitProgram::Rows::InnerIterator it(program->G(), i); it; ++it) value += it.value() * x[it.col()];
      *g++ = value;
    }
    return true;
  }

  bool eval_jac_g(ip::Index, const double*, bool, ip::Index, ip::Index, ip::Index* row, ip::Index* column,
                  double* value) override {
    int r = 0;
    for (const Index i : rows) {
      for (UnitProgram::Rows::InnerIterator it(program->G(), i); it; ++it) {
        if (value) {
          *value++ = it.value();
        } else {
          *row++ = r;
          *column++ = static_cast<int>(it.col());
        }
      }
      ++r;
    }
    return true;
  }

  bool eval_h(ip::Index n, const double*, bool, double weight, ip::Index, const double*, bool, ip::Index,
              ip::Index* row, ip::Index* column, double* value) override {
    for (int i = 0; i < n; ++i) {
      if (value)
        value[i] = weight;
      else
        row[i] = column[i] = i;
    }
    return true;
  }

  bool intermediate_callback(ip::AlgorithmMode mode, ip::Index iteration, double, double, double, double, double,
                             double, double, double, ip::Index, const ip::IpoptData* data,
                             ip::IpoptCalculatedQuantities* quantities) override {
    iterations = iteration;
    if (mode == ip::RegularMode && read_iterate(*data, *quantities)) {
      if (observe) observe(iteration, y, lambda);
      const double residual = kkt_check(*program, y, lambda).worst();
      if (residual < best.residual) best = {y, lambda, residual};
    }
    return !deadline.passed();
  }

  void finalize_solution(ip::SolverReturn, ip::Index n, const double* x, const double*, const double*, ip::Index,
                         const double*, const double* multipliers, double, const ip::IpoptData*,
                         ip::IpoptCalculatedQuantities*) override {
    y = Eigen::Map<const Vector>(x, n);
    spread(multipliers);
  }

 private:
  int row_size(Index i) const {
    const int* outer = program->G().outerIndexPtr();
    return outer[i + 1] - outer[i];
  }
  bool read_iterate(const ip::IpoptData& data, ip::IpoptCalculatedQuantities& quantities) {
    auto* original = dynamic_cast<ip::OrigIpoptNLP*>(ip::GetRawPtr(quantities.GetIpoptNLP()));
    auto* adapter = original ? dynamic_cast<ip::TNLPAdapter*>(ip::GetRawPtr(original->nlp())) : nullptr;
    if (!adapter) return false;
    y.resize(program->size());
    multipliers_.resize(static_cast<Index>(rows.size()));
    adapter->ResortX(*data.curr()->x(), y.data());
    adapter->ResortG(*data.curr()->y_c(), *data.curr()->y_d(), multipliers_.data());
    spread(multipliers_.data());
    return true;
  }
  void spread(const double* multipliers) {
    lambda.setZero(program->rows());
    for (const Index i : rows) lambda[i] = -*multipliers++;
  }

  Vector multipliers_;  // over `rows`
};

}  // namespace

// The application and its options, built once: registering Ipopt's options takes longer than a small solve.
class IpoptSession {
 public:
  IpoptSession() : application(new ip::IpoptApplication(false)), qp(new WhitenedQp) {
    auto options = application->Options();
    for (const auto& [name, value] : {std::pair{"jac_c_constant", "yes"},
                                      {"jac_d_constant", "yes"},
                                      {"hessian_constant", "yes"},
                                      {"nlp_scaling_method", "none"},
                                      {"linear_solver", "mumps"},
                                      {"sb", "yes"}})
      options->SetStringValue(name, value);
    options->SetNumericValue("bound_relax_factor", 0);
    options->SetIntegerValue("acceptable_iter", 0);
    options->SetIntegerValue("print_level", 0);
    application->Initialize(std::string());
  }

  // Half of T each, so that a violated row and a weakly active one may add up to T.
  void set(double tolerance, int iterations, double seconds, bool mehrotra) {
    const double half = 0.5 * tolerance;
    auto options = application->Options();
    for (const char* name : {"tol", "dual_inf_tol", "constr_viol_tol", "acceptable_tol", "acceptable_dual_inf_tol",
                             "acceptable_constr_viol_tol"})
      options->SetNumericValue(name, half);
    for (const char* name : {"compl_inf_tol", "acceptable_compl_inf_tol"})
      options->SetNumericValue(name, std::max(half * half, 1e-22));
    options->SetIntegerValue("max_iter", iterations);
    options->SetNumericValue("max_cpu_time", std::clamp(seconds, 1e-3, 1e6));
    options->SetStringValue("mehrotra_algorithm", mehrotra ? "yes" : "no");
  }

  ip::SmartPtr<ip::IpoptApplication> application;
  ip::SmartPtr<WhitenedQp> qp;
};

std::vector<Setting<Ipopt>> Ipopt::settings() {
  return {{"max_iterations", &Ipopt::max_iterations, "interior-point iterations before giving up"},
          {"mehrotra", &Ipopt::mehrotra, "Mehrotra's predictor-corrector instead of Ipopt's line search"}};
}

namespace {

std::string in_words(ip::ApplicationReturnStatus code) {
  switch (code) {
    case ip::Solve_Succeeded:
      return "Ipopt: solve succeeded";
    case ip::Solved_To_Acceptable_Level:
      return "Ipopt: solved to acceptable level";
    case ip::Infeasible_Problem_Detected:
      return "Ipopt: infeasible problem detected";
    case ip::Search_Direction_Becomes_Too_Small:
      return "Ipopt: search direction becomes too small";
    case ip::Diverging_Iterates:
      return "Ipopt: diverging iterates";
    case ip::Restoration_Failed:
      return "Ipopt: restoration failed";
    case ip::Error_In_Step_Computation:
      return "Ipopt: error in step computation";
    default:
      return "Ipopt: return code " + std::to_string(static_cast<int>(code));
  }
}

// Ipopt gives no certificate, but where its restoration stalls the multipliers, and what is still violated, often are
// one: at the point of least violation v, G'v = 0 over the violated rows.
bool certificate(const UnitProgram& program, const Vector& y, const Vector& lambda, Vector& u) {
  Vector motion;
  u = lambda;
  if (proves_infeasible(program, u, motion)) return true;
  program.slack(y, u);
  u = -u;
  return proves_infeasible(program, u, motion);
}

}  // namespace

void Ipopt::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  auto& [program, equalities, opened] = work;
  if (!program.build(problem, options, solution)) return;
  if (program.rows() == 0) {
    solution.z = problem.z_u;
    solution.status = Status::solved;
    return;
  }
  auto& [application, qp] = opened.open();

  qp->rows.clear();
  for (Index i = 0; i < program.rows(); ++i) qp->rows.push_back(i);
  Vector u;
  if (!equalities.clearly_independent(program)) {
    equalities.factorize(program);
    if (equalities.conflict(program, u)) {
      solution.status = Status::infeasible;
      solution.z.resize(0);
      sharpen(program, u);
      program.write_certificate(problem, u, solution);
      solution.message = "equality rows contradict each other, found before Ipopt was called";
      return;
    }
    for (const Index i : equalities.dropped()) {
      std::erase(qp->rows, i);
      solution.redundant.push_back(program.problem_row(i));
    }
  }

  qp->program = &program;
  program.warm_multipliers(problem, options.warm_start, u);
  program.motion(u, qp->start);
  qp->deadline = deadline;
  qp->iterations = 0;
  qp->y.resize(0);
  qp->best = {};
  qp->observe = nullptr;
  if (options.observe)
    qp->observe = [&](int iteration, const Vector& y, const Vector& lambda) {
      program.write(problem, y, lambda, solution);
      options.observe(iteration, solution.z, solution.lambda);
    };
  opened.open().set(options.tolerance, std::min(max_iterations, options.max_iterations), deadline.left(), mehrotra);
  const ip::ApplicationReturnStatus code = application->OptimizeTNLP(ip::SmartPtr<ip::TNLP>(ip::GetRawPtr(qp)));
  solution.iterations = qp->iterations;
  solution.message = in_words(code);
  solution.status = Status::numerical_failure;
  if (qp->y.size() != program.size() || !qp->y.allFinite()) {
    solution.z.resize(0);
    solution.lambda.resize(0);
  } else {
    program.write(problem, qp->y, qp->lambda, solution);
  }

  if (code == ip::Maximum_Iterations_Exceeded) {
    solution.status = Status::iteration_limit;
    return;
  }
  if (code == ip::Maximum_CpuTime_Exceeded || code == ip::User_Requested_Stop) {
    solution.status = Status::time_limit;
    return;
  }
  if (code == ip::Infeasible_Problem_Detected) solution.status = Status::infeasible;
  if (solution.z.size() == 0) return;
  const bool claims_success = code == ip::Solve_Succeeded || code == ip::Solved_To_Acceptable_Level ||
                              code == ip::Search_Direction_Becomes_Too_Small;
  const bool stuck = code == ip::Search_Direction_Becomes_Too_Small || code == ip::Restoration_Failed ||
                     code == ip::Error_In_Step_Computation;
  const double enough = std::max(options.tolerance, 1e-13);
  const double residual = claims_success ? kkt_check(program, qp->y, qp->lambda).worst() : 0;
  if (claims_success && residual <= enough) {
    solution.status = Status::solved;
  } else if (stuck && qp->best.residual <= enough) {
    solution.status = Status::solved;
    solution.message += ", an earlier iterate holds";
    program.write(problem, qp->best.y, qp->best.lambda, solution);
  } else if (certificate(program, qp->y, qp->lambda, u)) {
    solution.status = Status::infeasible;
    sharpen(program, u);
    program.write_certificate(problem, u, solution);
  } else if (claims_success) {
    std::ostringstream text;
    text << ", but its KKT residual is " << residual;
    solution.message += text.str();
  }
}

}  // namespace zwang

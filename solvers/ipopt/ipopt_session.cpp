#include <zwang/solvers/ipopt/ipopt_session.h>

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>

#include <zwang/solvers/first_order/kkt_check.h>

namespace ip = ::Ipopt;

namespace zwang {
namespace {

constexpr double unbounded = 2e19;  // Ipopt takes anything beyond 1e19 as no bound

// The whitened problem in Ipopt's terms: minimize 1/2 |y|^2, 0 <= G y - h (<= 0 on equality rows), over the rows of
// `rows` only. Ipopt's Lagrangian is f + lambda'g, so its multipliers are ours with the sign turned.
class WhitenedQp : public ip::TNLP {
 public:
  IpoptQuestion question;
  IpoptAnswer answer;

  bool get_nlp_info(ip::Index& n, ip::Index& m, ip::Index& nonzeros_G, ip::Index& nonzeros_hessian,
                    IndexStyleEnum& style) override {
    n = nonzeros_hessian = static_cast<int>(question.program->size());
    m = static_cast<int>(question.rows.size());
    nonzeros_G = 0;
    for (const Index i : question.rows) nonzeros_G += row_size(i);
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(ip::Index n, double* lower, double* upper, ip::Index m, double* g_lower,
                       double* g_upper) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    std::fill_n(g_lower, m, 0);
    for (int i = 0; i < m; ++i)
      g_upper[i] = question.program->is_equality(question.rows[static_cast<std::size_t>(i)]) ? 0 : unbounded;
    return true;
  }

  bool get_starting_point(ip::Index n, bool, double* x, bool, double*, double*, ip::Index, bool, double*) override {
    std::copy_n(question.start.data(), n, x);
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
    for (const Index i : question.rows) {
      double value = -question.program->h()[i];
      for (UnitProgram::Rows::InnerIterator it(question.program->G(), i); it; ++it) value += it.value() * x[it.col()];
      *g++ = value;
    }
    return true;
  }

  bool eval_jac_g(ip::Index, const double*, bool, ip::Index, ip::Index, ip::Index* row, ip::Index* column,
                  double* value) override {
    int r = 0;
    for (const Index i : question.rows) {
      for (UnitProgram::Rows::InnerIterator it(question.program->G(), i); it; ++it) {
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
    answer.iterations = iteration;
    if (mode == ip::RegularMode && read_iterate(*data, *quantities)) {
      if (question.observe) question.observe(iteration, answer.y, answer.lambda);
      const double residual = kkt_residual(*question.program, answer.y, answer.lambda);
      if (residual < answer.best.residual) answer.best = {answer.y, answer.lambda, residual};
    }
    return !question.deadline.passed();
  }

  void finalize_solution(ip::SolverReturn, ip::Index n, const double* x, const double*, const double*, ip::Index,
                         const double*, const double* multipliers, double, const ip::IpoptData*,
                         ip::IpoptCalculatedQuantities*) override {
    answer.y = Eigen::Map<const Vector>(x, n);
    spread(multipliers);
  }

 private:
  int row_size(Index i) const {
    const int* outer = question.program->G().outerIndexPtr();
    return outer[i + 1] - outer[i];
  }
  bool read_iterate(const ip::IpoptData& data, ip::IpoptCalculatedQuantities& quantities) {
    auto* original = dynamic_cast<ip::OrigIpoptNLP*>(ip::GetRawPtr(quantities.GetIpoptNLP()));
    auto* adapter = original ? dynamic_cast<ip::TNLPAdapter*>(ip::GetRawPtr(original->nlp())) : nullptr;
    if (!adapter) return false;
    answer.y.resize(question.program->size());
    multipliers_.resize(static_cast<Index>(question.rows.size()));
    adapter->ResortX(*data.curr()->x(), answer.y.data());
    adapter->ResortG(*data.curr()->y_c(), *data.curr()->y_d(), multipliers_.data());
    spread(multipliers_.data());
    return true;
  }
  void spread(const double* multipliers) {
    answer.lambda.setZero(question.program->rows());
    for (const Index i : question.rows) answer.lambda[i] = -*multipliers++;
  }

  Vector multipliers_;  // over `question.rows`
};

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

// What the return code means.
void read_code(ip::ApplicationReturnStatus code, IpoptAnswer& answer) {
  answer.in_words = in_words(code);
  answer.claims_success = code == ip::Solve_Succeeded || code == ip::Solved_To_Acceptable_Level ||
                          code == ip::Search_Direction_Becomes_Too_Small;
  answer.stuck = code == ip::Search_Direction_Becomes_Too_Small || code == ip::Restoration_Failed ||
                 code == ip::Error_In_Step_Computation;
  if (code == ip::Infeasible_Problem_Detected) answer.status = Status::infeasible;
  if (code == ip::Maximum_Iterations_Exceeded) answer.status = Status::iteration_limit;
  if (code == ip::Maximum_CpuTime_Exceeded || code == ip::User_Requested_Stop) answer.status = Status::time_limit;
}

}  // namespace

struct IpoptSession::Library {
  ip::SmartPtr<ip::IpoptApplication> application = new ip::IpoptApplication(false);
  ip::SmartPtr<WhitenedQp> qp = new WhitenedQp;
};

IpoptSession::IpoptSession() : library_(std::make_unique<Library>()) {
  auto options = library_->application->Options();
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
  library_->application->Initialize(std::string());
}

IpoptSession::~IpoptSession() = default;

IpoptQuestion& IpoptSession::question() { return library_->qp->question; }

const IpoptAnswer& IpoptSession::run() {
  auto& [application, qp] = *library_;
  const IpoptQuestion& question = qp->question;
  const double half = 0.5 * question.tolerance;  // so that a violated row and a weakly active one may add up to T
  auto options = application->Options();
  for (const char* name : {"tol", "dual_inf_tol", "constr_viol_tol", "acceptable_tol", "acceptable_dual_inf_tol",
                           "acceptable_constr_viol_tol"})
    options->SetNumericValue(name, half);
  for (const char* name : {"compl_inf_tol", "acceptable_compl_inf_tol"})
    options->SetNumericValue(name, std::max(half * half, 1e-22));
  options->SetIntegerValue("max_iter", question.max_iterations);
  options->SetNumericValue("max_cpu_time", std::clamp(question.deadline.left(), 1e-3, 1e6));
  options->SetStringValue("mehrotra_algorithm", question.mehrotra ? "yes" : "no");

  qp->answer = {};
  read_code(application->OptimizeTNLP(ip::SmartPtr<ip::TNLP>(ip::GetRawPtr(qp))), qp->answer);
  return qp->answer;
}

}  // namespace zwang

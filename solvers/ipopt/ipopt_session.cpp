#include <zwang/solvers/ipopt/ipopt_session.h>

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <map>

#include <zwang/solvers/law/second_order_cone.h>

namespace ip = ::Ipopt;

namespace zwang {
namespace {

constexpr double unbounded = 2e19;  // Ipopt takes anything beyond 1e19 as no bound

// The question in Ipopt's terms: over (y, s), s of the cones alone, G y - h - s = 0 on their rows, 0 <= G y - h (<= 0
// on equality rows) on the others, and s_0^2 - s_1^2 - s_2^2 >= 0, s_0 >= 0 of each cone. s stands beside y so that the
// start is inside the cones, and so that the multipliers of its rows are forces: where a contact sticks, s = 0 and the
// gradient of the squares vanishes. Ipopt's Lagrangian is f + lambda'g: its multipliers are ours with the sign turned.
class Nlp final : public ip::TNLP {
 public:
  IpoptQuestion question;
  IpoptAnswer answer;

  bool get_nlp_info(ip::Index& n, ip::Index& m, ip::Index& nonzeros_jacobian, ip::Index& nonzeros_hessian,
                    IndexStyleEnum& style) override {
    unknowns_ = static_cast<int>(question.G.cols());
    rows_ = static_cast<int>(question.G.rows());
    cones_ = static_cast<int>(question.cones);
    n = nonzeros_hessian = unknowns_ + 3 * cones_;
    m = rows_ + cones_;
    nonzeros_jacobian = static_cast<int>(question.G.nonZeros()) + 3 * cones_ + 3 * cones_;
    style = C_STYLE;
    x_.resize(n);
    multipliers_.resize(m);
    return true;
  }

  bool get_bounds_info(ip::Index n, double* lower, double* upper, ip::Index m, double* g_lower,
                       double* g_upper) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    for (int k = 0; k < cones_; ++k) lower[unknowns_ + 3 * k] = 0;
    std::fill_n(g_lower, m, 0);
    for (int r = 0; r < m; ++r) g_upper[r] = r < 3 * cones_ || (r < rows_ && question.equality[at(r)]) ? 0 : unbounded;
    return true;
  }

  bool get_starting_point(ip::Index, bool, double* x, bool, double*, double*, ip::Index, bool, double*) override {
    std::copy_n(question.start.data(), unknowns_, x);
    for (int k = 0; k < cones_; ++k) {
      double* s = x + unknowns_ + 3 * k;
      for (int q = 0; q < 3; ++q) s[q] = slack(3 * k + q, x);
      s[0] = std::max(s[0], std::hypot(s[1], s[2]) + question.inside);
    }
    return true;
  }

  bool eval_f(ip::Index, const double* x, bool, double& value) override {
    value = 0.5 * Eigen::Map<const Vector>(x, unknowns_).squaredNorm();
    return true;
  }

  bool eval_grad_f(ip::Index n, const double* x, bool, double* gradient) override {
    std::fill(std::copy_n(x, unknowns_, gradient), gradient + n, 0);
    return true;
  }

  bool eval_g(ip::Index, const double* x, bool, ip::Index, double* g) override {
    const double* s = x + unknowns_;
    for (int r = 0; r < rows_; ++r) *g++ = slack(r, x) - (r < 3 * cones_ ? s[r] : 0);
    for (int k = 0; k < cones_; ++k) *g++ = second_order_cone::determinant(s + 3 * k);
    return true;
  }

  bool eval_jac_g(ip::Index, const double* x, bool, ip::Index, ip::Index, ip::Index* row, ip::Index* column,
                  double* value) override {
    Entries entries{row, column, value};
    for (int r = 0; r < rows_; ++r) {
      for (decltype(question.G)::InnerIterator it(question.G, r); it; ++it)
        entries.add(r, static_cast<int>(it.col()), it.value());
      if (r < 3 * cones_) entries.add(r, unknowns_ + r, -1);
    }
    for (int r = 0; r < 3 * cones_; ++r)
      entries.add(rows_ + r / 3, unknowns_ + r, value ? (r % 3 == 0 ? 2 : -2) * x[unknowns_ + r] : 0);
    return true;
  }

  bool eval_h(ip::Index n, const double*, bool, double weight, ip::Index, const double* multipliers, bool, ip::Index,
              ip::Index* row, ip::Index* column, double* value) override {
    Entries entries{row, column, value};
    for (int i = 0; i < n; ++i) {
      const int r = i - unknowns_;
      entries.add(i, i, !value || r < 0 ? weight : (r % 3 == 0 ? 2 : -2) * multipliers[rows_ + r / 3]);
    }
    return true;
  }

  bool intermediate_callback(ip::AlgorithmMode mode, ip::Index iteration, double, double, double, double, double,
                             double, double, double, ip::Index, const ip::IpoptData* data,
                             ip::IpoptCalculatedQuantities* quantities) override {
    answer.iterations = iteration;
    if (mode == ip::RegularMode && read_iterate(*data, *quantities)) {
      if (question.observe) question.observe(iteration, answer.y, answer.lambda);
      const double now = question.residual(answer.y, answer.lambda);
      if (now < answer.best.residual) answer.best = {answer.y, answer.lambda, now};
    }
    return !question.deadline.passed();
  }

  void finalize_solution(ip::SolverReturn, ip::Index, const double* x, const double*, const double*, ip::Index,
                         const double*, const double* multipliers, double, const ip::IpoptData*,
                         ip::IpoptCalculatedQuantities*) override {
    take(x, multipliers);
  }

 private:
  // Of a sparse matrix, where its entries are, or what they are.
  struct Entries {
    ip::Index *row, *column;
    double* value;
    void add(ip::Index i, ip::Index j, double number) {
      if (value)
        *value++ = number;
      else
        *row++ = i, *column++ = j;
    }
  };

  double slack(int row, const double* x) const {
    double value = -question.h[row];
    for (decltype(question.G)::InnerIterator it(question.G, row); it; ++it) value += it.value() * x[it.col()];
    return value;
  }
  // From Ipopt's variables and multipliers to `answer`.
  void take(const double* x, const double* multipliers) {
    answer.y = Eigen::Map<const Vector>(x, unknowns_);
    answer.lambda = -Eigen::Map<const Vector>(multipliers, rows_);
  }
  bool read_iterate(const ip::IpoptData& data, ip::IpoptCalculatedQuantities& quantities) {
    auto* original = dynamic_cast<ip::OrigIpoptNLP*>(ip::GetRawPtr(quantities.GetIpoptNLP()));
    auto* adapter = original ? dynamic_cast<ip::TNLPAdapter*>(ip::GetRawPtr(original->nlp())) : nullptr;
    if (!adapter) return false;
    adapter->ResortX(*data.curr()->x(), x_.data());
    adapter->ResortG(*data.curr()->y_c(), *data.curr()->y_d(), multipliers_.data());
    take(x_.data(), multipliers_.data());
    return true;
  }

  int unknowns_ = 0, rows_ = 0, cones_ = 0;
  Vector x_, multipliers_;
};

std::string in_words(ip::ApplicationReturnStatus code) {
  static const std::map<ip::ApplicationReturnStatus, const char*> words{
      {ip::Solve_Succeeded, "solve succeeded"},
      {ip::Solved_To_Acceptable_Level, "solved to acceptable level"},
      {ip::Infeasible_Problem_Detected, "infeasible problem detected"},
      {ip::Search_Direction_Becomes_Too_Small, "search direction becomes too small"},
      {ip::Diverging_Iterates, "diverging iterates"},
      {ip::Restoration_Failed, "restoration failed"},
      {ip::Error_In_Step_Computation, "error in step computation"}};
  const auto found = words.find(code);
  return "Ipopt: " + (found != words.end() ? found->second : "return code " + std::to_string(static_cast<int>(code)));
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
  ip::SmartPtr<Nlp> nlp = new Nlp;
};

IpoptSession::IpoptSession() : library_(std::make_unique<Library>()) {
  auto options = library_->application->Options();
  for (const auto& [name, value] :
       {std::pair{"jac_c_constant", "yes"}, {"nlp_scaling_method", "none"}, {"linear_solver", "mumps"}, {"sb", "yes"}})
    options->SetStringValue(name, value);
  options->SetNumericValue("bound_relax_factor", 0);
  options->SetIntegerValue("acceptable_iter", 0);
  options->SetIntegerValue("print_level", 0);
  library_->application->Initialize(std::string());
}

IpoptSession::~IpoptSession() = default;

IpoptQuestion& IpoptSession::question() { return library_->nlp->question; }

const IpoptAnswer& IpoptSession::run() {
  auto& [application, nlp] = *library_;
  const IpoptQuestion& question = nlp->question;
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

  for (const char* name : {"jac_d_constant", "hessian_constant"})
    options->SetStringValue(name, question.cones > 0 ? "no" : "yes");

  nlp->answer = {};
  read_code(application->OptimizeTNLP(ip::SmartPtr<ip::TNLP>(ip::GetRawPtr(nlp))), nlp->answer);
  return nlp->answer;
}

}  // namespace zwang

#include <zwang/solvers/ipopt/ipopt_session.h>

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <map>

#include <zwang/solvers/finish/kkt_check.h>
#include <zwang/solvers/law/second_order_cone.h>

namespace ip = ::Ipopt;

namespace zwang {
namespace {

constexpr double unbounded = 2e19;  // Ipopt takes anything beyond 1e19 as no bound

// Either program in Ipopt's terms, and what comes back of it.
class Asked : public ip::TNLP {
 public:
  IpoptQuestion question;
  IpoptAnswer answer;

  bool intermediate_callback(ip::AlgorithmMode mode, ip::Index iteration, double, double, double, double, double,
                             double, double, double, ip::Index, const ip::IpoptData* data,
                             ip::IpoptCalculatedQuantities* quantities) final {
    answer.iterations = iteration;
    if (mode == ip::RegularMode && read_iterate(*data, *quantities)) {
      if (question.observe) question.observe(iteration, answer.y, answer.lambda);
      const double now = residual();
      if (now < answer.best.residual) answer.best = {answer.y, answer.lambda, now};
    }
    return !question.deadline.passed();
  }

  bool eval_f(ip::Index, const double* x, bool, double& value) final {
    value = 0.5 * Eigen::Map<const Vector>(x, unknowns_).squaredNorm();
    return true;
  }

  bool eval_grad_f(ip::Index n, const double* x, bool, double* gradient) final {
    std::fill(std::copy_n(x, unknowns_, gradient), gradient + n, 0);
    return true;
  }

  void finalize_solution(ip::SolverReturn, ip::Index, const double* x, const double*, const double*, ip::Index,
                         const double*, const double* multipliers, double, const ip::IpoptData*,
                         ip::IpoptCalculatedQuantities*) final {
    take(x, multipliers);
  }

 protected:
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

  // From Ipopt's variables and multipliers to `answer`.
  virtual void take(const double* x, const double* multipliers) = 0;
  virtual double residual() = 0;  // of `answer`
  void has_size(ip::Index variables, ip::Index constraints, ip::Index unknowns) {
    x_.resize(variables);
    multipliers_.resize(constraints);
    unknowns_ = unknowns;
  }

  ip::Index unknowns_ = 0;  // the first variables: of these the square is minimized

 private:
  bool read_iterate(const ip::IpoptData& data, ip::IpoptCalculatedQuantities& quantities) {
    auto* original = dynamic_cast<ip::OrigIpoptNLP*>(ip::GetRawPtr(quantities.GetIpoptNLP()));
    auto* adapter = original ? dynamic_cast<ip::TNLPAdapter*>(ip::GetRawPtr(original->nlp())) : nullptr;
    if (!adapter) return false;
    adapter->ResortX(*data.curr()->x(), x_.data());
    adapter->ResortG(*data.curr()->y_c(), *data.curr()->y_d(), multipliers_.data());
    take(x_.data(), multipliers_.data());
    return true;
  }

  Vector x_, multipliers_;
};

// The whitened problem in Ipopt's terms: minimize 1/2 |y|^2, 0 <= G y - h (<= 0 on equality rows), over the rows of
// `rows` only. Ipopt's Lagrangian is f + lambda'g, so its multipliers are ours with the sign turned.
class WhitenedQp final : public Asked {
 public:
  bool get_nlp_info(ip::Index& n, ip::Index& m, ip::Index& nonzeros_G, ip::Index& nonzeros_hessian,
                    IndexStyleEnum& style) override {
    n = nonzeros_hessian = static_cast<int>(question.program->size());
    m = static_cast<int>(question.rows.size());
    nonzeros_G = 0;
    for (const Index i : question.rows) nonzeros_G += row_size(i);
    style = C_STYLE;
    has_size(n, m, n);
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
    Entries entries{row, column, value};
    int r = 0;
    for (const Index i : question.rows) {
      for (UnitProgram::Rows::InnerIterator it(question.program->G(), i); it; ++it)
        entries.add(r, static_cast<int>(it.col()), it.value());
      ++r;
    }
    return true;
  }

  bool eval_h(ip::Index n, const double*, bool, double weight, ip::Index, const double*, bool, ip::Index,
              ip::Index* row, ip::Index* column, double* value) override {
    Entries entries{row, column, value};
    for (int i = 0; i < n; ++i) entries.add(i, i, weight);
    return true;
  }

 private:
  int row_size(Index i) const {
    const int* outer = question.program->G().outerIndexPtr();
    return outer[i + 1] - outer[i];
  }
  void take(const double* x, const double* multipliers) override {
    answer.y = Eigen::Map<const Vector>(x, question.program->size());
    answer.lambda.setZero(question.program->rows());
    for (const Index i : question.rows) answer.lambda[i] = -*multipliers++;
  }
  double residual() override { return kkt_residual(*question.program, answer.y, answer.lambda); }
};

// The cone program: over (v, s), minimize 1/2 |v|^2 with G v - s = h, and s_0^2 - s_1^2 - s_2^2 >= 0, s_0 >= 0 of each
// cone; single rows as they are. s stands beside v so that the start is inside the cones, and so that the multipliers
// of its rows are forces: where a contact sticks, s = 0 and the gradient of the squares vanishes.
class ConeNlp final : public Asked {
 public:
  bool get_nlp_info(ip::Index& n, ip::Index& m, ip::Index& nonzeros_G, ip::Index& nonzeros_hessian,
                    IndexStyleEnum& style) override {
    ConeProgram& p = *question.cones;
    const auto unknowns = static_cast<int>(p.face().unknowns());
    cones_ = static_cast<int>(p.cones());
    rays_ = static_cast<int>(p.rays());
    n = unknowns + 3 * cones_;
    m = 3 * cones_ + rays_ + cones_;
    nonzeros_G = (3 * cones_ + rays_) * unknowns + 3 * cones_ + 3 * cones_;
    nonzeros_hessian = n;
    style = C_STYLE;
    has_size(n, m, unknowns);
    v_.resize(unknowns);
    slack_.resize(p.rows());
    return true;
  }

  bool get_bounds_info(ip::Index n, double* lower, double* upper, ip::Index m, double* g_lower,
                       double* g_upper) override {
    std::fill_n(lower, n, -unbounded);
    std::fill_n(upper, n, unbounded);
    for (int k = 0; k < cones_; ++k) lower[unknowns_ + 3 * k] = 0;
    std::fill_n(g_lower, m, 0);
    std::fill_n(g_upper, 3 * cones_, 0);
    for (int r = 0; r < rays_; ++r) g_upper[3 * cones_ + r] = question.cones->is_equality(r) ? 0 : unbounded;
    std::fill_n(g_upper + 3 * cones_ + rays_, cones_, unbounded);
    return true;
  }

  bool get_starting_point(ip::Index, bool, double* x, bool, double*, double*, ip::Index, bool, double*) override {
    slack_at(question.start.data());
    std::copy_n(question.start.data(), unknowns_, x);
    for (int k = 0; k < cones_; ++k) {
      double* s = std::copy_n(slack_.data() + 3 * k, 3, x + unknowns_ + 3 * k) - 3;
      s[0] = std::max(s[0], std::hypot(s[1], s[2]) + question.cones->start());
    }
    return true;
  }

  bool eval_g(ip::Index, const double* x, bool, ip::Index, double* g) override {
    slack_at(x);
    const double* s = x + unknowns_;
    for (int r = 0; r < 3 * cones_; ++r) *g++ = slack_[r] - s[r];
    g = std::copy_n(slack_.data() + 3 * cones_, rays_, g);
    for (int k = 0; k < cones_; ++k) *g++ = second_order_cone::determinant(s + 3 * k);
    return true;
  }

  bool eval_jac_g(ip::Index, const double* x, bool, ip::Index, ip::Index, ip::Index* row, ip::Index* column,
                  double* value) override {
    Entries entries{row, column, value};
    DenseFace& face = question.cones->dense_face();
    for (int r = 0; r < 3 * cones_ + rays_; ++r) {
      for (int j = 0; j < unknowns_; ++j) entries.add(r, j, value ? face.row(r)[j] : 0);
      if (r < 3 * cones_) entries.add(r, unknowns_ + r, -1);
    }
    for (int k = 0; k < cones_; ++k)
      for (int q = 0; q < 3; ++q) {
        const int j = unknowns_ + 3 * k + q;
        entries.add(3 * cones_ + rays_ + k, j, value ? (q == 0 ? 2 : -2) * x[j] : 0);
      }
    return true;
  }

  bool eval_h(ip::Index n, const double*, bool, double weight, ip::Index, const double* multipliers, bool, ip::Index,
              ip::Index* row, ip::Index* column, double* value) override {
    Entries entries{row, column, value};
    for (int i = 0; i < n; ++i) {
      const int k = (i - unknowns_) / 3, q = (i - unknowns_) % 3;
      entries.add(i, i, !value || i < unknowns_ ? weight : (q == 0 ? 2 : -2) * multipliers[3 * cones_ + rays_ + k]);
    }
    return true;
  }

 private:
  void slack_at(const double* v) {
    v_ = Eigen::Map<const Vector>(v, unknowns_);
    question.cones->slack(v_, slack_);
  }
  void take(const double* x, const double* multipliers) override {
    answer.y = Eigen::Map<const Vector>(x, unknowns_);
    answer.lambda = -Eigen::Map<const Vector>(multipliers, 3 * cones_ + rays_);
  }
  double residual() override {
    slack_at(answer.y.data());
    return std::max(question.cones->residual(answer.lambda, slack_).natural,
                    question.cones->imbalance(answer.y, answer.lambda) * question.cones->scale(answer.y));
  }

  int cones_ = 0, rays_ = 0;
  Vector v_, slack_;
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
  ip::SmartPtr<WhitenedQp> qp = new WhitenedQp;
  ip::SmartPtr<ConeNlp> cone_nlp = new ConeNlp;
  IpoptQuestion question;
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

IpoptQuestion& IpoptSession::question() { return library_->question; }

const IpoptAnswer& IpoptSession::run() {
  auto& [application, qp, cone_nlp, question] = *library_;
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
    options->SetStringValue(name, question.cones ? "no" : "yes");

  Asked& asked = question.cones ? static_cast<Asked&>(*cone_nlp) : *qp;
  asked.question = question;
  asked.answer = {};
  read_code(application->OptimizeTNLP(ip::SmartPtr<ip::TNLP>(&asked)), asked.answer);
  return asked.answer;
}

}  // namespace zwang

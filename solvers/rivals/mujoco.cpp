#include <zwang/solvers/rivals/mujoco.h>

#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>

#include <zwang/core/problem/wording.h>
#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/rivals/peer_rows.h>

namespace zwang {
namespace {

// In MuJoCo's sparse form, without its lists of rows that look alike (`super`).
void put(const UnitProgram::Rows& A, int* count, int* first, int* super, int* column, double* value) {
  for (Index i = 0; i < A.rows(); ++i) {
    first[i] = A.outerIndexPtr()[i];
    count[i] = A.outerIndexPtr()[i + 1] - first[i];
    super[i] = 0;
  }
  std::copy_n(A.innerIndexPtr(), A.nonZeros(), column);
  std::copy_n(A.valuePtr(), A.nonZeros(), value);
}

}  // namespace

// A model of n masses of 1 kg, each on a slide of its own, with room for k rows. Its poses are never looked at: M = I,
// and the rows are written into mjData, where MuJoCo's own constraints would be.
class MujocoSession {
 public:
  MujocoSession() {
    mju_user_error = [](const char* message) { throw std::runtime_error(message); };
    mju_user_warning = [](const char*) {};
  }

  void fit(Index n, Index k);
  void state(const UnitProgram& program, double stiffness, const Vector& start);
  // At most `steps` from the last point; the number taken.
  int run(int steps, double tolerance);
  bool converged(int steps, double tolerance) const;
  void read(Vector& y, Vector& lambda) const;

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::vector<Index> order_;  // equality rows first, as MuJoCo wants them
  UnitProgram::Rows J_, JT_;
};

void MujocoSession::fit(Index n, Index k) {
  if (model_ && model_->nv == n && model_->njmax >= k) return;
  data_.reset();
  std::ostringstream xml;
  xml << "<mujoco><size njmax='" << k << "' nconmax='1' nstack='" << 8 * n * n + 64 * (n + k) + 4096
      << "'/><option solver='Newton'/><worldbody>";
  for (Index i = 0; i < n; ++i)
    xml << "<body><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/><joint type='slide'/></body>";
  xml << "</worldbody></mujoco>";
  const std::string text = xml.str();
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "slides.xml", static_cast<int>(text.size()));
  std::ranges::copy(text, static_cast<char*>(files->filedata[0]));
  char error[500] = "";
  model_.reset(mj_loadXML("slides.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model_) throw std::runtime_error(std::string("MuJoCo refused the model: ") + error);
  data_.reset(mj_makeData(model_.get()));
  if (!data_) throw std::bad_alloc();
  model_->stat.meaninertia = 1.0 / static_cast<double>(std::max<Index>(1, n));  // improvements as they are
  std::fill_n(data_->qM, model_->nM, 1.0);
}

void MujocoSession::state(const UnitProgram& program, double stiffness, const Vector& start) {
  const Preparation preparing;
  mjData& d = *data_;
  order_ = program.rows_of(true);
  const std::vector<Index> inequalities = program.rows_of(false);
  d.ne = static_cast<int>(order_.size());
  order_.insert(order_.end(), inequalities.begin(), inequalities.end());
  d.nf = d.ncon = 0;
  d.nefc = static_cast<int>(order_.size());
  J_ = program.some(order_);
  for (Index at = 0; at < d.nefc; ++at) {
    d.efc_type[at] = at < d.ne ? mjCNSTR_EQUALITY : mjCNSTR_CONTACT_FRICTIONLESS;
    d.efc_id[at] = 0;
    d.efc_frictionloss[at] = 0;
    d.efc_aref[at] = program.h[order_[static_cast<std::size_t>(at)]];
    d.efc_D[at] = stiffness;
    d.efc_R[at] = 1 / stiffness;
  }
  if (mj_isSparse(model_.get())) {
    JT_ = J_.transpose();
    put(J_, d.efc_J_rownnz, d.efc_J_rowadr, d.efc_J_rowsuper, d.efc_J_colind, d.efc_J);
    put(JT_, d.efc_JT_rownnz, d.efc_JT_rowadr, d.efc_JT_rowsuper, d.efc_JT_colind, d.efc_JT);
  } else {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(d.efc_J, J_.rows(), J_.cols()) =
        J_;
  }
  std::fill_n(d.qacc_smooth, model_->nv, 0.0);
  std::fill_n(d.qfrc_smooth, model_->nv, 0.0);
  std::copy_n(start.data(), model_->nv, d.qacc_warmstart);
}

int MujocoSession::run(int steps, double tolerance) {
  model_->opt.iterations = steps;
  model_->opt.tolerance = tolerance;
  mj_fwdConstraint(model_.get(), data_.get());
  return data_->solver_iter;
}

// MuJoCo's own tests: no step improves, or the last one improved little.
bool MujocoSession::converged(int steps, double tolerance) const {
  if (data_->solver_iter < steps) return true;
  const mjSolverStat& last = data_->solver[std::min(steps, mjNSOLVER) - 1];
  return last.improvement < tolerance || last.gradient < tolerance;
}

void MujocoSession::read(Vector& y, Vector& lambda) const {
  y = Eigen::Map<const Vector>(data_->qacc, model_->nv);
  lambda.resize(std::ssize(order_));
  lambda(order_) = Eigen::Map<const Vector>(data_->efc_force, lambda.size());
}

void MujocoNewton::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr double default_gain = 1e-8;  // of a last step: MuJoCo's own tolerance
  constexpr double claimed_part = 0.01;  // of T, in the residual
  if (!program.build(problem, options, solution)) return;
  MujocoSession& session = opened.open();
  session.fit(program.size(), program.rows());
  Vector y, lambda;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, y);
  session.state(program, stiffness, y);

  // Newton keeps nothing from step to step, so that shown steps may be asked for one by one.
  const int limit = std::min(max_steps, options.max_iterations), batch = options.observe ? 1 : limit;
  const double tolerance = std::min(default_gain, options.tolerance * options.tolerance);
  solution.status = Status::iteration_limit;
  while (solution.status == Status::iteration_limit && solution.iterations < limit) {
    const int steps = std::min(batch, limit - solution.iterations);
    solution.iterations += session.run(steps, tolerance);
    if (session.converged(steps, tolerance)) solution.status = Status::solved;
    session.read(y, lambda);
    if (!options.observe) continue;
    program.write(problem, y, lambda, solution);
    options.observe(solution.iterations, solution.z, solution.lambda);
  }
  program.write(problem, y, lambda, solution);
  if (solution.status != Status::solved) return;
  const double residual = program.kkt_residual(y, lambda);
  solution.message = printed("MuJoCo: converged; its soft rows give way by %g of the motion", residual);
  if (!(residual <= std::max(claimed_part * options.tolerance, tolerances::kkt_floor)))
    solution.status = Status::iteration_limit;
}

}  // namespace zwang

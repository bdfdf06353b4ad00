#include <zwang/solvers/rivals/siconos.h>

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <GlobalFrictionContactProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

#include <zwang/core/problem/wording.h>

// OpenBLAS' own threads would make small solves slower, and answers differ from run to run.
extern "C" void openblas_set_num_threads(int count) __attribute__((weak));

namespace zwang {
namespace {

struct FreeOptions {
  void operator()(SolverOptions* o) const {
    solver_options_delete(o);
    std::free(o);
  }
};
struct FreeLocal {
  void operator()(FrictionContactProblem* p) const { frictionContactProblem_free(p); }
};
struct FreeGlobal {
  void operator()(GlobalFrictionContactProblem* p) const { globalFrictionContact_free(p); }
};

// The library frees what it is given with free().
double* copied(const double* from, Index count) {
  auto* to = static_cast<double*>(std::malloc(sizeof(double) * at(std::max<Index>(count, 1))));
  if (!to) throw std::bad_alloc();
  std::copy_n(from, count, to);
  return to;
}

std::unique_ptr<SolverOptions, FreeOptions> choose(int method, double tolerance, int iterations) {
  if (openblas_set_num_threads) openblas_set_num_threads(1);
  std::unique_ptr<SolverOptions, FreeOptions> options(solver_options_create(method));
  if (!options) throw std::bad_alloc();
  options->dparam[SICONOS_DPARAM_TOL] = tolerance;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = iterations;
  return options;
}

template <class Sparse>
NumericsMatrix* sparse(const Sparse& A, bool transposed) {
  const auto rows = static_cast<int>(transposed ? A.cols() : A.rows()),
             columns = static_cast<int>(transposed ? A.rows() : A.cols());
  NumericsMatrix* out = NM_create(NM_SPARSE, rows, columns);
  NM_triplet_alloc(out, static_cast<CS_INT>(A.nonZeros()));
  for (Index k = 0; k < A.outerSize(); ++k)
    for (typename Sparse::InnerIterator it(A, k); it; ++it)
      if (it.value() != 0)
        NM_entry(out, static_cast<int>(transposed ? it.col() : it.row()),
                 static_cast<int>(transposed ? it.row() : it.col()), it.value());
  return out;
}

constexpr Index most_rows = 3000;  // of a dense Delassus matrix

}  // namespace

std::string SiconosWork::supports(const Problem& p, bool global) {
  if (!p.has_tangents()) return "no contact with friction";
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i)) continue;
    if (p.is_equality(i)) {
      if (global) return "equality rows: Siconos has none, and its global form leaves joints in";
      continue;
    }
    if (p.tangents(i) != 2 || !(p.mu[i] > 0))
      return "rows without friction, or with one tangent: Siconos' 3D solvers take contacts only";
    if (!std::isfinite(p.c[i])) return "an inactive contact";
  }
  if (!global && p.rows() > most_rows) return "a dense Delassus matrix of more than 3000 rows";
  return {};
}

void SiconosWork::judge(int code, const Problem& p, const SolveOptions& options, Solution& solution) {
  slack.setZero(program.rows());
  if (program.is_dense()) program.face().force(y, motion);
  program.slack(motion, slack);
  const double scale = program.scale(motion);
  double left = program.residual(y, slack).natural;
  if (!program.is_dense()) {  // the motion came back beside the forces
    velocity.setZero(motion.size());
    reaction.setZero(motion.size());
    program.face().force(y, velocity);
    program.face().mass(motion, reaction);
    left = std::max(left, scale * (velocity - reaction).lpNorm<Eigen::Infinity>() /
                              std::max(reaction.lpNorm<Eigen::Infinity>(), std::numeric_limits<double>::min()));
  }
  const bool holds = motion.allFinite() && left <= options.tolerance * scale;
  solution.status = holds ? Status::solved : Status::numerical_failure;
  solution.message = printed("Siconos: code %d, natural residual %g", code, left / scale);
  if (!motion.allFinite()) {
    solution.empty_answer();
  } else {
    program.write(p, motion, y, solution);
  }
}

void SiconosWork::solve_local(int method, const Problem& p, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (!program.build(p, ConeProgram::Want::any, options, deadline, solution)) return;
  if (!program.is_dense() || program.rays() > 0)
    throw Stopped{Status::unsupported, "joints or rows that this form does not take"};
  const Index m = program.rows(), nc = program.cones();
  const auto unscaled = [&](Index r) { return r % 3 == 0 ? program.mu(r / 3) : 1.0; };
  W.resize(m, m);
  y.setZero(m);
  slack.setZero(m);
  motion.setZero(program.face().unknowns());
  for (Index r = 0; r < m; ++r) {
    y[r] = unscaled(r);
    program.face().force(y, motion);
    program.face().slack(motion, slack);
    for (Index i = 0; i < m; ++i) W(i, r) = unscaled(i) * slack[i];
    y[r] = 0;
  }
  velocity = -program.h();
  for (Index r = 0; r < m; ++r) velocity[r] *= unscaled(r);
  Vector mu(nc);
  for (Index k = 0; k < nc; ++k) mu[k] = program.mu(k);
  std::unique_ptr<FrictionContactProblem, FreeLocal> local(frictionContactProblem_new_with_data(
      3, static_cast<int>(nc),
      NM_create_from_data(NM_DENSE, static_cast<int>(m), static_cast<int>(m), copied(W.data(), m * m)),
      copied(velocity.data(), m), copied(mu.data(), nc)));
  const auto chosen = choose(method, ask * options.tolerance, std::min(max_iterations, options.max_iterations));
  reaction.setZero(m);
  velocity.setZero(m);
  const int code = fc3d_driver(local.get(), reaction.data(), velocity.data(), chosen.get());
  solution.iterations = chosen->iparam[SICONOS_IPARAM_ITER_DONE];
  for (Index r = 0; r < m; ++r) y[r] = unscaled(r) * reaction[r];
  program.face().force(y, motion);
  judge(code, p, options, solution);
}

void SiconosWork::solve_global(int method, const Problem& p, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (!program.build(p, ConeProgram::Want::any, options, deadline, solution)) return;
  const Index n = p.size(), m = p.rows(), nc = m / 3;
  std::unique_ptr<GlobalFrictionContactProblem, FreeGlobal> global(globalFrictionContactProblem_new());
  const Vector q = p.M * p.z_u, b = -p.c;
  Vector mu(nc);
  for (Index k = 0; k < nc; ++k) mu[k] = p.mu[3 * k];
  global->dimension = 3;
  global->numberOfContacts = static_cast<int>(nc);
  global->M = sparse(p.M, false);
  global->H = sparse(p.J, true);
  global->q = copied(q.data(), n);
  global->b = copied(b.data(), m);
  global->mu = copied(mu.data(), nc);
  global->norm_q = q.norm();
  global->norm_b = b.norm();
  global->env = nullptr;
  const auto chosen = choose(method, ask * options.tolerance, std::min(max_iterations, options.max_iterations));
  reaction.setZero(m);
  velocity.setZero(m);
  Vector motion_of_all = Vector::Zero(n);
  const int code = gfc3d_driver(global.get(), reaction.data(), velocity.data(), motion_of_all.data(), chosen.get());
  solution.iterations = chosen->iparam[SICONOS_IPARAM_ITER_DONE];
  program.read(p, motion_of_all, reaction, motion, y);
  judge(code, p, options, solution);
}

}  // namespace zwang

#include <zwang/solvers/rivals/nlopt.h>

#include <nlopt.h>

#include <algorithm>
#include <memory>

#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/rivals/peer_rows.h>

namespace zwang {
namespace {

constexpr double row_tolerance = tolerances::nlopt_row;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The rows b - A v <= 0 (= 0), dense, as NLopt's vector-valued constraints want them. -A is what is kept: NLopt asks
// for it as the gradient in every evaluation, and turning the signs then took 1 % of SLSQP's time on a hand.
struct DenseRows {
  RowMajor minus_A;
  Vector b;

  static void evaluate(unsigned m, double* result, unsigned n, const double* v, double* gradient, void* self) {
    const auto& rows = *static_cast<const DenseRows*>(self);
    Eigen::Map<Vector> value(result, m);
    value = rows.b;
    value.noalias() += rows.minus_A * Eigen::Map<const Vector>(v, n);
    if (gradient) std::copy_n(rows.minus_A.data(), rows.minus_A.size(), gradient);
  }
};

// minimize 1/2 |v|^2 over the two sets of rows, y = origin + basis v (basis empty: y = v).
struct DenseProgram {
  Vector origin;
  Matrix basis;
  DenseRows equalities, inequalities;
  Deadline deadline;
  nlopt_opt optimizer = nullptr;
  std::function<void(int, const Vector&)> observe = nullptr;
  int evaluations = 0;

  Index size() const { return basis.size() ? basis.cols() : origin.size(); }
  Vector motion(const Vector& v) const { return basis.size() ? Vector(origin + basis * v) : v; }

  static double objective(unsigned n, const double* v, double* gradient, void* self) {
    auto& program = *static_cast<DenseProgram*>(self);
    const Eigen::Map<const Vector> at(v, n);
    if (gradient) Eigen::Map<Vector>(gradient, n) = at;
    ++program.evaluations;
    if (program.deadline.passed()) nlopt_force_stop(program.optimizer);
    if (program.observe) program.observe(program.evaluations, program.motion(at));
    return 0.5 * at.squaredNorm();
  }
};

DenseRows dense_rows(const UnitProgram& program, bool equality, const DenseProgram& frame) {
  const std::vector<Index> chosen = program.rows_of(equality);
  DenseRows rows{.minus_A = RowMajor(-program.some(chosen)), .b = program.h(chosen)};
  for (Index r = 0; r < std::ssize(chosen); ++r) rows.b[r] -= program.dot(chosen[at(r)], frame.origin);
  if (frame.basis.size()) rows.minus_A = RowMajor(rows.minus_A * frame.basis);
  return rows;
}

constexpr std::array algorithms{NLOPT_LD_SLSQP, NLOPT_LD_MMA, NLOPT_LD_CCSAQ, NLOPT_LN_COBYLA};  // as NloptMethod

Status claim(nlopt_result result) {
  return meaning(result, {{NLOPT_SUCCESS, Status::solved},
                          {NLOPT_STOPVAL_REACHED, Status::solved},
                          {NLOPT_FTOL_REACHED, Status::solved},
                          {NLOPT_XTOL_REACHED, Status::solved},
                          {NLOPT_MAXEVAL_REACHED, Status::iteration_limit},
                          {NLOPT_MAXTIME_REACHED, Status::time_limit},
                          {NLOPT_FORCED_STOP, Status::time_limit}});
}

// Start of MMA and CCSAQ. At v = 0 the objective's gradient vanishes, their first model is flat, and they claim success
// after a step of no length. One step along the violated rows leaves that point.
Vector off_the_origin(const DenseRows& rows, Index size) {
  if (rows.b.size() == 0) return Vector::Zero(size);
  return -(rows.minus_A.transpose() * rows.b.cwiseMax(0.0));
}

nlopt_result run(NloptMethod method, DenseProgram& program, const SolveOptions& options, int evaluations, Vector& v) {
  const unsigned n = static_cast<unsigned>(program.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> owner(
      nlopt_create(algorithms[static_cast<std::size_t>(method)], n), nlopt_destroy);
  nlopt_opt optimizer = program.optimizer = owner.get();
  nlopt_set_min_objective(optimizer, DenseProgram::objective, &program);
  const auto add = [&](DenseRows& rows, auto add_constraints) {
    const Vector tolerance = Vector::Constant(rows.b.size(), row_tolerance);
    if (rows.b.size() > 0)
      add_constraints(optimizer, static_cast<unsigned>(rows.b.size()), DenseRows::evaluate, &rows, tolerance.data());
  };
  add(program.equalities, nlopt_add_equality_mconstraint);
  add(program.inequalities, nlopt_add_inequality_mconstraint);

  // Lengths are near 1, so a step below T is what T means; the floor keeps NLopt from waiting for less than rounding.
  const double step = std::max(options.tolerance, tolerances::nlopt_step);
  nlopt_set_xtol_rel(optimizer, step);
  nlopt_set_xtol_abs1(optimizer, step);
  nlopt_set_maxeval(optimizer, evaluations);
  if (std::isfinite(options.time_limit)) nlopt_set_maxtime(optimizer, std::max(program.deadline.left(), 1e-9));
  double value = 0;
  return nlopt_optimize(optimizer, v.data(), &value);
}

// MMA and CCSAQ raise the weights of their convex models until steps fall below T, near the solution or far from it:
// at 1e-8 they claimed success 0.06 off on two boxes, 1.3 off on ten masses. A new run begins with small weights, so
// only a run that moves by no more than T has arrived.
nlopt_result restart_until_it_stays(NloptMethod method, DenseProgram& program, const SolveOptions& options,
                                    int evaluations, nlopt_result result, Vector& v) {
  for (double moved = infinity; result == NLOPT_XTOL_REACHED && moved > options.tolerance;) {
    if (program.evaluations >= evaluations) return NLOPT_MAXEVAL_REACHED;
    const Vector before = v;
    result = run(method, program, options, evaluations - program.evaluations, v);
    moved = (v - before).norm();
  }
  return result;
}

}  // namespace

template <NloptMethod method>
void Nlopt<method>::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  DenseProgram dense{
      .origin = {}, .basis = {}, .equalities = {}, .inequalities = {}, .deadline = Deadline(options.time_limit)};
  if (!program.build(problem, options, solution)) return;
  solution.empty_lambda();

  dense.origin.setZero(program.size());
  if (reduce || !equalities.clearly_independent(program)) {
    equalities.factorize(program);
    if (Vector u; equalities.conflict(program, u)) {
      solution.status = Status::infeasible;
      solution.empty_z();
      program.write_certificate(problem, u, solution);
      solution.message = "equality rows contradict each other, found before NLopt was called";
      return;
    }
    for (const Index i : equalities.dropped()) solution.redundant.push_back(program.row[at(i)]);
    if (equalities.rank() > 0) {
      dense.origin = equalities.shortest(program);
      dense.basis = equalities.free_motions(program);
    }
  } else {
    dense.equalities = dense_rows(program, true, dense);
  }
  dense.inequalities = dense_rows(program, false, dense);
  if (options.observe)
    dense.observe = [&](int evaluation, const Vector& y) {
      program.write(problem, y, Vector(), solution);
      options.observe(evaluation, solution.z, solution.lambda);
    };

  const bool rigid = dense.basis.rows() > 0 && dense.basis.cols() == 0;
  Vector v = Vector::Zero(rigid ? 0 : dense.size());
  Vector y = dense.origin;
  if (rigid) {
    const bool holds = dense.inequalities.b.size() == 0 || dense.inequalities.b.maxCoeff() <= row_tolerance;
    solution.status = holds ? Status::solved : Status::numerical_failure;
    solution.message = "the equality rows leave no motion for NLopt";
  } else {
    if (method == NloptMethod::mma || method == NloptMethod::ccsaq)
      v = off_the_origin(dense.inequalities, dense.size());
    const int most = std::max(1, std::min(max_evaluations, options.max_iterations));
    nlopt_result result = run(method, dense, options, most, v);
    if (method == NloptMethod::mma || method == NloptMethod::ccsaq)
      result = restart_until_it_stays(method, dense, options, most, result, v);
    solution.status = claim(result);
    solution.message = std::string("NLopt: ") + nlopt_result_to_string(result);
    y = dense.motion(v);
  }
  solution.iterations = dense.evaluations;
  write_answer(problem, program, y, {}, {}, solution);
}

template struct Nlopt<NloptMethod::slsqp>;
template struct Nlopt<NloptMethod::mma>;
template struct Nlopt<NloptMethod::ccsaq>;
template struct Nlopt<NloptMethod::cobyla>;

}  // namespace zwang

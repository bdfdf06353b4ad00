#include <zwang/solvers/ipopt/ipopt_method.h>

#include <algorithm>

#include <zwang/core/problem/wording.h>
#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/ipopt/ipopt_session.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

bool is_limit(Status status) { return status == Status::iteration_limit || status == Status::time_limit; }

void write_proof(const Problem& problem, const UnitProgram& program, Vector& u, Solution& solution) {
  solution.status = Status::infeasible;
  Sharpening().run(program, u);
  program.write_certificate(problem, u, solution);
}

// The rows that Ipopt can take. False where equality rows contradict each other, which is then written.
bool choose_rows(const Problem& problem, const UnitProgram& program, EqualityRows& equalities, std::vector<Index>& rows,
                 Solution& solution) {
  const Preparation preparing;
  rows.clear();
  for (Index i = 0; i < program.rows(); ++i) rows.push_back(i);
  if (equalities.clearly_independent(program)) return true;
  equalities.factorize(program);
  if (Vector u; equalities.conflict(program, u)) {
    solution.empty_z();
    write_proof(problem, program, u, solution);
    solution.message = "equality rows contradict each other, found before Ipopt was called";
    return false;
  }
  for (const Index i : equalities.dropped()) {
    std::erase(rows, i);
    solution.redundant.push_back(program.row[at(i)]);
  }
  return true;
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

void judge(const Problem& problem, const UnitProgram& program, const IpoptAnswer& answer, double tolerance,
           Solution& solution) {
  const double enough = std::max(tolerance, tolerances::kkt_floor);
  const double residual = answer.claims_success ? program.kkt_residual(answer.y, answer.lambda) : 0;
  if (answer.claims_success && residual <= enough) {
    solution.status = Status::solved;
  } else if (answer.stuck && answer.best.residual <= enough) {
    solution.status = Status::solved;
    solution.message += ", an earlier iterate holds";
    program.write(problem, answer.best.y, answer.best.lambda, solution);
  } else if (Vector u; certificate(program, answer.y, answer.lambda, u)) {
    write_proof(problem, program, u, solution);
  } else if (answer.claims_success) {
    solution.message += printed(", but its KKT residual is %g", residual);
  }
}

}  // namespace

// A question with the limits set.
IpoptQuestion& IpoptMethod::ask(const SolveOptions& options, const Deadline& deadline) {
  IpoptQuestion& question = session.open().question();
  question = {.tolerance = options.tolerance,
              .max_iterations = std::min(max_iterations, options.max_iterations),
              .mehrotra = mehrotra,
              .deadline = deadline};
  return question;
}

const IpoptAnswer& IpoptMethod::run(Solution& solution) {
  const IpoptAnswer& answer = session.open().run();
  solution.iterations = answer.iterations;
  solution.message = answer.in_words;
  return answer;
}

bool IpoptMethod::holds(const Vector& v, const Vector& y, const SolveOptions& options) {
  ConeProgram& program = cones;
  if (v.size() != program.face().unknowns() || !v.allFinite() || !y.allFinite()) return false;
  slack.resize(program.rows());
  program.slack(v, slack);
  const bool balanced = (v.isZero(0) && y.isZero(0)) || program.imbalance(v, y) <= options.tolerance;
  return balanced && program.accepts(program.residual(y, slack), v, options);
}

void IpoptMethod::solve_cones(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  ConeProgram& program = cones;
  if (!program.build(problem, ConeProgram::Want::dense, options, deadline, solution)) return;
  if (!program.is_dense()) throw Stopped{Status::unsupported, "more than 1000 unknowns with friction"};
  IpoptQuestion& question = ask(options, deadline);
  const Index unknowns = program.face().unknowns();
  question.G.resize(program.rows(), unknowns);
  question.G.reserve(Eigen::VectorXi::Constant(program.rows(), static_cast<int>(unknowns)));
  for (Index r = 0; r < program.rows(); ++r)
    for (Index j = 0; j < unknowns; ++j) question.G.insert(r, j) = program.dense_face().row(r)[j];
  question.h = program.h();
  question.equality.assign(at(3 * program.cones()), 0);
  for (Index r = 0; r < program.rays(); ++r) question.equality.push_back(program.is_equality(r));
  question.cones = program.cones();
  question.inside = program.start();
  question.residual = [&](const Vector& v, const Vector& y) {
    slack.resize(program.rows());
    program.slack(v, slack);
    return std::max(program.residual(y, slack).natural, program.imbalance(v, y) * program.scale(v));
  };
  v.setZero(program.face().unknowns());
  if (Vector y; program.warm(problem, options.warm_start, y)) program.face().force(y, v);
  question.start = v;
  if (options.observe)
    question.observe = [&](int iteration, const Vector& v, const Vector& y) {
      program.write(problem, v, y, solution);
      options.observe(iteration, solution.z, solution.lambda);
    };
  const IpoptAnswer& answer = run(solution);
  solution.status = answer.status == Status::infeasible ? Status::numerical_failure : answer.status;
  const bool limited = is_limit(answer.status);
  if (!limited && holds(answer.y, answer.lambda, options)) {
    solution.status = Status::solved;
    program.write(problem, answer.y, answer.lambda, solution);
  } else if (!limited && holds(answer.best.y, answer.best.lambda, options)) {
    solution.status = Status::solved;
    solution.message += ", an earlier iterate holds";
    program.write(problem, answer.best.y, answer.best.lambda, solution);
  } else if (answer.y.size() > 0 && answer.y.allFinite() && answer.lambda.allFinite()) {
    program.write(problem, answer.y, answer.lambda, solution);
    if (!limited && answer.claims_success) solution.message += ", but the natural residual is above the tolerance";
  } else {
    solution.empty_answer();
  }
}

void IpoptMethod::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (problem.has_tangents()) return solve_cones(problem, options, solution);
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  IpoptQuestion& question = ask(options, deadline);
  if (!choose_rows(problem, program, equalities, rows, solution)) return;
  // Multipliers of all rows.
  const auto of_all = [this](const Vector& of_rows) {
    Vector all = Vector::Zero(program.rows());
    if (of_rows.size() == std::ssize(rows)) all(rows) = of_rows;
    return all;
  };
  question.G = program.some(rows);
  question.h = program.h(rows);
  for (const Index i : rows) question.equality.push_back(program.is_equality(i));
  question.residual = [&](const Vector& y, const Vector& multipliers) {
    return program.kkt_residual(y, of_all(multipliers));
  };
  Vector lambda;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, question.start);
  if (options.observe)
    question.observe = [&](int iteration, const Vector& y, const Vector& multipliers) {
      program.write(problem, y, of_all(multipliers), solution);
      options.observe(iteration, solution.z, solution.lambda);
    };

  IpoptAnswer answer = run(solution);
  for (Vector* multipliers : {&answer.lambda, &answer.best.lambda}) *multipliers = of_all(*multipliers);
  solution.status = answer.status;
  const bool has_point = answer.y.size() == program.size() && answer.y.allFinite();
  if (has_point) {
    program.write(problem, answer.y, answer.lambda, solution);
  } else {
    solution.empty_answer();
  }
  const bool limited = is_limit(answer.status);
  if (has_point && !limited) judge(problem, program, answer, options.tolerance, solution);
}

}  // namespace zwang

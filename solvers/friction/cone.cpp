#include <zwang/solvers/friction/cone.h>

#include <zwang/solvers/solver_entry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace zwang {
namespace {

constexpr int most_steps = 60;    // of an interior point from one start
constexpr int most_coupled = 52;  // and, where the shift is differentiated, with Newton's steps between them
constexpr int most_modes = 8;     // Newton steps from an iterate inside the cones
// And from an earlier answer: under Coulomb's law, where the interior point is soon done, too, a few, and more where
// they have almost arrived. (32 at once are lost on the multipliers of a frame whose contacts were others; 10 alone end
// two frames of a hand in ten just before the answer.)
constexpr int most_warm = 32, few_warm = 10, more_warm = 6;
// Convex problems where no start led to an answer; from when on the slips go half of the way, for some go to and fro.
constexpr int most_rounds = 40, whole_rounds = 24;

// Unknowns that are never cut apart: a body's six. In files without M (M = I then) any may stand alone; without
// friction the solver that is handed the problem looks for parts itself.
Index unit_of(const Problem& problem) {
  constexpr Index body = 6;
  if (!problem.has_tangents()) return body;
  if (problem.size() % body != 0) return 1;
  const auto& M = problem.M;
  if (M.nonZeros() != M.cols()) return body;
  const bool identity = std::all_of(M.valuePtr(), M.valuePtr() + M.nonZeros(), [](double mass) { return mass == 1; });
  return identity ? 1 : body;
}

}  // namespace

// A part that hardly moves beside the others may be beyond doubles by itself, and well within them in the whole.
void Cone::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  works_.begin();
  normals_.begin();
  int parts = 0;
  const auto one = [&](const Problem& p, const SolveOptions& o, Solution& part) {
    ++parts;
    works_.own(p.size(), p.rows()).solve(*this, p, o, part);
  };
  islands_.solve_apart(one, unit_of(problem), problem, options, solution);
  if (parts <= 1 || solution.status != Status::numerical_failure) return;
  const int iterations = solution.iterations;
  SolveOptions rest = options;
  rest.time_limit = deadline.left();
  one(problem, rest, solution);
  solution.iterations += iterations;
  solution.fallback = true;
}

void Cone::Work::Best::keep(const Vector& other_v, const Vector& other_y, double residual) {
  if (!(residual < natural) || !other_v.allFinite() || !other_y.allFinite()) return;
  v = other_v;
  y = other_y;
  natural = residual;
}

// Keeps what is accepted whatever was kept before: of a motion without end the natural residual may be the smaller.
bool Cone::Work::takes(const Job& job, const ConeProgram::Residual& r, const Vector& v, const Vector& y, bool settled) {
  const bool accepted = program_.accepts(r, v, job.options, settled);
  if (accepted) job.best.natural = infinity;
  job.best.keep(v, y, r.natural);
  return accepted;
}

// What a start is too large or too small for shows at the end only.
const std::array<Cone::Work::Rung, 7> Cone::Work::ladder{Rung{nullptr, &Work::from_rest},
                                                         {nullptr, &Work::from_warm},
                                                         {nullptr, &Work::from_start},
                                                         {&Work::may_go_dense, &Work::from_dense_rows},
                                                         {nullptr, &Work::from_start, 0.03},
                                                         {nullptr, &Work::from_start, 30},
                                                         {&Work::may_take_slips, &Work::from_convex_problems}};

bool Cone::Work::may_go_dense(const Job& job) const {
  return program_.law().lifts() && !program_.is_dense() && ConeProgram::can_be_dense(job.problem);
}

Cone::Work::End Cone::Work::from_rest(const Job& job, double) {
  job.best.natural = infinity;
  modes_.v.setZero(program_.face().unknowns());
  modes_.y.setZero(program_.rows());
  modes_.begin(program_);
  job.best.keep(modes_.v, modes_.y, modes_.residual.natural);
  return modes_.residual.natural == 0 ? End::accepted : End::failed;
}

void Cone::Work::run_modes(const Job& job, double goal, double leaves, int most) {
  modes_.run(program_, goal, leaves, std::min(most, job.options.max_iterations - job.solution.iterations), job.deadline,
             job.solution.iterations);
}

Cone::Work::End Cone::Work::from_warm(const Job& job, double) {
  if (!program_.warm(job.problem, job.options.warm_start, modes_.y)) return End::failed;
  modes_.v.setZero(program_.face().unknowns());
  if (!program_.is_dense()) return End::failed;
  program_.face().force(modes_.y, modes_.v);
  modes_.begin(program_);
  const double goal = tolerances::cone_exact * program_.scale(modes_.v);
  const auto run = [&](int most) { run_modes(job, goal, job.options.tolerance * program_.scale(modes_.v), most); };
  const bool lifts = program_.law().lifts();
  run(lifts ? few_warm : most_warm);
  const double left = modes_.residual.natural;
  if (lifts && !modes_.settled && left > goal && left <= tolerances::cone_arrives * program_.scale(modes_.v))
    run(more_warm);
  return takes(job, modes_.residual, modes_.v, modes_.y, modes_.settled) ? End::accepted : End::failed;
}

// To an answer that nothing certifies yet, as where contacts depend on each other, other ways mostly end there, too,
// and all of them together get the iterations of one.
Cone::Work::End Cone::Work::from_start(const Job& job, double start) {
  if (start == first_start || !is_near(job.best)) begun_ = job.solution.iterations;
  return job.solution.iterations - begun_ < most_coupled ? from_inside(job, start) : End::failed;
}

Cone::Work::End Cone::Work::from_dense_rows(const Job& job, double start) {
  const int before = job.solution.iterations;
  if (!program_.build(job.problem, ConeProgram::Want::dense, job.options, job.deadline, job.solution))
    return End::written;
  job.solution.iterations = before;
  job.solution.fallback = true;
  const End end = from_rest(job, 0);
  return end == End::failed ? from_start(job, start) : end;
}

Cone::Work::End Cone::Work::from_inside(const Job& job, double start) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  inside_.begin(program_, start);
  const double unit = program_.start();
  const bool couples = program_.law().lifts() && program_.is_dense();
  double target = couples ? tolerances::cone_coupled_regime : tolerances::cone_regime;
  double looked_at = tolerances::cone_runs_off * unit;
  for (int step = 0;;) {
    const bool in_regime = inside_.gap() <= target * unit * unit && inside_.residual() <= std::sqrt(target) * unit;
    bool stuck = (couples ? solution.iterations - begun_ >= most_coupled : step >= most_steps) ||
                 target < tolerances::cone_deepest;
    if (!in_regime && !stuck) {
      if (deadline.passed() || solution.iterations >= options.max_iterations) {
        best.keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
        return End::limit;
      }
      stuck = !inside_.step(program_);
      if (!stuck) {
        ++step;
        ++solution.iterations;
        if (options.observe) {
          program_.write(p, inside_.v, inside_.y, solution);
          options.observe(solution.iterations, solution.z, solution.lambda);
        }
        if (!program_.law().lifts() && inside_.y.lpNorm<Eigen::Infinity>() > looked_at) {
          if (inside_.proves_infeasible(program_, tolerances::out_of_reach, proof_)) {
            program_.write_certificate(p, proof_, solution);
            return End::written;
          }
          looked_at = tolerances::cone_runs_off * inside_.y.lpNorm<Eigen::Infinity>();
        }
        if (program_.is_dense()) continue;
        const ConeProgram::Residual own = program_.residual(inside_.y, inside_.s);
        if (inside_.residual() <= options.tolerance * program_.scale(inside_.v) &&
            takes(job, own, inside_.v, inside_.y))
          return End::accepted;
        continue;
      }
    }
    best.keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
    if (deadline.passed()) return End::limit;
    if (finish) {
      modes_.begin(program_, inside_);
      const double goal = tolerances::cone_exact * program_.scale(modes_.v);
      run_modes(job, goal, options.tolerance * program_.scale(modes_.v), most_modes);
      if (takes(job, modes_.residual, modes_.v, modes_.y, modes_.settled)) return End::accepted;
    } else if (takes(job, program_.residual(inside_.y, inside_.s), inside_.v, inside_.y)) {
      return End::accepted;
    }
    if (stuck) return End::failed;
    target *= tolerances::cone_deeper;
  }
}

// Each law asks for s_n >= 0 of all contacts, whatever their friction: a proof against that is one against it.
bool Cone::Work::contradicts_itself(Work& normals, const Job& job) {
  SolveOptions rest = job.options;
  rest.observe = nullptr;
  if (!normals.program_.build(job.problem, ConeProgram::Want::normals, rest, job.deadline, of_normals_))
    return of_normals_.status == Status::infeasible;
  return normals.from_inside({job.problem, rest, job.deadline, of_normals_, normals.best_}, first_start) ==
         End::written;
}

bool Cone::Work::is_near(const Best& best) {
  const double left = best.natural / program_.scale(best.v);
  return program_.law().lifts() && program_.is_dense() && left > tolerances::cone_exact &&
         left <= tolerances::cone_near;
}

// Would another step leave the motion where it is? With very different masses a residual of rounding is far from z.
bool Cone::Work::modes_stay(const SolveOptions& options) {
  move_ = modes_.v;
  if (!modes_.step(program_)) return false;
  move_ -= modes_.v;
  pull_.setZero(move_.size());
  program_.face().mass(move_, pull_);
  return std::sqrt(std::max(0.0, pull_.dot(move_))) <= accepted_error(options.tolerance) * program_.scale(modes_.v);
}

// Coulomb's law as a fixed point of the slips (fixed_point.h): from the answer to the convex problem of the slips at
// hand to Newton's method on the modes. Slower than the interior point, and led elsewhere.
Cone::Work::End Cone::Work::from_convex_problems(const Job& job, double start) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  SolveOptions rest = options;
  rest.observe = nullptr;
  const int most = is_near(best) ? std::min(begun_ + most_coupled, options.max_iterations) : options.max_iterations;
  const ConeLaw law = program_.law();
  slips_.setZero(program_.cones());
  s_.setZero(program_.rows());
  for (int round = 0; round < most_rounds; ++round) {
    of_convex_.reset(p.size(), p.rows());
    rest.max_iterations = most - solution.iterations;
    program_.state({}, &slips_);
    of_slips_ = best;
    of_slips_.natural = infinity;
    const End end = from_inside({p, rest, deadline, of_convex_, of_slips_}, start);
    solution.iterations += of_convex_.iterations;
    program_.state(law);
    if (end == End::limit) break;
    const bool none = end == End::written;
    if (none) of_slips_.v.setZero();  // the slips of z_u lift the cones enough
    program_.slack(of_slips_.v, s_);
    if (!none) {
      modes_.v = of_slips_.v;
      modes_.y = of_slips_.y;
      modes_.begin(program_);
      run_modes(job, tolerances::cone_exact * program_.scale(modes_.v), 0, most_modes);
      if (takes(job, modes_.residual, modes_.v, modes_.y) && modes_stay(options)) {
        solution.fallback = true;
        return End::accepted;
      }
    }
    for (Index k = 0; k < program_.cones(); ++k) {
      const double slip = law.lift * std::hypot(s_[3 * k + 1], s_[3 * k + 2]);
      const double step = round < whole_rounds ? 1 : 0.5;
      slips_[k] = none ? std::max(2 * slips_[k], slip) : slips_[k] + step * (slip - slips_[k]);
    }
  }
  return End::failed;
}

void Cone::Work::climb(const Job& job) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  if (!program_.build(p, ConeProgram::Want::any, options, deadline, solution)) return;
  End end = End::failed;
  for (const Rung& rung : ladder)
    if (end == End::failed && (!rung.when || (this->*rung.when)(job))) end = (this->*rung.run)(job, rung.start);
  if (end == End::written) return;
  program_.write(p, best.v, best.y, solution);
  if (options.observe) options.observe(solution.iterations, solution.z, solution.lambda);
  if (end == End::accepted) {
    solution.status = Status::solved;
  } else if (end == End::limit || deadline.passed()) {
    solution.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
  } else {
    solution.status = Status::numerical_failure;
    const double left = best.natural / program_.scale(best.v);
    const char* const reason = left <= options.tolerance ? "the natural residual is %.1e of the motion, and proves no z"
                                                         : "the natural residual stays at %.1e of the motion";
    std::array<char, 80> text;
    std::snprintf(text.data(), text.size(), reason, left);
    solution.message = text.data();
  }
}

void Cone::Work::solve_without_friction(const Problem& p, const SolveOptions& options, Solution& solution) {
  const bool few = p.size() <= ConeProgram::few_unknowns;
  if (few)
    active_set_.solve(p, options, solution);
  else
    newton_.solve(p, options, solution);
  if (solution.handed_to.empty()) solution.handed_to = few ? DualActiveSet::name : Newton::name;
}

void Cone::Work::solve(Cone& cone, const Problem& p, const SolveOptions& options, Solution& solution) {
  if (!p.has_tangents()) return solve_without_friction(p, options, solution);
  const Deadline deadline(options.time_limit);
  const Job job{p, options, deadline, solution, best_, cone.finish};
  climb(job);
  if (solution.status == Status::numerical_failure && contradicts_itself(cone.normals_.own(p.size(), p.rows()), job)) {
    solution.status = Status::infeasible;
    solution.zero_certificate(p.rows()) = of_normals_.certificate;
    solution.empty_z();
    solution.empty_lambda();
    solution.message.clear();
  }
}

template SolverEntry entry<Cone>(SolverEntry);

}  // namespace zwang

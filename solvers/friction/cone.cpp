#include <zwang/solvers/friction/cone.h>

#include <zwang/solvers/solver_entry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

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

void Cone::Work::keep(const Vector& v, const Vector& y, double natural) {
  if (!(natural < natural_) || !v.allFinite() || !y.allFinite()) return;
  v_ = v;
  y_ = y;
  natural_ = natural;
}

// Keeps what is accepted whatever was kept before: of a motion without end the natural residual may be the smaller.
bool Cone::Work::takes(const ConeProgram::Residual& r, const Vector& v, const Vector& y, const SolveOptions& options,
                       bool settled) {
  const bool accepted = program_.accepts(r, v, options, settled);
  if (accepted) natural_ = std::numeric_limits<double>::infinity();
  keep(v, y, r.natural);
  return accepted;
}

bool Cone::Work::from_warm(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                           const WarmStart* warm, Solution& solution) {
  if (!program_.warm(p, warm, modes_.y)) return false;
  modes_.v.setZero(program_.face().unknowns());
  if (!program_.is_dense()) return false;
  program_.face().force(modes_.y, modes_.v);
  modes_.begin(program_);
  const double goal = tolerances::cone_exact * program_.scale(modes_.v);
  const auto run = [&](int most) {
    modes_.run(program_, goal, options.tolerance * program_.scale(modes_.v),
               std::min(most, options.max_iterations - solution.iterations), deadline, solution.iterations);
  };
  run(program_.law().lifts() ? few_warm : most_warm);
  const double left = modes_.residual.natural;
  if (program_.law().lifts() && !modes_.settled && left > goal &&
      left <= tolerances::cone_arrives * program_.scale(modes_.v))
    run(more_warm);
  return takes(modes_.residual, modes_.v, modes_.y, options, modes_.settled);
}

Cone::Work::End Cone::Work::from_inside(bool finish, const Problem& p, const SolveOptions& options,
                                        const Deadline& deadline, double start, Solution& solution) {
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
        keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
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
            return End::infeasible;
          }
          looked_at = tolerances::cone_runs_off * inside_.y.lpNorm<Eigen::Infinity>();
        }
        if (program_.is_dense()) continue;
        const ConeProgram::Residual own = program_.residual(inside_.y, inside_.s);
        if (inside_.residual() <= options.tolerance * program_.scale(inside_.v) &&
            takes(own, inside_.v, inside_.y, options))
          return End::accepted;
        continue;
      }
    }
    keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
    if (deadline.passed()) return End::limit;
    if (finish) {
      modes_.begin(program_, inside_);
      const double goal = tolerances::cone_exact * program_.scale(modes_.v);
      modes_.run(program_, goal, options.tolerance * program_.scale(modes_.v),
                 std::min(most_modes, options.max_iterations - solution.iterations), deadline, solution.iterations);
      if (takes(modes_.residual, modes_.v, modes_.y, options, modes_.settled)) return End::accepted;
    } else if (takes(program_.residual(inside_.y, inside_.s), inside_.v, inside_.y, options)) {
      return End::accepted;
    }
    if (stuck) return End::failed;
    target *= tolerances::cone_deeper;
  }
}

// Each law asks for s_n >= 0 of all contacts, whatever their friction: a proof against that is one against it.
bool Cone::Work::contradicts_itself(Work& normals, const Problem& p, const SolveOptions& options,
                                    const Deadline& deadline) {
  SolveOptions rest = options;
  rest.observe = nullptr;
  if (!normals.program_.build(p, ConeProgram::Want::normals, rest, deadline, of_normals_))
    return of_normals_.status == Status::infeasible;
  return normals.from_inside(true, p, rest, deadline, 1, of_normals_) == End::infeasible;
}

// From an earlier answer, from nothing, and from so many starts inside the cones.
Cone::Work::End Cone::Work::from_starts(std::span<const double> starts, bool finish, const Problem& p,
                                        const SolveOptions& options, const Deadline& deadline, const WarmStart* warm,
                                        Solution& solution) {
  natural_ = std::numeric_limits<double>::infinity();
  modes_.v.setZero(program_.face().unknowns());
  modes_.y.setZero(program_.rows());
  modes_.begin(program_);
  keep(modes_.v, modes_.y, modes_.residual.natural);
  if (modes_.residual.natural == 0 || (warm && from_warm(p, options, deadline, warm, solution))) return End::accepted;
  End end = End::failed;
  for (std::size_t k = 0; k < starts.size() && end == End::failed; ++k) {
    if (k == 0 || !is_near()) begun_ = solution.iterations;
    if (k == 0 || solution.iterations - begun_ < most_coupled)
      end = from_inside(finish, p, options, deadline, starts[k], solution);
  }
  return end;
}

// To an answer that nothing certifies yet, as where contacts depend on each other: other ways mostly end there, too,
// and all of them together get the iterations of one.
bool Cone::Work::is_near() {
  const double left = natural_ / program_.scale(v_);
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
bool Cone::Work::by_convex_problems(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                    Solution& solution) {
  SolveOptions rest = options;
  rest.observe = nullptr;
  best_v_ = v_;
  best_y_ = y_;
  const int most = is_near() ? std::min(begun_ + most_coupled, options.max_iterations) : options.max_iterations;
  double least = natural_;
  bool accepted = false;
  slips_.setZero(program_.cones());
  s_.setZero(program_.rows());
  for (int round = 0; round < most_rounds && !accepted; ++round) {
    of_convex_.reset(p.size(), p.rows());
    rest.max_iterations = most - solution.iterations;
    program_.state({}, &slips_);
    natural_ = std::numeric_limits<double>::infinity();
    const End end = from_inside(true, p, rest, deadline, 1, of_convex_);
    solution.iterations += of_convex_.iterations;
    program_.state(ConeLaw::of(p.law));
    if (end == End::limit) break;
    if (end == End::infeasible) v_.setZero(program_.face().unknowns());  // the slips of z_u lift the cones enough
    program_.slack(v_, s_);
    if (end != End::infeasible) {
      natural_ = least;
      modes_.v = v_;
      modes_.y = y_;
      modes_.begin(program_);
      const double goal = tolerances::cone_exact * program_.scale(modes_.v);
      modes_.run(program_, goal, 0, std::min(most_modes, options.max_iterations - solution.iterations), deadline,
                 solution.iterations);
      v_ = best_v_;
      y_ = best_y_;
      accepted = takes(modes_.residual, modes_.v, modes_.y, options);
      least = natural_;
      best_v_ = v_;
      best_y_ = y_;
      accepted = accepted && modes_stay(options);
    }
    for (Index k = 0; k < program_.cones(); ++k) {
      const double slip = program_.law().lift * std::hypot(s_[3 * k + 1], s_[3 * k + 2]);
      const double step = round < whole_rounds ? 1 : 0.5;
      slips_[k] = end == End::infeasible ? std::max(2 * slips_[k], slip) : slips_[k] + step * (slip - slips_[k]);
    }
  }
  v_ = best_v_;
  y_ = best_y_;
  natural_ = least;
  return accepted;
}

// False where the answer is not to be trusted; solution says so.
bool Cone::Work::solve_under_law(bool finish, const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                 const WarmStart* warm, Solution& solution) {
  if (!program_.build(p, ConeProgram::Want::any, options, deadline, solution)) return false;
  // What the start is too large or too small for shows at the end only.
  static constexpr std::array starts{1.0, 0.03, 30.0};
  const bool may_go_dense = program_.law().lifts() && !program_.is_dense() && ConeProgram::can_be_dense(p);
  End end = from_starts(std::span(starts).first(may_go_dense ? 1 : starts.size()), finish, p, options, deadline, warm,
                        solution);
  if (end == End::failed && may_go_dense) {
    const int before = solution.iterations;
    if (!program_.build(p, ConeProgram::Want::dense, options, deadline, solution)) return false;
    solution.iterations = before;
    solution.fallback = true;
    end = from_starts(starts, finish, p, options, deadline, nullptr, solution);
  }
  if (end == End::failed && program_.law().lifts() && program_.is_dense() &&
      by_convex_problems(p, options, deadline, solution)) {
    solution.fallback = true;
    end = End::accepted;
  }
  if (end == End::infeasible) return false;
  const bool accepted = end == End::accepted, limited = end == End::limit;
  program_.write(p, v_, y_, solution);
  if (options.observe) options.observe(solution.iterations, solution.z, solution.lambda);
  if (accepted) {
    solution.status = Status::solved;
  } else if (limited || deadline.passed()) {
    solution.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
  } else {
    solution.status = Status::numerical_failure;
    const double left = natural_ / program_.scale(v_);
    const char* const reason = left <= options.tolerance ? "the natural residual is %.1e of the motion, and proves no z"
                                                         : "the natural residual stays at %.1e of the motion";
    std::array<char, 80> text;
    std::snprintf(text.data(), text.size(), reason, left);
    solution.message = text.data();
  }
  return accepted;
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
  solve_under_law(cone.finish, p, options, deadline, options.warm_start, solution);
  if (solution.status == Status::numerical_failure &&
      contradicts_itself(cone.normals_.own(p.size(), p.rows()), p, options, deadline)) {
    solution.status = Status::infeasible;
    solution.zero_certificate(p.rows()) = of_normals_.certificate;
    solution.empty_z();
    solution.empty_lambda();
    solution.message.clear();
  }
}

template SolverEntry entry<Cone>(SolverEntry);

}  // namespace zwang

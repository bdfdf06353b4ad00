#include <zwang/solvers/friction/cone_starts.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang {
namespace {

constexpr int most_steps = 60;    // of an interior point from one start
constexpr int most_coupled = 60;  // and, where the shift is differentiated, with Newton's steps between them
// Where the shift is differentiated, the first try: the interior point alone ends in fewer where a problem is not hard,
// and the central path costs several times as much a step.
constexpr int most_quick = 45;
// And behind modes that failed: contacts that depend on each other keep the gap from falling to where they show again.
constexpr int most_behind_modes = 5;
constexpr Index most_unknowns = 20'000;  // of sparse LU: of more a factor may take many seconds
constexpr int most_modes = 8;            // Newton steps from an iterate inside the cones
// And from an earlier answer: under Coulomb's law, where the interior point is soon done, too, a few, and more while
// they arrive: more are lost on the multipliers of a frame whose contacts were others. And from what paths came near.
constexpr int most_warm = 32, few_warm = 10, more_warm = 6, most_behind_path = 16;
// Convex problems where no start led to an answer; from when on the slips go half of the way, for some go to and fro.
constexpr int most_rounds = 40, whole_rounds = 24;
// Sweeps over the contacts of sparse rows, a few a factorization's time, and Newton steps from where they are.
constexpr int most_sweeps = 5000, sweeps_a_look = 250, most_swept = 15;
// Of the motion: a natural residual at which one more step tells whether the motion stays, where no way is left. (On
// the way it leaves answers a few digits short that another start would have had.)
constexpr double nearly_exact = 100 * tolerances::cone_exact;
// The gap, in the program's unit, at which a promise is first asked for, and by what it falls until the next look.
constexpr double promising_from = 0.001;

}  // namespace

// What a start is too large or too small for shows at the end only.
const std::array<ConeStarts::Rung, 9> ConeStarts::ladder{
    {{nullptr, &ConeStarts::from_rest},
     {&ConeStarts::has_warm, &ConeStarts::from_warm},
     {&ConeStarts::may_take_few_steps, &ConeStarts::from_inside_once, first_start, Way::quick},
     {&ConeStarts::may_follow, &ConeStarts::from_inside_once, 10, Way::path},
     {&ConeStarts::may_follow, &ConeStarts::from_inside_once, 0.3, Way::path},
     {&ConeStarts::may_start, &ConeStarts::from_start},
     {&ConeStarts::may_start, &ConeStarts::from_start, 0.03},
     {&ConeStarts::has_slips, &ConeStarts::from_convex_problems},
     {&ConeStarts::may_sweep, &ConeStarts::from_sweeps}}};

ConeStarts::End ConeStarts::climb(const Job& job) {
  End end = End::failed;
  for (const Rung& rung : ladder)
    if (end == End::failed && (!rung.applies || (this->*rung.applies)(job, rung))) end = (this->*rung.run)(job, rung);
  return end;
}

void ConeStarts::Best::keep(const Vector& other_v, const Vector& other_y, double residual) {
  if (!(residual < natural) || !other_v.allFinite() || !other_y.allFinite()) return;
  v = other_v;
  y = other_y;
  natural = residual;
}

// Keeps what is accepted whatever was kept before: of a motion without end the natural residual may be the smaller.
bool ConeStarts::takes(const Job& job, const ConeProgram::Residual& r, const Vector& v, const Vector& y, bool settled) {
  const bool accepted = program_.accepts(r, v, job.options, settled);
  if (accepted) job.best.natural = infinity;
  job.best.keep(v, y, r.natural);
  return accepted;
}

ConeStarts::End ConeStarts::from_rest(const Job& job, const Rung&) {
  modes_.begin(program_, job.best.v, job.best.y);
  job.best.keep(modes_.v, modes_.y, modes_.residual.natural);
  return modes_.residual.natural <= tolerances::cone_exact * program_.scale(modes_.v) ? End::accepted : End::failed;
}

bool ConeStarts::run_modes(const Job& job, int most, int more) {
  const double size = program_.scale(modes_.v);
  const int left = job.options.max_iterations - job.solution.iterations;
  modes_.run(program_, tolerances::cone_exact * size, job.options.tolerance * size, std::min(most, left),
             std::min(most + more, left), job.deadline, job.solution.iterations);
  return takes(job, modes_.residual, modes_.v, modes_.y, modes_.settled);
}

bool ConeStarts::has_warm(const Job& job, const Rung&) {
  return program_.is_dense() && program_.warm(job.problem, job.options.warm_start, modes_.y);
}

ConeStarts::End ConeStarts::from_warm(const Job& job, const Rung&) {
  modes_.v.setZero(program_.face().unknowns());
  program_.face().force(modes_.y, modes_.v);
  modes_.begin(program_, modes_.v, modes_.y);
  if (modes_.residual.natural > tolerances::cone_other_frame * program_.scale(modes_.v)) return End::failed;
  const bool lifts = program_.law().lifts();
  return run_modes(job, lifts ? few_warm : most_warm, lifts ? more_warm : 0) ? End::accepted : End::failed;
}

ConeStarts::End ConeStarts::from_start(const Job& job, const Rung& rung) {
  Best& best = job.best;
  if (rung.start == first_start && program_.is_dense() && inside_.follows() &&
      arrives(best, tolerances::cone_near_behind)) {
    program_.face().force(best.y, modes_.v);  // the best may be a guess, whose motion is not that of its forces
    modes_.begin(program_, modes_.v, best.y, true);
    if (run_modes(job, most_behind_path)) return End::accepted;
  }
  if (rung.start == first_start || !is_near(best)) begun_ = job.solution.iterations;
  return job.solution.iterations - begun_ < most_coupled ? from_inside(job, rung.start) : End::failed;
}

bool ConeStarts::may_take_few_steps(const Job& job, const Rung&) {
  return program_.couples() && !(arrives(job.best, tolerances::cone_arrives) && job.solution.iterations > 0);
}

bool ConeStarts::may_follow(const Job&, const Rung&) {
  if (!program_.couples() || !inside_.follows()) return program_.couples();
  const double unit = program_.start();
  return program_.is_dense() && !(inside_.gap() <= tolerances::cone_far_end * unit * unit);
}

ConeStarts::End ConeStarts::from_inside_once(const Job& job, const Rung& rung) {
  begun_ = job.solution.iterations;
  return from_inside(job, rung.start, rung.way);
}

bool ConeStarts::can_couple(const Job& job) {
  return program_.law().lifts() && !program_.face().takes_unsymmetric() &&
         (ConeProgram::can_be_dense(job.problem) || program_.face().unknowns() <= most_unknowns);
}

bool ConeStarts::couple(const Job& job) {
  const int before = job.solution.iterations;
  const bool dense = ConeProgram::can_be_dense(job.problem);
  if (dense && !begin(job, ConeProgram::Want::dense)) return false;
  if (!dense) program_.couple(), inside_.forget_path(), job.best.begin(program_);
  job.solution.iterations = before;
  job.solution.fallback = true;
  return true;
}

// Is where the path points at an answer, or `near` one? Newton's method on the modes then begins there. Both ends are
// guesses, which may fit the modes to the last digit while the motion is not that of the forces: a step makes it so.
// (Where it is made so before, the modes may be others, and a hand that slides has frames without an answer.)
bool ConeStarts::end_is_near(const Job& job, double& near) {
  if (!inside_.sees_end() || !inside_.v_end.allFinite() || !inside_.y_end.allFinite()) return false;
  modes_.begin(program_, inside_.v_end, inside_.y_end);
  if (modes_.residual.natural <= job.options.tolerance * program_.scale(modes_.v) && !modes_.step(program_))
    return false;
  job.best.keep(modes_.v, modes_.y, modes_.residual.natural);
  const double left = modes_.residual.natural / program_.scale(modes_.v);
  if (!(left <= near)) return false;
  near = tolerances::cone_nearer * left;
  return true;
}

ConeStarts::End ConeStarts::from_inside(const Job& job, double start, Way way) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  const double unit = program_.start();
  const bool follows = way == Way::path, quick = way == Way::quick;
  if (follows || start != first_start || !inside_.follows())
    inside_.begin(program_, start);
  else
    inside_.let_go(program_);
  const bool couples = program_.couples();
  double target = follows   ? tolerances::cone_path_regime
                  : couples ? tolerances::cone_coupled_regime
                            : tolerances::cone_regime;
  double looked_at = tolerances::cone_runs_off * unit, promising = promising_from * unit * unit;
  double near = tolerances::cone_near_end;
  for (int step = 0, last = most_steps;;) {  // last: sooner behind modes that failed, where it is to be quick
    const bool sees = follows && end_is_near(job, near);
    const double rounding = std::numeric_limits<double>::epsilon() * inside_.s.lpNorm<Eigen::Infinity>();
    const bool in_regime = sees || (inside_.gap() <= target * unit * unit &&
                                    inside_.residual() <= std::max(std::sqrt(target) * unit, rounding));
    const bool close = inside_.gap() <= tolerances::cone_in_sight * unit * unit;
    bool stuck = (couples ? solution.iterations - begun_ >= (quick ? most_quick : most_coupled) : step >= most_steps) ||
                 (quick && inside_.last_step() < (close ? tolerances::cone_blocked_close : tolerances::cone_blocked)) ||
                 target < tolerances::cone_deepest || step > last;
    if (!in_regime && !stuck) {
      if (deadline.passed() || solution.iterations >= options.max_iterations) {
        best.keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
        return End::limit;
      }
      stuck = !(follows ? inside_.follow(program_) : inside_.step(program_));
      if (!stuck) {
        ++step;
        ++solution.iterations;
        if (options.observe) {
          program_.write(p, inside_.v, inside_.y, solution);
          options.observe(solution.iterations, solution.z, solution.lambda);
        }
        if (!program_.law().lifts() && inside_.y.lpNorm<Eigen::Infinity>() > looked_at) {
          if (inside_.proves_infeasible(program_, proof_)) {
            program_.write_certificate(p, proof_, solution);
            return End::written;
          }
          looked_at = tolerances::cone_runs_off * inside_.y.lpNorm<Eigen::Infinity>();
        }
        // Of dense rows a look costs more than a step, which is made up for where many would follow.
        if (options.has_accuracy() &&
            (!program_.is_dense() || (program_.law().lifts() && promise_.keeps_modes(inside_.y, inside_.s))) &&
            inside_.gap() <= promising) {
          if (promise_.holds_at(inside_.y, solution)) return End::written;
          promising = promising_from * (promise_.is_vain() ? promising_from : 1) * inside_.gap();
        }
        if (!program_.is_dense() && inside_.residual() <= options.tolerance * program_.scale(inside_.v) &&
            takes(job, program_.residual(inside_.y, inside_.s), inside_.v, inside_.y))
          return End::accepted;
        continue;
      }
    }
    best.keep(inside_.v, inside_.y, program_.residual(inside_.y, inside_.s).natural);
    if (deadline.passed()) return End::limit;
    if (way != Way::free && !in_regime) return End::failed;
    if (finish) {
      if (!sees) modes_.begin(program_, inside_);
      if (run_modes(job, most_modes)) return End::accepted;
    } else if (inside_.residual() <= accepted_error(options.tolerance) * program_.scale(inside_.v) &&
               takes(job, program_.residual(inside_.y, inside_.s), inside_.v, inside_.y)) {
      if (!program_.law().lifts()) return End::accepted;
      modes_.begin(program_, inside_);
      if (modes_stay(options)) return End::accepted;
    }
    if (stands(job, false)) return End::accepted;
    if (stuck) return End::failed;
    if (quick) last = step + most_behind_modes;
    do  // the same iterate has the same modes
      target *= tolerances::cone_deeper;
    while (inside_.gap() <= target * unit * unit && target >= tolerances::cone_deepest);
  }
}

ConeStarts::End ConeStarts::from_sweeps(const Job& job, const Rung&) {
  if (!sweeps_.begin(program_)) return End::failed;
  Vector &v = swept_.v, &y = swept_.y;
  v.setZero(program_.face().unknowns());
  y = job.best.y;
  program_.cut(y);
  program_.face().force(y, v);
  program_.divide_by_mass(v);
  for (int sweep = 1; sweep <= most_sweeps; ++sweep) {
    if (job.deadline.passed()) return End::limit;
    sweeps_.sweep(program_, v, y);
    if (sweep % sweeps_a_look != 0) continue;
    modes_.begin(program_, v, y);
    if (!(modes_.residual.natural <= tolerances::cone_swept * program_.scale(v))) continue;
    if (run_modes(job, most_swept)) return End::accepted;
    if (job.solution.iterations >= job.options.max_iterations) return End::limit;
  }
  return End::failed;
}

bool ConeStarts::arrives(const Best& best, double within) { return best.natural <= within * program_.scale(best.v); }

// An answer that nothing certifies yet?
bool ConeStarts::is_near(const Best& best) {
  const double left = best.natural / program_.scale(best.v);
  return program_.law().lifts() && program_.is_dense() && left > tolerances::cone_exact &&
         left <= tolerances::cone_near;
}

// Does friction take next to nothing of the motion?
bool ConeStarts::all_but_rests(const Best& best) {
  s_.setZero(program_.rows());
  program_.slack(best.v, s_);
  double taken = 0;
  for (Index k = 0; k < program_.cones(); ++k)
    taken += std::max(0.0, best.y[3 * k]) * std::hypot(s_[3 * k + 1], s_[3 * k + 2]);
  const double size = program_.scale(best.v);
  return taken <= tolerances::cone_rests * size * size;
}

// Would another step leave the motion where it is? With very different masses a residual of rounding is far from z.
bool ConeStarts::modes_stay(const SolveOptions& options) {
  move_ = modes_.v;
  if (!modes_.step(program_)) return false;
  move_ -= modes_.v;
  return program_.length(move_) <= accepted_error(options.tolerance) * program_.scale(modes_.v);
}

bool ConeStarts::stands(const Job& job, bool at_last) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  const double size = program_.scale(best.v);
  const bool lifts = program_.law().lifts(), anew = best.natural < 0.5 * best.looked_at;
  if (!finish || !(best.natural <= options.tolerance * size) || deadline.passed()) return false;
  asked_.accuracy = accepted_error(options.tolerance);
  nearby_.begin(p, asked_, &program_);
  best.looked_at = std::min(best.looked_at, best.natural);
  const bool bounded = anew && !program_.is_out_of_reach(best.v) && nearby_.holds_at(best.y);
  modes_.begin(program_, bounded ? nearby_.v() : best.v, bounded ? nearby_.y() : best.y);
  const bool settled = at_last && lifts && best.natural <= nearly_exact * size &&
                       program_.accepts(modes_.residual, modes_.v, options, true);
  if (!(bounded || settled) || (lifts && !modes_stay(options))) return false;
  if (bounded) best.v = nearby_.v(), best.y = nearby_.y();
  return true;
}

bool ConeStarts::has_slips(const Job& job, const Rung&) {
  if (!program_.law().lifts()) return false;
  return program_.is_dense() || (!program_.face().takes_unsymmetric() && all_but_rests(job.best));
}

ConeStarts::End ConeStarts::from_convex_problems(const Job& job, const Rung& rung) {
  const bool dense = program_.is_dense();
  const auto& [p, options, deadline, solution, best, finish] = job;
  SolveOptions rest = options;
  rest.observe = nullptr;
  rest.accuracy = rest.speed_accuracy = 0;
  const int most = is_near(best) ? std::min(begun_ + most_coupled, options.max_iterations) : options.max_iterations;
  const ConeLaw law = program_.law();
  slips_.setZero(program_.cones());
  s_.setZero(program_.rows());
  for (int round = 0; round < (dense ? most_rounds : 1); ++round) {
    of_convex_.reset(p.size(), p.rows());
    rest.max_iterations = most - solution.iterations;
    program_.state({}, &slips_);
    of_slips_.begin(program_);
    const End end = from_inside({p, rest, deadline, of_convex_, of_slips_}, rung.start);
    solution.iterations += of_convex_.iterations;
    program_.state(law);
    if (end == End::limit) break;
    const bool none = end == End::written;
    if (none) of_slips_.v.setZero();  // the slips of z_u lift the cones enough
    program_.slack(of_slips_.v, s_);
    if (!none) {
      modes_.begin(program_, of_slips_.v, of_slips_.y);
      if (run_modes(job, most_modes) && modes_stay(options)) {
        solution.fallback = true;
        return End::accepted;
      }
    }
    for (Index k = 0; k < program_.cones(); ++k) {
      const double slip = law.lift * std::hypot(s_[3 * k + 1], s_[3 * k + 2]);
      slips_[k] =
          none ? std::max(2 * slips_[k], slip) : slips_[k] + (round < whole_rounds ? 1 : 0.5) * (slip - slips_[k]);
    }
  }
  return End::failed;
}

}  // namespace zwang

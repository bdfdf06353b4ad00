#pragma once

#include <array>

#include <zwang/solvers/friction/contact_sweeps.h>
#include <zwang/solvers/friction/mode_newton.h>
#include <zwang/solvers/friction/promise.h>
#include <zwang/solvers/newton_start.h>

namespace zwang {

// The ways to an answer of a cone program, from one start each, and the best iterate of them all: an interior point
// into the regime where the modes of the contacts show, then Newton's method on the modes.
class ConeStarts {
 public:
  using End = NewtonStart::End;
  // Of an interior point: `quick` is given up where the problem is hard, `path` keeps to the central path.
  enum class Way { free, quick, path };
  // The best iterate there is, by its natural residual.
  struct Best {
    Vector v = {}, y = {};
    double natural = 0, looked_at = 0;  // that stands() looked at the last time
    void keep(const Vector& other_v, const Vector& other_y, double residual);
    void begin(ConeProgram& program) {
      v.setZero(program.face().unknowns());
      y.setZero(program.rows());
      natural = looked_at = infinity;
    }
  };
  struct Job {
    const Problem& problem;
    const SolveOptions& options;
    const Deadline& deadline;
    Solution& solution;
    Best& best;
    bool finish = true;  // Newton's method on the modes
  };
  static constexpr double first_start = 1;

  // False where the answer is known, and then written.
  bool begin(const Job& job, ConeProgram::Want want) {
    promise_.begin(job.problem, job.options, &program_, &modes_.equations());
    inside_.forget_path();
    if (!program_.build(job.problem, want, job.options, job.deadline, job.solution)) return false;
    job.best.begin(program_);
    return true;
  }
  ConeProgram& program() { return program_; }
  // Sparse rows under Coulomb's law, which are not differentiated: they go all ways again, dense or with sparse LU.
  bool can_couple(const Job& job);
  bool couple(const Job& job);  // false: the problem is decided
  // Is there an answer near the best iterate where residual and gap do not tell? There is by a bound on its error
  // (promise.h), and the best then moves to where it holds; at last also where contacts that depend on each other hand
  // load to and fro, and the motion stays.
  bool stands(const Job& job, bool at_last);
  bool promises(const Job& job) { return promise_.holds_at(job.best.y, job.solution); }
  // Where that is not what was asked for.
  void judge(const Job& job) {
    double& bound = job.solution.error_bound;
    const bool is_vain = promise_.is_vain();
    if (!is_vain) promise_.judge(job.problem, job.options, job.solution);
    if (!std::isfinite(bound)) bound = is_vain ? infinity : Solution::unknown;  // the registry asks again
  }
  Best best;

  End climb(const Job& job);  // from one start after the other, until one does not fail
  End from_inside(const Job& job, double start, Way way = Way::free);  // by the interior point

 private:
  // A start, and when it is tried where all before it failed. `start`: the size of an interior point's.
  struct Rung {
    bool (ConeStarts::*applies)(const Job& job, const Rung& rung);
    End (ConeStarts::*run)(const Job& job, const Rung& rung);
    double start = first_start;
    Way way = Way::free;
  };
  static const std::array<Rung, 9> ladder;

  // z_u, where it meets the rows to rounding.
  End from_rest(const Job& job, const Rung&);
  End from_warm(const Job& job, const Rung&);
  bool has_warm(const Job& job, const Rung&);
  End from_inside_once(const Job& job, const Rung& rung);
  // Coulomb's law, where few steps of the interior point are enough. (Where Newton's method on the modes came near from
  // an earlier answer and did not settle, contacts depend on each other, and they seldom are.)
  bool may_take_few_steps(const Job& job, const Rung&);
  // Along the central path of Coulomb's law, as far as it leads; from_start() of size first_start then goes on from its
  // end. Behind another path where that ended at a fold, of dense rows: the one from another size may have none.
  bool may_follow(const Job& job, const Rung&);
  // Behind a path of dense rows, where something came near, Newton's method on the modes goes on from that first. From
  // another size where rows are not differentiated again.
  End from_start(const Job& job, const Rung& rung);
  bool may_start(const Job& job, const Rung& rung) { return rung.start == first_start || !can_couple(job); }
  // Coulomb's law as a fixed point of the slips (fixed_point.h): from the answer to the convex problem of the slips at
  // hand to Newton's method on the modes. Slower than the interior point, and led elsewhere. Of sparse rows the first
  // round alone, where all but nothing slides: of a heap at rest it is the answer, which the refreshed shift misses.
  End from_convex_problems(const Job& job, const Rung& rung);
  bool has_slips(const Job& job, const Rung&);
  // Sparse rows under Coulomb's law that are differentiated: from the best iterate by sweeps over the contacts
  // (contact_sweeps.h), which come near an answer, to Newton's method on the modes. Piles where the interior point is
  // blocked. (What was tried in their place: docs/notes/stability.md.)
  End from_sweeps(const Job& job, const Rung&);
  bool may_sweep(const Job&, const Rung&) { return !program_.is_dense() && program_.couples(); }

  bool end_is_near(const Job& job, double& near);
  bool run_modes(const Job& job, int most, int more = 0);
  bool modes_stay(const SolveOptions& options);
  bool is_near(const Best& best);
  bool arrives(const Best& best, double within);
  bool all_but_rests(const Best& best);
  bool takes(const Job& job, const ConeProgram::Residual& residual, const Vector& v, const Vector& y,
             bool settled = false);

  ConeProgram program_;
  InteriorPoint inside_;
  ModeNewton modes_;
  Promise promise_, nearby_;
  SolveOptions asked_;  // of nearby_
  ContactSweeps sweeps_;
  Best of_slips_, swept_;
  Vector proof_, slips_, s_, move_;
  int begun_ = 0;  // iterations before the start at hand, or before the first of those that share
  Solution of_convex_;
};

}  // namespace zwang

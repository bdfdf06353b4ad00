#include <zwang/solvers/active_set/nnls.h>

#include <algorithm>

#include <zwang/solvers/solver_entry.h>

namespace zwang {

void Nnls::solve(const Problem& p, const SolveOptions& options, Solution& s) { method_.solve(*this, p, options, s); }

void Nnls::Method::solve(const Problem& p, const Nnls& settings, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows()), most = std::min(n + 1, m);
  storage_.require((n + 1) * m + 2 * (n + 1 + most) * most, options);
  if (!begin(rows_, p, options, deadline, s)) return;
  nearest_.reset(rows_, deadline);

  const auto each = [&] {
    if (!options.observe) return;
    write(p, s);
    options.observe(s.iterations, s.z, s.lambda);
  };
  const Status end = nearest_.solve(warm_rows_.find(p, rows_, options.warm_start), s.iterations, options.max_iterations,
                                    std::ref(each));

  if (end == Status::time_limit || end == Status::iteration_limit) {
    write(p, s);
    s.status = end;
    return;
  }
  if (end == Status::infeasible && contradicts_itself(p, settings.polish, s)) return;
  QrRows& active = nearest_.equalities();
  if (!settings.polish) write(p, s);
  for (const Index i : nearest_.pushing()) active.append(i);
  if (settings.polish)
    polish_.run(p, rows_, active, options, s);
  else
    polish_.judge(p, rows_, active, options, s);
  // Rows that fit nothing can leave an active set that polish cannot mend (1 in 25,000 fuzzed starts).
  if (s.status == Status::numerical_failure && options.warm_start) {
    SolveOptions cold = options;
    cold.warm_start = nullptr;
    cold.time_limit = deadline.left();
    solve(p, settings, cold, s);
    s.fallback = true;
  }
}

// Is there a proof where the least squares end without a residual? If not, the polish may go on from their rows;
// without it, that is the answer.
bool Nnls::Method::contradicts_itself(const Problem& p, bool polish, Solution& s) {
  QrRows& active = nearest_.equalities();
  const Index e = active.size();
  if (polish) {
    if (polish_.certify(p, rows_, active, nearest_.pushing(), s)) return true;
    while (active.size() > e) active.drop(active.size() - 1);
    return false;
  }
  nearest_.locate(y_, unit_);
  if (polish_.certify(p, rows_, unit_, s)) return true;
  s.status = Status::numerical_failure;
  s.message = "the least squares end without a residual, and without a proof that there is no solution";
  return true;
}

// The last iterate.
void Nnls::Method::write(const Problem& p, Solution& s) {
  nearest_.locate(y_, unit_);
  rows_.primal(p, y_, s.z);
  rows_.multipliers(p, unit_, s.lambda);
}

template SolverEntry entry<Nnls>(SolverEntry, Nnls);

}  // namespace zwang

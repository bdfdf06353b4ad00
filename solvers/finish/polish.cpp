#include <zwang/solvers/finish/polish.h>

#include <cstdlib>

namespace zwang {
namespace {

// Double-double has double's range: its products may not underflow.
bool in_range(const Whitened& w) {
  constexpr int most = 300;
  return std::abs(w.exponent) < most && w.row_norm.maxCoeff() < std::ldexp(1, most) &&
         w.row_norm.minCoeff() > std::ldexp(1, -most);
}

}  // namespace

bool Polish::run(const Problem& p, const Whitened& w, ActiveRows& active, const SolveOptions& options, Solution& s) {
  const bool passes_on = w.rows() > 0 && in_range(w);
  const bool first = ExtendedPolish::run(p, w, active, options, s, passes_on);
  if (!passes_on || s.status == Status::infeasible || s.status == Status::solved) return first;
  first_ = s;
  s.message.clear();
  const bool second = double_double_.run(p, w, active, options, s);
  s.fallback = s.fallback || first_.status != Status::solved_ill_conditioned || !is_blurred();
  if (second) return true;
  s = first_;
  return first;
}

// Tried before: the answer's own residuals. They are rounding in z, which hides what a row that all but depends on the
// active ones asks for: answers among such rows were called solved, and far away.
void Polish::judge(const Problem& p, const Whitened& w, ActiveRows& active, const SolveOptions& options, Solution& s) {
  polished_ = s;
  const bool solved = run(p, w, active, options, polished_) && polished_.status != Status::infeasible;
  const auto length = [&](const auto& motion) {
    off_ = motion;
    if (p.size() > 0) w.factor.multiply_upper(off_);
    return std::ldexp(off_.norm(), -w.exponent);
  };
  const double limit = accepted_error(options.tolerance) * std::max(w.free_norm, length(s.z));
  const bool holds = solved && length(s.z - polished_.z) <= limit;
  s.status = holds ? polished_.status : Status::numerical_failure;
  s.message = holds ? "" : "the method's own answer is not within the tolerance of the refined one";
  s.redundant = polished_.redundant;
  s.margins = polished_.margins;
}

}  // namespace zwang

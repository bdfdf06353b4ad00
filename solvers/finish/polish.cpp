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

Polish::Outcome Polish::run(const Problem& p, Whitened& w, ActiveRows& active, const SolveOptions& options,
                            Solution& s) {
  const bool passes_on = w.rows() > 0 && in_range(w);
  const Outcome first = ExtendedPolish::run(p, w, active, options, s, passes_on);
  if (!passes_on || first == Outcome::infeasible || s.status == Status::solved) return first;
  first_ = s;
  s.message.clear();
  const Outcome second = double_double_.run(p, w, active, options, s);
  s.fallback = s.fallback || first_.status != Status::solved_ill_conditioned || !is_blurred();
  if (second != Outcome::failed) return second;
  s = first_;
  return first;
}

}  // namespace zwang

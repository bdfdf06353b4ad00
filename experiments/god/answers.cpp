#include "experiments/god/answers.h"

#include <algorithm>
#include <array>

#include "solvers/registry.h"

namespace zwang::god {

AnySolver solver_of(const Options& options) {
  std::string text = options.solver;
  const SolverEntry* entry = find_solver(text.substr(0, text.find(':')));
  if (options.maximal && entry &&
      std::any_of(entry->settings.begin(), entry->settings.end(), [](const auto& s) { return s.name == "reduce"; }))
    text += text.find(':') == std::string::npos ? ":reduce=off" : ",reduce=off";
  return make_solver(text);
}

bool has_answer(const Problem& problem, const Solution& solution) {
  const Status s = solution.status;
  return (s == Status::solved || s == Status::solved_ill_conditioned || s == Status::iteration_limit ||
          s == Status::time_limit) &&
         solution.z.size() == problem.size() && solution.z.allFinite();
}

Status worse(Status a, Status b) {
  const auto rank = [](Status s) {
    return s == Status::solved ? 0 : s == Status::unsolved ? 1 : 1 + static_cast<int>(s);
  };
  return rank(a) < rank(b) ? b : a;
}

Verdict worse(Verdict a, Verdict b) {
  constexpr std::array order{
      Verdict::solved,    Verdict::infeasible_proven, Verdict::near,    Verdict::undecided, Verdict::infeasible_claimed,
      Verdict::no_answer, Verdict::unsupported,       Verdict::timeout, Verdict::crashed,   Verdict::bad_input,
      Verdict::wrong};
  const auto rank = [&](Verdict v) { return std::find(order.begin(), order.end(), v); };
  return rank(a) < rank(b) ? b : a;
}

}  // namespace zwang::god

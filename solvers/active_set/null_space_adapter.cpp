#include <zwang/solvers/active_set/null_space_adapter.h>

namespace zwang {

bool NullSpaceAdapter::prepare(const Problem& problem, const SolveOptions& options) {
  reason_ = {};
  if (options.observe)
    reason_ = "an observer";
  else if (!answer_.prepare(problem))
    reason_ = answer_.reason();
  if (!reason_.empty()) return false;
  answer_.state(problem, reduced_);
  part_.reset(reduced_.size(), reduced_.rows());
  part_.status = Status::solved;
  return true;
}

// Iterations are the method's. Where the climb has to go on from its active rows, the answer is the dual method's.
bool NullSpaceAdapter::recover(const Problem& problem, const SolveOptions& options, const Deadline& deadline,
                               Solution& solution) {
  if (part_.status != Status::solved) {
    reason_ = "the reduced problem is not solved";
    return false;
  }
  pushing_.clear();
  for (Index j = 0; j < reduced_.rows(); ++j)
    if (part_.lambda[j] > 0) pushing_.push_back(j);
  solution.reset(problem.size(), problem.rows());
  if (!answer_.finish(options, deadline, pushing_, solution)) {
    reason_ = answer_.reason();
    return false;
  }
  if (solution.iterations > 0) solution.handed_to = "dual_active_set";
  solution.fallback = part_.fallback || !solution.handed_to.empty();
  if (solution.handed_to.empty()) solution.iterations = part_.iterations;
  return true;
}

void NullSpaceAdapter::explain(Solution& solution) const {
  if (!solution.message.empty()) solution.message.append("; ");
  solution.message.append("not reduced: ").append(reason_);
  solution.fallback = true;
}

}  // namespace zwang

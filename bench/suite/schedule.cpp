#include <zwang/bench/suite/schedule.h>

#include <algorithm>
#include <utility>

namespace zwang {

static double work(const Instance& i) { return 20 + static_cast<double>(i.problem.size() + i.problem.rows()); }

Schedule::Schedule(const Plan& plan) : plan_(plan), start_(wall_seconds()) {
  for (std::size_t b = 0; b < plan.instances.size(); ++b)
    if (plan.shard.holds(b)) work_left_ += work(plan.instances[b]);
  work_all_ = work_left_;
}

BatchLimits Schedule::next(const Instance& instance, std::size_t batches_left) {
  BatchLimits limits;
  limits.repetitions = plan_.options.repetitions;
  limits.time_limit = plan_.time_limit;
  limits.repeat = !plan_.options.accuracy;
  limits.budget = std::max(0.5, 0.02 * static_cast<double>(plan_.runs.size()));
  if (plan_.limit_s > 0) {
    const double left = std::max(0.0, 0.9 * plan_.limit_s - elapsed());
    const double firsts = work_done_ > 0 ? 1.5 * first_s_ / work_done_ * work_left_ : left / 2;
    const double share = std::max(0.0, left - firsts) / static_cast<double>(batches_left);
    limits.budget = plan_.whole_suite ? share : std::min(limits.budget, share);
    // The large problems come last and make first solves look costlier than they are; a first solve alone would count
    // its allocations.
    if (plan_.speed) limits.budget = std::max(limits.budget, 1.5);
    const double allowance = left / static_cast<double>(batches_left);
    const auto solvers = static_cast<double>(plan_.solvers());
    while (plan_.options.time_limit == 0 && limits.time_limit >= 0.5 && limits.time_limit * solvers > 4 * allowance) limits.time_limit /= 2;
  }
  shortest_limit_ = std::min(shortest_limit_, limits.time_limit);
  batch_work_ = work(instance);
  return limits;
}

void Schedule::finished(double first_s) {
  first_s_ += first_s;
  work_done_ += batch_work_;
  work_left_ -= std::exchange(batch_work_, 0);
}

void Schedule::skip(const Instance& instance) { work_left_ -= work(instance); }

// Work that an earlier call did took no time of this one.
double Schedule::left(double fraction) const {
  const double done = work_done_ + (fraction - this->fraction(0)) * work_all_;
  return done > 0 ? elapsed() * (1 - fraction) * work_all_ / done : -1;
}

}  // namespace zwang

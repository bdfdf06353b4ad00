#pragma once

#include <cstddef>

#include <zwang/bench/suite/plan.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/timing/batch.h>

namespace zwang {

// Shares a suite's time out to its batches. First solves cannot be dropped, so they are foreseen from those already
// made (per unknown and row) and repetitions get what is left. When even first solves will not fit, the time limit of
// a solve is halved until they do, down to 0.25 s: below that an interior-point method would be cut off on a hand. On
// scenes and files that somebody chose, and in suites without a limit, a batch spends at most 20 ms a run on
// repetitions.
class Schedule {
 public:
  explicit Schedule(const Plan& plan);

  // Each batch is one of: next ... finished (first_s: what it took but for repetitions), or skip.
  BatchLimits next(const Instance& instance, std::size_t batches_left);
  void finished(double first_s);
  void skip(const Instance& instance);

  double elapsed() const { return wall_seconds() - start_; }
  // Of the whole, when this part of the present batch is done.
  double fraction(double of_batch) const { return 1 - (work_left_ - of_batch * batch_work_) / work_all_; }
  double left(double fraction) const;  // s, estimated; -1: not yet known
  double shortest_time_limit() const { return shortest_limit_; }

 private:
  const Plan& plan_;
  double start_, work_all_ = 0, work_left_ = 0, work_done_ = 0, batch_work_ = 0, first_s_ = 0;
  double shortest_limit_ = plan_.time_limit;
};

}  // namespace zwang

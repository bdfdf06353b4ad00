#pragma once

#include <algorithm>
#include <limits>

#include <zwang/core/problem/cpu_clock.h>

namespace zwang {

// The part of a solve that brings a problem into the form a method or a library wants: whitening, and copies into a
// library's own arrays. An object of this class lives as long as such a part; one within another counts once. A dense
// matrix that the method works on (of NNLS, of the Delassus form) is the method's own work, not preparation.
//
// Reading the clock may take as long as a small solve, so it is read only while the thread has a Watch.
class Preparation {
 public:
  Preparation() {
    if (watch_ && watch_->depth_++ == 0) watch_->begin_ = watch_->count_();
  }
  ~Preparation() {
    if (watch_ && --watch_->depth_ == 0)
      watch_->sum_ += std::max(0.0, watch_->count_() - watch_->begin_ - watch_->reading_);
  }
  Preparation(Preparation&&) = delete;

  // Adds up what this thread prepares while it lives: CPU seconds, or whatever `count` counts. What a reading itself
  // adds is left out. One a thread at a time.
  class Watch {
   public:
    explicit Watch(double (*count)() = thread_cpu_seconds) : count_(count), reading_(least_difference()) {
      watch_ = this;
    }
    ~Watch() { watch_ = nullptr; }
    Watch(Watch&&) = delete;
    double sum() const { return sum_; }

   private:
    friend class Preparation;
    double least_difference() const {
      double least = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 4; ++i) {
        const double before = count_();
        least = std::min(least, count_() - before);
      }
      return least;
    }

    double (*count_)();
    double reading_, begin_ = 0, sum_ = 0;
    int depth_ = 0;
  };

 private:
  static inline constinit thread_local Watch* watch_ = nullptr;
};

}  // namespace zwang

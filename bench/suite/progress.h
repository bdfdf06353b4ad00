#pragma once

#include <chrono>
#include <optional>
#include <string>

#include <zwang/core/problem/wording.h>

namespace zwang {

inline double wall_seconds() {  // since some moment
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// "9 min 20 s", "4 s", "180 ms".
std::string duration(double seconds);

// How far a long run is: one line that is redrawn on a terminal, a plain line every 10 % elsewhere. Writes to stderr.
class Progress {
 public:
  Progress();
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // fraction: 0..1 of the whole; what: "hand c=64   ipopt @ 1e-08"; left [s], below 0: not known; {}: as fast as so
  // far.
  void show(double fraction, const std::string& what, std::optional<double> left = {});
  void clear();

 private:
  bool terminal_, drawn_ = false;
  double last_ = -1, since_ = 0;   // s of the monotonic clock
  double begun_ = 0, before_ = 2;  // fractions: where this part of the work began; the last one
  int tenths_ = 0;
};

}  // namespace zwang

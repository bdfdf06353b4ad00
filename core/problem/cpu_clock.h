#pragma once

#include <ctime>

namespace zwang {

// CPU seconds that another process spent on behalf of this thread (OtherProgram), less what waiting for it took here.
inline constinit thread_local double seconds_elsewhere = 0;

// 0 for a clock that cannot be read.
inline double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// CPU seconds of the calling thread (CLOCK_THREAD_CPUTIME_ID), and those spent elsewhere on its behalf: what other
// processes do besides does not count.
inline double thread_cpu_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID) + seconds_elsewhere; }

}  // namespace zwang

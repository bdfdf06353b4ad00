#pragma once

#include <ctime>

namespace zwang {

// CPU seconds of the calling thread (CLOCK_THREAD_CPUTIME_ID): what other processes do does not count.
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace zwang

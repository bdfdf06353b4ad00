#pragma once

#include <ctime>

namespace zwang {

// CPU seconds that another process spent on behalf of this thread (OtherProgram), less what waiting for it took here.
inline constinit thread_local double seconds_elsewhere = 0;

// CPU seconds of the calling thread (CLOCK_THREAD_CPUTIME_ID), and those spent elsewhere on its behalf: what other
// processes do besides does not count.
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec) + seconds_elsewhere;
}

}  // namespace zwang

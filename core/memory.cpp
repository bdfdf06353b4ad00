#include "core/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace zwang {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double spare = 0.05;  // of what is free: page tables, and what others need meanwhile

// "MemAvailable:   123 kB"
double available_on_the_machine() {
  std::ifstream file("/proc/meminfo");
  std::string name, unit;
  for (double kilobytes; file >> name >> kilobytes && std::getline(file, unit);)
    if (name == "MemAvailable:") return 1024 * kilobytes;
  return infinity;
}

// A control group's number; infinity for "max" and where there is none.
double number_in(const char* path) {
  double number;
  return std::ifstream(path) >> number ? number : infinity;
}

double available_in_the_group() {
  const double limit =
      std::min(number_in("/sys/fs/cgroup/memory.max"), number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
  const double used =
      std::min(number_in("/sys/fs/cgroup/memory.current"), number_in("/sys/fs/cgroup/memory/memory.usage_in_bytes"));
  return used < infinity ? std::max(0.0, limit - used) : limit;
}

double address_space() {
  double pages;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return 0;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double available_to_the_process() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return infinity;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - address_space());
}

}  // namespace

double free_memory() {
  const double outside = (1 - spare) * std::min(available_on_the_machine(), available_in_the_group());
  return std::min(outside, available_to_the_process());
}

MemoryCap::MemoryCap() {
  rlimit limit{};
  const double most = address_space() + free_memory();
  if (getrlimit(RLIMIT_AS, &limit) != 0 || !(most < static_cast<double>(limit.rlim_cur))) return;
  before_ = limit.rlim_cur;
  limit.rlim_cur = static_cast<rlim_t>(most);
  set_ = setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryCap::~MemoryCap() {
  rlimit limit{};
  if (!set_ || getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = before_;
  setrlimit(RLIMIT_AS, &limit);
}

}  // namespace zwang

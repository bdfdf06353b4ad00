#include <zwang/core/problem/memory.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>

#include <zwang/core/problem/types.h>

namespace zwang {
namespace {

namespace fs = std::filesystem;

constexpr double spare = 0.05;  // of what is free: page tables, and what others need meanwhile

// In a file of lines like "MemAvailable:   123 kB" or "active_file 123"; `otherwise` where there is no such line.
double number_after(const char* wanted, const fs::path& path, double otherwise) {
  std::ifstream file(path);
  std::string name, unit;
  for (double number; file >> name >> number && std::getline(file, unit);)
    if (name == wanted) return number;
  return otherwise;
}

double available_on_the_machine() { return 1024 * number_after("MemAvailable:", "/proc/meminfo", infinity); }

// A control group's number; infinity for "max" and where there is none.
double number_in(const fs::path& path) {
  double number;
  return std::ifstream(path) >> number ? number : infinity;
}

// Files that the kernel keeps in memory while there is room count as used, though it gives them up when asked.
double available_in(const fs::path& max, const fs::path& current, const fs::path& stat, const std::string& of_all) {
  const double limit = number_in(max), used = number_in(current);
  if (!(used < infinity)) return limit;
  double kept = 0;
  for (const char* files : {"active_file", "inactive_file"}) kept += number_after((of_all + files).c_str(), stat, 0);
  return std::max(0.0, limit - std::max(0.0, used - kept));
}

// Version 2 and version 1 of the kernel's interface.
double available_in_the_group(const fs::path& groups) {
  const fs::path first = groups / "memory";
  return std::min(
      available_in(groups / "memory.max", groups / "memory.current", groups / "memory.stat", ""),
      available_in(first / "memory.limit_in_bytes", first / "memory.usage_in_bytes", first / "memory.stat", "total_"));
}

double available_to_the_process() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return infinity;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - address_space());
}

}  // namespace

double address_space() {
  double pages;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return 0;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double free_memory(const fs::path& groups) {
  const double outside = (1 - spare) * std::min(available_on_the_machine(), available_in_the_group(groups));
  return std::min(outside, available_to_the_process());
}

MemoryCap::MemoryCap() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds seldom(100);  // looking takes longer than a small solve
  thread_local Clock::time_point seen;
  thread_local double free = 0;
  if (const auto now = Clock::now(); seen == Clock::time_point() || now - seen > seldom) {
    free = free_memory();
    seen = now;
  }
  const double most = address_space() + free;
  rlimit limit{};
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

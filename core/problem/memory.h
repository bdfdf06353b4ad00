#pragma once

#include <filesystem>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ZWANG_ADDRESS_SANITIZER  // it reserves terabytes of addresses
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ZWANG_ADDRESS_SANITIZER
#endif

namespace zwang {

// Bytes that this process may still ask for, by the kernel's count of what is free, its control group and its own limit
// (RLIMIT_AS); infinity where none of them can be read. `groups`: where the kernel shows control groups.
double free_memory(const std::filesystem::path& groups = "/sys/fs/cgroup");

// Bytes of addresses that this process holds; 0 where they cannot be read.
double address_space();

// As long as it lives, this process cannot grow by more than was free at its beginning, or a tenth of a second before:
// an allocation then fails with std::bad_alloc, where the kernel would kill some process instead.
class MemoryCap {
 public:
  MemoryCap();
  ~MemoryCap();
  MemoryCap(MemoryCap&&) = delete;

 private:
  unsigned long before_ = 0;
  bool set_ = false;
};

}  // namespace zwang

#include "tests/bench/fuzz/failing_allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

// As in bench/timing/allocations.cpp: the C library's own entry points are replaced, since Eigen calls malloc.
namespace {
std::atomic<long> left{0};
bool refused() { return left.load() > 0 && --left == 0; }
std::atomic<bool> reached{false};
bool refuse() {
  if (!refused()) return false;
  reached = true;
  errno = ENOMEM;
  return true;
}
}  // namespace

namespace zwang {
void refuse_allocation(long n) {
  reached = false;
  left = n;
}
bool allocation_was_refused() { return reached; }
}  // namespace zwang

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) { return refuse() ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t items, std::size_t size) { return refuse() ? nullptr : __libc_calloc(items, size); }
void* realloc(void* block, std::size_t size) { return refuse() ? nullptr : __libc_realloc(block, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return refuse() ? nullptr : __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) { return aligned_alloc(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = aligned_alloc(alignment, size);
  return *block ? 0 : ENOMEM;
}
}

#include <zwang/bench/timing/allocations.h>

#include <cerrno>
#include <cstddef>

#include <zwang/core/problem/memory.h>

// Counting operator new alone would miss Eigen, which calls malloc, and CHOLMOD, which goes through SuiteSparse's own
// function table; so the C library's entry points themselves are replaced. glibc exports what stands behind them
// (__libc_malloc, ...). Under AddressSanitizer, which replaces malloc itself, its hook counts.

namespace {
// Per thread and plain: an atomic one would cost a solver that allocates much, such as Ipopt, a few percent of its
// time.
thread_local long count = 0, bytes = 0;
void add(std::size_t size) {
  ++count;
  bytes += static_cast<long>(size);
}
}  // namespace

namespace zwang {
long allocations() { return count; }
long allocated_bytes() { return bytes; }
}  // namespace zwang

#ifdef ZWANG_ADDRESS_SANITIZER

#include <sanitizer/allocator_interface.h>

namespace {
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { add(size); }, [](const volatile void*) {});
}  // namespace

#else

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  add(size);
  return __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size) {
  add(items * size);
  return __libc_calloc(items, size);
}
void* realloc(void* block, std::size_t size) {
  add(size);
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  add(size);
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  add(size);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  add(size);
  *block = __libc_memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
}

#endif

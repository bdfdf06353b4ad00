#include <zwang/solvers/linalg/library_memory.h>

#include <SuiteSparse_config.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

namespace zwang {
namespace {

thread_local LibraryMemory* in_use = nullptr;

}  // namespace

// What stands in front of the bytes that a library gets.
struct alignas(64) LibraryMemory::Block {
  LibraryMemory* owner;
  std::size_t size;
  Block* next = nullptr;  // of the free ones

  void* bytes() { return this + 1; }
  static Block* of(void* bytes) { return static_cast<Block*>(bytes) - 1; }
};

LibraryMemory::~LibraryMemory() {
  while (free_) std::free(std::exchange(free_, free_->next));
}

// The smallest block that is large enough, unless most of it would lie idle.
LibraryMemory::Block* LibraryMemory::take(std::size_t size) {
  constexpr std::size_t spare = 2;
  Block** best = nullptr;
  for (Block** at = &free_; *at; at = &(*at)->next)
    if ((*at)->size >= size && (*at)->size / spare <= size && (!best || (*at)->size < (*best)->size)) best = at;
  return best ? std::exchange(*best, (*best)->next) : nullptr;
}

// SuiteSparse's own table of functions.
struct LibraryHooks {
  using Block = LibraryMemory::Block;

  static void* allocate(std::size_t size) {
    Block* block = in_use ? in_use->take(size) : nullptr;
    if (!block) {
      if (size > std::numeric_limits<std::size_t>::max() - 2 * sizeof(Block)) return nullptr;
      const std::size_t whole = (size + 2 * sizeof(Block) - 1) / sizeof(Block) * sizeof(Block);
      block = static_cast<Block*>(std::aligned_alloc(sizeof(Block), whole));
      if (!block) return nullptr;
      *block = {in_use, size};
    }
    return block->bytes();
  }
  static void* allocate_zeros(std::size_t count, std::size_t size) {
    if (size > 0 && count > std::numeric_limits<std::size_t>::max() / size) return nullptr;
    void* const bytes = allocate(count * size);
    if (bytes) std::memset(bytes, 0, count * size);
    return bytes;
  }
  static void* reallocate(void* old, std::size_t size) {
    if (!old) return allocate(size);
    void* const bytes = allocate(size);
    if (!bytes) return nullptr;
    std::memcpy(bytes, old, std::min(size, Block::of(old)->size));
    release(old);
    return bytes;
  }
  static void release(void* bytes) {
    if (!bytes) return;
    Block* const block = Block::of(bytes);
    if (block->owner)
      block->next = std::exchange(block->owner->free_, block);
    else
      std::free(block);
  }
};

void LibraryMemory::install() {
  SuiteSparse_config.malloc_func = LibraryHooks::allocate;
  SuiteSparse_config.calloc_func = LibraryHooks::allocate_zeros;
  SuiteSparse_config.realloc_func = LibraryHooks::reallocate;
  SuiteSparse_config.free_func = LibraryHooks::release;
}

LibraryMemory::Use::Use(LibraryMemory& memory) : before_(in_use) { in_use = &memory; }

LibraryMemory::Use::~Use() { in_use = before_; }

}  // namespace zwang

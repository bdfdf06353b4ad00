#pragma once

#include <cstddef>

namespace zwang {

// Memory that SuiteSparse's libraries have given back and will ask for again: they allocate and free in every call.
//
// Only where the host asks for it, by install(): the libraries' allocator belongs to the whole process. Without that a
// Use does nothing, and every sparse factorization allocates.
//
// One for each factorization, used by one thread at a time; inside a Use the libraries get blocks that were kept
// before. It returns its blocks to the system at its end: free the libraries' objects made in a Use before.
class LibraryMemory {
 public:
  // Replaces SuiteSparse's allocator, for good. Call it once, before the process makes its first solver or other object
  // of SuiteSparse: what was allocated before may not be freed after.
  static void install();

  LibraryMemory() = default;
  ~LibraryMemory();
  LibraryMemory(LibraryMemory&&) = delete;

  // While it lives, what the libraries ask for on this thread comes from `memory`.
  class Use {
   public:
    explicit Use(LibraryMemory& memory);
    ~Use();
    Use(Use&&) = delete;

   private:
    LibraryMemory* before_;
  };

 private:
  struct Block;
  friend struct LibraryHooks;

  Block* take(std::size_t size);

  Block* free_ = nullptr;  // a list through the blocks themselves: giving one back neither allocates nor throws
};

}  // namespace zwang

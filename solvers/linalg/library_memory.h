#pragma once

#include <cstddef>

namespace zwang {

// Memory that SuiteSparse's libraries have given back and will ask for again: they allocate and free in every call.
//
// One for each factorization, used by one thread at a time; what a Use covers is met from blocks kept before. Blocks go
// back to the system with it, so that all of the library's objects made under it have to be freed before.
class LibraryMemory {
 public:
  LibraryMemory() = default;
  ~LibraryMemory();
  LibraryMemory(const LibraryMemory&) = delete;
  LibraryMemory& operator=(const LibraryMemory&) = delete;

  // While it lives, what the libraries ask for on this thread comes from `memory`.
  class Use {
   public:
    explicit Use(LibraryMemory& memory);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

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

#pragma once

namespace zwang {

// Heap blocks asked for by this thread since it started, through any door: malloc, calloc, realloc, aligned
// allocation, operator new, in the project's code and in every library it is linked with.
long allocations();
// And how large they were, together.
long allocated_bytes();

}  // namespace zwang

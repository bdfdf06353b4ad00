#pragma once

#include <cstddef>
#include <cstdint>
#include <list>

#include <zwang/core/problem/types.h>

namespace zwang {

// Storage for the parts of a problem, one T for each shape. Parts of different shapes do not share a T: one that is
// resized back and forth allocates every time. Parts of the same shape share one, which stays in the CPU's cache.
//
// A new shape reuses the T that has been unused for longest, if no part has asked for that one since begin(). So there
// are as many T as one problem has shapes, or `kept` if that is more.
template <class T>
class ShapeCache {
 public:
  explicit ShapeCache(std::size_t kept = 1) : kept_(kept) {}

  // A new problem.
  void begin() { begun_ = clock_; }

  // The T of parts of this shape: the number of unknowns, and what else sizes depend on. References stay valid.
  T& of(Index size, Index kind) { return find(size, kind, clock_); }
  // One that no other part of this problem has: for what differs between parts of one shape, as ranks do.
  T& own(Index size, Index kind) { return find(size, kind, begun_); }

 private:
  struct Place {
    T value = {};
    Index size = -1, kind = -1;
    std::uint64_t used = 0;  // by clock_
  };

  T& find(Index size, Index kind, std::uint64_t used_before) {
    Place* oldest = nullptr;
    for (Place& place : places_) {
      if (place.size == size && place.kind == kind && place.used <= used_before) return use(place);
      if (!oldest || place.used < oldest->used) oldest = &place;
    }
    const bool unused = oldest && oldest->used <= begun_;
    if (!unused || places_.size() < kept_) oldest = &places_.emplace_back();
    oldest->size = size;
    oldest->kind = kind;
    return use(*oldest);
  }

  T& use(Place& place) {
    place.used = ++clock_;
    return place.value;
  }

  std::list<Place> places_;  // where they are, and nothing before the first
  std::uint64_t clock_ = 0, begun_ = 0;
  std::size_t kept_;
};

}  // namespace zwang

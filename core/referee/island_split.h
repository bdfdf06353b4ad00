#pragma once

#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// A part of a problem that shares no entry of M, no row and no contact with the rest, in the problem's units; apart
// from Islands, which solvers use.
struct IslandPart {
  Problem problem = {};
  std::vector<Index> columns = {}, rows = {};  // of the whole, ascending

  // The part's entries of one number an unknown, or a row; in any scalar.
  template <class Entries>
  Entries columns_of(const Entries& x) const {
    return pick(columns, x);
  }
  template <class Entries>
  Entries rows_of(const Entries& x) const {
    return pick(rows, x);
  }

 private:
  template <class Entries>
  static Entries pick(const std::vector<Index>& places, const Entries& x) {
    Entries out(places.size());
    for (std::size_t k = 0; k < places.size(); ++k)
      out[static_cast<decltype(out.size())>(k)] = x[static_cast<decltype(x.size())>(places[k])];
    return out;
  }
};

// A contact stays in one part, its rows of zeros too. All unknowns that no row meets are one part. Contacts and
// equality rows that meet no unknown are in the first part, and those that say nothing (c = -Inf) in none. Empty where
// the problem is one part.
std::vector<IslandPart> split_islands(const Problem& problem);

}  // namespace zwang

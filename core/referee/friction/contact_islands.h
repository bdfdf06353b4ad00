#pragma once

#include <vector>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// Proofs of a part are dense; they are tried up to these sizes.
inline constexpr Index most_proven_unknowns = 1500, most_proven_rows = 2000;
inline bool may_prove(Index unknowns, Index rows) {
  return rows == 0 || (unknowns <= most_proven_unknowns && rows <= most_proven_rows);
}

// A part of a frictional problem that shares no entry of M and no contact with the rest, in the problem's units; apart
// from Islands, which solvers use.
struct ContactIsland {
  Problem problem = {};
  std::vector<Index> columns = {}, rows = {};  // of the whole, ascending

  bool may_prove() const { return zwang::may_prove(std::ssize(columns), std::ssize(rows)); }
  Vector columns_of(const Vector& x) const { return x(columns); }
  Vector rows_of(const Vector& x) const { return x(rows); }
};

// A contact stays in one part, its rows of zeros too. All unknowns that no row meets are one part. Contacts and
// equality rows that meet no unknown are in the first part. None where the problem is one part.
std::vector<ContactIsland> split_contacts(const Problem& problem);

}  // namespace zwang

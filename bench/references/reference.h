#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <zwang/core/problem/instance.h>

namespace zwang {

// What is known of a problem, and how: docs/references.md.
struct FoundReference {
  std::optional<Reference> reference = {};  // empty: nothing certain is known
  std::string note = {};                    // then: why, in one line
};

struct ReferenceOptions {
  // n <= 96: CGAL's rational solver must agree (16 to 20 s a hand); with what the instance brings, the 100-digit
  // method.
  bool second_witness = false;
};

// The instance's own reference where it has one (closed form, known answer, file); otherwise
//   n <= 300   the dual active-set method in 100-digit arithmetic, bound 0: z* rounded once (6.5 s at n = 280);
//   n <= 1200  the same method in long double, with the referee's active-set bound;
//   beyond     nothing.
// Where two witnesses disagree there is no reference, and `note` says so. Answers are kept in cache_dir by the hash of
// the problem's content; an entry that cannot be read, does not fit or is refuted by the referee is computed again. An empty cache_dir keeps
// none.
FoundReference reference_for(const Instance& instance, const std::filesystem::path& cache_dir,
                             const ReferenceOptions& options = {});

}  // namespace zwang

#include <zwang/solvers/linalg/dense_storage.h>

#include <algorithm>
#include <string>

#include <zwang/core/problem/memory.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr double never_asked_for = 0x1p28;

std::string gigabytes(double bytes) { return printed("%.3g GB", bytes / 1e9); }

}  // namespace

void DenseStorage::require(double numbers, const SolveOptions& options) {
  const double bytes = numbers * sizeof(double);
  if (bytes <= options.memory_limit && (bytes <= never_asked_for || bytes <= granted_)) return;
  const double most = std::min(options.memory_limit, granted_ + free_memory());
  if (bytes > most)
    throw Stopped{Status::numerical_failure,
                  "its dense parts take " + gigabytes(bytes) + ", more than the " + gigabytes(most) + " there are"};
  granted_ = std::max(granted_, bytes);
}

}  // namespace zwang

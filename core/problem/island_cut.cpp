// Islands' cutting of parts out of a problem and joining of their answers.
#include <algorithm>
#include <array>
#include <cmath>

#include <zwang/core/problem/islands.h>

namespace zwang {
namespace {

template <class Sparse>
Index count_entries(const Sparse& A, const std::vector<Index>& outer) {
  Index count = 0;
  for (const Index k : outer) count += A.outerIndexPtr()[k + 1] - A.outerIndexPtr()[k];
  return count;
}

// `part` becomes the chosen rows (columns) of the compressed matrix A, its inner indices renumbered. Entries that leave
// the island are stored zeros; there are none where it is closed. An island of neighbouring unknowns, as assembly makes
// them, needs no look-up, and where it is closed, neighbouring rows are copied as one.
template <class Sparse>
void extract(const Sparse& A, const std::vector<Index>& outer, const std::vector<Index>& inner,
             const std::vector<Index>& local, const std::vector<Index>& island, bool closed, Index rows, Index cols,
             Sparse& part) {
  if (part.rows() != rows || part.cols() != cols) part.resize(rows, cols);  // Eigen's would allocate for no rows
  part.resizeNonZeros(count_entries(A, outer));
  int* start = part.outerIndexPtr();
  int* index = part.innerIndexPtr();
  double* value = part.valuePtr();
  int at = 0;
  const auto copy = [&](const auto& place_of) {
    for (const Index k : outer) {
      *start++ = at;
      for (int e = A.outerIndexPtr()[k]; e < A.outerIndexPtr()[k + 1]; ++e) {
        const Index place = place_of(A.innerIndexPtr()[e]);
        if (place < 0) continue;
        index[at] = static_cast<int>(place);
        value[at++] = A.valuePtr()[e];
      }
    }
  };
  const auto count = static_cast<Index>(inner.size());
  const Index first = count > 0 ? inner.front() : 0;
  const bool neighbours = count == 0 || inner.back() - first + 1 == count;
  const auto copy_runs = [&] {
    for (std::size_t k = 0, run = 0; k < outer.size(); k = run) {
      const int begin = A.outerIndexPtr()[outer[k]];
      for (run = k; run < outer.size() && outer[run] == outer[k] + static_cast<Index>(run - k); ++run)
        *start++ = at + A.outerIndexPtr()[outer[run]] - begin;
      const int size = A.outerIndexPtr()[outer[run - 1] + 1] - begin;
      for (int e = 0; e < size; ++e) index[at + e] = A.innerIndexPtr()[begin + e] - static_cast<int>(first);
      std::copy_n(A.valuePtr() + begin, size, value + at);
      at += size;
    }
  };
  if (neighbours && closed)
    copy_runs();
  else if (neighbours)
    copy([&](int k) { return k >= first && k < first + count ? k - first : -1; });
  else
    copy([&](int k) {
      const auto s = static_cast<std::size_t>(k);
      return island[s] == island[static_cast<std::size_t>(first)] ? local[s] : -1;
    });
  *start = at;
  part.resizeNonZeros(at);
}

// From best to worst; what stands further right wins when islands differ.
int severity(Status status) {
  static constexpr std::array order{Status::solved,
                                    Status::solved_ill_conditioned,
                                    Status::iteration_limit,
                                    Status::time_limit,
                                    Status::numerical_failure,
                                    Status::unsolved,
                                    Status::unsupported,
                                    Status::crashed,
                                    Status::bad_input,
                                    Status::infeasible};
  return static_cast<int>(std::find(order.begin(), order.end(), status) - order.begin());
}

}  // namespace

void Islands::fill(const Problem& p, const Island& island, bool closed, Problem& part) const {
  const auto n = static_cast<Index>(island.columns.size()), m = static_cast<Index>(island.rows.size());
  part.name = p.name;
  part.z_u.resize(n);
  part.c.resize(m);
  part.kind.resize(island.rows.size());
  part.key.resize(island.rows.size());
  extract(p.M, island.columns, island.columns, local_, island_, closed, n, n, part.M);
  extract(p.J, island.rows, island.columns, local_, island_, closed, m, n, part.J);
  for (Index k = 0; k < n; ++k) part.z_u[k] = p.z_u[island.columns[static_cast<std::size_t>(k)]];
  for (std::size_t i = 0; i < island.rows.size(); ++i) {
    const Index row = island.rows[i];
    part.c[static_cast<Index>(i)] = p.c[row];
    part.kind[i] = p.kind[static_cast<std::size_t>(row)];
    part.key[i] = p.key[static_cast<std::size_t>(row)];
  }
}

void Islands::join(const Island& island, const Solution& part, Index rows, Solution& whole) const {
  const auto scatter = [](const Vector& from, const std::vector<Index>& to, Vector& into) {
    for (std::size_t k = 0; k < to.size() && into.size() > 0; ++k) into[to[k]] = from[static_cast<Index>(k)];
  };
  // One island without: the whole without.
  if (part.z.size() != std::ssize(island.columns)) whole.empty_z();
  if (part.lambda.size() != std::ssize(island.rows)) whole.empty_lambda();
  scatter(part.z, island.columns, whole.z);
  scatter(part.lambda, island.rows, whole.lambda);
  if (part.certificate.size() > 0 && whole.certificate.size() == 0)
    scatter(part.certificate, island.rows, whole.zero_certificate(rows));
  for (const Index row : part.redundant) whole.redundant.push_back(island.rows[static_cast<std::size_t>(row)]);
  if (severity(part.status) > severity(whole.status)) whole.status = part.status;
  whole.iterations += part.iterations;
  whole.fallback = whole.fallback || part.fallback;
  if (!part.handed_to.empty()) whole.handed_to = part.handed_to;
  whole.range_gap = std::fmax(whole.range_gap, part.range_gap);
  if (!std::isnan(part.prepare_s)) whole.prepare_s = part.prepare_s + std::fmax(whole.prepare_s, 0);
  whole.margins.rank = part.margins.rank < 0 || whole.margins.rank < 0 ? -1 : whole.margins.rank + part.margins.rank;
  whole.margins.smallest_accepted = std::fmin(whole.margins.smallest_accepted, part.margins.smallest_accepted);
  whole.margins.largest_rejected = std::fmax(whole.margins.largest_rejected, part.margins.largest_rejected);
}

}  // namespace zwang

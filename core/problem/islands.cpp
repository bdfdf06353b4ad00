#include <zwang/core/problem/islands.h>

#include <algorithm>
#include <array>
#include <type_traits>

namespace zwang {
namespace {

template <class Sparse>
Index count_entries(const Sparse& A, const std::vector<Index>& outer) {
  Index count = 0;
  for (const Index k : outer) count += A.outerIndexPtr()[k + 1] - A.outerIndexPtr()[k];
  return count;
}

// `part` becomes the chosen rows (columns) of the compressed matrix A, its inner indices renumbered. Where the island's
// unknowns are neighbours, as assembly makes them, neighbouring rows are copied as one.
template <class Sparse>
void extract(const Sparse& A, const std::vector<Index>& outer, const std::vector<Index>& inner,
             const std::vector<Index>& local, Index rows, Index cols, Sparse& part) {
  if (part.rows() != rows || part.cols() != cols) part.resize(rows, cols);  // Eigen's would allocate for no rows
  part.resizeNonZeros(count_entries(A, outer));
  int* start = part.outerIndexPtr();
  int* index = part.innerIndexPtr();
  int at = 0;
  const Index first = inner.empty() ? 0 : inner.front();
  const bool neighbours = inner.empty() || inner.back() - first + 1 == std::ssize(inner);
  for (std::size_t k = 0, run = 0; k < outer.size(); k = run) {
    const int begin = A.outerIndexPtr()[outer[k]];
    for (run = k; run < outer.size() && outer[run] == outer[k] + static_cast<Index>(run - k); ++run)
      *start++ = at + A.outerIndexPtr()[outer[run]] - begin;
    const int size = A.outerIndexPtr()[outer[run - 1] + 1] - begin;
    const int* const from = A.innerIndexPtr() + begin;
    if (neighbours)
      std::transform(from, from + size, index + at, [&](int i) { return i - static_cast<int>(first); });
    else
      std::transform(from, from + size, index + at,
                     [&](int i) { return static_cast<int>(local[static_cast<std::size_t>(i)]); });
    std::copy_n(A.valuePtr() + begin, size, part.valuePtr() + at);
    at += size;
  }
  *start = at;
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

Island& Islands::next_island() {
  if (count_ == islands_.size()) islands_.emplace_back();
  Island& island = islands_[count_++];
  island.columns.clear();
  island.rows.clear();
  return island;
}

void Islands::split(const Problem& problem, Index unit) {
  require_matching_sizes(problem);
  unit_ = 0;
  several_blocks(problem, unit);
  list(problem, unit);
  for (std::size_t k = 0; k < count_; ++k) fill(problem, islands_[k], islands_[k].problem);
}

bool Islands::several(const Problem& p, Index unit) {
  const bool same_contacts = p.has_tangents() ? kind_ == p.kind : kind_.empty();
  if (unit == unit_ && same_contacts && M_places_.matches(p.M) && J_places_.matches(p.J)) return count_ > 1;
  unit_ = unit;
  kind_.clear();
  if (p.has_tangents()) kind_ = p.kind;
  M_places_.keep(p.M);
  J_places_.keep(p.J);
  // Dividing by a constant takes a quarter of the time.
  constexpr std::integral_constant<Index, 6> body;
  count_ = 1;
  if (unit == body ? several_blocks(p, body) : several_blocks(p, unit)) list(p, unit);
  return count_ > 1;
}

// Rows first, and of each its ends: joints connect a hand, and then nothing else needs to be looked at.
template <class Unit>
bool Islands::several_blocks(const Problem& p, Unit unit) {
  const Index blocks = (p.size() + unit - 1) / unit;
  blocks_.reset(blocks);
  Index count = blocks;
  std::array<Index, 2> joined{-1, -1};  // the rows of one joint couple the same two
  const auto couple_blocks = [&](Index a, Index b) {
    if (std::array{a, b} == joined) return;
    joined = {a, b};
    count -= blocks_.join(a, b);
  };
  const auto block_of = [&](int k) -> Index { return k / unit; };
  const auto inner = [](const auto& A, Index outer) {
    const int *const begin = A.innerIndexPtr() + A.outerIndexPtr()[outer], *const counts = A.innerNonZeroPtr();
    return std::span(begin, counts ? begin + counts[outer] : A.innerIndexPtr() + A.outerIndexPtr()[outer + 1]);
  };
  // Inner indices ascend: where the first and the last are of one block, so are all.
  const auto visit = [&](const auto& A, Index outer, Index block) {
    const auto indices = inner(A, outer);
    if (indices.empty()) return;
    if (block < 0) block = block_of(indices.front());
    if (indices.front() >= block * unit && indices.back() < (block + 1) * unit) return;
    Index begin = block * unit;
    for (const int k : indices) {
      if (k >= begin && k < begin + unit) continue;
      const Index own = block_of(k);
      couple_blocks(block, own);
      block = own;
      begin = own * unit;
    }
  };
  for (Index i = 0; i < p.rows() && count > 1; ++i)
    if (const auto indices = inner(p.J, i); !indices.empty())
      couple_blocks(block_of(indices.front()), block_of(indices.back()));
  for (Index i = 0; i < p.rows() && count > 1; ++i) visit(p.J, i, -1);
  if (p.has_tangents()) {
    // A contact's rows belong together even where they touch no body in common.
    Index contact = -1;
    for (Index i = 0; i < p.rows() && count > 1; ++i) {
      const int e = p.J.outerIndexPtr()[i];
      const bool empty = e == p.J.outerIndexPtr()[i + 1];
      if (!p.is_tangent(i)) contact = -1;
      if (empty) continue;
      const Index own = block_of(p.J.innerIndexPtr()[e]);
      if (contact >= 0 && contact != own) couple_blocks(contact, own);
      contact = own;
    }
  }
  for (Index j = 0; j < p.size() && count > 1; ++j) visit(p.M, j, j / unit);
  return count > 1;
}

// Islands of the blocks that several_blocks() left joined.
void Islands::list(const Problem& p, Index unit) {
  const Index n = p.size();
  island_.resize(at(n));
  local_.resize(at(n));
  count_ = 0;
  for (Index b = 0; b * unit < n; ++b) {
    const Index r = blocks_.find(b);  // the first block of the island
    const auto home = at(b * unit);
    if (r == b) {
      island_[home] = static_cast<Index>(count_);
      next_island();
    } else {
      island_[home] = island_[at(r * unit)];
    }
    std::vector<Index>& columns = islands_[at(island_[home])].columns;
    for (Index k = b * unit; k < std::min(n, (b + 1) * unit); ++k) {
      island_[at(k)] = island_[home];
      local_[at(k)] = static_cast<Index>(columns.size());
      columns.push_back(k);
    }
  }
  if (n == 0) next_island();
  const auto island_of = [&](Index row) -> Index {
    const int e = p.J.outerIndexPtr()[row];
    return e == p.J.outerIndexPtr()[row + 1] ? -1 : island_[at(p.J.innerIndexPtr()[e])];
  };
  Index own = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    if (!p.is_tangent(i)) {
      own = island_of(i);
      // The normal row of a body that cannot move along it goes with its tangent rows.
      for (Index t = 1; own < 0 && t <= p.tangents(i); ++t) own = island_of(i + t);
      own = std::max<Index>(own, 0);
    }
    islands_[at(own)].rows.push_back(i);
  }
}

void Islands::fill(const Problem& p, const Island& island, Problem& part) const {
  const auto n = static_cast<Index>(island.columns.size()), m = static_cast<Index>(island.rows.size());
  part.name = p.name;
  part.z_u.resize(n);
  part.c.resize(m);
  part.kind.resize(island.rows.size());
  part.key.resize(island.rows.size());
  part.mu.resize(p.has_tangents() ? m : 0);
  part.law = p.law;
  extract(p.M, island.columns, island.columns, local_, n, n, part.M);
  extract(p.J, island.rows, island.columns, local_, m, n, part.J);
  for (Index k = 0; k < n; ++k) part.z_u[k] = p.z_u[island.columns[at(k)]];
  for (std::size_t i = 0; i < island.rows.size(); ++i) {
    const Index row = island.rows[i];
    part.c[static_cast<Index>(i)] = p.c[row];
    part.kind[i] = p.kind[at(row)];
    part.key[i] = p.key[at(row)];
    if (p.has_tangents()) part.mu[static_cast<Index>(i)] = p.mu[row];
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
  for (const Index row : part.redundant) whole.redundant.push_back(island.rows[at(row)]);
  if (severity(part.status) > severity(whole.status)) whole.status = part.status;
  whole.iterations += part.iterations;
  whole.fallback = whole.fallback || part.fallback;
  if (!part.handed_to.empty()) whole.handed_to = part.handed_to;
  // Of the whole motion: s_k^2 of the parts add up to at most 2 s^2, s_k being max(|z_u|_M, |z*|_M).
  const double bound = std::sqrt(2) * part.error_bound;
  if (!(bound <= whole.error_bound) && !std::isnan(whole.error_bound)) whole.error_bound = bound;
  whole.range_gap = std::fmax(whole.range_gap, part.range_gap);
  whole.margins.rank = part.margins.rank < 0 || whole.margins.rank < 0 ? -1 : whole.margins.rank + part.margins.rank;
  whole.margins.smallest_accepted = std::fmin(whole.margins.smallest_accepted, part.margins.smallest_accepted);
  whole.margins.largest_rejected = std::fmax(whole.margins.largest_rejected, part.margins.largest_rejected);
}

}  // namespace zwang

#include <zwang/core/referee/island_split.h>

#include <zwang/core/problem/disjoint_sets.h>

namespace zwang {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

}  // namespace

std::vector<IslandPart> split_islands(const ScaledProblem& scaled) {
  const Index n = scaled.size();
  DisjointSets sets(n);
  for (Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(scaled.M, j); it; ++it)
      if (it.value() != 0) sets.join(it.row(), j);
  for (Index i = 0; i < scaled.rows(); ++i) {
    if (!scaled.counts(i)) continue;
    const Index first = SparseRows::InnerIterator(scaled.J, i).col();
    for (SparseRows::InnerIterator it(scaled.J, i); it; ++it) sets.join(it.col(), first);
  }

  std::vector<IslandPart> parts;
  std::vector<Index> part_of(static_cast<std::size_t>(n), -1), place(static_cast<std::size_t>(n));
  const auto part = [&](Index column) -> IslandPart& {
    Index& id = part_of[static_cast<std::size_t>(sets.find(column))];
    if (id < 0) {
      id = static_cast<Index>(parts.size());
      parts.emplace_back();
    }
    return parts[static_cast<std::size_t>(id)];
  };
  for (Index j = 0; j < n; ++j) {
    place[static_cast<std::size_t>(j)] = static_cast<Index>(part(j).columns.size());
    part(j).columns.push_back(j);
  }
  for (Index i = 0; i < scaled.rows(); ++i)
    if (scaled.counts(i)) part(SparseRows::InnerIterator(scaled.J, i).col()).rows.push_back(i);
  if (parts.size() <= 1) return parts;

  std::vector<Eigen::Triplet<double>> entries;
  const auto local = [&](Index column) { return static_cast<int>(place[static_cast<std::size_t>(column)]); };
  for (IslandPart& p : parts) {
    const auto size = static_cast<Index>(p.columns.size()), rows = static_cast<Index>(p.rows.size());
    Problem& out = p.problem;
    out.z_u.resize(size);
    entries.clear();
    for (const Index j : p.columns) {
      out.z_u[local(j)] = scaled.z_u[j];
      for (Eigen::SparseMatrix<double>::InnerIterator it(scaled.M, j); it; ++it)
        if (it.value() != 0) entries.emplace_back(local(it.row()), local(j), it.value());
    }
    out.M.resize(size, size);
    out.M.setFromTriplets(entries.begin(), entries.end());
    entries.clear();
    out.c.resize(rows);
    for (Index k = 0; k < rows; ++k) {
      const Index i = p.rows[static_cast<std::size_t>(k)];
      out.c[k] = scaled.c[i];
      out.kind.push_back(scaled.is_equality(i) ? RowKind::equality : RowKind::inequality);
      for (SparseRows::InnerIterator it(scaled.J, i); it; ++it)
        entries.emplace_back(static_cast<int>(k), local(it.col()), it.value());
    }
    out.J.resize(rows, size);
    out.J.setFromTriplets(entries.begin(), entries.end());
    out.key.resize(out.kind.size());
  }
  return parts;
}

}  // namespace zwang

#include <zwang/core/referee/island_split.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/disjoint_sets.h>

namespace zwang {
namespace {

constexpr Index meets_nothing = -1, says_nothing = -2;

// The first unknown that each row's block (an equality row, or a contact) meets. Joins all that it meets.
std::vector<Index> join_blocks(const Problem& p, DisjointSets& sets) {
  std::vector<Index> first(at(p.rows()));
  for (Index i = 0; i < p.rows();) {
    const Index end = i + 1 + (p.is_equality(i) ? 0 : p.tangents(i));
    Index met = std::isfinite(p.c[i]) ? meets_nothing : says_nothing;
    for (Index k = i; k < end && met != says_nothing; ++k)
      for (RowMatrix::InnerIterator it(p.J, k); it; ++it) {
        if (it.value() == 0) continue;
        if (met < 0) met = it.col();
        sets.join(it.col(), met);
      }
    for (; i < end; ++i) first[at(i)] = met;
  }
  return first;
}

// The parts' problems, their columns and rows being known.
void fill(const Problem& p, const std::vector<Index>& place, IslandPart& island) {
  const auto local = [&](Index column) { return static_cast<int>(place[at(column)]); };
  const auto size = std::ssize(island.columns), rows = std::ssize(island.rows);
  Problem& out = island.problem;
  out.z_u = p.z_u(island.columns);
  out.c = p.c(island.rows);
  if (p.has_tangents()) out.mu = p.mu(island.rows);
  out.law = p.law;
  std::vector<Eigen::Triplet<double>> entries;
  for (const Index j : island.columns)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it)
      if (it.value() != 0) entries.emplace_back(local(it.row()), local(j), it.value());
  out.M = sparse_of<SparseMatrix>(size, size, entries);
  entries.clear();
  for (Index k = 0; k < rows; ++k) {
    const Index i = island.rows[at(k)];
    out.kind.push_back(p.kind[at(i)]);
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it)
      if (it.value() != 0) entries.emplace_back(static_cast<int>(k), local(it.col()), it.value());
  }
  out.J = sparse_of<RowMatrix>(rows, size, entries);
  out.key.resize(out.kind.size());
}

}  // namespace

std::vector<IslandPart> split_islands(const Problem& p) {
  DisjointSets sets(p.size());
  for (Index j = 0; j < p.size(); ++j)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it)
      if (it.value() != 0) sets.join(it.row(), j);
  const std::vector<Index> first = join_blocks(p, sets);

  std::vector<IslandPart> islands;
  std::vector<Index> island_of(at(p.size()), -1), place(at(p.size()));
  std::vector<Index> still;  // rows that meet no unknown
  for (Index i = 0; i < p.rows(); ++i) {
    const Index met = first[at(i)];
    if (met == meets_nothing) still.push_back(i);
    if (met < 0) continue;
    Index& id = island_of[at(sets.find(met))];
    if (id < 0) id = std::ssize(islands), islands.emplace_back();
    islands[at(id)].rows.push_back(i);
  }
  if (islands.empty()) return {};
  std::vector<Index>& rows = islands.front().rows;
  rows.insert(rows.end(), still.begin(), still.end());
  std::ranges::sort(rows);
  Index rest = -1;  // the part that no row meets
  for (Index j = 0; j < p.size(); ++j) {
    Index id = island_of[at(sets.find(j))];
    if (id < 0) {
      if (rest < 0) rest = std::ssize(islands), islands.emplace_back();
      id = rest;
    }
    IslandPart& island = islands[at(id)];
    place[at(j)] = std::ssize(island.columns);
    island.columns.push_back(j);
  }
  if (islands.size() == 1) return {};
  for (IslandPart& island : islands) fill(p, place, island);
  return islands;
}

}  // namespace zwang

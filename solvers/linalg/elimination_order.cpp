#include <zwang/solvers/linalg/elimination_order.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <utility>

namespace zwang {
namespace {

std::vector<int> minimum_degree(const Lists& near) {
  const int n = static_cast<int>(near.size());
  if (n == 0) return {};
  SparseMatrix shape(n, n);
  Eigen::VectorXi count(n);
  for (int i = 0; i < n; ++i) count[i] = static_cast<int>(near[at(i)].size()) + 1;
  shape.reserve(count);
  for (int i = 0; i < n; ++i) {
    shape.insert(i, i) = 1;
    for (const int k : near[at(i)]) shape.insert(k, i) = 1;
  }
  shape.makeCompressed();
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(shape, order);
  return {order.indices().data(), order.indices().data() + n};
}

}  // namespace

void sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

Elimination eliminate(const Lists& near, const Deadline& deadline) {
  const int n = static_cast<int>(near.size());
  Elimination e{.order = minimum_degree(near), .below = Lists(near.size())};
  std::vector<int> rank(near.size());
  for (int k = 0; k < n; ++k) rank[at(e.order[at(k)])] = k;
  Lists children(near.size() + 1);
  for (int k = 0; k < n; ++k) {
    deadline.keep();
    auto& below = e.below[at(k)];
    for (const int i : near[at(e.order[at(k)])])
      if (rank[at(i)] > k) below.push_back(rank[at(i)]);
    for (const int c : children[at(k)])
      for (const int i : e.below[at(c)])
        if (i > k) below.push_back(i);
    sort_unique(below);
    children[at(below.empty() ? n : below.front())].push_back(k);
  }

  // Postorder, the child with most below it last: it is the one that may be merged.
  for (auto& list : children) std::ranges::sort(list, {}, [&](int a) { return std::pair(e.below[at(a)].size(), a); });
  std::vector<int> place(near.size()), stack;
  std::vector<std::size_t> next(near.size() + 1, 0);
  int count = 0;
  stack.push_back(n);
  while (!stack.empty()) {
    const int k = stack.back();
    if (next[at(k)] < children[at(k)].size()) {
      stack.push_back(children[at(k)][next[at(k)]++]);
    } else {
      if (k < n) place[at(k)] = count++;
      stack.pop_back();
    }
  }
  Elimination sorted{.order = std::vector<int>(near.size()), .below = Lists(near.size())};
  for (int k = 0; k < n; ++k) {
    sorted.order[at(place[at(k)])] = e.order[at(k)];
    auto& below = sorted.below[at(place[at(k)])];
    for (const int i : e.below[at(k)]) below.push_back(place[at(i)]);
    std::sort(below.begin(), below.end());
  }
  return sorted;
}

}  // namespace zwang

#pragma once

#include <span>

#include <zwang/core/problem/problem.h>

namespace zwang::test {

// Problems that share nothing as one; the keys of part k are those of its own with row + 1000 k.
inline Problem side_by_side(std::span<const Problem> parts) {
  Problem whole{.name = "side by side"};
  std::vector<Eigen::Triplet<double>> M, J;
  std::vector<double> z_u, c;
  std::uint32_t number = 0;
  for (const Problem& part : parts) {
    const auto row = std::ssize(c), column = std::ssize(z_u);
    for (Index j = 0; j < part.size(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(part.M, j); it; ++it)
        M.emplace_back(column + it.row(), column + j, it.value());
    for (Index i = 0; i < part.rows(); ++i)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(part.J, i); it; ++it)
        J.emplace_back(row + i, column + it.col(), it.value());
    z_u.insert(z_u.end(), part.z_u.begin(), part.z_u.end());
    c.insert(c.end(), part.c.begin(), part.c.end());
    whole.kind.insert(whole.kind.end(), part.kind.begin(), part.kind.end());
    for (const RowKey& key : part.key) whole.key.push_back({key.constraint, key.row + 1000 * number});
    ++number;
  }
  const auto n = std::ssize(z_u), m = std::ssize(c);
  whole.M.resize(n, n);
  whole.M.setFromTriplets(M.begin(), M.end());
  whole.J.resize(m, n);
  whole.J.setFromTriplets(J.begin(), J.end());
  whole.z_u = Eigen::Map<const Vector>(z_u.data(), n);
  whole.c = Eigen::Map<const Vector>(c.data(), m);
  return whole;
}

}  // namespace zwang::test

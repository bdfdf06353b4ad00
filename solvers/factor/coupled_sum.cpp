#include <zwang/solvers/factor/coupled_sum.h>

#include <Eigen/SparseLU>
#include <algorithm>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

// Calls visit(row, column, value) for each term of M + G'D G, in one order.
template <class Visit>
void for_each_term(const std::vector<MatrixEntry>& mass, const SparseRows& rows, const std::vector<int>& place,
                   const std::vector<double>& D, const Vector& ray_weight, const Visit& visit) {
  for (const auto& [row, column, value] : mass) visit(row, column, value);
  const Index cones = std::ssize(D) / 9;
  for (Index k = 0; k < cones; ++k) {
    const double* d = &D[at(9 * k)];
    const auto first = at(rows.begin[at(3 * k)]), width = at(rows.begin[at(3 * k) + 1]) - first;
    const double* g = &rows.value[first];
    for (std::size_t i = 0; i < width; ++i) {
      double Dg[3];
      for (int c = 0; c < 3; ++c)
        Dg[c] = g[i] * d[3 * c] + g[width + i] * d[3 * c + 1] + g[2 * width + i] * d[3 * c + 2];
      for (std::size_t j = 0; j < width; ++j)
        visit(place[first + i], place[first + j], Dg[0] * g[j] + Dg[1] * g[width + j] + Dg[2] * g[2 * width + j]);
    }
  }
  for (Index r = 0; r < ray_weight.size(); ++r) {
    const auto row = at(3 * cones + r);
    for (int i = rows.begin[row]; i < rows.begin[row + 1]; ++i)
      for (int j = rows.begin[row]; j < rows.begin[row + 1]; ++j)
        visit(place[at(i)], place[at(j)], ray_weight[r] * rows.value[at(i)] * rows.value[at(j)]);
  }
}

}  // namespace

struct CoupledSum::Lu : Eigen::SparseLU<SparseMatrix, Eigen::NaturalOrdering<int>> {};

bool CoupledSum::factorize(int unknowns, const std::vector<MatrixEntry>& mass, const SparseRows& rows,
                           const std::vector<int>& place, const std::vector<double>& D, const Vector& ray_weight) {
  if (!known_ || !lu_) {
    known_ = true;
    std::vector<Eigen::Triplet<double>> all;
    for_each_term(mass, rows, place, D, ray_weight,
                  [&](int row, int column, double) { all.emplace_back(row, column); });
    for (int j = 0; j < unknowns; ++j) all.emplace_back(j, j);
    sum_ = sparse_of<SparseMatrix>(unknowns, unknowns, all);
    entry_.clear();
    const int *start = sum_.outerIndexPtr(), *index = sum_.innerIndexPtr();
    for_each_term(mass, rows, place, D, ray_weight, [&](int row, int column, double) {
      entry_.push_back(
          static_cast<int>(std::lower_bound(index + start[column], index + start[column + 1], row) - index));
    });
    lu_ = {};
    lu_.open().isSymmetric(true);
    lu_->setPivotThreshold(tolerances::coupled_pivot);
    lu_->analyzePattern(sum_);
  }
  sum_.coeffs().setZero();
  auto entry = entry_.begin();
  for_each_term(mass, rows, place, D, ray_weight, [&](int, int, double value) { sum_.valuePtr()[*entry++] += value; });
  lu_->factorize(sum_);
  return lu_->info() == Eigen::Success;
}

void CoupledSum::solve(Vector& x) { x = lu_->solve(x).eval(); }

}  // namespace zwang

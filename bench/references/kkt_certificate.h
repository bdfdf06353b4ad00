#pragma once

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <zwang/core/referee/exact_rank.h>

namespace zwang {

// Proves an answer of a problem from its stored doubles and its KKT conditions alone, in a scalar of 100 digits. It
// shares no code with any solver, and assumes nothing about the answer.
//
// Let N be the equality rows, the rows with a multiplier and the rows that z touches, but for touched ones that
// contradict the rest. If the rows of N, as equalities, are consistent (decided exactly: exact_rank.h), then some z~
// satisfies them all, and with a basis B of N
//
//   |z~ - z|_M <= off = |slack_B| / sigma_min(G_B)           on unit rows G_i = J_i M^-1/2 / |..|.
//
// If every other row has more slack at z than `off`, z~ is feasible, and as lambda is zero outside N, weak duality says
//
//   |z~ - z*|_M <= |M (z~ - z_u) - J'lambda|_M^-1 <= |M (z - z_u) - J'lambda|_M^-1 + off,  so
//   |z - z*|_M  <= |M (z - z_u) - J'lambda|_M^-1 + 2 off.
//
// A negative multiplier of an inequality row counts as zero, so it shows in the force balance. sigma_min^2 > delta is
// what a Cholesky factorization of G_B G_B' - delta I shows by its success (Rump, Verification of positive
// definiteness, 2006). Rounding in the residuals is bounded by `rounding` of their terms; what it does to the factors
// is not bounded, but delta and `limit` are at least 10 digits above it.
template <class Scalar>
class KktCertificate {
  static_assert(std::numeric_limits<Scalar>::digits10 >= 100);

 public:
  explicit KktCertificate(const Problem& p)
      : p_(p), M_(p.M.template cast<Scalar>()), row_norm_(p.rows()), z_u_(p.z_u.template cast<Scalar>()) {
    const Index n = p.size();
    if (n > 0) {
      const Eigen::SimplicialLLT<Eigen::SparseMatrix<Scalar>> factor(M_);
      definite_ = factor.info() == Eigen::Success;
      if (!definite_) return;
      L_ = factor.matrixL();
      P_ = factor.permutationP();
    }
    std::vector<Eigen::Triplet<Scalar>> entries;
    VectorX<Scalar> x(n);
    for (Index i = 0; i < p.rows(); ++i) {
      x.setZero();
      for (RowMatrix::InnerIterator it(p.J, i); it; ++it) x[it.col()] = it.value();
      forward(x);
      row_norm_[i] = x.norm();
      for (Index k = 0; k < n; ++k)
        if (x[k] != 0) entries.emplace_back(k, i, x[k]);
    }
    G_ = sparse_of<Eigen::SparseMatrix<Scalar>>(n, p.rows(), entries);
  }

  // "" where |z - z*|_M <= limit max(|z_u|_M, |z|_M) is proven, otherwise what is wrong, in a few words.
  // z: n, lambda: m multipliers, both in the problem's units.
  std::string refuse(const VectorX<Scalar>& z, const VectorX<Scalar>& lambda) const {
    const Index n = p_.size(), m = p_.rows();
    const auto row = [](Index i, const char* what) { return "row " + std::to_string(i) + " " + what; };
    if (!definite_) return "M is not positive definite";
    if (z.size() != n || lambda.size() != m) return "its size is not the problem's";

    Sums force(n);
    for (Index j = 0; j < n; ++j)
      for (SparseMatrix::InnerIterator it(p_.M, j); it; ++it)
        force.add(it.row(), Scalar(it.value() * (z[j] - z_u_[j])));

    const Scalar scale = std::max(norm(z_u_), norm(z));
    std::vector<Index> equality, pushing, touched, open;
    std::vector<Sum> slacks(at(m));
    for (Index i = 0; i < m; ++i) {
      if (is_vacuous(i)) continue;
      const Sum& sum = slacks[at(i)] = slack(i, z);
      const Scalar near = touching * (sum.terms + row_norm_[i] * scale);
      if (sum.value < -near || (p_.is_equality(i) && sum.value > near)) return row(i, "is violated");
      if (row_norm_[i] == 0) continue;
      const bool pushes = p_.is_equality(i) || lambda[i] > 0;
      if (pushes) add_force(i, lambda[i], force);
      (p_.is_equality(i) ? equality : pushes ? pushing : sum.value <= near ? touched : open).push_back(i);
    }

    std::vector<Index> holding = std::move(equality);
    holding.insert(holding.end(), pushing.begin(), pushing.end());
    holding.insert(holding.end(), touched.begin(), touched.end());
    const ExactBasis basis = exact_basis(p_.J, p_.c, holding);
    for (const Index i : basis.contradictory) {
      if (p_.is_equality(i) || lambda[i] > 0) return "the rows that hold at it contradict each other";
      open.push_back(i);
    }
    if (!singular_values_exceed_delta(basis.rows)) return "the rows that hold at it are too close to dependent";
    Scalar squared(0);
    for (const Index i : basis.rows) {
      const Sum& sum = slacks[at(i)];
      const Scalar own = (abs(sum.value) + rounding * sum.terms) / row_norm_[i];
      squared += own * own;
    }
    const Scalar off = sqrt(Scalar(squared / delta));
    for (const Index i : open) {
      const Sum& sum = slacks[at(i)];
      if (!(sum.value - rounding * sum.terms >= off * row_norm_[i])) return row(i, "may be violated");
    }
    const Scalar error = dual_norm(force) + 2 * off;
    return error <= limit * scale ? "" : "the force balance does not hold to 40 digits";
  }

  // "" where u is Farkas' vector of an infeasible problem: u_I >= 0, J'u = 0, c'u > 0, up to rounding. Any feasible
  // z has |z - z_u|_M >= (c - J z_u)'u / |J'u|_M^-1; that has to be 1/limit times as far as |z_u| and as any row of u.
  std::string refuse_infeasible(const VectorX<Scalar>& u) const {
    if (!definite_) return "M is not positive definite";
    if (u.size() != p_.rows()) return "its size is not the problem's";
    Sum gain;
    Sums force(p_.size());
    Scalar reach = norm(z_u_);
    for (Index i = 0; i < p_.rows(); ++i) {
      if (u[i] == 0 || (!p_.is_equality(i) && u[i] < 0)) continue;
      if (is_vacuous(i)) return "row " + std::to_string(i) + " excludes nothing";
      const Sum own = slack(i, z_u_);
      gain.value -= own.value * u[i];
      gain.terms += own.terms * abs(u[i]);
      add_force(i, u[i], force);
      if (row_norm_[i] > 0) reach = std::max(reach, Scalar(abs(own.value) / row_norm_[i]));
    }
    const Scalar proven = gain.value - rounding * gain.terms;
    return proven > 0 && limit * proven >= dual_norm(force) * reach ? ""
                                                                    : "its combination of rows contradicts nothing";
  }

  Scalar norm(const VectorX<Scalar>& v) const { return sqrt(std::max(Scalar(0), Scalar(v.dot(M_ * v)))); }

  static constexpr double limit = 1e-40;

 private:
  static constexpr double rounding = 1e-95;  // of the sum of the terms' sizes; the scalar's own is 1e-100
  static constexpr double touching = 1e-50;  // of a row's terms and motion: what is left of a slack that is zero
  static constexpr double delta = 1e-80;     // sigma_min^2 of unit rows; doubles can make it 1e-32 and, rarely, less

  struct Sum {
    Scalar value{0}, terms{0};
    void add(const Scalar& term) {
      value += term;
      terms += abs(term);
    }
  };
  struct Sums {
    VectorX<Scalar> value, terms;
    explicit Sums(Index size) : value(VectorX<Scalar>::Zero(size)), terms(value) {}
    void add(Index k, const Scalar& term) {
      value[k] += term;
      terms[k] += abs(term);
    }
  };

  bool is_vacuous(Index i) const { return !std::isfinite(p_.c[i]); }
  Sum slack(Index i, const VectorX<Scalar>& z) const {
    Sum sum;
    sum.add(Scalar(-p_.c[i]));
    for (RowMatrix::InnerIterator it(p_.J, i); it; ++it) sum.add(Scalar(it.value() * z[it.col()]));
    return sum;
  }
  // force -= J_i' multiplier.
  void add_force(Index i, const Scalar& multiplier, Sums& force) const {
    for (RowMatrix::InnerIterator it(p_.J, i); it; ++it) force.add(it.col(), Scalar(-it.value() * multiplier));
  }
  Scalar dual_norm(const Sums& force) const {
    VectorX<Scalar> value = force.value, terms = force.terms;
    forward(value);
    forward(terms);
    return value.norm() + rounding * terms.norm();
  }
  // x = L^-1 x
  void forward(VectorX<Scalar>& x) const {
    if (P_.size() > 0) x = P_ * x;
    for (Index j = 0; j < x.size(); ++j) {
      if (x[j] == 0) continue;
      typename Eigen::SparseMatrix<Scalar>::InnerIterator it(L_, j);
      x[j] /= it.value();
      for (++it; it; ++it) x[it.row()] -= it.value() * x[j];
    }
  }
  bool singular_values_exceed_delta(const std::vector<Index>& rows) const {
    if (rows.empty()) return true;
    const auto count = static_cast<Index>(rows.size());
    // Gram matrix less delta on the diagonal, its lower half by columns. (Eigen's sparse product loses memory of
    // scalars that own some.)
    std::vector<std::vector<std::pair<Index, Scalar>>> of_unknown(at(G_.rows()));
    std::vector<Eigen::Triplet<Scalar>> gram;
    for (Index k = count - 1; k >= 0; --k) {
      const Index i = rows[at(k)];
      std::vector<Scalar> column(at(count), Scalar(0));
      column[at(k)] = -Scalar(delta);
      for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(G_, i); it; ++it) {
        auto& others = of_unknown[at(it.row())];
        others.emplace_back(k, Scalar(it.value() / row_norm_[i]));
        for (const auto& [other, value] : others) column[at(other)] += others.back().second * value;
      }
      for (Index other = k; other < count; ++other)
        if (other == k || column[at(other)] != 0) gram.emplace_back(other, k, column[at(other)]);
    }
    const auto shifted = sparse_of<Eigen::SparseMatrix<Scalar>>(count, count, gram);
    return Eigen::SimplicialLLT<Eigen::SparseMatrix<Scalar>>(shifted).info() == Eigen::Success;
  }

  const Problem& p_;
  Eigen::SparseMatrix<Scalar> M_, L_;  // P M P' = L L'
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> P_;
  bool definite_ = true;
  Eigen::SparseMatrix<Scalar> G_;  // n x m: column i is L^-1 P J_i'
  VectorX<Scalar> row_norm_, z_u_;
};

}  // namespace zwang

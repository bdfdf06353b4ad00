#include "core/problem.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace zwang {

void require_matching_sizes(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  const bool ok = p.M.rows() == n && p.M.cols() == n && p.J.rows() == m && p.J.cols() == n &&
                  static_cast<Index>(p.kind.size()) == m && static_cast<Index>(p.key.size()) == m;
  if (ok) return;
  std::ostringstream text;
  text << "problem '" << p.name << "': sizes do not match: z_u " << n << ", c " << m << ", M " << p.M.rows() << " x "
       << p.M.cols() << ", J " << p.J.rows() << " x " << p.J.cols() << ", kind " << p.kind.size() << ", key "
       << p.key.size();
  throw std::invalid_argument(text.str());
}

namespace {

// Zero times what is not finite is NaN: one pass along lanes for all entries.
bool all_finite(const double* x, Index size) { return (Eigen::Map<const Vector>(x, size) * 0.0).sum() == 0; }

template <class Sparse>
std::string non_finite(const Sparse& A, const char* letter) {
  if (A.isCompressed() && all_finite(A.valuePtr(), A.nonZeros())) return {};
  for (Index k = 0; k < A.outerSize(); ++k)
    for (typename Sparse::InnerIterator it(A, k); it; ++it)
      if (!std::isfinite(it.value()))
        return std::string(letter) + "(" + std::to_string(it.row()) + ", " + std::to_string(it.col()) +
               ") is not a finite number";
  return {};
}

// Whether M(i, k) = x has its mirror image, where `diagonal` entries of column k stand above M(k, k). Columns of one
// body hold the same rows, so that M(k, i) stands in the same place of column i; elsewhere it is searched for.
class Mirror {
 public:
  explicit Mirror(const Eigen::SparseMatrix<double>& M)
      : M_(M),
        outer_(M.isCompressed() ? M.outerIndexPtr() : nullptr),
        inner_(M.innerIndexPtr()),
        value_(M.valuePtr()) {}
  bool shows(Index i, Index k, int diagonal, double x) const {
    if (outer_) {
      const int at = outer_[i] + diagonal;
      if (at < outer_[i + 1] && inner_[at] == k) return value_[at] == x;
    }
    return M_.coeff(k, i) == x;
  }

 private:
  const Eigen::SparseMatrix<double>& M_;
  const int *outer_, *inner_;
  const double* value_;
};

// Squares of 1 / sqrt(M) have to fit a double, sums of them too. A fuzzed mass of 1e-319 made every solver wrong.
constexpr double least_mass = 0x1p-960;

}  // namespace

std::string bad_input(const Problem& p) {
  if (std::string text = non_finite(p.M, "M"); !text.empty()) return text;
  if (std::string text = non_finite(p.J, "J"); !text.empty()) return text;
  const bool check_z_u = !all_finite(p.z_u.data(), p.size()), check_c = !all_finite(p.c.data(), p.rows());
  for (Index i = 0; check_z_u && i < p.size(); ++i)
    if (!std::isfinite(p.z_u[i])) return "z_u(" + std::to_string(i) + ") is not a finite number";
  for (Index i = 0; check_c && i < p.rows(); ++i) {
    const bool inactive = !p.is_equality(i) && p.c[i] == -std::numeric_limits<double>::infinity();
    if (!std::isfinite(p.c[i]) && !inactive) return "c(" + std::to_string(i) + ") is not a finite number";
  }
  const Mirror mirror(p.M);
  for (Index k = 0; k < p.M.outerSize(); ++k) {
    int diagonal = 0;
    Eigen::SparseMatrix<double>::InnerIterator it(p.M, k);
    for (; it && it.row() < k; ++it) ++diagonal;
    if (it && it.row() == k && it.value() > 0 && it.value() < least_mass)
      return "M(" + std::to_string(k) + ", " + std::to_string(k) + ") is below 2^-960: its inverse would overflow";
    for (it = {p.M, k}; it; ++it)
      if (it.row() != k && !mirror.shows(it.row(), k, diagonal, it.value()))
        return "M is not symmetric at (" + std::to_string(it.row()) + ", " + std::to_string(k) + ")";
  }
  return {};
}

bool is_positive_definite(const Eigen::SparseMatrix<double>& M) {
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(M);
  return M.rows() == 0 || factor.info() == Eigen::Success;
}

}  // namespace zwang

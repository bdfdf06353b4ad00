#include <zwang/core/problem/problem.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <zwang/core/problem/law.h>

namespace zwang {

void require_matching_sizes(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  const bool ok = p.M.rows() == n && p.M.cols() == n && p.J.rows() == m && p.J.cols() == n &&
                  static_cast<Index>(p.kind.size()) == m && static_cast<Index>(p.key.size()) == m &&
                  (p.mu.size() == 0 || p.mu.size() == m);
  if (ok) return;
  std::ostringstream text;
  text << "problem '" << p.name << "': sizes do not match: z_u " << n << ", c " << m << ", M " << p.M.rows() << " x "
       << p.M.cols() << ", J " << p.J.rows() << " x " << p.J.cols() << ", kind " << p.kind.size() << ", key "
       << p.key.size() << ", mu " << p.mu.size();
  throw std::invalid_argument(text.str());
}

namespace {

// Squares of 1 / sqrt(M) have to fit a double, sums of them too, and so do M's own and |J M^-1/2|, which entries of J
// below 2^512 cannot make too long. A fuzzed mass of 1e-319 made every solver wrong, entries of 1e308 most.
constexpr double least_mass = 0x1p-960, greatest_mass = 0x1p1000, short_entry = 0x1p512;
constexpr int longest_row = 1000;  // power of two

// Zero times what is not finite, or is not after `enlarged`, is NaN: one pass along lanes for all entries.
bool all_finite(const double* x, Index size, double enlarged = 1) {
  return (Eigen::Map<const Vector>(x, size) * enlarged * 0.0).sum() == 0;
}
template <class Sparse>
bool all_below(const Sparse& A, double limit) {
  return A.isCompressed() && all_finite(A.valuePtr(), A.nonZeros(), 0x1p1023 / limit);
}

std::string name_of(const char* letter, Index i, Index k) {
  return std::string(letter) + "(" + std::to_string(i) + ", " + std::to_string(k) + ")";
}

template <class Sparse>
std::string bad_entry(const Sparse& A, const char* letter, double limit) {
  for (Index k = 0; k < A.outerSize(); ++k)
    for (typename Sparse::InnerIterator it(A, k); it; ++it) {
      if (!std::isfinite(it.value())) return name_of(letter, it.row(), it.col()) + " is not a finite number";
      if (std::abs(it.value()) > limit)
        return name_of(letter, it.row(), it.col()) + " is above 2^" + std::to_string(std::ilogb(limit)) +
               ": its square would overflow";
    }
  return {};
}

std::string bad_length(const Problem& p) {
  std::optional<Eigen::SimplicialLLT<SparseMatrix>> factor;
  for (Index i = 0; i < p.rows(); ++i) {
    const double largest = largest_entry(p.J, i);
    if (!(largest > short_entry)) continue;
    if (!factor) factor.emplace(p.M);
    if (factor->info() != Eigen::Success) return {};
    const int exponent = std::ilogb(largest);
    const Vector unit = p.J.row(i).transpose() * std::ldexp(1.0, -exponent);
    if (exponent + std::ilogb(std::sqrt(unit.dot(factor->solve(unit)))) >= longest_row)
      return "row " + std::to_string(i) + " of J is too long: |J M^-1/2| is above 2^" + std::to_string(longest_row);
  }
  return {};
}

// Do `size` columns from k on hold one full symmetric block and nothing else, of masses that are not too small?
template <int size>
bool is_good_block(const SparseMatrix& M, Index k) {
  if (!M.isCompressed() || k + size > M.outerSize()) return false;
  const int first = static_cast<int>(k), begin = M.outerIndexPtr()[k];
  int other = 0;
  for (int j = 1; j <= size; ++j) other |= M.outerIndexPtr()[k + j] ^ (begin + size * j);
  if (other != 0) return false;
  const int* const inner = M.innerIndexPtr() + begin;
  const double* const value = M.valuePtr() + begin;
  for (int e = 0; e < size * size; ++e) other |= inner[e] ^ (first + e % size);
  bool good = other == 0;
  for (int j = 0; j < size; ++j) {
    good &= !(value[size * j + j] < least_mass);
    for (int i = 0; i < j; ++i) good &= value[size * j + i] == value[size * i + j];
  }
  return good;
}

// How many columns from k on a mass, an inertia or both together fill, where these are good. A hand's masses are
// checked in 0.2 us like this, and in 0.5 entry by entry.
Index good_columns(const SparseMatrix& M, Index k) {
  const int size = k < M.outerSize() ? M.outerIndexPtr()[k + 1] - M.outerIndexPtr()[k] : 0;
  if (size == 1 && is_good_block<1>(M, k)) return 1;
  if (size == 3 && is_good_block<3>(M, k)) return 3;
  if (size == 6 && is_good_block<6>(M, k)) return 6;
  return 0;
}

// Columns of one body hold the same rows, so that the mirror image of an entry in column k stands as far down in its
// column as M(k, k) in its own; elsewhere it is searched for.
std::string bad_mass(const SparseMatrix& M) {
  const int *const outer = M.outerIndexPtr(), *const counts = M.innerNonZeroPtr(), *const inner = M.innerIndexPtr();
  const double* const value = M.valuePtr();
  for (Index k = 0; k < M.outerSize(); ++k) {
    while (const Index good = good_columns(M, k)) k += good;
    if (k == M.outerSize()) break;
    const int begin = outer[k], end = counts ? begin + counts[k] : outer[k + 1];
    int diagonal = begin;
    while (diagonal < end && inner[diagonal] < k) ++diagonal;
    if (diagonal < end && inner[diagonal] == k && value[diagonal] > 0 && value[diagonal] < least_mass)
      return name_of("M", k, k) + " is below 2^-960: its inverse would overflow";
    for (int e = begin; e < end; ++e) {
      const int i = inner[e];
      if (i == k) continue;
      const int mirror = outer[i] + (diagonal - begin);
      const bool there = mirror < (counts ? outer[i] + counts[i] : outer[i + 1]) && inner[mirror] == k;
      if ((there ? value[mirror] : M.coeff(k, i)) != value[e]) return "M is not symmetric at " + name_of("", i, k);
    }
  }
  return {};
}

// Tangent rows stand in ones or twos after the inequality row of their contact, where mu is a number >= 0; a contact
// with mu > 0 has them.
std::string bad_friction(const Problem& p) {
  const auto row = [](Index i) { return "row " + std::to_string(i); };
  if (!p.has_tangents()) {
    const auto tangent = std::ranges::find(p.kind, RowKind::tangent);
    return tangent == p.kind.end() ? "" : row(tangent - p.kind.begin()) + " is a tangent row, but there are no mu";
  }
  if (!has_cones(p.law))
    return "there are tangent rows, but the law is " + std::string(to_string(p.law)) + "; expected convex or coulomb";
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i)) return row(i) + " is a tangent row without an inequality row before it";
    if (p.is_equality(i)) continue;
    const Index tangents = p.tangents(i);
    if (!(p.mu[i] >= 0) || std::isinf(p.mu[i]))
      return (std::ostringstream() << "mu(" << i << ") is " << p.mu[i] << "; expected a number >= 0").str();
    if (tangents > 2) return row(i) + " has " + std::to_string(tangents) + " tangent rows; expected 1 or 2";
    if (tangents == 0 && p.mu[i] > 0) return row(i) + " has mu > 0 and no tangent rows";
    i += tangents;
  }
  return {};
}

}  // namespace

std::string bad_input(const Problem& p) {
  const bool long_rows = !all_below(p.J, short_entry);
  if (!all_below(p.M, greatest_mass))
    if (std::string text = bad_entry(p.M, "M", greatest_mass); !text.empty()) return text;
  if (long_rows)
    if (std::string text = bad_entry(p.J, "J", infinity); !text.empty()) return text;
  const bool check_z_u = !all_finite(p.z_u.data(), p.size()), check_c = !all_finite(p.c.data(), p.rows());
  for (Index i = 0; check_z_u && i < p.size(); ++i)
    if (!std::isfinite(p.z_u[i])) return "z_u(" + std::to_string(i) + ") is not a finite number";
  for (Index i = 0; check_c && i < p.rows(); ++i) {
    const bool inactive = p.kind[at(i)] == RowKind::inequality && p.c[i] == -infinity;
    if (!std::isfinite(p.c[i]) && !inactive) return "c(" + std::to_string(i) + ") is not a finite number";
  }
  if (std::string text = bad_friction(p); !text.empty()) return text;
  if (std::string text = bad_mass(p.M); !text.empty()) return text;
  return long_rows ? bad_length(p) : std::string();
}

double largest_entry(const RowMatrix& J, Index row) {
  double largest = 0;
  for (RowMatrix::InnerIterator it(J, row); it; ++it) largest = std::max(largest, std::abs(it.value()));
  return largest;
}

bool is_positive_definite(const SparseMatrix& M) {
  const Eigen::SimplicialLLT<SparseMatrix> factor(M);
  return M.rows() == 0 || factor.info() == Eigen::Success;
}

}  // namespace zwang

#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <type_traits>
#include <vector>

// Matrices cross between the libraries and their host: both must lay them out, take and free their memory alike.
#if EIGEN_MAX_ALIGN_BYTES != 16 || EIGEN_MALLOC_ALREADY_ALIGNED
#error "this file is compiled with another layout of Eigen's matrices than zwang: link zwang::core, which passes it on"
#endif

namespace zwang {

template <class T, int N>
using Vec = Eigen::Matrix<T, N, 1>;
template <class T, int R, int C>
using Mat = Eigen::Matrix<T, R, C>;
template <class T>
using VectorX = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <class T>
using MatrixX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

using Vec3 = Vec<double, 3>;
using Mat3 = Mat<double, 3, 3>;
using Vector = VectorX<double>;
using Matrix = MatrixX<double>;
using SparseMatrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Index = Eigen::Index;
using BodyId = int;

inline constexpr double infinity = std::numeric_limits<double>::infinity();
// An index into a standard container.
constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }
// What f makes of each, in order: mapped(scene.bodies, &Body::pose).
template <class Range, class F>
auto mapped(const Range& range, const F& f) {
  std::vector<std::decay_t<decltype(std::invoke(f, *std::begin(range)))>> all;
  for (const auto& each : range) all.push_back(std::invoke(f, each));
  return all;
}
// first, first + 1, ...
template <class T>
std::vector<T> numbers_from(T first, std::size_t count) {
  std::vector<T> all(count);
  std::iota(all.begin(), all.end(), first);
  return all;
}
// Entries of one place sum.
template <class Sparse>
Sparse sparse_of(Index rows, Index columns, const std::vector<Eigen::Triplet<typename Sparse::Scalar>>& entries) {
  Sparse A(rows, columns);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

// J z = c, J z >= c, or a direction of slip of the contact whose inequality row stands before it: 1 or 2 of them, in
// the unit of that row, J z - c being the slip.
enum class RowKind : unsigned char { equality, inequality, tangent };

// How a contact with friction is read (docs/formulation.md). Per contact s = (s_n, s_t) = J z - c and
// lambda = (l_n, l_t), K = {|l_t| <= mu l_n}, K* = {s_n >= mu |s_t|}; M (z - z_u) = J' lambda always.
enum class Law : unsigned char {
  frictionless,  // tangent rows are left out
  pyramid,       // four facets (two in the plane) in place of K*: the inequality rows N +- mu T, a QP
  convex,        // K* ∋ s ⊥ lambda ∈ K: Gauss' principle over the cone, one z if any
  coulomb,       // K* ∋ s + mu |s_t| e_n ⊥ lambda ∈ K: Coulomb's own law; none, one or several z
};

// Names one row across frames: a joint's id, or a hash of (body, object, feature) for a contact, and the row within it.
// Warm starts match rows by it when contacts appear and vanish.
struct RowKey {
  std::uint64_t constraint = 0;
  std::uint32_t row = 0;
  friend auto operator<=>(const RowKey&, const RowKey&) = default;
};

}  // namespace zwang

#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>

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
using Index = Eigen::Index;
using BodyId = int;

// J z = c, or J z >= c.
enum class RowKind : unsigned char { equality, inequality };

// Names one row across frames: a joint's id, or a hash of (body, object, feature) for a contact, and the row within it.
// Warm starts match rows by it when contacts appear and vanish.
struct RowKey {
  std::uint64_t constraint = 0;
  std::uint32_t row = 0;
  friend auto operator<=>(const RowKey&, const RowKey&) = default;
};

}  // namespace zwang

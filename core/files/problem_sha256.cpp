#include <bit>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>

namespace zwang {
namespace {

// Numbers as little-endian 64-bit words.
struct CanonicalBytes {
  std::string bytes = {};

  void add(std::uint64_t word) {
    for (int k = 0; k < 64; k += 8) bytes += static_cast<char>(word >> k);
  }
  void add(Index number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const Vector& v) {
    for (const double x : v) add(x);
  }
  // Entries that are not zero, so that the stored pattern does not matter.
  template <int Options>
  void add(const Eigen::SparseMatrix<double, Options>& A) {
    for (Index k = 0; k < A.outerSize(); ++k)
      for (typename Eigen::SparseMatrix<double, Options>::InnerIterator it(A, k); it; ++it)
        if (it.value() != 0) {
          add(Index{it.row()});
          add(Index{it.col()});
          add(it.value());
        }
    add(Index{-1});
  }
};

}  // namespace

std::string problem_sha256(const Problem& p) {
  CanonicalBytes canonical;
  canonical.add(p.size());
  canonical.add(p.rows());
  canonical.add(p.M);
  canonical.add(p.J);
  canonical.add(p.z_u);
  canonical.add(p.c);
  for (const RowKind kind : p.kind) canonical.add(static_cast<std::uint64_t>(kind));
  if (p.has_tangents()) {
    canonical.add(p.mu);
    canonical.add(static_cast<std::uint64_t>(p.law));
  }
  return sha256(canonical.bytes);
}

}  // namespace zwang

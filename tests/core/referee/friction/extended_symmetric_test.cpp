#include <gtest/gtest.h>

#include <cmath>

#include <zwang/core/referee/friction/extended_symmetric.h>

namespace zwang {
namespace {

// L R', symmetric, added as a product and entry by entry: the same system beyond the digits of a double.
TEST(ExtendedSymmetric, AProductIsTheSumOfItsEntries) {
  constexpr Index n = 7, m = 12;
  Matrix left(n, m);
  MatrixX<DoubleDouble> right(n, m);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < m; ++k) {
      left(i, k) = std::sin(1.0 + static_cast<double>(3 * i + 7 * k));
      right(i, k) = DoubleDouble(left(i, k)) * (DoubleDouble(1) / DoubleDouble(3.0 + static_cast<double>(k)));
    }
  ExtendedSymmetric product(n, 1), entries(n, 1);
  for (ExtendedSymmetric* system : {&product, &entries}) {
    system->set_zero();
    for (Index i = 0; i <= n; ++i) system->add(i, i, DoubleDouble(i < n ? 1 : -1));
  }
  product.add_product(left, right);
  for (Index k = 0; k < m; ++k)
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) entries.add(i, j, DoubleDouble(left(i, k)) * right(j, k));
  ASSERT_TRUE(product.factorize());
  ASSERT_TRUE(entries.factorize());
  VectorX<DoubleDouble> x(n + 1), y(n + 1);
  for (Index i = 0; i <= n; ++i) x[i] = y[i] = DoubleDouble(1.0 + static_cast<double>(i));
  product.solve(x);
  entries.solve(y);
  for (Index i = 0; i <= n; ++i) EXPECT_LE(std::abs((x[i] - y[i]).hi), 1e-28) << i;
}

}  // namespace
}  // namespace zwang

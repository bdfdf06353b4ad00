#include <zwang/core/number/double_double.h>

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <random>

namespace zwang {
namespace {

using Far =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200, boost::multiprecision::digit_base_2>>;

Far far(const DoubleDouble& x) { return Far(x.hi) + Far(x.lo); }

TEST(DoubleDouble, SumsProductsQuotientsAndRootsHold102Bits) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(1, 2);
  std::uniform_int_distribution<int> exponent(-40, 40);
  const auto draw = [&] {
    return DoubleDouble::exact_sum(std::ldexp(mantissa(random), exponent(random)),
                                   std::ldexp(mantissa(random), exponent(random) - 53));
  };
  const auto error = [](const DoubleDouble& x, const Far& truth) {
    return static_cast<double>(abs(Far(far(x) / truth - 1)));
  };
  constexpr double rounding = 0x1p-102;
  for (int trial = 0; trial < 10000; ++trial) {
    const DoubleDouble a = draw(), b = draw();
    EXPECT_LE(error(a + b, far(a) + far(b)), rounding);
    EXPECT_LE(error(a * b, far(a) * far(b)), rounding);
    EXPECT_LE(error(a / b, far(a) / far(b)), rounding);
    EXPECT_LE(error(sqrt(a), sqrt(far(a))), rounding);
    EXPECT_EQ(a < b, far(a) < far(b));
    EXPECT_EQ(abs(-a), a);
  }
}

}  // namespace
}  // namespace zwang

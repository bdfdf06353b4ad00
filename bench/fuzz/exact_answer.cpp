#include <zwang/bench/fuzz/exact_answer.h>

#include <boost/multiprecision/gmp.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace zwang {
namespace {

namespace mp = boost::multiprecision;
using Integer = mp::number<mp::gmp_int, mp::et_off>;
using Integers = MatrixX<Integer>;
using IntegerVector = VectorX<Integer>;
using Flags = Eigen::Array<bool, Eigen::Dynamic, 1>;

constexpr int most_bits = 10;  // after the point

// The least number of bits after the point that holds all entries.
int bits_of(const Matrix& A) {
  int bits = 0;
  for (const double a : A.reshaped())
    while (std::isfinite(a) && std::ldexp(a, bits) != std::floor(std::ldexp(a, bits)))
      if (++bits > most_bits) throw std::range_error("not an integer / 2^10");
  return bits;
}

Integer to_integer(double x, int bits) {
  const double scaled = std::ldexp(x, bits);
  if (!(std::abs(scaled) < 0x1p40)) throw std::range_error("too large");
  return static_cast<std::int64_t>(scaled);
}

Integers to_integers(const Matrix& A, int bits) {
  return A.unaryExpr([bits](double a) { return to_integer(a, bits); });
}

double quotient(const Integer& a, const Integer& b) {
  return static_cast<double>(static_cast<long double>(a) / static_cast<long double>(b));
}

// basic_i = (constant_i + sum_j entry_ij nonbasic_j) / denominator. Position i holds the pair (slack, lambda) of row
// `row[i]`; one of the two is basic there, the other nonbasic.
struct Tableau {
  Integers entry;
  IntegerVector constant;
  Integer denominator = 1;
  VectorX<Index> row = {};
  Flags pushes = {};  // lambda is the basic one

  // Makes the nonbasic variable at s basic at position r. The divisions leave no remainder.
  void exchange(Index r, Index s) {
    const Integer p = entry(r, s), sign = p < 0 ? -1 : 1;
    for (Index i = 0; i < entry.rows(); ++i) {
      if (i == r) continue;
      for (Index j = 0; j < entry.cols(); ++j)
        if (j != s) entry(i, j) = sign * ((entry(i, j) * p - entry(i, s) * entry(r, j)) / denominator);
      constant[i] = sign * ((constant[i] * p - entry(i, s) * constant[r]) / denominator);
      entry(i, s) *= sign;
    }
    entry.row(r) *= Integer(-sign);
    constant[r] *= -sign;
    entry(r, s) = sign * denominator;
    denominator = sign * p;
  }
  void exchange_pair(Index i) {
    exchange(i, i);
    pushes[i] = !pushes[i];
  }
  void exchange_pairs(Index i, Index j) {
    exchange(i, j);
    exchange(j, i);
    std::swap(row[i], row[j]);
    std::swap(pushes[i], pushes[j]);
    pushes[i] = !pushes[i];
    pushes[j] = !pushes[j];
  }
};

// Row i of the tableau says that a combination of slacks is a negative constant: the combination is the certificate.
Reference infeasible_by(const Tableau& t, Index i, Index m) {
  Reference found{.feasible = false, .certificate = Vector::Zero(m), .method = "integers"};
  const int sign = t.constant[i] < 0 ? 1 : -1;
  found.certificate[t.row[i]] = sign * static_cast<double>(t.denominator);
  for (Index j = 0; j < m; ++j)
    if (j != i && t.pushes[j]) found.certificate[t.row[j]] = -sign * static_cast<double>(t.entry(i, j));
  found.certificate /= found.certificate.cwiseAbs().maxCoeff();
  return found;
}

// M^-1 = A / d in lowest terms, M in integers; Gauss-Jordan on the tableau M y = x.
std::pair<Integers, Integer> inverse_of(const Integers& M) {
  Tableau t{.entry = M, .constant = IntegerVector::Zero(M.rows())};
  for (Index i = 0; i < M.rows(); ++i) t.exchange(i, i);
  Integer common = t.denominator;
  for (const Integer& a : t.entry.reshaped()) common = gcd(common, a);
  return {t.entry / common, t.denominator / common};
}

Reference solve(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  const int M_bits = bits_of(Matrix(p.M)), J_bits = bits_of(Matrix(p.J));
  const int z_bits = std::max(bits_of(p.z_u), bits_of(p.c) - J_bits);
  const auto [A, d] = inverse_of(to_integers(Matrix(p.M), M_bits));
  const Integers J = to_integers(Matrix(p.J), J_bits);
  const IntegerVector z_u = to_integers(p.z_u, z_bits);

  // z = z_u + A J' lambda, all integers: z in units of 2^-z_bits, J of 2^-J_bits, and lambda takes what is left.
  Tableau t{.entry = J * A * J.transpose(),
            .constant = J * z_u,
            .row = VectorX<Index>::LinSpaced(m, 0, m - 1),
            .pushes = Flags::Zero(m)};
  // Positions at which nothing is exchanged by sign: equality rows, and rows without a c. The others alone change
  // places.
  Flags fixed = Flags::Zero(m);
  for (Index i = 0; i < m; ++i) {
    fixed[i] = p.is_equality(i) || !std::isfinite(p.c[i]);
    if (std::isfinite(p.c[i])) t.constant[i] -= to_integer(p.c[i], J_bits + z_bits);
  }
  for (Index i = 0; i < m; ++i) {
    if (!p.is_equality(i)) continue;
    if (t.entry(i, i) != 0)
      t.exchange_pair(i);
    else if (t.constant[i] != 0)
      return infeasible_by(t, i, m);
  }
  const auto least = [&](const auto& wanted) {
    Index best = -1;
    for (Index i = 0; i < m; ++i)
      if (!fixed[i] && wanted(i) && (best < 0 || t.row[i] < t.row[best])) best = i;
    return best;
  };
  for (;;) {
    const Index i = least([&](Index k) { return t.constant[k] < 0; });
    if (i < 0) break;
    if (t.entry(i, i) != 0) {
      t.exchange_pair(i);
      continue;
    }
    const Index j = least([&](Index k) { return t.entry(i, k) > 0; });
    if (j < 0) return infeasible_by(t, i, m);
    t.exchange_pairs(i, j);
  }

  Reference found{.z = Vector(n), .lambda = Vector::Zero(m), .method = "integers"};
  IntegerVector push = IntegerVector::Zero(m);
  for (Index i = 0; i < m; ++i)
    if (t.pushes[i]) {
      push[t.row[i]] = t.constant[i];
      found.lambda[t.row[i]] = std::ldexp(quotient(t.constant[i] * d, t.denominator), J_bits - M_bits - z_bits);
    }
  const IntegerVector moved = A * (J.transpose() * push);
  for (Index j = 0; j < n; ++j)
    found.z[j] = std::ldexp(quotient(z_u[j] * t.denominator + moved[j], t.denominator), -z_bits);
  return found;
}

}  // namespace

std::optional<Reference> exact_answer(const Problem& problem) {
  try {
    return solve(problem);
  } catch (const std::range_error&) {
    return {};
  }
}

}  // namespace zwang

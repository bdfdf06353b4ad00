#include <zwang/bench/fuzz/exact_answer.h>

#include <cmath>
#include <utility>

namespace zwang {
namespace {

__extension__ using Integer = __int128;
using Integers = MatrixX<Integer>;
using IntegerVector = VectorX<Integer>;

struct TooLarge {};

constexpr int most_bits = 10;  // after the point

Integer times(Integer a, Integer b) {
  Integer product;
  if (__builtin_mul_overflow(a, b, &product)) throw TooLarge{};
  return product;
}

Integer minus(Integer a, Integer b) {
  Integer difference;
  if (__builtin_sub_overflow(a, b, &difference)) throw TooLarge{};
  return difference;
}
// (a p - b q) / d, which leaves no remainder.
Integer cross(Integer a, Integer p, Integer b, Integer q, Integer d) { return minus(times(a, p), times(b, q)) / d; }

// The least number of bits after the point that holds all entries.
int bits_of(const Matrix& A) {
  int bits = 0;
  for (const double a : A.reshaped())
    while (std::isfinite(a) && std::ldexp(a, bits) != std::floor(std::ldexp(a, bits)))
      if (++bits > most_bits) throw TooLarge{};
  return bits;
}

Integer to_integer(double x, int bits) {
  const double scaled = std::ldexp(x, bits);
  if (!(std::abs(scaled) < 0x1p40)) throw TooLarge{};
  return static_cast<Integer>(scaled);
}

Integers to_integers(const Matrix& A, int bits) {
  return A.unaryExpr([bits](double a) { return to_integer(a, bits); });
}

Integer greatest_common_divisor(Integer a, Integer b) {
  while (b != 0) a = std::exchange(b, a % b);
  return a < 0 ? -a : a;
}

Integers product(const Integers& A, const Integers& B) {
  Integers C = Integers::Zero(A.rows(), B.cols());
  for (Index i = 0; i < C.rows(); ++i)
    for (Index j = 0; j < C.cols(); ++j)
      for (Index k = 0; k < A.cols(); ++k) C(i, j) = minus(C(i, j), -times(A(i, k), B(k, j)));
  return C;
}

double quotient(Integer a, Integer b) {
  return static_cast<double>(static_cast<long double>(a) / static_cast<long double>(b));
}

// basic_i = (constant_i + sum_j entry_ij nonbasic_j) / denominator. Position i holds the pair (slack, lambda) of row
// `row[i]`; one of the two is basic there, the other nonbasic.
struct Tableau {
  Integers entry;
  IntegerVector constant;
  Integer denominator = 1;
  std::vector<Index> row = {};
  std::vector<char> pushes = {};  // lambda is the basic one

  // Makes the nonbasic variable at s basic at position r.
  void exchange(Index r, Index s) {
    const Integer p = entry(r, s), sign = p < 0 ? -1 : 1;
    for (Index i = 0; i < entry.rows(); ++i) {
      if (i == r) continue;
      for (Index j = 0; j < entry.cols(); ++j)
        if (j != s) entry(i, j) = sign * cross(entry(i, j), p, entry(i, s), entry(r, j), denominator);
      constant[i] = sign * cross(constant[i], p, entry(i, s), constant[r], denominator);
      entry(i, s) *= sign;
    }
    entry.row(r) *= -sign;
    constant[r] *= -sign;
    entry(r, s) = sign * denominator;
    denominator = sign * p;
  }
  void exchange_pair(Index i) {
    exchange(i, i);
    pushes[at(i)] = !pushes[at(i)];
  }
  void exchange_pairs(Index i, Index j) {
    exchange(i, j);
    exchange(j, i);
    std::swap(row[at(i)], row[at(j)]);
    std::swap(pushes[at(i)], pushes[at(j)]);
    pushes[at(i)] = !pushes[at(i)];
    pushes[at(j)] = !pushes[at(j)];
  }
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
};

// Row i of the tableau says that a combination of slacks is a negative constant: the combination is the certificate.
Reference infeasible_by(const Tableau& t, Index i, Index m) {
  Reference found{.feasible = false, .certificate = Vector::Zero(m), .method = "integers"};
  const Integer sign = t.constant[i] < 0 ? 1 : -1;
  found.certificate[t.row[Tableau::at(i)]] = static_cast<double>(sign * t.denominator);
  for (Index j = 0; j < m; ++j)
    if (j != i && t.pushes[Tableau::at(j)])
      found.certificate[t.row[Tableau::at(j)]] = static_cast<double>(-sign * t.entry(i, j));
  found.certificate /= found.certificate.cwiseAbs().maxCoeff();
  return found;
}

// M^-1 = A / d in lowest terms, M in integers; Gauss-Jordan on the tableau M y = x.
std::pair<Integers, Integer> inverse_of(const Integers& M) {
  Tableau t{.entry = M, .constant = IntegerVector::Zero(M.rows())};
  for (Index i = 0; i < M.rows(); ++i) t.exchange(i, i);
  Integer common = t.denominator;
  for (const Integer a : t.entry.reshaped()) common = greatest_common_divisor(common, a);
  return {t.entry / common, t.denominator / common};
}

Reference solve(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  const int M_bits = bits_of(Matrix(p.M)), J_bits = bits_of(Matrix(p.J));
  const int z_bits = std::max(bits_of(p.z_u), bits_of(p.c) - J_bits);
  const auto [A, d] = inverse_of(to_integers(Matrix(p.M), M_bits));
  const Integers J = to_integers(Matrix(p.J), J_bits), z_u = to_integers(p.z_u, z_bits);

  // z = z_u + A J' lambda, all integers: z in units of 2^-z_bits, J of 2^-J_bits, and lambda takes what is left.
  Tableau t{.entry = product(product(J, A), J.transpose()),
            .constant = product(J, z_u).col(0),
            .row = {},
            .pushes = std::vector<char>(Tableau::at(m), 0)};
  std::vector<char> free(Tableau::at(m), 0), silent(Tableau::at(m), 0);
  for (Index i = 0; i < m; ++i) {
    t.row.push_back(i);
    free[Tableau::at(i)] = p.is_equality(i);
    if (std::isfinite(p.c[i]))
      t.constant[i] = minus(t.constant[i], to_integer(p.c[i], J_bits + z_bits));
    else
      silent[Tableau::at(i)] = 1;
  }

  for (Index i = 0; i < m; ++i) {
    if (!free[Tableau::at(i)]) continue;
    if (t.entry(i, i) != 0)
      t.exchange_pair(i);
    else if (t.constant[i] != 0)
      return infeasible_by(t, i, m);
  }
  // free and silent stand for positions: only inequality rows with a c change places below.
  const auto least = [&](const auto& wanted) {
    Index best = -1;
    for (Index i = 0; i < m; ++i)
      if (!free[Tableau::at(i)] && !silent[Tableau::at(i)] && wanted(i) &&
          (best < 0 || t.row[Tableau::at(i)] < t.row[Tableau::at(best)]))
        best = i;
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
  Integers push = Integers::Zero(m, 1);
  for (Index i = 0; i < m; ++i)
    if (t.pushes[Tableau::at(i)]) {
      push(t.row[Tableau::at(i)], 0) = t.constant[i];
      found.lambda[t.row[Tableau::at(i)]] =
          std::ldexp(quotient(times(t.constant[i], d), t.denominator), J_bits - M_bits - z_bits);
    }
  const Integers moved = product(A, product(J.transpose(), push));
  for (Index j = 0; j < n; ++j)
    found.z[j] = std::ldexp(quotient(minus(times(z_u(j, 0), t.denominator), -moved(j, 0)), t.denominator), -z_bits);
  return found;
}

}  // namespace

std::optional<Reference> exact_answer(const Problem& problem) {
  try {
    return solve(problem);
  } catch (const TooLarge&) {
    return {};
  }
}

}  // namespace zwang

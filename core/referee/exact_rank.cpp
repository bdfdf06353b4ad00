#include <zwang/core/referee/exact_rank.h>

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace zwang {
namespace {

__extension__ using Wide = unsigned __int128;

// The integers modulo p.
struct Field {
  std::uint64_t p;

  std::uint64_t times(std::uint64_t a, std::uint64_t b) const {
    return static_cast<std::uint64_t>(static_cast<Wide>(a) * b % p);
  }
  std::uint64_t minus(std::uint64_t a, std::uint64_t b) const { return a >= b ? a - b : a + (p - b); }
  std::uint64_t power(std::uint64_t base, std::uint64_t exponent) const {
    std::uint64_t result = 1;
    for (; exponent > 0; exponent >>= 1, base = times(base, base))
      if (exponent & 1) result = times(result, base);
    return result;
  }
  std::uint64_t inverse(std::uint64_t a) const { return power(a, p - 2); }
  std::uint64_t of(double x) const {
    int e = 0;
    const double mantissa = std::ldexp(std::frexp(std::abs(x), &e), 53);
    e -= 53;
    const std::uint64_t scale =
        e >= 0 ? power(2, static_cast<std::uint64_t>(e)) : power((p + 1) / 2, static_cast<std::uint64_t>(-e));
    const std::uint64_t value = times(static_cast<std::uint64_t>(mantissa) % p, scale);
    return x < 0 ? minus(0, value) : value;
  }
};

// Two of 61 bits, drawn by each process: no problem can be made so that they divide its minors.
const std::array<std::uint64_t, 2>& primes() {
  static const std::array<std::uint64_t, 2> drawn = [] {
    std::random_device device;
    const auto draw = [&] {
      for (;;) {
        const std::uint64_t bits = (static_cast<std::uint64_t>(device()) << 32 | device()) >> 4;
        const std::uint64_t n = bits | std::uint64_t{1} << 60 | 1;
        // No composite below 2^64 passes GMP's tests (Baillie & Wagstaff 1980).
        if (mpz_probab_prime_p(mpz_class(n).get_mpz_t(), 25) > 0) return n;
      }
    };
    const std::uint64_t first = draw();
    for (;;)
      if (const std::uint64_t second = draw(); second != first) return std::array{first, second};
  }();
  return drawn;
}

using Row = std::vector<std::uint64_t>;

class Elimination {
 public:
  Elimination(const RowMatrix& J, const Vector& c, std::uint64_t prime) : J_(J), c_(c), f_{prime} {}

  // How row i depends on the independent rows so far; an independent one joins them.
  Consistency add(Index i) {
    Row row = reduced(i);
    std::size_t pivot = 0;
    while (pivot < columns() && row[pivot] == 0) ++pivot;
    if (pivot == columns()) return row.back() == 0 ? Consistency::consistent : Consistency::contradictory;
    const std::uint64_t scale = f_.inverse(row[pivot]);
    for (std::uint64_t& x : row) x = f_.times(x, scale);
    pivot_.push_back(pivot);
    row_.push_back(std::move(row));
    return Consistency::independent;
  }

 private:
  std::size_t columns() const { return at(J_.cols()); }
  Row reduced(Index i) const {
    Row row(columns() + 1, 0);
    for (RowMatrix::InnerIterator it(J_, i); it; ++it) row[at(it.col())] = f_.of(it.value());
    row.back() = f_.of(c_[i]);
    for (std::size_t k = 0; k < row_.size(); ++k) {
      const std::uint64_t factor = row[pivot_[k]];
      if (factor == 0) continue;
      for (std::size_t j = 0; j < row.size(); ++j)
        if (row_[k][j] != 0) row[j] = f_.minus(row[j], f_.times(factor, row_[k][j]));
    }
    return row;
  }

  const RowMatrix& J_;
  const Vector& c_;
  Field f_;
  std::vector<Row> row_;
  std::vector<std::size_t> pivot_;
};

}  // namespace

Consistency exact_consistency(const RowMatrix& J, const Vector& c, std::span<const Index> basis,
                              std::span<const Index> more) {
  for (const std::uint64_t prime : primes()) {
    Elimination elimination(J, c, prime);
    for (const Index i : basis)
      if (elimination.add(i) != Consistency::independent) return Consistency::independent;
    for (const Index i : more)
      if (const Consistency found = elimination.add(i); found != Consistency::consistent) return found;
  }
  return Consistency::consistent;
}

ExactBasis exact_basis(const RowMatrix& J, const Vector& c, std::span<const Index> rows) {
  ExactBasis basis;
  Elimination elimination(J, c, primes()[0]), again(J, c, primes()[1]);
  for (const Index i : rows) {
    const Consistency found = elimination.add(i), second = again.add(i);
    if (found == Consistency::independent) basis.rows.push_back(i);
    if (found == Consistency::contradictory || second != found) basis.contradictory.push_back(i);
  }
  return basis;
}

}  // namespace zwang

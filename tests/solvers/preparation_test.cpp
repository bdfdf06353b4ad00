// What solvers do before they solve grows with the non-zeros of the problem, on walls up to each solver's own limit:
// nobody is charged for a dense matrix that is not the method itself.
#include <zwang/core/problem/preparation.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/ipopt/ipopt_method.h>
#include <zwang/solvers/registry.h>

// A double that counts its arithmetic.
struct Counted {
  double x = 0;
  static inline long operations = 0;

  Counted() = default;
  template <class T>
  requires std::is_arithmetic_v<T> Counted(T value) : x(static_cast<double>(value)) {}
  static Counted made(double value) {
    ++operations;
    return value;
  }
  friend Counted operator+(const Counted& a, const Counted& b) { return made(a.x + b.x); }
  friend Counted operator-(const Counted& a, const Counted& b) { return made(a.x - b.x); }
  friend Counted operator*(const Counted& a, const Counted& b) { return made(a.x * b.x); }
  friend Counted operator/(const Counted& a, const Counted& b) { return made(a.x / b.x); }
  Counted operator-() const { return -x; }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator-=(const Counted& b) { return *this = *this - b; }
  Counted& operator*=(const Counted& b) { return *this = *this * b; }
  Counted& operator/=(const Counted& b) { return *this = *this / b; }
  friend bool operator==(const Counted& a, const Counted& b) { return a.x == b.x; }
  friend auto operator<=>(const Counted& a, const Counted& b) { return a.x <=> b.x; }
  explicit operator double() const { return x; }
};
inline Counted abs(const Counted& a) { return std::abs(a.x); }
inline Counted abs2(const Counted& a) { return a * a; }
inline Counted sqrt(const Counted& a) { return Counted::made(std::sqrt(a.x)); }
inline Counted ldexp(const Counted& a, int e) { return Counted::made(std::ldexp(a.x, e)); }
inline Counted frexp(const Counted& a, int* e) { return Counted::made(std::frexp(a.x, e)); }
inline bool isfinite(const Counted& a) { return std::isfinite(a.x); }

template <>
struct Eigen::NumTraits<Counted> : Eigen::NumTraits<double> {
  using Real = Counted;
  using NonInteger = Counted;
  using Nested = Counted;
  using Literal = Counted;
  enum { RequireInitialization = 1 };
};

namespace zwang {
namespace {

Problem wall(int bricks, Law law = Law::frictionless) {
  const std::string mu = law == Law::frictionless ? "" : ",mu=0.5";
  return under(law, make_scenes("wall(boxes=" + std::to_string(bricks) + mu + ")").at(0).problem);
}
// Under the first law that the solver takes.
Law law_of(const AnySolver& solver) {
  for (const Law law : {Law::frictionless, Law::coulomb})
    if (solver.supports(wall(4, law)).empty()) return law;
  return Law::convex;
}
double nonzeros(const Problem& p) { return static_cast<double>(p.M.nonZeros() + p.J.nonZeros()); }
double bytes() { return static_cast<double>(allocated_bytes()); }

TEST(Preparation, ArithmeticOfWhiteningGrowsWithTheNonZeros) {
  double before = std::numeric_limits<double>::infinity();
  for (const int bricks : {25, 100, 400, 1000}) {
    const Problem p = wall(bricks);
    const BasicProblem<Counted> counted = cast<Counted>(p);
    BasicWhitened<Counted> w;
    Counted::operations = 0;
    ASSERT_TRUE(w.build(counted));
    const double each = static_cast<double>(Counted::operations) / nonzeros(p);
    EXPECT_LE(each, 40) << bricks << " bricks";
    EXPECT_LE(each, 1.2 * before) << bricks << " bricks";
    before = each;
  }
}

class EverySolver : public testing::TestWithParam<std::string> {};

TEST_P(EverySolver, PreparesInMemoryThatGrowsWithTheNonZeros) {
  struct Size {
    double nonzeros = 0, bytes = 0, whole_bytes = 0;
  };
  std::vector<Size> sizes;
  const SolveOptions one_step{.max_iterations = 1};
  const std::set<std::string> sparse = {"pgs", "apgd", "projected_gradient", "newton", "cholesky", "ipopt"};
  const bool is_sparse = sparse.contains(GetParam());
  for (const int bricks : {4, 25, 100, 400}) {
    if (bricks > 100 && !is_sparse) break;  // what is dense takes minutes there
    // What runs in a program of its own is watched here.
    AnySolver solver = GetParam() == "ipopt" ? IpoptMethod() : make_solver(GetParam());
    const Problem p = wall(bricks, law_of(solver));
    if (!solver.supports(p).empty()) break;
    Size size{.nonzeros = nonzeros(p)};
    Solution s;
    const double before = bytes();
    {
      const Preparation::Watch watch(bytes);
      solver.solve(p, one_step, s);
      size.bytes = watch.sum();
    }
    size.whole_bytes = bytes() - before;
    std::printf("%s, %d bricks: %.0f non-zeros, %.0f bytes each (%.0f in the whole)\n", GetParam().c_str(), bricks,
                size.nonzeros, size.bytes / size.nonzeros, size.whole_bytes / size.nonzeros);
    EXPECT_GT(size.bytes, 0) << "its preparation is not marked";
    sizes.push_back(size);
  }
  ASSERT_FALSE(sizes.empty());
  for (const Size& size : sizes) EXPECT_LE(size.bytes, 1000 * size.nonzeros + 10000);
  for (std::size_t k = 2; k < sizes.size(); ++k) {
    const double growth = sizes[k].nonzeros / sizes[k - 1].nonzeros;
    EXPECT_LE(sizes[k].bytes, 1.5 * growth * sizes[k - 1].bytes);
  }

  // Methods that are sparse hold nothing dense at all.
  if (!is_sparse) return;
  ASSERT_EQ(sizes.size(), 4u);
  EXPECT_LE(sizes[3].whole_bytes, 2 * sizes[3].nonzeros / sizes[2].nonzeros * sizes[2].whole_bytes);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const SolverEntry& e : solvers()) all.push_back(e.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::ValuesIn(names()), [](const auto& i) { return i.param; });

// One within another counts once, nothing without a watch, and a watch starts at zero.
TEST(Preparation, IsAddedUpWhileItIsWatched) {
  static double clock;
  clock = 0;
  const auto work = [] {
    const Preparation outer;
    clock += 1;
    const Preparation inner;
    clock += 2;
  };
  work();
  for (int i = 0; i < 2; ++i) {
    const Preparation::Watch watch([] { return clock; });
    work();
    clock += 10;
    work();
    EXPECT_EQ(watch.sum(), 6);
  }
}

}  // namespace
}  // namespace zwang

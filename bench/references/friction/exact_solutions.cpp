#include <zwang/bench/references/friction/exact_solutions.h>

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/gauss_jordan.h>

namespace zwang {
namespace {

using referee::reduce;
using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using Exact = VectorX<Rational>;
using Rationals = Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // may have no rows
using Form = std::vector<std::pair<Index, Rational>>;                                        // sum of factor times row

constexpr std::size_t most_misses = 6;
constexpr Index most_contracting = 4;  // contacts: their Delassus matrix is eliminated

// What is tried for one equality row or contact: forces along edges, rows that hold, rows that may open.
struct Choice {
  std::vector<Form> pushes = {}, held = {}, kept = {};
};

Rationals stacked(const Rationals& above, const Rationals& below) {
  Rationals all(above.rows() + below.rows(), above.cols());
  all << above, below;
  return all;
}

// a x + a_0 of each row (a, a_0).
Exact values(const Rationals& forms, const Exact& x) { return forms * (Exact(x.size() + 1) << x, 1).finished(); }

// A vertex of the points with A x = b, a row (A, b), where all of asked (a, a_0) have a x + a_0 >= 0; empty where there
// is none. Solves the system. What it leaves open is asked to be zero in turn.
std::optional<Exact> vertex(Rationals& system, const Rationals& asked) {
  const Index unknowns = system.cols() - 1, rank = std::ssize(reduce(system, unknowns));
  const Exact right = system.col(unknowns);
  if ((right.tail(right.size() - rank).array() != 0).any()) return {};
  if (rank == unknowns) {
    const Exact x = right.head(rank);
    return (values(asked, x).array() >= 0).all() ? std::optional(x) : std::nullopt;
  }
  for (Rationals form : asked.rowwise()) {
    form(0, unknowns) *= -1;
    Rationals tight = stacked(system, form);
    if (std::ssize(reduce(tight, unknowns)) <= rank) continue;
    if (std::optional<Exact> x = vertex(tight, asked)) return x;
  }
  return {};
}

// Whether this vertex is the only point: no direction leaves it. One along which the forms that are zero stay so would
// be a line.
bool is_alone(Rationals system, const Rationals& asked, const Exact& x) {
  const Index unknowns = x.size();
  const Exact at_x = values(asked, x);
  Rationals zero(0, unknowns + 1);
  for (Index i = 0; i < asked.rows(); ++i)
    if (at_x[i] == 0) zero = stacked(zero, asked.row(i));
  system.col(unknowns).setZero();
  if (zero.rows() > 0) zero.col(unknowns).setZero();
  Rationals all = stacked(system, zero);
  if (std::ssize(reduce(all, unknowns)) < unknowns) return false;
  for (Index k = 0; k < unknowns; ++k)
    for (const int sign : {1, -1}) {
      Rationals way = Rationals::Zero(1, unknowns + 1);
      way(0, k) = sign;
      way(0, unknowns) = 1;
      Rationals leaving = stacked(system, way);
      if (vertex(leaving, zero)) return false;
    }
  return true;
}

Vector rounded(const Exact& v) { return v.cast<double>(); }

}  // namespace

struct ExactSolutions::Data {
  Rationals M, J, moves, W;  // moves: M^-1 J'
  Exact z_u, c;
  std::vector<Exact> z = {};  // solutions
  Rational free = 0;          // |z_u|_M^2
  const Problem problem;

  explicit Data(const Problem& p)
      : M(Matrix(p.M).cast<Rational>()), J(Matrix(p.J).cast<Rational>()), z_u(p.z_u.cast<Rational>()), problem(p) {
    c = p.c.unaryExpr([](double c_i) { return std::isfinite(c_i) ? c_i : 0; }).cast<Rational>();
    Rationals system(p.size(), p.size() + p.rows());
    system << M, J.transpose();
    reduce(system, p.size());
    moves = system.rightCols(p.rows());
    W = J * moves;
    free = squared(z_u);
  }

  Rational squared(const Exact& v) const { return v.dot(M * v); }
  Rational slack(const Form& form, const Exact& of) const {
    Rational sum = 0;
    for (const auto& [row, factor] : form) sum += factor * (J.row(row).dot(of) - c[row]);
    return sum;
  }
  Rational coupling(const Form& a, const Form& b) const {
    Rational sum = 0;
    for (const auto& [i, x] : a)
      for (const auto& [j, y] : b) sum += x * y * W(i, j);
    return sum;
  }

  std::vector<std::vector<Choice>> choices() const {
    std::vector<std::vector<Choice>> all;
    Rationals equalities(0, z_u.size());  // those that no others before them combine to: their forces are all there are
    for (Index i = 0; i < problem.rows(); ++i) {
      const Form row = {{i, 1}};
      if (problem.is_equality(i)) {
        Rationals more = stacked(equalities, J.row(i));
        const bool pushes = std::ssize(reduce(more, z_u.size())) == more.rows();
        if (pushes) equalities = std::move(more);
        all.push_back({{.pushes = std::vector<Form>(pushes ? 1 : 0, row), .held = {row}}});
        continue;
      }
      const Index n = i, t = i + 1, tangents = problem.has_tangents() ? problem.tangents(i) : 0;
      i += tangents;
      if (problem.c[n] == -std::numeric_limits<double>::infinity()) continue;
      if (tangents == 0 || problem.mu[n] == 0) {
        all.push_back({{.kept = {row}}, {.pushes = {row}, .held = {row}}});
        continue;
      }
      const Rational mu = problem.mu[n];
      const Form back = {{n, 1}, {t, -mu}}, forth = {{n, 1}, {t, mu}}, slip = {{t, 1}}, other_slip = {{t, -1}};
      if (!referee::slip_lifts(problem.law))
        all.push_back({{.kept = {back, forth}},
                       {.pushes = {back}, .held = {back}, .kept = {forth}},
                       {.pushes = {forth}, .held = {forth}, .kept = {back}},
                       {.pushes = {back, forth}, .held = {back, forth}}});
      else
        all.push_back({{.kept = {row}},
                       {.pushes = {back}, .held = {row}, .kept = {slip}},
                       {.pushes = {forth}, .held = {row}, .kept = {other_slip}},
                       {.pushes = {back, forth}, .held = {row, slip}}});
    }
    return all;
  }

  // Two solutions z, z' have |z - z'|^2 <= sum mu^2 |J_t (z - z')|^2 / theta for theta below the eigenvalues of W, for
  // both are convex answers that are lifted by mu times their slips: one solution where W > sum mu^2 tr W_tt.
  bool contracts() const {
    Rational theta = 0;
    for (Index i = 0, n = 0; i < problem.rows(); ++i)
      if (problem.is_tangent(i))
        theta += Rational(problem.mu[n]) * Rational(problem.mu[n]) * W(i, i);
      else
        n = i;
    Rationals rest = W;
    for (Index k = 0; k < rest.rows(); ++k) rest(k, k) -= theta;
    for (Index k = 0; k < rest.rows(); ++k) {
      if (rest(k, k) <= 0) return false;
      for (Index i = k + 1; i < rest.rows(); ++i)
        for (Index j = rest.rows(); j-- > k;) rest(i, j) -= rest(i, k) * rest(k, j) / rest(k, k);
    }
    return true;
  }
};

ExactSolutions::ExactSolutions(const Problem& problem) : data_(std::make_shared<Data>(problem)) {
  const std::vector<std::vector<Choice>> all = data_->choices();
  const Index n = problem.size();
  std::vector<std::size_t> chosen(all.size(), 0);
  for (bool more = true; more;) {
    Choice choice;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Choice& part = all[k][chosen[k]];
      choice.pushes.insert(choice.pushes.end(), part.pushes.begin(), part.pushes.end());
      choice.held.insert(choice.held.end(), part.held.begin(), part.held.end());
      choice.kept.insert(choice.kept.end(), part.kept.begin(), part.kept.end());
    }
    more = false;
    for (std::size_t k = 0; k < all.size() && !more; ++k) {
      more = ++chosen[k] < all[k].size();
      if (!more) chosen[k] = 0;
    }

    const Index unknowns = std::ssize(choice.pushes);
    Rationals edges = Rationals::Zero(unknowns, n);
    for (Index k = 0; k < unknowns; ++k)
      for (const auto& [row, factor] : choice.pushes[at(k)]) edges.row(k) += factor * data_->J.row(row);
    if (unknowns > n || std::ssize(reduce(edges, n)) < unknowns) continue;
    const auto equations_of = [&](const std::vector<Form>& forms, int sign) {
      Rationals rows(std::ssize(forms), unknowns + 1);
      for (Index i = 0; i < rows.rows(); ++i) {
        for (Index k = 0; k < unknowns; ++k) rows(i, k) = data_->coupling(forms[at(i)], choice.pushes[at(k)]);
        rows(i, unknowns) = sign * data_->slack(forms[at(i)], data_->z_u);
      }
      return rows;
    };
    const Rationals equations = equations_of(choice.held, -1);
    Rationals system = equations, asked = equations_of(choice.kept, 1);
    for (Index k = 0; k < unknowns; ++k)
      if (!problem.is_equality(choice.pushes[at(k)][0].first))
        asked = stacked(asked, Rationals::Identity(unknowns, unknowns + 1).row(k));
    const std::optional<Exact> right = vertex(system, asked);
    if (std::ssize(reduce(system, unknowns)) < unknowns && (!right || !is_alone(equations, asked, *right))) {
      complete_ = complete_ && !right;
      continue;
    }
    const Exact rest = system.col(unknowns);
    if ((rest.tail(rest.size() - unknowns).array() != 0).any()) continue;
    const Exact force = right ? *right : Exact(rest.head(unknowns));

    Exact lambda = Exact::Zero(problem.rows());
    for (Index k = 0; k < unknowns; ++k)
      for (const auto& [row, factor] : choice.pushes[at(k)]) lambda[row] += factor * force[k];
    Exact z = data_->z_u + data_->moves * lambda;
    if (right && std::ranges::find(data_->z, z) == data_->z.end()) {
      solutions_.push_back({rounded(z), rounded(lambda)});
      data_->z.push_back(std::move(z));
    } else if (!right && misses_.size() < most_misses) {
      misses_.push_back({rounded(z), rounded(lambda)});
    }
  }
}

ExactSolutions::ExactSolutions(const Problem& problem, const Vector& z, const Vector& lambda)
    : data_(std::make_shared<Data>(problem)), solutions_{{z, lambda}} {
  data_->z.push_back(z.cast<Rational>());
  const auto contacts = std::ranges::count(problem.kind, RowKind::inequality);
  complete_ = !referee::slip_lifts(problem.law) || (contacts <= most_contracting && data_->contracts());
}

ExactSolutions::Range ExactSolutions::error(const Vector& given) const {
  const Exact z = given.cast<Rational>();
  const auto root = [](const Rational& x, const Rational& y) {
    if (x == 0 || y == 0) return x == 0 ? 0. : std::sqrt(x.convert_to<double>()) / std::numeric_limits<double>::min();
    return std::sqrt(Rational(x / y).convert_to<double>());
  };
  Range range{0, std::numeric_limits<double>::infinity()};
  for (const Exact& known : data_->z)
    range.high = std::min(range.high, root(data_->squared(z - known), std::max(data_->free, data_->squared(known))));
  if (complete_) return {range.high, range.high};
  // Every solution meets these rows, and is longer than this one by its distance at most.
  const Rational size = std::max(data_->free, data_->squared(z));
  for (Index i = 0; i < data_->problem.rows(); ++i) {
    const Rational s = data_->slack({{i, 1}}, z), g = data_->W(i, i);
    if (data_->problem.is_tangent(i) || !std::isfinite(data_->problem.c[i]) || g == 0) continue;
    if (s > 0 && !data_->problem.is_equality(i)) continue;
    const double off = root(s * s / g, size);
    range.low = std::max(range.low, std::isinf(off) ? 1 : off / (1 + off));
  }
  return range;
}

double ExactSolutions::motions() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Exact& z : data_->z) {
    const Rational way = data_->squared(z - data_->z_u);
    if (way == 0) return 0;
    if (data_->free > 0) least = std::min(least, std::sqrt(Rational(way / data_->free).convert_to<double>()));
  }
  return least;
}

std::optional<ExactSolutions> enumerate_planar(const Problem& problem) {
  constexpr int most_contacts = 6;
  int contacts = 0;
  for (Index i = 0; i < problem.rows(); ++i) {
    if (problem.is_equality(i)) continue;
    const Index tangents = problem.has_tangents() ? problem.tangents(i) : 0;
    contacts += std::isfinite(problem.c[i]);
    if (contacts > most_contacts || (tangents > 1 && problem.mu[i] > 0)) return {};
    i += tangents;
  }
  return ExactSolutions(problem);
}

}  // namespace zwang

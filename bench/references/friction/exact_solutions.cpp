#include <zwang/bench/references/friction/exact_solutions.h>

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include <zwang/core/referee/friction/law.h>

namespace zwang {
namespace {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using Exact = std::vector<Rational>;
using Form = std::vector<std::pair<Index, Rational>>;  // sum of factor times row

constexpr std::size_t most_misses = 6;
constexpr Index most_contracting = 4;  // contacts: their Delassus matrix is eliminated

// What is tried for one equality row or contact: forces along edges, rows that hold, rows that may open.
struct Choice {
  std::vector<Form> pushes = {}, held = {}, kept = {};
};

// Gauss and Jordan on the first `columns` columns: the pivots' columns, whose rows come first.
std::vector<std::size_t> reduce(std::vector<Exact>& rows, std::size_t columns) {
  std::vector<std::size_t> pivots;
  for (std::size_t j = 0; j < columns && pivots.size() < rows.size(); ++j) {
    Exact& top = rows[pivots.size()];
    const auto below = rows.begin() + static_cast<std::ptrdiff_t>(pivots.size());
    const auto found = std::find_if(below, rows.end(), [j](const Exact& row) { return row[j] != 0; });
    if (found == rows.end()) continue;
    std::swap(*found, top);
    const Rational pivot = top[j];
    for (Rational& x : top) x /= pivot;
    for (Exact& row : rows) {
      const Rational factor = row[j];
      if (&row == &top || factor == 0) continue;
      for (std::size_t k = j; k < row.size(); ++k)
        if (top[k] != 0) row[k] -= factor * top[k];
    }
    pivots.push_back(j);
  }
  return pivots;
}

// a x + a_0.
Rational value(const Exact& form, const Exact& x) {
  Rational sum = form.back();
  for (std::size_t k = 0; k < x.size(); ++k) sum += form[k] * x[k];
  return sum;
}

// A vertex of the points with A x = b, a row (A, b), where all of asked (a, a_0) have a x + a_0 >= 0; empty where there
// is none. Solves the system. What it leaves open is asked to be zero in turn.
std::optional<Exact> vertex(std::vector<Exact>& system, const std::vector<Exact>& asked, std::size_t unknowns) {
  const std::size_t rank = reduce(system, unknowns).size();
  for (std::size_t k = rank; k < system.size(); ++k)
    if (system[k].back() != 0) return {};
  if (rank == unknowns) {
    Exact x;
    for (std::size_t k = 0; k < unknowns; ++k) x.push_back(system[k].back());
    if (std::ranges::all_of(asked, [&](const Exact& form) { return value(form, x) >= 0; })) return x;
    return {};
  }
  for (Exact form : asked) {
    std::vector<Exact> tight = system;
    form.back() = -form.back();
    tight.push_back(std::move(form));
    if (reduce(tight, unknowns).size() <= rank) continue;
    if (std::optional<Exact> x = vertex(tight, asked, unknowns)) return x;
  }
  return {};
}

// Whether this vertex is the only point: no direction leaves it. One along which the forms that are zero stay so would
// be a line.
bool is_alone(std::vector<Exact> system, std::vector<Exact> asked, const Exact& x) {
  const std::size_t unknowns = x.size();
  std::erase_if(asked, [&](const Exact& form) { return value(form, x) != 0; });
  for (std::vector<Exact>* rows : {&system, &asked})
    for (Exact& row : *rows) row.back() = 0;
  std::vector<Exact> all = system;
  all.insert(all.end(), asked.begin(), asked.end());
  if (reduce(all, unknowns).size() < unknowns) return false;
  for (std::size_t k = 0; k < unknowns; ++k)
    for (const int sign : {1, -1}) {
      std::vector<Exact> leaving = system;
      leaving.emplace_back(unknowns + 1, 0);
      leaving.back()[k] = sign;
      leaving.back().back() = 1;
      if (vertex(leaving, asked, unknowns)) return false;
    }
  return true;
}

Exact exactly(const Vector& v) { return {v.begin(), v.end()}; }

Rational dot(const Exact& a, const Exact& b) {
  Rational sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] != 0 && b[k] != 0) sum += a[k] * b[k];
  return sum;
}

std::vector<Exact> rows_of(const Matrix& A) {
  std::vector<Exact> rows;
  for (Index i = 0; i < A.rows(); ++i) rows.push_back(A.cols() > 0 ? exactly(A.row(i)) : Exact());
  return rows;
}

Vector rounded(const Exact& v) {
  Vector out(std::ssize(v));
  for (Index k = 0; k < out.size(); ++k) out[k] = v[at(k)].convert_to<double>();
  return out;
}

}  // namespace

struct ExactSolutions::Data {
  std::vector<Exact> M, J, moves, W;  // moves: M^-1 J', a row each
  Exact z_u, c;
  std::vector<Exact> z = {};  // solutions
  Rational free = 0;          // |z_u|_M^2
  const Problem problem;

  explicit Data(const Problem& p) : M(rows_of(Matrix(p.M))), J(rows_of(Matrix(p.J))), z_u(exactly(p.z_u)), problem(p) {
    for (const double c_i : p.c) c.emplace_back(std::isfinite(c_i) ? c_i : 0);
    std::vector<Exact> system = M;
    for (std::size_t j = 0; j < system.size(); ++j)
      for (const Exact& row : J) system[j].push_back(row[j]);
    reduce(system, M.size());
    for (std::size_t i = 0; i < J.size(); ++i) {
      moves.emplace_back();
      for (const Exact& row : system) moves[i].push_back(row[M.size() + i]);
    }
    for (const Exact& row : J) {
      W.emplace_back();
      for (const Exact& move : moves) W.back().push_back(dot(row, move));
    }
    free = squared(z_u);
  }

  Rational squared(const Exact& v) const {
    Rational sum = 0;
    for (std::size_t j = 0; j < v.size(); ++j) sum += v[j] * dot(M[j], v);
    return sum;
  }
  Exact minus(Exact a, const Exact& b) const {
    for (std::size_t j = 0; j < a.size(); ++j) a[j] -= b[j];
    return a;
  }
  Rational slack(const Form& form, const Exact& of) const {
    Rational sum = 0;
    for (const auto& [row, factor] : form) sum += factor * (dot(J[at(row)], of) - c[at(row)]);
    return sum;
  }
  Rational coupling(const Form& a, const Form& b) const {
    Rational sum = 0;
    for (const auto& [i, x] : a)
      for (const auto& [j, y] : b) sum += x * y * W[at(i)][at(j)];
    return sum;
  }

  std::vector<std::vector<Choice>> choices() const {
    std::vector<std::vector<Choice>> all;
    std::vector<Exact> equalities;  // those that no others before them combine to: their forces are all there are
    for (Index i = 0; i < problem.rows(); ++i) {
      const Form row = {{i, 1}};
      if (problem.is_equality(i)) {
        std::vector<Exact> more = equalities;
        more.push_back(J[at(i)]);
        const bool pushes = reduce(more, z_u.size()).size() > equalities.size();
        if (pushes) equalities.push_back(J[at(i)]);
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
        theta += Rational(problem.mu[n]) * Rational(problem.mu[n]) * W[at(i)][at(i)];
      else
        n = i;
    std::vector<Exact> rest = W;
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k][k] -= theta;
    for (std::size_t k = 0; k < rest.size(); ++k) {
      if (rest[k][k] <= 0) return false;
      for (std::size_t i = k + 1; i < rest.size(); ++i)
        for (std::size_t j = rest.size(); j-- > k;) rest[i][j] -= rest[i][k] * rest[k][j] / rest[k][k];
    }
    return true;
  }
};

ExactSolutions::ExactSolutions(const Problem& problem) : data_(std::make_shared<Data>(problem)) {
  const std::vector<std::vector<Choice>> all = data_->choices();
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

    const std::size_t unknowns = choice.pushes.size();
    std::vector<Exact> edges, system, asked;
    for (const Form& push : choice.pushes) {
      edges.emplace_back(data_->z_u.size(), 0);
      for (const auto& [row, factor] : push)
        for (std::size_t j = 0; j < edges.back().size(); ++j) edges.back()[j] += factor * data_->J[at(row)][j];
    }
    if (unknowns > data_->z_u.size() || reduce(edges, data_->z_u.size()).size() < unknowns) continue;
    const auto row_of = [&](const Form& form, int sign) {
      Exact row;
      for (const Form& push : choice.pushes) row.push_back(data_->coupling(form, push));
      row.push_back(sign * data_->slack(form, data_->z_u));
      return row;
    };
    for (const Form& form : choice.held) system.push_back(row_of(form, -1));
    for (const Form& form : choice.kept) asked.push_back(row_of(form, 1));
    for (std::size_t k = 0; k < unknowns; ++k) {
      if (problem.is_equality(choice.pushes[k][0].first)) continue;
      asked.emplace_back(unknowns + 1, 0);
      asked.back()[k] = 1;
    }
    const std::vector<Exact> equations = system;
    const std::optional<Exact> right = vertex(system, asked, unknowns);
    if (reduce(system, unknowns).size() < unknowns && (!right || !is_alone(equations, asked, *right))) {
      complete_ = complete_ && !right;
      continue;
    }
    if (std::any_of(system.begin() + static_cast<std::ptrdiff_t>(unknowns), system.end(),
                    [](const Exact& row) { return row.back() != 0; }))
      continue;
    const auto force = [&](std::size_t k) { return right ? (*right)[k] : system[k].back(); };

    Exact z = data_->z_u, lambda(data_->J.size(), 0);
    for (std::size_t k = 0; k < unknowns; ++k)
      for (const auto& [row, factor] : choice.pushes[k]) lambda[at(row)] += factor * force(k);
    for (std::size_t i = 0; i < lambda.size(); ++i)
      for (std::size_t j = 0; j < z.size() && lambda[i] != 0; ++j) z[j] += lambda[i] * data_->moves[i][j];
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
  data_->z.push_back(exactly(z));
  const auto contacts = std::ranges::count(problem.kind, RowKind::inequality);
  complete_ = !referee::slip_lifts(problem.law) || (contacts <= most_contracting && data_->contracts());
}

ExactSolutions::Range ExactSolutions::error(const Vector& given) const {
  const Exact z = exactly(given);
  const auto root = [](const Rational& x, const Rational& y) {
    if (x == 0 || y == 0) return x == 0 ? 0. : std::sqrt(x.convert_to<double>()) / std::numeric_limits<double>::min();
    return std::sqrt(Rational(x / y).convert_to<double>());
  };
  Range range{0, std::numeric_limits<double>::infinity()};
  for (const Exact& known : data_->z)
    range.high = std::min(range.high,
                          root(data_->squared(data_->minus(z, known)), std::max(data_->free, data_->squared(known))));
  if (complete_) return {range.high, range.high};
  // Every solution meets these rows, and is longer than this one by its distance at most.
  const Rational size = std::max(data_->free, data_->squared(z));
  for (Index i = 0; i < data_->problem.rows(); ++i) {
    const Rational s = data_->slack({{i, 1}}, z), g = data_->W[at(i)][at(i)];
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
    const Rational way = data_->squared(data_->minus(z, data_->z_u));
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

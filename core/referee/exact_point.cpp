#include <gmpxx.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <zwang/core/referee/exact_point.h>
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/gauss_jordan.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::reduce;
using referee::slip_lifts;
using Rational = mpq_class;
using Exact = VectorX<Rational>;
using Rationals = Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Form = std::vector<std::pair<Index, Rational>>;  // sum of factor times row

constexpr double most_products = 30000;  // of an inverse of M and a matrix of Delassus
constexpr std::size_t most_edges = 8;    // of which all sets are tried
constexpr int simple = 30;               // bits: what ran out of digits may be a simple number

bool holds_beyond(const Rationals& rows, std::size_t rank) {
  return (rows.rightCols<1>().bottomRows(rows.rows() - static_cast<Index>(rank)).array() == Rational(0)).all();
}

std::optional<Rational> root(const Rational& square) {
  if (!mpz_perfect_square_p(square.get_num_mpz_t()) || !mpz_perfect_square_p(square.get_den_mpz_t())) return {};
  return Rational(sqrt(square.get_num()), sqrt(square.get_den()));
}

// x as a multiple of 2^-30 of `size`.
double simplified(double x, double size) {
  if (!(size > 0)) return x;
  const int unit = std::ilogb(size) - simple;
  return std::ldexp(std::round(std::ldexp(x, -unit)), unit);
}

// A force that a contact or an equality row may have.
struct Edge {
  Index row;         // the normal one
  Form push;         // what it is a sum of
  bool free = true;  // of any sign; the cone is looked at afterwards
  double guess = 0;
};

class ExactSearch {
 public:
  ExactSearch(const Problem& problem, const Vector& z)
      : p_(problem),
        M_(Matrix(problem.M).cast<Rational>()),
        J_(Matrix(problem.J).cast<Rational>()),
        z_u_(problem.z_u.cast<Rational>()),
        z_(z.cast<Rational>()),
        c_(problem.c.unaryExpr([](double c) { return std::isfinite(c) ? c : 0; }).cast<Rational>()) {}

  // z as it stands.
  bool forces_at(const Exact& z, std::span<const Vector> guesses) {
    const Exact force = M_ * (z - z_u_);
    std::vector<Edge> edges;
    for (Index i = 0; i < p_.rows(); i += size(i))
      if (counts(i) && !add_edges(i, z, edges)) return false;
    for (const Vector& guess : guesses) {
      for (Edge& edge : edges) edge.guess = guessed(edge, guess);
      std::ranges::stable_sort(edges, {}, [](const Edge& e) { return -std::abs(e.guess); });
      const double largest = edges.empty() ? 0 : std::abs(edges[0].guess);
      for (const Frozen frozen : {Frozen::guessed, Frozen::simple, Frozen::nothing}) {
        const Index count = std::ssize(edges);
        Rationals system = Rationals::Zero(z.size(), count + 1);
        for (Index k = 0; k < count; ++k)
          for (const auto& [i, factor] : edges[at(k)].push) system.col(k) += factor * J_.row(i).transpose();
        system.col(count) = force;
        const std::vector<Index> pivots = reduce(system, count);
        if (!holds_beyond(system, pivots.size())) return false;
        Exact weights = Exact::Zero(count);
        for (Index k = 0; k < count && frozen != Frozen::nothing; ++k) {
          if (std::ranges::find(pivots, k) != pivots.end()) continue;
          const double guessed = edges[at(k)].guess;
          weights[k] = frozen == Frozen::simple ? simplified(guessed, largest) : guessed;
          system.col(count) -= system.col(k) * weights[k];
        }
        for (std::size_t r = 0; r < pivots.size(); ++r) weights[pivots[r]] = system(static_cast<Index>(r), count);
        if (take(z, edges, weights)) return true;
        if (pivots.size() == edges.size()) break;
      }
    }
    return false;
  }

  // Sets of edges near z.
  void sets_of_edges(std::span<const Vector> guesses) {
    prepare();
    std::vector<Edge> edges = edges_near();
    std::vector<Edge> chosen;
    for (const Vector& guess : guesses) {
      for (Edge& edge : edges) edge.guess = guessed(edge, guess);
      chosen.clear();
      for (const Edge& edge : edges)
        if (edge.free || edge.guess > 0) chosen.push_back(edge);
      std::ranges::stable_sort(chosen, {}, [](const Edge& e) { return -std::abs(e.guess); });
      if (solve(chosen) && is_close()) return;
    }
    if (edges.size() > most_edges) return;
    for (std::size_t set = 0; set < std::size_t{1} << edges.size(); ++set) {
      chosen.clear();
      for (std::size_t k = 0; k < edges.size(); ++k)
        if (set >> k & 1) chosen.push_back(edges[k]);
      if (std::ssize(chosen) <= z_.size() && solve(chosen) && is_close()) return;
    }
  }

  const std::optional<ExactPoint>& best() const { return best_; }

 private:
  enum class Frozen { guessed, simple, nothing };  // where forces that are free to change stay

  // Of a contact or an equality row: the rows stored, and those of its cone.
  Index size(Index i) const { return 1 + (p_.has_tangents() && !p_.is_equality(i) ? p_.tangents(i) : 0); }
  Index tangents(Index i) const { return size(i) > 1 && p_.mu[i] > 0 ? size(i) - 1 : 0; }
  bool counts(Index i) const { return p_.c[i] != -infinity; }

  Rational squared(const Exact& v) const { return v.dot(M_ * v); }
  Rational slack(Index i, const Exact& z) const { return J_.row(i).dot(z) - c_[i]; }

  // The edges of a contact with one tangent: n - mu t and n + mu t.
  Edge side(Index i, int sign) const { return {i, {{i, 1}, {i + 1, sign * Rational(p_.mu[i])}}, false}; }

  // Forces that a contact may have at z. False where z breaks its row.
  bool add_edges(Index i, const Exact& z, std::vector<Edge>& edges) const {
    const Rational normal = slack(i, z);
    if (p_.is_equality(i)) {
      edges.push_back({i, {{i, 1}}});
      return normal == 0;
    }
    const Index t = tangents(i);
    if (normal < 0 || (normal > 0 && (t == 0 || slip_lifts(p_.law)))) return normal > 0;
    if (t == 0) {
      edges.push_back({i, {{i, 1}}, false});
      return true;
    }
    const Rational mu = p_.mu[i], first = slack(i + 1, z), second = t > 1 ? slack(i + 2, z) : Rational(0);
    const Rational slip = first * first + second * second;
    if (!slip_lifts(p_.law) && normal * normal != mu * mu * slip) return normal * normal > mu * mu * slip;
    if (slip == 0) {
      for (Index k = 0; k <= t; ++k) edges.push_back({i, {{i + k, 1}}});
      if (t == 1) {
        edges.resize(edges.size() - 2);
        edges.push_back(side(i, -1));
        edges.push_back(side(i, 1));
      }
      return true;
    }
    const std::optional<Rational> length = root(slip);
    if (!length) return true;  // forces that are not rational, or none
    Edge edge{i, {{i, 1}, {i + 1, -mu * first / *length}}, false};
    if (t > 1) edge.push.emplace_back(i + 2, -mu * second / *length);
    edges.push_back(std::move(edge));
    return true;
  }

  // How much of an edge is in forces.
  double guessed(const Edge& edge, const Vector& forces) const {
    const Index first = edge.push[0].first;
    if (forces.size() != p_.rows()) return 0;
    double guess = forces[first];
    if (edge.free) return guess;
    if (tangents(edge.row) == 1 && edge.push.size() > 1)
      guess = (guess + forces[first + 1] / p_.mu[first] * (edge.push[1].second > 0 ? 1 : -1)) / 2;
    const double size = std::abs(forces[first]);
    return guess > referee::mode_cut * size ? guess : 0;
  }

  // Does z with these forces solve the law?
  bool solves(const Exact& z, const Exact& lambda) const {
    for (Index i = 0; i < p_.rows(); i += size(i)) {
      if (!counts(i)) continue;
      const Rational normal = slack(i, z), &force = lambda[i];
      if (p_.is_equality(i)) {
        if (normal != 0) return false;
        continue;
      }
      const Index t = tangents(i);
      const Rational mu = t > 0 ? p_.mu[i] : 0.;
      Rational slip = 0, along = 0, work = 0;
      for (Index k = i + 1; k <= i + t; ++k) {
        const Rational s = slack(k, z);
        slip += s * s;
        along += lambda[k] * lambda[k];
        work += lambda[k] * s;
      }
      const Rational edge = mu * force;
      if (normal < 0 || force < 0 || along > edge * edge) return false;
      if (!slip_lifts(p_.law) && t > 0) {
        if (normal * normal < mu * mu * slip || force * normal + work != 0) return false;
      } else {
        // work = -|l_t| |s_t| and |l_t| = mu l_n, where it slides.
        if (force * normal != 0) return false;
        if (t > 0 && (work > 0 || work * work != edge * edge * slip)) return false;
      }
    }
    return true;
  }

  bool take(const Exact& z, const std::vector<Edge>& edges, const Exact& weights) {
    Exact lambda = Exact::Zero(J_.rows());
    for (Index k = 0; k < weights.size(); ++k) {
      if (!edges[at(k)].free && weights[k] < 0) return false;
      for (const auto& [row, factor] : edges[at(k)].push) lambda[row] += factor * weights[k];
    }
    if (!solves(z, lambda)) return false;
    const ExactPoint point{length(squared(z - z_)), length(squared(z))};
    if (std::isfinite(point.distance) && std::isfinite(point.size) && !(best_ && best_->distance <= point.distance))
      best_ = point;
    return best_.has_value();
  }
  static double length(const Rational& square) {
    const double value = square.get_d();
    return square == 0 ? 0 : referee::ordinary(value) && value > 0 ? std::sqrt(value) : infinity;
  }

  // M^-1 J', and what touches at z.
  void prepare() {
    Rationals system(M_.rows(), M_.cols() + J_.rows());
    system << M_, J_.transpose();
    reduce(system, M_.cols());
    moves_ = system.rightCols(J_.rows());
    W_ = J_ * moves_;
    free_slack_ = J_ * z_u_ - c_;
    motion_ = std::max(length(squared(z_)), length(squared(z_u_)));
    close_ = referee::sharp_enough * motion_;
  }
  std::vector<Edge> edges_near() const {
    std::vector<Edge> edges;
    const auto zero = [&](Index i) {
      return referee::touched_by_guess * motion_ * std::sqrt(std::max(0., W_(i, i).get_d()));
    };
    for (Index i = 0; i < p_.rows(); i += size(i)) {
      if (!counts(i)) continue;
      const double normal = slack(i, z_).get_d();
      const Index t = tangents(i);
      const double slip = t == 1 ? slack(i + 1, z_).get_d() : 0, mu = t == 1 ? p_.mu[i] : 0;
      if (p_.is_equality(i)) {
        edges.push_back({i, {{i, 1}}});
      } else if (t == 0 && normal <= zero(i)) {
        edges.push_back({i, {{i, 1}}, false});
      } else if (t == 1) {
        const double room = slip_lifts(p_.law) ? zero(i) : zero(i) + mu * zero(i + 1);
        for (const int sign : {-1, 1}) {
          const bool touches =
              slip_lifts(p_.law) ? normal <= room && sign * slip <= zero(i + 1) : normal + sign * mu * slip <= room;
          if (touches) edges.push_back(side(i, sign));
        }
      }
    }
    return edges;
  }

  // The z at which these edges push, and the rows hold that they ask for.
  bool solve(const std::vector<Edge>& edges) {
    const Index count = std::ssize(edges);
    Rationals system = Rationals::Zero(count, count + 1);
    for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
      Form held = edge->push;
      if (slip_lifts(p_.law) && tangents(edge->row) > 0) {
        const bool second =
            std::any_of(edges.begin(), edge, [&](const Edge& before) { return before.row == edge->row; });
        held = {{second ? edge->row + 1 : edge->row, 1}};
      }
      const Index r = edge - edges.begin();
      for (const auto& [i, a] : held) {
        for (Index k = 0; k < count; ++k)
          for (const auto& [j, b] : edges[at(k)].push) system(r, k) += a * b * W_(i, j);
        system(r, count) -= a * free_slack_[i];
      }
    }
    const std::vector<Index> pivots = reduce(system, count);
    if (!holds_beyond(system, pivots.size())) return false;
    Exact weights = Exact::Zero(count), z = z_u_;
    for (std::size_t r = 0; r < pivots.size(); ++r) {
      weights[pivots[r]] = system(static_cast<Index>(r), count);
      if (!edges[at(pivots[r])].free && weights[pivots[r]] < 0) return false;
    }
    for (Index k = 0; k < count; ++k)
      for (const auto& [row, factor] : edges[at(k)].push)
        if (weights[k] != 0) z += Rational(weights[k] * factor) * moves_.col(row);
    return take(z, edges, weights);
  }

  bool is_close() const { return best_ && best_->distance <= close_; }

  const Problem& p_;
  Rationals M_, J_, moves_, W_;  // moves: M^-1 J'
  Exact z_u_, z_, c_, free_slack_;
  double motion_ = 0, close_ = 0;
  std::optional<ExactPoint> best_;
};

}  // namespace

std::optional<ExactPoint> exact_point(const Problem& problem, const Vector& z, std::span<const Vector> near,
                                      std::span<const Vector> forces) {
  const auto n = static_cast<double>(problem.size()), m = static_cast<double>(problem.rows());
  if (n * n * (n + m) > most_products || !z.allFinite()) return {};
  ExactSearch search(problem, z);
  static const Vector none;
  std::vector<Vector> guesses(forces.begin(), forces.end());
  guesses.push_back(none);
  const auto holds = [&](const Vector& point) {
    const double size = point.size() > 0 ? point.lpNorm<Eigen::Infinity>() : 0;
    Vector rounded = point;
    for (double& entry : rounded) entry = simplified(entry, size);
    return point.allFinite() &&
           (search.forces_at(point.cast<Rational>(), guesses) || search.forces_at(rounded.cast<Rational>(), guesses));
  };
  if (holds(z) || std::ranges::any_of(near, holds)) return search.best();
  search.sets_of_edges(guesses);
  return search.best();
}

}  // namespace zwang

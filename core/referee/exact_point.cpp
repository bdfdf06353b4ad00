#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <zwang/core/referee/exact_point.h>
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::slip_lifts;
using Rational = mpq_class;
using Exact = std::vector<Rational>;
using Form = std::vector<std::pair<Index, Rational>>;  // sum of factor times row

constexpr double most_products = 30000;  // of an inverse of M and a matrix of Delassus
constexpr std::size_t most_edges = 8;    // of which all sets are tried
constexpr int simple = 30;               // bits: what ran out of digits may be a simple number

// Gauss and Jordan, the first columns first: the pivots' columns, whose rows come first.
std::vector<std::size_t> reduce(std::vector<Exact>& rows, std::size_t columns) {
  std::vector<std::size_t> pivots;
  for (std::size_t j = 0; j < columns && pivots.size() < rows.size(); ++j) {
    Exact& top = rows[pivots.size()];
    const auto below = rows.begin() + std::ssize(pivots);
    const auto found = std::find_if(below, rows.end(), [j](const Exact& row) { return row[j] != 0; });
    if (found == rows.end()) continue;
    std::swap(*found, top);
    const Rational pivot = top[j];
    for (std::size_t k = j; k < top.size(); ++k)
      if (top[k] != 0) top[k] /= pivot;
    for (Exact& row : rows) {
      if (&row == &top || row[j] == 0) continue;
      const Rational factor = row[j];
      for (std::size_t k = j; k < row.size(); ++k)
        if (top[k] != 0) row[k] -= factor * top[k];
    }
    pivots.push_back(j);
  }
  return pivots;
}

bool holds_beyond(const std::vector<Exact>& rows, std::size_t rank) {
  return std::all_of(rows.begin() + static_cast<std::ptrdiff_t>(rank), rows.end(),
                     [](const Exact& row) { return row.back() == 0; });
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
  ExactSearch(const Problem& problem, const Vector& z) : p_(problem), z_u_(exactly(problem.z_u)), z_(exactly(z)) {
    for (Index i = 0; i < p_.rows(); ++i) {
      J_.emplace_back(z_u_.size(), 0);
      for (RowMatrix::InnerIterator it(p_.J, i); it; ++it) J_.back()[at(it.col())] = it.value();
      c_.emplace_back(std::isfinite(p_.c[i]) ? p_.c[i] : 0);
    }
    for (std::size_t j = 0; j < z_u_.size(); ++j) M_.emplace_back(z_u_.size(), 0);
    for (Index j = 0; j < p_.M.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(p_.M, j); it; ++it) M_[at(it.row())][at(j)] = it.value();
  }

  // z as it stands.
  bool forces_at(const Exact& z, std::span<const Vector> guesses) {
    Exact moved = z;
    for (std::size_t j = 0; j < z.size(); ++j) moved[j] -= z_u_[j];
    std::vector<Edge> edges;
    for (Index i = 0; i < p_.rows(); i += size(i))
      if (counts(i) && !add_edges(i, z, edges)) return false;
    for (const Vector& guess : guesses) {
      for (Edge& edge : edges) edge.guess = guessed(edge, guess);
      std::ranges::stable_sort(edges, {}, [](const Edge& e) { return -std::abs(e.guess); });
      const double largest = edges.empty() ? 0 : std::abs(edges[0].guess);
      for (const Frozen frozen : {Frozen::guessed, Frozen::simple, Frozen::nothing}) {
        std::vector<Exact> system;
        for (std::size_t j = 0; j < z.size(); ++j) {
          Exact row;
          for (const Edge& edge : edges) {
            Rational sum = 0;
            for (const auto& [i, factor] : edge.push) sum += factor * J_[at(i)][j];
            row.push_back(sum);
          }
          row.push_back(dot(M_[j], moved));
          system.push_back(std::move(row));
        }
        const std::vector<std::size_t> pivots = reduce(system, edges.size());
        if (!holds_beyond(system, pivots.size())) return false;
        Exact weights(edges.size(), 0);
        for (std::size_t k = 0, pivot = 0; k < edges.size(); ++k) {
          if (pivot < pivots.size() && pivots[pivot] == k) {
            ++pivot;
          } else if (frozen != Frozen::nothing) {
            weights[k] = frozen == Frozen::simple ? simplified(edges[k].guess, largest) : edges[k].guess;
            for (std::size_t r = 0; r < pivots.size(); ++r) system[r].back() -= system[r][k] * weights[k];
          }
        }
        for (std::size_t r = 0; r < pivots.size(); ++r) weights[pivots[r]] = system[r].back();
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
      if (chosen.size() <= z_.size() && solve(chosen) && is_close()) return;
    }
  }

  const std::optional<ExactPoint>& best() const { return best_; }

  static Exact exactly(const Vector& v) { return {v.begin(), v.end()}; }

 private:
  enum class Frozen { guessed, simple, nothing };  // where forces that are free to change stay

  // Of a contact or an equality row: the rows stored, and those of its cone.
  Index size(Index i) const { return 1 + (p_.has_tangents() && !p_.is_equality(i) ? p_.tangents(i) : 0); }
  Index tangents(Index i) const { return size(i) > 1 && p_.mu[i] > 0 ? size(i) - 1 : 0; }
  bool counts(Index i) const { return p_.c[i] != -infinity; }

  static Rational dot(const Exact& a, const Exact& b) {
    Rational sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      if (a[k] != 0 && b[k] != 0) sum += a[k] * b[k];
    return sum;
  }
  Rational squared(const Exact& v) const {
    Rational sum = 0;
    for (std::size_t j = 0; j < v.size(); ++j)
      if (v[j] != 0) sum += v[j] * dot(M_[j], v);
    return sum;
  }
  Rational slack(Index i, const Exact& z) const { return dot(J_[at(i)], z) - c_[at(i)]; }

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
      const Rational normal = slack(i, z), &force = lambda[at(i)];
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
        along += lambda[at(k)] * lambda[at(k)];
        work += lambda[at(k)] * s;
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
    Exact lambda(J_.size(), 0);
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (!edges[k].free && weights[k] < 0) return false;
      for (const auto& [row, factor] : edges[k].push) lambda[at(row)] += factor * weights[k];
    }
    if (!solves(z, lambda)) return false;
    Exact off = z;
    for (std::size_t j = 0; j < off.size(); ++j) off[j] -= z_[j];
    const ExactPoint point{length(squared(off)), length(squared(z))};
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
    std::vector<Exact> system = M_;
    for (std::size_t j = 0; j < system.size(); ++j)
      for (const Exact& row : J_) system[j].push_back(row[j]);
    reduce(system, M_.size());
    for (std::size_t i = 0; i < J_.size(); ++i) {
      moves_.emplace_back();
      for (const Exact& row : system) moves_[i].push_back(row[M_.size() + i]);
    }
    for (const Exact& row : J_) {
      W_.emplace_back();
      for (const Exact& move : moves_) W_.back().push_back(dot(row, move));
      free_slack_.push_back(slack(std::ssize(free_slack_), z_u_));
    }
    motion_ = std::max(length(squared(z_)), length(squared(z_u_)));
    close_ = referee::sharp_enough * motion_;
  }
  std::vector<Edge> edges_near() const {
    std::vector<Edge> edges;
    const auto zero = [&](Index i) {
      return referee::touched_by_guess * motion_ * std::sqrt(std::max(0., W_[at(i)][at(i)].get_d()));
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
    std::vector<Exact> system;
    for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
      Form held = edge->push;
      if (slip_lifts(p_.law) && tangents(edge->row) > 0) {
        const bool second =
            std::any_of(edges.begin(), edge, [&](const Edge& before) { return before.row == edge->row; });
        held = {{second ? edge->row + 1 : edge->row, 1}};
      }
      Exact row(edges.size() + 1, 0);
      for (const auto& [i, a] : held) {
        for (std::size_t k = 0; k < edges.size(); ++k)
          for (const auto& [j, b] : edges[k].push) row[k] += a * b * W_[at(i)][at(j)];
        row.back() -= a * free_slack_[at(i)];
      }
      system.push_back(std::move(row));
    }
    const std::vector<std::size_t> pivots = reduce(system, edges.size());
    if (!holds_beyond(system, pivots.size())) return false;
    Exact weights(edges.size(), 0), z = z_u_;
    for (std::size_t r = 0; r < pivots.size(); ++r) {
      weights[pivots[r]] = system[r].back();
      if (!edges[pivots[r]].free && system[r].back() < 0) return false;
    }
    for (std::size_t k = 0; k < edges.size(); ++k)
      for (const auto& [row, factor] : edges[k].push)
        for (std::size_t j = 0; j < z.size() && weights[k] != 0; ++j) z[j] += weights[k] * factor * moves_[at(row)][j];
    return take(z, edges, weights);
  }

  bool is_close() const { return best_ && best_->distance <= close_; }

  const Problem& p_;
  std::vector<Exact> M_, J_, moves_, W_;  // moves: M^-1 J', a row each
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
    return point.allFinite() && (search.forces_at(ExactSearch::exactly(point), guesses) ||
                                 search.forces_at(ExactSearch::exactly(rounded), guesses));
  };
  if (holds(z) || std::ranges::any_of(near, holds)) return search.best();
  search.sets_of_edges(guesses);
  return search.best();
}

}  // namespace zwang

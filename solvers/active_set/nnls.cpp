#include <zwang/solvers/active_set/nnls.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/solver_entry.h>

namespace zwang {

// The equality rows' own solution y_E, and what is left of the other rows in the null space of G_E:
// g~ = (I - QQ') g, h~ = h - g . y_E. A row that lies in the span of the equality rows is left to the polish.
void Nnls::Method::eliminate(const Problem& p, bool project, const Deadline& deadline) {
  const Index n = p.size(), k = rows_.rows();
  active_.reset(rows_, deadline);
  column_.clear();
  column_.reserve(at(k));
  free_.clear();
  if (project)
    for (Index i = 0; i < k; ++i)
      if (rows_.equality[at(i)]) active_.append(i);
  const Index e = active_.size();
  work_.resize(std::min(n, k));
  auto t = work_.head(e);
  for (Index i = 0; i < e; ++i) t[i] = rows_.h[active_[i]];
  active_.qr().solve_transposed(t);
  y_E_.setZero(n);
  y_E_.noalias() += active_.qr().Q() * t;

  E_.resize(n + 1, k);
  h_.resize(k);
  length_.resize(k);
  for (Index i = 0; i < k; ++i) {
    if (project && rows_.equality[at(i)]) continue;
    deadline.keep();
    const Index j = static_cast<Index>(column_.size());
    auto g = E_.col(j).head(n);
    g.setZero();
    rows_.add(i, 1, g);
    t.noalias() = active_.qr().Q().transpose() * g;
    g.noalias() -= active_.qr().Q() * t;
    length_[j] = g.norm();
    if (!(length_[j] > tolerances::projected_out)) continue;
    g /= length_[j];
    h_[j] = (rows_.h[i] - rows_.dot(i, y_E_)) / length_[j];
    column_.push_back(i);
    free_.push_back(rows_.equality[at(i)]);
  }
}

// The equality rows' part of unit_, from the others': G_E' lambda_E = y - G_I' lambda_I, in the least-squares sense.
void Nnls::Method::balance(const Vector& y) {
  auto t = work_.head(active_.size());
  rest_ = y;
  for (Index i = 0; i < rows_.rows(); ++i)
    if (unit_[i] != 0) rows_.add(i, -unit_[i], rest_);
  t.noalias() = active_.qr().Q().transpose() * rest_;
  active_.qr().solve(t);
  for (Index i = 0; i < active_.size(); ++i) unit_[active_[i]] = t[i];
}

// The last iterate: y and the unit multipliers, into the solution.
void Nnls::Method::write_iterate(const Problem& p, Solution& s) {
  const Index n = p.size();
  const Vector& r = least_squares_.residual();
  unit_.setZero(rows_.rows());
  y_ = y_E_;
  if (sigma_ > 0 && r.size() == n + 1 && r[n] > 0) {
    y_.noalias() -= (sigma_ / r[n]) * r.head(n);
    for (const Index j : least_squares_.passive())
      unit_[column_[at(j)]] = sigma_ * least_squares_.x()[j] / (r[n] * length_[j]);
  }
  balance(y_);
  rows_.primal(p, y_, s.z);
  rows_.multipliers(p, unit_, s.lambda);
}

// Finds the active set. False when the solution is already complete: a limit was met, or the rows are infeasible.
bool Nnls::Method::least_distance(const Problem& p, const SolveOptions& options, const Deadline& deadline, bool polish,
                                  Solution& s) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const Index n = p.size(), columns = static_cast<Index>(column_.size());
  f_.setZero(n + 1);
  f_[n] = 1;
  sigma_ = 0;
  for (Index j = 0; j < columns; ++j) sigma_ = std::max(sigma_, free_[at(j)] ? std::abs(h_[j]) : h_[j]);
  if (sigma_ == 0) return true;  // the equality rows' solution violates nothing

  std::function<void()> observe;
  if (options.observe)
    observe = [&] {
      write_iterate(p, s);
      options.observe(least_squares_.iterations(), s.z, s.lambda);
    };
  const LawsonHanson::Limits limits{options.max_iterations, &deadline, observe ? &observe : nullptr};
  least_squares_.restart();
  constexpr int rounds = 12;
  for (int round = 0; round < rounds; ++round) {
    for (Index j = 0; j < columns; ++j) E_(n, j) = std::max(h_[j] / sigma_, -tolerances::horizon);
    const Status end = least_squares_.solve(E_.leftCols(columns), f_, free_, warm_, limits);
    s.iterations = least_squares_.iterations();
    if (end != Status::solved) {
      write_iterate(p, s);
      s.status = end;
      return false;
    }
    const Vector& r = least_squares_.residual();
    warm_.assign(least_squares_.passive().begin(), least_squares_.passive().end());

    // r = 0 up to rounding: the passive columns carry a Farkas vector, if it holds.
    if (r.norm() <= tolerances::zero_residual * eps * std::max(1.0, least_squares_.x().lpNorm<1>())) {
      unit_.setZero(rows_.rows());
      if (!polish) {
        for (const Index j : warm_) unit_[column_[at(j)]] = least_squares_.x()[j] / length_[j];
        y_.setZero(n);
        balance(y_);
        if (polish_.certify(p, rows_, unit_, s)) return false;
        s.status = Status::numerical_failure;
        s.message = "the least squares end without a residual, and without a proof that there is no solution";
        return false;
      }
      const Index e = active_.size();
      for (const Index j : warm_) unit_[j] = std::abs(least_squares_.x()[j]) / length_[j];
      std::sort(warm_.begin(), warm_.end(),
                [&](Index a, Index b) { return unit_[a] > unit_[b] || (unit_[a] == unit_[b] && a < b); });
      for (Index& j : warm_) j = column_[at(j)];
      if (polish_.certify(p, rows_, active_, warm_, s)) return false;
      while (active_.size() > e) active_.drop(active_.size() - 1);
      return true;
    }
    const double growth = r.head(n).norm() / r[n];
    if (!(growth > tolerances::outgrown) || round + 1 == rounds) break;
    sigma_ *= growth;
  }
  for (Index& j : warm_) j = column_[at(j)];
  return true;
}

void Nnls::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  const auto plain = [this](const Problem& q, const SolveOptions& o, Solution& t) {
    plain_.of(q.size(), q.rows()).solve(q, *this, o, t);
  };
  plain_.begin();
  if (reduce) return reduced_.solve(plain, p, options, polish, s);
  plain(p, options, s);
}

void Nnls::Method::solve(const Problem& p, const Nnls& settings, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows()), most = std::min(n + 1, m);
  storage_.require((n + 1) * m + 2 * (n + 1 + most) * most, options);
  if (!begin(rows_, p, options, deadline, s)) return;
  eliminate(p, settings.project, deadline);
  warm_.clear();
  warm_.reserve(at(rows_.rows()));
  for (const Index i : warm_rows_.find(p, rows_, options.warm_start)) {
    const auto place = std::lower_bound(column_.begin(), column_.end(), i);
    if (place != column_.end() && *place == i) warm_.push_back(place - column_.begin());
  }
  if (!least_distance(p, options, deadline, settings.polish, s)) return;
  if (!settings.polish) write_iterate(p, s);
  for (const Index i : warm_) active_.append(i);
  if (settings.polish)
    polish_.run(p, rows_, active_, options.tolerance, s);
  else
    polish_.judge(p, rows_, active_, options.tolerance, s);
  // Rows that fit nothing can leave an active set that polish cannot mend (1 in 25,000 fuzzed starts).
  if (s.status == Status::numerical_failure && options.warm_start) {
    SolveOptions cold = options;
    cold.warm_start = nullptr;
    cold.time_limit = deadline.left();
    solve(p, settings, cold, s);
    s.fallback = true;
  }
}

template SolverEntry entry<Nnls>(SolverEntry);

}  // namespace zwang

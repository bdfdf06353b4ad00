#include <zwang/solvers/active_set/least_distance.h>

#include <algorithm>
#include <cmath>

namespace zwang {

void LeastDistance::reset(const Whitened& rows, const Deadline& deadline) {
  w_ = &rows;
  deadline_ = &deadline;
  const Index n = rows.size(), k = rows.rows();
  equalities_.reset(rows, deadline);
  for (Index i = 0; i < k; ++i)
    if (rows.equality[at(i)]) equalities_.append(i);
  part_.resize(std::min(n, k));
  auto t = part_.head(equalities_.size());
  for (Index i = 0; i < t.size(); ++i) t[i] = rows.h[equalities_[i]];
  equalities_.qr().solve_transposed(t);
  y_E_.setZero(n);
  y_E_.noalias() += equalities_.qr().Q() * t;

  E_.resize(n + 1, k);
  h_.resize(k);
  length_.resize(k);
  column_.clear();
  for (std::vector<Index>* list : {&column_, &warm_, &pushing_}) list->reserve(at(k));
  for (Index i = 0; i < k; ++i) {
    if (rows.equality[at(i)]) continue;
    deadline.keep();
    project(i);
  }
  free_.assign(column_.size(), 0);
}

// What is left of an inequality row in the null space of the equality rows: g~ = (I - QQ') g, h~ = h - g . y_E. One
// that lies in their span is left to the polish.
void LeastDistance::project(Index row) {
  const Index j = columns();
  auto g = E_.col(j).head(w_->size());
  auto t = part_.head(equalities_.size());
  g.setZero();
  w_->add(row, 1, g);
  t.noalias() = equalities_.qr().Q().transpose() * g;
  g.noalias() -= equalities_.qr().Q() * t;
  length_[j] = g.norm();
  if (!(length_[j] > tolerances::projected_out)) return;
  g /= length_[j];
  h_[j] = (w_->h[row] - w_->dot(row, y_E_)) / length_[j];
  column_.push_back(row);
}

Status LeastDistance::solve(std::span<const Index> warm, int& iterations, int most_iterations,
                            const std::function<void()>& each) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const Index n = w_->size();
  infeasible_ = false;
  pushing_.clear();
  warm_.clear();
  for (const Index i : warm) {
    const auto place = std::ranges::lower_bound(column_, i);
    if (place != column_.end() && *place == i) warm_.push_back(place - column_.begin());
  }
  sigma_ = columns() > 0 ? std::max(0.0, h_.head(columns()).maxCoeff()) : 0;
  if (sigma_ == 0) return Status::solved;  // the equality rows' solution violates nothing
  f_.setZero(n + 1);
  f_[n] = 1;
  const Vector& r = least_squares_.residual();
  constexpr int rounds = 12;
  for (int round = 0; round < rounds; ++round) {
    for (Index j = 0; j < columns(); ++j) E_(n, j) = std::max(h_[j] / sigma_, -tolerances::horizon);
    const Status end =
        least_squares_.solve(E_.leftCols(columns()), f_, free_, warm_, iterations, {most_iterations, *deadline_, each});
    if (end != Status::solved) return end;
    warm_.assign(least_squares_.passive().begin(), least_squares_.passive().end());
    infeasible_ = r.norm() <= tolerances::zero_residual * eps * std::max(1.0, least_squares_.x().lpNorm<1>());
    const double growth = r.head(n).norm() / r[n];
    if (infeasible_ || !(growth > tolerances::outgrown) || round + 1 == rounds) break;
    sigma_ *= growth;
  }
  const auto lighter = [&](Index j) { return std::pair(-std::abs(least_squares_.x()[j]) / length_[j], j); };
  if (infeasible_) std::ranges::sort(warm_, {}, lighter);
  for (const Index j : warm_) pushing_.push_back(column_[at(j)]);
  return infeasible_ ? Status::infeasible : Status::solved;
}

void LeastDistance::locate(Vector& y, Vector& unit) {
  const Index n = w_->size();
  const Vector& r = least_squares_.residual();
  const bool has_point = !infeasible_ && sigma_ > 0 && r.size() == n + 1 && r[n] > 0;
  y = y_E_;
  if (has_point) y.noalias() -= (sigma_ / r[n]) * r.head(n);
  if (infeasible_) y.setZero();
  unit.setZero(w_->rows());
  if (has_point || infeasible_)
    for (const Index j : least_squares_.passive()) {
      const double x = least_squares_.x()[j];
      unit[column_[at(j)]] = infeasible_ ? x / length_[j] : sigma_ * x / (r[n] * length_[j]);
    }

  // The equality rows' part, from the others': G_E' lambda_E = y - G_I' lambda_I, in the least-squares sense.
  auto t = part_.head(equalities_.size());
  rest_ = y;
  for (const Index i : column_)
    if (unit[i] != 0) w_->add(i, -unit[i], rest_);
  t.noalias() = equalities_.qr().Q().transpose() * rest_;
  equalities_.qr().solve(t);
  for (Index i = 0; i < t.size(); ++i) unit[equalities_[i]] = t[i];
}

}  // namespace zwang

#pragma once

#include <algorithm>
#include <vector>

#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/thin_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The rows taken to be active, G_A, with a factorization that gains and loses rows. Three of them: orthogonal (QrRows,
// below; errors grow with cond(G_A)), the same in what the equality rows leave free (eliminated_rows.h), and by
// Cholesky on S_A = G_A G_A' (solvers/factor/cholesky_rows.h; with the square of that).
class ActiveRows {
 public:
  using Part = Eigen::Ref<Vector>;
  using Parts = Eigen::Ref<Matrix>;
  virtual ~ActiveRows() = default;

  const std::vector<Index>& rows() const { return rows_; }  // of the whitened problem, in the factorization's order
  Index size() const { return static_cast<Index>(rows_.size()); }
  Index operator[](Index i) const { return rows_[at(i)]; }
  bool accepts(double share) const { return share > threshold_; }
  // A rejected row may be independent all the same: this factorization cannot tell.
  bool undecided(double share) const { return !accepts(share) && share > certain_; }

  // Empty. `w` and `deadline` are kept until the next reset; the calls below throw Stopped where the latter has passed.
  virtual void reset(const Whitened& w, const Deadline& deadline) = 0;
  // From scratch, in the same order. False: the factors cannot be made better than they are.
  virtual bool refactor() = 0;
  virtual bool healthy() const { return true; }
  // The part of row `row` outside span(G_A), 1 = orthogonal; the row joins when it is accepted.
  virtual double append(Index row) = 0;
  virtual double share(Index row) = 0;
  virtual void drop(Index position) = 0;
  virtual double smallest_pivot() const = 0;
  // By how much a pass of correct() shrinks an error, at the least.
  virtual double contraction() const { return rounding_over(smallest_pivot()); }
  // The inequality row with the smallest pivot, if that is below `limit`, else -1. From now to the next reset no row is
  // accepted whose share is not clearly larger.
  virtual Index coarsen(double) { return -1; }
  // T = argmin |V - G_A' T|, column by column; V becomes V - G_A' T. Of together() columns at most.
  virtual void combine(Parts V, Parts T) = 0;
  virtual Index together() const { return 1; }  // columns that combine() is quickest with
  // From r1 (n) and r2 (|A|), in place: dy = r1 + G_A' dl and dl, with G_A dy = r2.
  virtual void correct(Vector& r1, Part r2) = 0;

  // g_row . v and v += factor g_row, over the nonzeros of the row.
  template <class Column>
  double dot(Index row, const Column& v) const {
    return w_->dot(row, v);
  }
  template <class Column>
  void add(Index row, double factor, Column&& v) const {
    w_->add(row, factor, v);
  }

 protected:
  void begin(const Whitened& w, const Deadline& deadline) {
    w_ = &w;
    deadline_ = &deadline;
    rows_.clear();
    rows_.reserve(at(w.rows()));
  }
  ActiveRows(double threshold, double certain) : threshold_(threshold), certain_(certain) {}
  ActiveRows(const ActiveRows&) = default;
  ActiveRows& operator=(const ActiveRows&) = default;
  static double rounding_over(double pivot) {
    return tolerances::pivot_margin * std::numeric_limits<double>::epsilon() / pivot;
  }
  void forget(Index position) { rows_.erase(rows_.begin() + position); }

  const Whitened* w_ = nullptr;
  const Deadline* deadline_ = nullptr;
  std::vector<Index> rows_;
  double threshold_, certain_;
};

// G_A' = Q R. A row counts as dependent when rounding in the row itself (eps / share) could make it so. Classes derived
// from it factorize the first rows in a way of their own, and the others in what those leave free.
class QrRows : public ActiveRows {
 public:
  QrRows() : ActiveRows(rounding, rounding) {}

  void reset(const Whitened& w, const Deadline& deadline) override {
    begin(w, deadline);
    threshold_ = certain_ = rounding;
    qr_.reset(w.size(), w.rows());
    part_.resize(std::min(w.size(), w.rows()));
    column_.resize(w.size());
  }
  bool refactor() override { return false; }
  const ThinQr& qr() const { return qr_; }

  double append(Index row) override {
    deadline_->keep();
    const double share = qr_.append(column(row), threshold_);
    if (accepts(share)) rows_.push_back(row);
    return share;
  }
  double share(Index row) override { return qr_.share(column(row)); }
  void drop(Index position) override {
    qr_.drop(position - first());
    forget(position);
  }
  Index coarsen(double limit) override {
    Index weakest = -1;
    for (Index j = 0; j < qr_.size(); ++j)
      if (!w_->equality[at((*this)[first() + j])] && qr_.pivot(j) < limit) {
        limit = qr_.pivot(j);
        weakest = first() + j;
      }
    if (weakest >= 0) threshold_ = certain_ = 2 * limit;
    return weakest;
  }
  double smallest_pivot() const override {
    double smallest = 1;
    for (Index j = 0; j < qr_.size(); ++j) smallest = std::min(smallest, qr_.pivot(j));
    return smallest;
  }
  void combine(Parts V, Parts T) override {
    for (Index c = 0; c < V.cols(); ++c) {
      deadline_->keep();
      qr_.split(V.col(c));
      T.col(c) = qr_.components();
      V.col(c) = qr_.remainder();
      qr_.solve(T.col(c));
    }
  }
  // dy = (I - QQ') r1 + Q R^-T r2,   dl = R^-1 (R^-T r2 - Q' r1).
  void correct(Vector& r1, Part r2) override {
    deadline_->keep();
    auto t = part_.head(qr_.size());
    qr_.solve_transposed(r2);
    t.noalias() = qr_.Q().transpose() * r1;
    r2 -= t;
    r1.noalias() += qr_.Q() * r2;
    qr_.solve(r2);
  }

 protected:
  static constexpr double rounding = tolerances::share_rounding * std::numeric_limits<double>::epsilon();

  Index first() const { return size() - qr_.size(); }  // the place of the first row that qr_ holds

  ThinQr qr_;
  Vector part_;

 private:
  const Vector& column(Index row) {
    column_.setZero();
    add(row, 1, column_);
    return column_;
  }

  Vector column_;
};

}  // namespace zwang

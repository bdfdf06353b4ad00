#include <zwang/solvers/factor/cholesky_rows.h>

#include <algorithm>

namespace zwang {

void CholeskyRows::reset(const Whitened& w, const Deadline& deadline) {
  w_ = &w;
  deadline_ = &deadline;
  const auto k = at(w.rows());
  rows_.clear();
  rows_.reserve(k);
  index_.reserve(k);
  value_.reserve(k);
  inside_.assign(k, 0);
  x_.resize(w.rows());
  part_.resize(w.rows());
  rest_.resize(w.size());
  healthy_ = factor_.reset(w.rows());
}

bool CholeskyRows::refactor() {
  std::fill(inside_.begin(), inside_.end(), char(0));
  healthy_ = factor_.reset(w_->rows());
  for (const Index row : rows_) healthy_ = healthy_ && factor_row(row);
  return healthy_ && (rows_.empty() || factor_.rcond() >= tolerances::gram_rcond);
}

// Column `row` of S over the rows that are in.
bool CholeskyRows::factor_row(Index row) {
  deadline_->keep();
  inside_[at(row)] = 1;
  index_.clear();
  value_.clear();
  rest_.setZero();
  add(row, 1, rest_);
  for (Index i = 0; i < w_->rows(); ++i) {
    if (!inside_[at(i)]) continue;
    const double s = dot(i, rest_);
    if (s == 0 && i != row) continue;
    index_.push_back(static_cast<int>(i));
    value_.push_back(s);
  }
  return factor_.add(row, index_, value_);
}

double CholeskyRows::share(Index row) {
  rest_.setZero();
  add(row, 1, rest_);
  project(rest_, part_.head(size()), 3);
  return rest_.norm();
}

double CholeskyRows::append(Index row) {
  const double part = size() < w_->size() ? share(row) : 0;
  if (!accepts(part)) return part;
  rows_.push_back(row);
  if (factor_row(row) && factor_.rcond() >= tolerances::gram_rcond) return part;
  // The update failed where the row itself is sound: once more from scratch, else hand it back.
  if (refactor()) return part;
  rows_.pop_back();
  refactor();
  return threshold_;
}

void CholeskyRows::drop(Index position) {
  const Index row = (*this)[position];
  forget(position);
  inside_[at(row)] = 0;
  if (!factor_.remove(row) || (size() > 0 && factor_.rcond() < tolerances::gram_rcond)) refactor();
}

// The first pass is right to cond(S_A) eps, each more gains as many digits.
void CholeskyRows::project(Vector& v, Part t, int passes) {
  deadline_->keep();
  t.setZero();
  for (int pass = 0; pass < passes && size() > 0; ++pass) {
    x_.setZero();
    for (const Index i : rows_) x_[i] = dot(i, v);
    factor_.solve(x_);
    for (Index i = 0; i < size(); ++i) {
      t[i] += x_[(*this)[i]];
      add((*this)[i], -x_[(*this)[i]], v);
    }
  }
}

// S_A dl = r2 - G_A r1,  dy = r1 + G_A' dl.
void CholeskyRows::correct(Vector& r1, Part r2) {
  deadline_->keep();
  x_.setZero();
  for (Index i = 0; i < size(); ++i) x_[(*this)[i]] = r2[i] - dot((*this)[i], r1);
  if (size() > 0) factor_.solve(x_);
  for (Index i = 0; i < size(); ++i) {
    r2[i] = x_[(*this)[i]];
    add((*this)[i], r2[i], r1);
  }
}

}  // namespace zwang

#include <zwang/solvers/factor/eliminated_rows.h>

namespace zwang {

void EliminatedRows::reset(const Whitened& w, const Deadline& deadline) {
  begin(w, deadline);
  threshold_ = certain_ = rounding;
  equalities_.clear();
  inequalities_.clear();
  column_.assign(at(w.rows()), -1);
  for (Index i = 0; i < w.rows(); ++i) {
    if (w.equality[at(i)]) {
      equalities_.push_back(i);
    } else {
      column_[at(i)] = std::ssize(inequalities_);
      inequalities_.push_back(i);
    }
  }
  constexpr double rank_rounding = tolerances::rank * std::numeric_limits<double>::epsilon();
  elimination_.factorize(w.G, equalities_, rank_rounding, deadline, sparse);
  rejected_.clear();
  for (const Index k : elimination_.order()) rows_.push_back(equalities_[at(k)]);
  for (const Index k : elimination_.rejected()) rejected_.push_back(equalities_[at(k)]);
  qr_.reset(freedom(), freedom());
  x_.setZero(elimination_.padded_size());
  range_.resize(rank());
  v_.setZero(freedom());
  part_.resize(freedom());

  w_E_.resize(rank());
  for (Index k = 0; k < rank(); ++k) w_E_[k] = w.h[rows_[at(k)]];
  elimination_.solve_transposed(w_E_);
  y_E_.setZero(elimination_.padded_size());
  elimination_.join(w_E_, v_, y_E_);
  y_E_norm_ = y_E_.norm();

  elimination_.reduce(w.G, inequalities_, deadline, A_);
  b_.resize(A_.cols());
  for (Index j = 0; j < b_.size(); ++j) b_[j] = b_of(inequalities_[at(j)]);
}

// What the null space leaves of a row.
const Vector& EliminatedRows::reduced(Index row) {
  if (const Index j = column_[at(row)]; j >= 0) {
    v_ = A_.col(j);
  } else {
    x_.setZero();
    add(row, 1, x_);
    elimination_.rotate(x_);
    elimination_.free(x_, v_);
  }
  return v_;
}

double EliminatedRows::share(Index row) { return qr_.size() < freedom() ? qr_.share(reduced(row)) : 0; }

double EliminatedRows::append(Index row) {
  deadline_->keep();
  const double part = qr_.size() < freedom() ? qr_.split(reduced(row)) : 0;
  if (!accepts(part)) return part;
  qr_.append();
  rows_.push_back(row);
  return part;
}

double EliminatedRows::smallest_pivot() const {
  return std::min(elimination_.smallest_accepted(), QrRows::smallest_pivot());
}

void EliminatedRows::combine(Parts V, Parts T) {
  const Index n = V.rows(), q = qr_.size();
  if (X_.rows() != elimination_.padded_size() || X_.cols() < V.cols())
    X_.resize(elimination_.padded_size(), together());
  if (V_.rows() != freedom() || V_.cols() < V.cols()) V_.resize(freedom(), together());
  auto X = X_.leftCols(V.cols());
  auto free = V_.leftCols(V.cols());
  auto own = T.bottomRows(q);
  X.setZero();
  X.topRows(n) = V;
  elimination_.rotate(X);
  elimination_.free(X, free);
  QrRows::combine(free, own);

  X.setZero();
  X.topRows(n) = V;
  for (Index c = 0; c < V.cols(); ++c)
    for (Index j = 0; j < q; ++j) add((*this)[rank() + j], -own(j, c), X.col(c));
  balance(X, T.topRows(rank()));
  elimination_.join(Matrix::Zero(rank(), V.cols()), free, X);
  V = X.topRows(n);
}

// dy = Q [w; v]: w from the equality rows, v as QrRows has it, of what w leaves; then the multipliers of the equality
// rows from what the others leave of dy - r1.
void EliminatedRows::correct(Vector& r1, Part r2) {
  const Index n = r1.size(), q = qr_.size();
  range_ = r2.head(rank());
  elimination_.solve_transposed(range_);
  v_.setZero();
  x_.setZero();
  elimination_.join(range_, v_, x_);
  auto own = r2.tail(q);
  for (Index j = 0; j < q; ++j) own[j] -= dot((*this)[rank() + j], x_);

  x_.setZero();
  x_.head(n) = r1;
  elimination_.rotate(x_);
  elimination_.free(x_, v_);
  QrRows::correct(v_, own);
  elimination_.join(range_, v_, x_);

  step_ = x_.head(n);
  x_.head(n) -= r1;
  for (Index j = 0; j < q; ++j) add((*this)[rank() + j], -own[j], x_);
  balance(x_, r2.head(rank()));
  r1 = step_;
}

void EliminatedRows::lift(const Vector& v, Vector& y) {
  elimination_.join(w_E_, v, x_);
  y = x_.head(y.size());
}

void EliminatedRows::balance(Parts Y, Parts T) const {
  elimination_.rotate(Y);
  elimination_.range(Y, T);
  elimination_.solve(T);
}

}  // namespace zwang

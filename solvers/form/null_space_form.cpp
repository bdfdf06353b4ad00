#include <zwang/solvers/form/null_space_form.h>

#include <cmath>
#include <cstring>

#include <zwang/solvers/linalg/multiply_add.h>
#include <zwang/solvers/linalg/tolerances.h>
namespace zwang {
namespace {

constexpr Index most_freedom = 512;  // N is dense: beyond, rows that keep their zeros are worth more
constexpr Index packet = BodyRows::lanes;

}  // namespace

std::string_view NullSpaceForm::build(const Problem& problem) {
  remembers_ = false;
  if (!rows_.build(problem)) return "rows that are not of jointed bodies";
  if (const auto refused = tree_.factorize(rows_); !refused.empty()) return refused;
  inequalities_.resize(rows_.row.size());
  std::size_t count = 0;
  for (Index i = 0; i < rows_.rows(); ++i) {
    inequalities_[count] = i;
    count += !rows_.equality[at(i)];
  }
  inequalities_.resize(count);
  equalities_.assign(tree_.tree_rows().begin(), tree_.tree_rows().end());
  equalities_.insert(equalities_.end(), tree_.cut().begin(), tree_.cut().end());
  smallest_pivot_ = tree_.smallest_pivot();
  const bool needs_N = !inequalities_.empty() || !tree_.cut().empty();
  if (needs_N && tree_.freedom() > most_freedom) return "too many freedoms for a dense reduced form";
  const auto tree_rows = static_cast<Index>(tree_.tree_rows().size());
  all_.resize(tree_.freedom());
  tree_mu_.resize(tree_rows);
  sigma_.resize(static_cast<Index>(equalities_.size()));
  rest_.resize(packet, rows_.bodies());
  y_E_.resize(packet, rows_.bodies());
  freedom_ = tree_.freedom() - static_cast<Index>(tree_.cut().size());
  padded_ = (freedom_ + packet - 1) / packet * packet;
  has_basis_ = false;
  if (!tree_.cut().empty() && !close_loops()) return "loops whose joints are redundant";
  for (std::size_t k = 0; k < equalities_.size(); ++k) sigma_[static_cast<Index>(k)] = rows_.h[equalities_[k]];
  tree_.shift(sigma_, y_E_);
  meet_cut(sigma_, y_E_);
  return {};
}

void NullSpaceForm::remember(const Problem& p) {
  if (!p.M.isCompressed() || !p.J.isCompressed()) return;
  M_places_.keep(p.M);
  J_places_.keep(p.J);
  M_entry_ = p.M.coeffs();
  J_entry_ = p.J.coeffs();
  remembers_ = true;
}

bool NullSpaceForm::take(const Problem& p) {
  if (!remembers_ || !M_places_.matches(p.M) || !J_places_.matches(p.J)) return false;
  const auto same = [](const Eigen::ArrayXd& own, const double* other) {
    return own.size() == 0 || std::memcmp(own.data(), other, at(own.size()) * sizeof(double)) == 0;
  };
  if (!same(M_entry_, p.M.valuePtr()) || !same(J_entry_, p.J.valuePtr())) return false;
  std::size_t k = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    const bool is_here = k < rows_.row.size() && rows_.row[k] == i, holds = is_here && rows_.equality[k] != 0;
    if (holds != p.is_equality(i) || (!is_here && std::isfinite(p.c[i]))) return false;
    k += is_here;
  }
  has_basis_ = has_basis_ && !tree_.cut().empty();  // as build() leaves it: with one, rows are reduced by other sums
  return true;
}

void NullSpaceForm::shift(const Vector& h) {
  for (std::size_t k = 0; k < equalities_.size(); ++k) {
    const Index e = equalities_[k];
    sigma_[static_cast<Index>(k)] = h[rows_.row[at(e)]] / rows_.row_norm[e];
  }
  tree_.shift(sigma_, y_E_);
  meet_cut(sigma_, y_E_);
}

// (G_cut N)' = Q [R; 0] by reflections; the last columns of Q are what the loops leave of N.
bool NullSpaceForm::close_loops() {
  const Index f = tree_.freedom(), r = static_cast<Index>(tree_.cut().size());
  if (r > f) return false;
  cut_.resize(f, r);
  scale_.resize(r);
  beta_.resize(r);
  cut_mu_.resize(r);
  for (Index k = 0; k < r; ++k) {
    rest_.setZero();
    rows_.add(tree_.cut()[at(k)], 1, rest_);
    tree_.reduce(rest_, all_);
    cut_.col(k) = all_;
  }
  for (Index k = 0; k < r; ++k) {
    auto v = cut_.col(k).tail(f - k);
    const double norm = v.norm();
    if (!(norm > tolerances::clear_pivot)) return false;
    smallest_pivot_ = std::min(smallest_pivot_, norm);
    beta_[k] = v[0] > 0 ? -norm : norm;
    scale_[k] = 1 / (beta_[k] * (beta_[k] - v[0]));
    v[0] -= beta_[k];
    for (Index l = k + 1; l < r; ++l) {
      auto x = cut_.col(l).tail(f - k);
      x -= (scale_[k] * v.dot(x)) * v;
    }
  }
  turn_.setIdentity(f, f);
  for (Index k = r; k-- > 0;) {
    const auto v = cut_.col(k).tail(f - k);
    for (Index c = k; c < f; ++c) {
      auto x = turn_.col(c).tail(f - k);
      x -= (scale_[k] * v.dot(x)) * v;
    }
  }
  if (!inequalities_.empty()) form_basis();
  return true;
}

void NullSpaceForm::form_basis() {
  if (has_basis_) return;
  has_basis_ = true;
  if (tree_.cut().empty()) return tree_.null_space(Nt_);
  tree_.null_space(Nt_tree_);
  Nt_.setZero(padded_, Nt_tree_.cols());
  Nt_.topRows(freedom_).noalias() = turn_.rightCols(freedom_).transpose() * Nt_tree_.topRows(tree_.freedom());
}

void NullSpaceForm::reduce_row(Index i, double* padded_column) const {
  const auto own = rows_.body[at(i)];
  if (!has_basis_) {
    Eigen::Map<Vector>(padded_column, padded_).setZero();
    return tree_.add_reduced(own, rows_.part(i, 0), rows_.part(i, own[1] < 0 ? 0 : 1), padded_column);
  }
  for (Index k = 0; k < padded_; k += packet) {
    Vec<double, packet> sum = Vec<double, packet>::Zero();
    for (int side = 0; side < 2 && own[at(side)] >= 0; ++side) {
      const Index first = 6 * own[at(side)];
      for (Index c = 0; c < 6; ++c)
        sum = multiply_add(rows_.part(i, side)[c], Nt_.col(first + c).segment<packet>(k), sum);
    }
    Eigen::Map<Vec<double, packet>>(padded_column + k) = sum;
  }
}

void NullSpaceForm::reduce(const Motion& y, Vector& v) const {
  if (tree_.cut().empty()) return tree_.reduce(y, v);
  tree_.reduce(y, all_);
  v.head(freedom_).noalias() = turn_.rightCols(freedom_).transpose() * all_;
}

void NullSpaceForm::expand(const Vector& v, Motion& y) const {
  if (tree_.cut().empty()) return tree_.expand(v, y);
  all_.noalias() = turn_.rightCols(freedom_) * v.head(freedom_);
  tree_.expand(all_, y);
}

void NullSpaceForm::meet(const Vector& sigma, Motion& y) const {
  tree_.meet(sigma, y);
  meet_cut(sigma, y);
}

// R'w = what the tree's answer leaves of the rows that close loops; y += N Q w.
void NullSpaceForm::meet_cut(const Vector& sigma, Motion& y) const {
  const Index tree_rows = tree_mu_.size(), r = cut_.cols();
  if (tree_.cut().empty()) return;
  for (Index k = 0; k < r; ++k) {
    double rest = sigma[tree_rows + k] - rows_.dot(equalities_[at(tree_rows + k)], y);
    for (Index l = 0; l < k; ++l) rest -= cut_(l, k) * cut_mu_[l];
    cut_mu_[k] = rest / beta_[k];
  }
  all_.noalias() = turn_.leftCols(r) * cut_mu_;
  tree_.expand(all_, rest_);
  y += rest_;
}

void NullSpaceForm::multipliers(const Motion& t, Vector& mu) const {
  if (tree_.cut().empty()) return tree_.multipliers(t, mu);
  const Index tree_rows = tree_mu_.size(), r = cut_.cols();
  tree_.reduce(t, all_);
  cut_mu_.noalias() = turn_.leftCols(r).transpose() * all_;
  rest_ = t;
  for (Index k = r; k-- > 0;) {
    double own = cut_mu_[k];
    for (Index l = k + 1; l < r; ++l) own -= cut_(k, l) * mu[tree_rows + l];
    mu[tree_rows + k] = own / beta_[k];
    rows_.add(equalities_[at(tree_rows + k)], -mu[tree_rows + k], rest_);
  }
  tree_.multipliers(rest_, tree_mu_);
  mu.head(tree_rows) = tree_mu_;
}

}  // namespace zwang

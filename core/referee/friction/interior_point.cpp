#include <zwang/core/referee/friction/interior_point.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include <zwang/core/referee/friction/extended_symmetric.h>
#include <zwang/core/referee/friction/lorentz_cone.h>

namespace zwang {
namespace {

using namespace lorentz_cone;

// ExtendedSymmetric's double: any matrix.
class DenseSystem {
 public:
  DenseSystem(Index positive, Index negative) : A_(positive + negative, positive + negative) {}
  void set_zero() { A_.setZero(); }
  void add(Index row, Index column, double value) { A_(row, column) += value; }
  void add_product(const Matrix& left, const Matrix& right) {
    A_.topLeftCorner(left.rows(), left.rows()).noalias() += left * right.transpose();
  }
  bool factorize() {
    lu_.compute(A_);
    return true;
  }
  void solve(Vector& x) const { x = lu_.solve(x); }

 private:
  Matrix A_;
  Eigen::PartialPivLU<Matrix> lu_;
};

template <class Real>
class InteriorPoint {
 public:
  InteriorPoint(const ContactProblem& p, std::span<const Index> equalities, const ExtendedVector* sigma, double inward)
      : p_(p),
        equalities_(equalities),
        turns_(!sigma),
        force_(ExtendedVector::Zero(p.rows())),
        system_(p.size(), std::ssize(equalities)) {
    for (std::size_t c = 0; c < p.contacts.size(); ++c) {
      const ContactRows& contact = p.contacts[c];
      if (contact.unit == 0) continue;
      cones_.push_back(c);
      VectorX<DoubleDouble> unit = VectorX<DoubleDouble>::Ones(contact.rows());
      if (contact.rows() > 1) unit[0] /= contact.mu;
      unit_.push_back(unit);
      lift_.push_back((sigma && contact.rows() > 1 ? (*sigma)[c] : DoubleDouble()) - unit[0] * (inward * contact.unit));
    }
    take_full_rows();
  }

  std::vector<InteriorAnswer> solve(const InteriorOptions& options) {
    const std::size_t count = cones_.size();
    x_.setZero(p_.size());
    y_.resize(count);
    w_.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const ContactRows& contact = contact_of(k);
      const double mu = contact.rows() > 1 ? contact.mu : 1;
      y_[k] = w_[k] = Block::Zero(contact.rows());
      y_[k][0] = Real(options.start * std::min(1.0, mu));
      w_[k][0] = Real(options.start * std::max(1.0, 1 / mu));
    }
    std::vector<InteriorAnswer> out;
    double best = infinity;
    int stalled = 0;
    for (int iteration = 0; iteration < referee::interior_steps && stalled <= referee::interior_stalls; ++iteration) {
      const double size = take_residuals();
      Real product = Real(0);
      for (std::size_t k = 0; k < count; ++k) product += y_[k].dot(w_[k]);
      const Real mean = product / Real(std::max(1.0, static_cast<double>(count)));
      const double complementarity = static_cast<double>(mean), merit = std::max(complementarity, 0.0) + size;
      if (!std::isfinite(merit)) break;
      stalled = merit < best * referee::interior_gain ? 0 : stalled + 1;
      if (merit < best || out.empty()) {
        best = std::min(best, merit);
        out.push_back(answer());
        out.back().complementarity = complementarity;
        out.back().residual = std::sqrt(size);
        if (complementarity <= options.target && size <= options.target) break;
      }
      if (!step(mean)) break;
    }
    std::ranges::stable_sort(out, [](const InteriorAnswer& a, const InteriorAnswer& b) {
      return a.complementarity + a.residual * a.residual > b.complementarity + b.residual * b.residual;
    });
    return out;
  }

 private:
  using Block = VectorX<Real>;  // of one contact: rows N / mu, T1, T2
  using Blocks = std::vector<Block>;

  // Rows of many entries, as of a large problem in Delassus form, are multiplied as a matrix.
  void take_full_rows() {
    constexpr Index few = 100, share = 4;
    const Index n = p_.size();
    if (n < few || share * p_.J.nonZeros() < p_.rows() * n) return;
    Index rows = 0;
    for (const std::size_t c : cones_) rows += p_.contacts[c].rows();
    full_.setZero(n, rows);
    weighted_.resize(n, rows);
    Index at = 0;
    for (std::size_t k = 0; k < cones_.size(); ++k)
      for (Index t = 0; t < contact_of(k).rows(); ++t, ++at)
        for (RowMatrix::InnerIterator it(p_.J, contact_of(k).row + t); it; ++it) full_(it.col(), at) = it.value();
  }

  const ContactRows& contact_of(std::size_t cone) const { return p_.contacts[cones_[cone]]; }

  // s = C x in the cones' units, from `right` = h: C x - h.
  Blocks rows_of(const ExtendedVector& x, const ExtendedVector* right) const {
    Blocks s(cones_.size());
    for (std::size_t k = 0; k < s.size(); ++k) {
      s[k].resize(unit_[k].size());
      for (Index t = 0; t < s[k].size(); ++t) {
        const Index row = contact_of(k).row + t;
        DoubleDouble sum = right ? -(*right)[row] : DoubleDouble();
        for (RowMatrix::InnerIterator it(p_.J, row); it; ++it) sum += DoubleDouble(it.value()) * x[it.col()];
        s[k][t] = static_cast<Real>(sum * unit_[k][t] + (right && t == 0 ? lift_[k] : DoubleDouble()));
      }
    }
    return s;
  }

  // Of the problem's rows, those of equality rows as in `force_`.
  ExtendedVector multipliers(const Blocks& y) const {
    ExtendedVector lambda = force_;
    for (std::size_t k = 0; k < y.size(); ++k)
      for (Index t = 0; t < y[k].size(); ++t) lambda[contact_of(k).row + t] = DoubleDouble(y[k][t]) * unit_[k][t];
    return lambda;
  }

  InteriorAnswer answer() const {
    InteriorAnswer out{{x_, multipliers(y_), std::vector(p_.contacts.size(), ContactMode::open)}};
    for (std::size_t k = 0; k < cones_.size(); ++k) out.modes[cones_[k]] = mode_of<Real>(y_[k], w_[k]);
    return out;
  }

  // What M x = J'lambda, w = C x - h + lift and E x = h lack; the sum of their squares.
  double take_residuals() {
    double size = 0;
    const Index n = p_.size(), equalities = std::ssize(equalities_);
    left_.resize(n + equalities);
    left_.head(n) = p_.force_residual(x_, multipliers(y_));
    for (Index e = 0; e < equalities; ++e) left_[n + e] = p_.slack(equalities_[at(e)], x_);
    for (const DoubleDouble& f : left_) size += f.hi * f.hi;
    r_ = rows_of(x_, &p_.h);
    turn_.resize(r_.size());
    for (std::size_t k = 0; k < r_.size(); ++k) {
      r_[k] = w_[k] - r_[k];
      turn_[k] = Block::Zero(r_[k].size());
      const Index t = r_[k].size() - 1;
      if (turns_ && t > 0) {
        const Real slip = w_[k].tail(t).norm();
        r_[k][0] -= slip;
        if (slip > Real(0)) turn_[k].tail(t) = w_[k].tail(t) / slip;
      }
      size += static_cast<double>(r_[k].squaredNorm());
    }
    return size;
  }

  // T = I + e_0 turn'.
  void turn(Blocks& s) const {
    for (std::size_t k = 0; k < s.size() && turns_; ++k) s[k][0] += turn_[k].dot(s[k]);
  }

  bool factorize(const std::vector<NesterovTodd<Real>>& scaling) {
    system_.set_zero();
    for (Index j = 0; j < p_.size(); ++j)
      for (SparseMatrix::InnerIterator it(p_.M, j); it; ++it) system_.add(it.row(), j, Real(it.value()));
    const bool full = full_.size() > 0;
    Index first = 0;
    for (std::size_t k = 0; k < cones_.size(); ++k) {
      MatrixX<Real> weight = scaling[k].square();
      if (turns_) weight += (weight.col(0) * turn_[k].transpose()).eval();
      for (Index a = 0; a < weight.rows(); ++a)
        for (Index b = 0; b < weight.cols(); ++b) weight(a, b) *= static_cast<Real>(unit_[k][a] * unit_[k][b]);
      if (full) {
        const auto own = full_.middleCols(first, weight.rows()).template cast<Real>();
        weighted_.middleCols(first, weight.rows()).noalias() = own.lazyProduct(weight.transpose());
        first += weight.rows();
      }
      for (Index a = 0; a < weight.rows() && !full; ++a)
        for (Index b = 0; b < weight.cols(); ++b) {
          const Real factor = weight(a, b);
          for (RowMatrix::InnerIterator j(p_.J, contact_of(k).row + b); j; ++j)
            for (RowMatrix::InnerIterator i(p_.J, contact_of(k).row + a); i; ++i)
              system_.add(i.col(), j.col(),
                          factor * static_cast<Real>(DoubleDouble::exact_product(i.value(), j.value())));
        }
    }
    if (full) system_.add_product(full_, weighted_);
    for (std::size_t e = 0; e < equalities_.size(); ++e)
      for (RowMatrix::InnerIterator it(p_.J, equalities_[e]); it; ++it) {
        const Index at = p_.size() + static_cast<Index>(e);
        system_.add(at, it.col(), Real(it.value()));
        system_.add(it.col(), at, Real(it.value()));
      }
    return system_.factorize();
  }

  // M dx - J'dy = -force, dw = T (C dx - r), P dw + P^-1 dy = target.
  void direction(const std::vector<NesterovTodd<Real>>& scaling, const Blocks& target) {
    Blocks push(r_);
    turn(push);
    for (std::size_t k = 0; k < push.size(); ++k) push[k] = scaling[k].times(target[k] + scaling[k].times(push[k]));
    ExtendedVector weights = multipliers(push);
    for (const Index i : equalities_) weights[i] = 0;
    ExtendedVector lack = left_;
    lack.head(p_.size()) += p_.force_residual(ExtendedVector::Zero(p_.size()), weights);
    VectorX<Real> step = -lack.cast<Real>();
    system_.solve(step);
    dx_ = step.head(p_.size()).template cast<DoubleDouble>();
    dforce_ = step.tail(std::ssize(equalities_));
    dw_ = rows_of(dx_, nullptr);
    for (std::size_t k = 0; k < dw_.size(); ++k) dw_[k] -= r_[k];
    turn(dw_);
    dy_.resize(dw_.size());
    for (std::size_t k = 0; k < dw_.size(); ++k) dy_[k] = scaling[k].times(target[k] - scaling[k].times(dw_[k]));
  }

  Real longest() const {
    Real least = Real(referee::interior_reach);
    for (std::size_t k = 0; k < y_.size(); ++k)
      least = std::min({least, longest_step<Real>(y_[k], dy_[k]), longest_step<Real>(w_[k], dw_[k])});
    return least;
  }

  bool step(const Real& mean) {
    std::vector<NesterovTodd<Real>> scaling;
    Blocks lam, target;
    for (std::size_t k = 0; k < y_.size(); ++k) {
      scaling.emplace_back(y_[k], w_[k]);
      lam.push_back(scaling[k].times(w_[k]));
      target.push_back(-lam[k]);
    }
    if (!factorize(scaling)) return false;
    direction(scaling, target);
    const Real left = Real(1) - std::min(Real(1), longest());
    const Real centre = std::max(left * left * left, Real(referee::interior_centre));
    for (std::size_t k = 0; k < y_.size(); ++k) {
      target[k] = -jordan<Real>(lam[k], lam[k]) - jordan<Real>(scaling[k].divide(dy_[k]), scaling[k].times(dw_[k]));
      target[k][0] += centre * mean;
      target[k] = jordan_divide<Real>(lam[k], target[k]);
    }
    direction(scaling, target);
    const Real step = std::min(Real(1), Real(referee::interior_way) * longest());
    if (!(step > Real(0)) || !std::isfinite(static_cast<double>(step))) return false;
    for (std::size_t k = 0; k < y_.size(); ++k) {
      y_[k] += step * dy_[k];
      w_[k] += step * dw_[k];
    }
    x_ += DoubleDouble(step) * dx_;
    for (std::size_t e = 0; e < equalities_.size(); ++e)
      force_[equalities_[e]] -= DoubleDouble(step * dforce_[static_cast<Index>(e)]);
    return true;
  }

  const ContactProblem& p_;
  std::span<const Index> equalities_;
  bool turns_;
  Matrix full_;                              // rows of all cones by columns, or none
  MatrixX<Real> weighted_;                   // of C'P^2 T
  std::vector<std::size_t> cones_;           // contacts
  std::vector<VectorX<DoubleDouble>> unit_;  // what a row is multiplied by
  std::vector<DoubleDouble> lift_;           // what is added to each first one
  ExtendedVector x_, dx_, force_, left_;     // force_: one a row, of equality rows alone
  Blocks y_, w_, dy_, dw_, r_, turn_;
  VectorX<Real> dforce_;
  std::conditional_t<std::is_same_v<Real, double>, DenseSystem, ExtendedSymmetric> system_;
};

}  // namespace

template <class Real>
std::vector<InteriorAnswer> interior_point(const ContactProblem& problem, std::span<const Index> equalities,
                                           const ExtendedVector* sigma, const InteriorOptions& options) {
  return InteriorPoint<Real>(problem, equalities, sigma, options.inward).solve(options);
}

template std::vector<InteriorAnswer> interior_point<double>(const ContactProblem&, std::span<const Index>,
                                                            const ExtendedVector*, const InteriorOptions&);
template std::vector<InteriorAnswer> interior_point<DoubleDouble>(const ContactProblem&, std::span<const Index>,
                                                                  const ExtendedVector*, const InteriorOptions&);

}  // namespace zwang

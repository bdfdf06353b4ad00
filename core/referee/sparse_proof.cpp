#include <zwang/core/referee/sparse_proof.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

struct Factor : Eigen::SimplicialLDLT<SparseMatrix> {
  double products() const { return m_nonZerosPerCol.cast<double>().squaredNorm(); }  // after analyzePattern()
};

using referee::penalty;

class SparseProof {
 public:
  explicit SparseProof(const ScaledProblem& scaled) : scaled_(scaled) {}

  Proof run(const ExtendedVector& guess_d, const ExtendedVector& guess_lambda) {
    for (Index i = 0; i < scaled_.rows(); ++i)
      if (scaled_.is_zero(i) ? !scaled_.is_vacuous(i) && !scaled_.zero_row_holds(i) : scaled_.is_equality(i)) return {};
    guess(guess_d, guess_lambda);
    return solve_pushing() && open_touching() ? bound() : Proof{};
  }

 private:
  double unit_product(Index i, const Vector& p) const { return scaled_.J.row(i).dot(p) / scaled_.row_norm[i]; }

  // Rows that push, and rows that push or touch.
  void guess(const ExtendedVector& d, const ExtendedVector& lambda) {
    d_ = d;
    lambda_ = lambda;
    const double near = referee::touched * std::max(scaled_.norm_of_free_motion(), scaled_.norm(d));
    for (Index i = 0; i < scaled_.rows(); ++i) {
      DoubleDouble& own = lambda_[i];
      const double slack = scaled_.counts(i) ? scaled_.unit_slack(i, d_) : 0;
      const bool pushes = scaled_.counts(i) && own.hi > 0 && own.hi * scaled_.row_norm[i] > slack;
      if (pushes) pushing_.push_back(i);
      if (!pushes) own = 0;
      if (pushes || (scaled_.counts(i) && slack < near)) touching_.push_back(i);
    }
  }

  // M + penalty G_A'G_A over the rows listed.
  bool factorize(const std::vector<Index>& listed, Factor& factor) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < listed.size(); ++k)
      for (RowMatrix::InnerIterator it(scaled_.J, listed[k]); it; ++it)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), it.value() / scaled_.row_norm[listed[k]]);
    const auto G = sparse_of<SparseMatrix>(std::ssize(listed), scaled_.size(), entries);
    const SparseMatrix weighted = scaled_.M + penalty * SparseMatrix(G.transpose() * G);
    factor.analyzePattern(weighted);
    if (!(factor.products() <= referee::sparse_products)) return false;
    factor.factorize(weighted);
    return factor.info() == Eigen::Success;
  }

  // M d = J'lambda, J_A (z_u + d) = c_A.
  bool solve_pushing() {
    Factor factor;
    if (!factorize(pushing_, factor)) return false;
    double before = infinity;
    for (int round = 0; round < referee::refinements; ++round) {
      const ExtendedVector force = scaled_.force_residual(d_, lambda_);
      Vector right = -force.cast<double>(), slack(std::ssize(pushing_));
      for (std::size_t k = 0; k < pushing_.size(); ++k) {
        const Index i = pushing_[k];
        slack[static_cast<Index>(k)] = scaled_.unit_slack(i, d_);
        add(i, -penalty * slack[static_cast<Index>(k)] / scaled_.row_norm[i], right);
      }
      const double error = scaled_.dual_norm(force) + slack.norm();
      if (!std::isfinite(error)) return false;
      if (error > before / 2) return true;
      before = error;
      const Vector step = factor.solve(right);
      d_ += step.cast<DoubleDouble>();
      for (std::size_t k = 0; k < pushing_.size(); ++k) {
        const Index i = pushing_[k];
        const double push = -penalty * (slack[static_cast<Index>(k)] + unit_product(i, step));
        lambda_[i] += push / scaled_.row_norm[i];
      }
    }
    return true;
  }

  void add(Index i, double weight, Vector& force) const {
    for (RowMatrix::InnerIterator it(scaled_.J, i); it; ++it) force[it.col()] += weight * it.value();
  }

  // p with G_i p near 1 over all rows that touch.
  bool open_touching() {
    Factor factor;
    if (!factorize(touching_, factor)) return false;
    Vector right = Vector::Zero(scaled_.size());
    for (const Index i : touching_) add(i, penalty / scaled_.row_norm[i], right);
    opening_ = factor.solve(right);
    opened_ = 1;
    for (const Index i : touching_) opened_ = std::min(opened_, unit_product(i, opening_));
    return opened_ > referee::opens;
  }

  Proof bound() {
    // mu >= 0; its change is seen in e.
    for (const Index i : pushing_)
      if (DoubleDouble& own = lambda_[i]; own.hi < 0) own = 0;
    const double e = scaled_.dual_norm(scaled_.force_residual(d_, lambda_)) + scaled_.force_rounding(d_, lambda_);

    // How far y_f may go, mu'max(s, 0), and the worst v.
    double t = infinity, held = 0, worst = 0;
    for (Index i = 0; i < scaled_.rows(); ++i) {
      if (!scaled_.counts(i)) continue;
      const double rounding = scaled_.rounding(i, d_), slack = scaled_.unit_slack(i, d_),
                   own = unit_product(i, opening_);
      held += lambda_[i].hi * scaled_.row_norm[i] * (std::max(slack, 0.0) + rounding);
      if (slack - rounding <= 0 && own <= opened_ / 2) return {};
      worst = std::max(worst, rounding - slack);
      if (own <= opened_ / 2) t = std::min(t, (slack - rounding) / (opened_ - 2 * own));
    }
    // delta_i >= t opened_ / 2 - v_i >= t opened_ / 4 where v_i > 0, so  sum mu*_i v_i <= share y*.(y_f - y*).
    const double length = scaled_.norm(opening_.cast<DoubleDouble>()), size = scaled_.norm(d_);
    double share = 0, moved = 0;
    if (worst > 0) {
      t = std::min(t, std::max(size, scaled_.norm_of_free_motion()) / length);
      share = 4 * worst / (t * opened_);
      moved = t * length;
      if (!(share <= referee::largest_share)) return {};
    }
    // With r = |y - y*|:  r^2 <= e r + held + share (|y| + r) (t |p| + r).
    const double linear = e + share * (size + moved), constant = held + share * size * moved;
    const double radius = (2 * linear + std::sqrt(2 * constant)) * (1 + referee::widened);
    if (!std::isfinite(radius)) return {};
    return {.rows = DistanceBound::Rows::feasible, .d = d_, .radius = radius};
  }

  const ScaledProblem& scaled_;
  ExtendedVector d_, lambda_;
  std::vector<Index> pushing_, touching_;
  Vector opening_;     // p
  double opened_ = 0;  // the least G_i p over rows that touch
};

}  // namespace

Proof prove_sparse(const ScaledProblem& scaled, const ExtendedVector& guess_d, const ExtendedVector& guess_lambda) {
  return SparseProof(scaled).run(guess_d, guess_lambda);
}

}  // namespace zwang

#include <zwang/core/referee/friction/interval_newton.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/exact_rank.h>

namespace zwang {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double unit_roundoff = 0x1p-53;
// What bounds are widened by for the rounding of their own sums of positive terms.
constexpr double widened = 1 + 1e-9;
// Modular products of the exact question about dropped rows.
constexpr double exact_products = 3e7;
constexpr int refinements = 12;
// How often modes that do not hold are changed, and how small a step has to become before a proof is tried.
constexpr int mode_changes = 12;
constexpr double polished = 1e-12;
constexpr double good_delta = 1e-12;

double safe(double x) { return std::isnan(x) ? infinity : x; }

// Independent rows and columns of K = S H^-1 N, by elimination with full pivoting.
struct Part {
  std::vector<Index> rows, columns, dropped_rows, frozen;
};

Part independent_part(const ModeSystem& system, const Eigen::LLT<Matrix>& mass, double threshold) {
  Part part;
  const auto count = static_cast<Index>(system.active.size());
  if (count == 0) return part;
  Eigen::FullPivLU<Matrix> lu;
  lu.setThreshold(threshold);
  lu.compute(system.S * mass.solve(system.N));
  const Index rank = lu.rank();
  for (Index k = 0; k < count; ++k) {
    // P A Q = L U: row k of P A is row i of A with P.indices()[i] = k.
    (k < rank ? part.columns : part.frozen).push_back(lu.permutationQ().indices()[k]);
  }
  for (Index i = 0; i < count; ++i)
    (lu.permutationP().indices()[i] < rank ? part.rows : part.dropped_rows).push_back(i);
  return part;
}

class Krawczyk {
 public:
  Krawczyk(const ContactProblem& problem, const ScaledProblem& scaled, const ModePoint& point)
      : p_(problem), scaled_(scaled), point_(point), system_(problem, point, nullptr) {}

  ModeProof prove(double threshold) {
    ModeProof proof{.point = point_};
    if (!system_.usable || !p_.exact) return proof;
    const Eigen::LLT<Matrix> mass(system_.H);
    if (mass.info() != Eigen::Success) return proof;
    part_ = independent_part(system_, mass, threshold);
    const Index n = p_.size(), rank = static_cast<Index>(part_.rows.size()), N = n + rank;
    R_ = derivative().partialPivLu().inverse();
    if (!R_.allFinite()) return proof;
    Vector value(N), value_error(N);
    if (!refine(value, value_error)) return proof;
    proof.point = point_;
    system_ = ModeSystem(p_, point_, nullptr);
    if (!system_.usable) return proof;
    const Matrix A = derivative();
    Matrix identity_error = R_ * A;
    identity_error.diagonal().array() -= 1;
    identity_error = identity_error.cwiseAbs();
    absolute_R_ = R_.cwiseAbs();
    const Matrix absolute_A = A.cwiseAbs();
    const double gamma = static_cast<double>(N + 20) * unit_roundoff * 1.01;
    const Vector start = (R_ * value).cwiseAbs() + absolute_R_ * (gamma * value.cwiseAbs() + value_error);
    Vector r = start.array() * 1.01 + 1e-200;
    bool inside = false;
    double contraction = 0;  // bounds |I - R F'| on the box, in the norm max |v_i| / r_i
    for (int round = 0; round < 12 && !inside; ++round) {
      const Vector spread = jacobian_spread(r);
      if (!spread.allFinite()) return proof;
      const Vector turned =
          (identity_error * r + absolute_R_ * (gamma * (absolute_A * r) + spread + gamma * gamma * r)) * widened;
      const Vector image = start * widened + turned;
      if (!image.allFinite()) return proof;
      inside = (image.array() < r.array()).all();
      if (N > 0) contraction = (turned.array() / r.array()).maxCoeff() * widened;
      if (!inside) r = image.array() * 1.5 + 1e-200;
    }
    if (!inside) return proof;
    proof.proven = true;
    proof.radius = p_.norm_bound(r.head(n));
    judge_modes(r, proof);
    proof.null_motion = null_motion();
    proof.unique_forces = part_.frozen.empty();
    proof.continuum = proof.strict && proof.delta == 0 && moves(r, contraction, gamma);
    return proof;
  }

 private:
  Matrix derivative() const {
    const Index n = p_.size(), rank = static_cast<Index>(part_.rows.size());
    Matrix A = Matrix::Zero(n + rank, n + rank);
    A.topLeftCorner(n, n) = system_.H;
    for (Index k = 0; k < rank; ++k) {
      A.col(n + k).head(n) = -system_.N.col(part_.columns[static_cast<std::size_t>(k)]);
      A.row(n + k).head(n) = system_.S.row(part_.rows[static_cast<std::size_t>(k)]);
    }
    return A;
  }

  // Moves the point to where the imposed equations hold to the last digits.
  bool refine(Vector& value, Vector& value_error) {
    double last = infinity;
    for (int round = 0; round < refinements; ++round) {
      residuals(value, value_error);
      const Vector step = R_ * value;
      const double size = step.lpNorm<Eigen::Infinity>();
      if (!std::isfinite(size)) return false;
      if (!(size < last / 4)) break;
      last = size;
      for (Index j = 0; j < p_.size(); ++j) point_.x[static_cast<std::size_t>(j)] -= step[j];
      for (std::size_t k = 0; k < part_.columns.size(); ++k)
        point_.lambda[static_cast<std::size_t>(system_.active[static_cast<std::size_t>(part_.columns[k])].row)] -=
            step[p_.size() + static_cast<Index>(k)];
      if (!settle_forces(p_, point_)) return false;
    }
    residuals(value, value_error);
    return true;
  }

  double multiplier_radius(Index row, const Vector& r) const {
    for (std::size_t k = 0; k < part_.columns.size(); ++k)
      if (system_.active[static_cast<std::size_t>(part_.columns[k])].row == row)
        return r[p_.size() + static_cast<Index>(k)];
    return 0;
  }

  // F at the point, and bounds on its rounding.
  void residuals(Vector& value, Vector& error) const {
    const Index n = p_.size();
    const ExtendedVector force = p_.force_residual(point_.x, point_.lambda);
    error.head(n) = p_.force_error(point_.x, point_.lambda);
    for (Index j = 0; j < n; ++j) value[j] = force[static_cast<std::size_t>(j)].hi;
    error.head(n) += unit_roundoff * value.head(n).cwiseAbs();
    for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
      if (point_.modes[c] != ContactMode::slide) continue;
      const ContactRows& contact = p_.contacts[c];
      const double slip = p_.slip(contact, point_.x).hi;
      const double turn = 0x1p-95 + 4 * p_.slip_error(contact, point_.x) / slip;
      const double push = contact.mu * std::abs(point_.lambda[static_cast<std::size_t>(contact.row)].hi) * turn;
      for (Index t = 1; t < contact.rows(); ++t)
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, contact.row + t); it; ++it)
          error[it.col()] += std::abs(it.value()) * push;
    }
    for (std::size_t k = 0; k < part_.rows.size(); ++k) {
      const Index row = system_.active[static_cast<std::size_t>(part_.rows[k])].row, at = n + static_cast<Index>(k);
      value[at] = p_.slack(row, point_.x).hi;
      error[at] = p_.slack_error(row, point_.x) + unit_roundoff * std::abs(value[at]);
    }
  }

  // By how much the slip changes in the box, and its least size there.
  double slip_reach(const ContactRows& contact, const Vector& radius) const {
    double reach = 0;
    for (Index t = 1; t < contact.rows(); ++t) reach = std::hypot(reach, p_.reach(contact.row + t, radius));
    return reach * widened;
  }
  double least_slip(const ContactRows& contact, const Vector& radius) const {
    const double error = p_.slip_error(contact, point_.x);
    return (p_.slip(contact, point_.x).hi - error) * (1 - 1e-9) - slip_reach(contact, radius);
  }
  // By how much its direction does.
  double slip_turn(const ContactRows& contact, const Vector& radius) const {
    const double least = least_slip(contact, radius);
    return least > 0 ? 2 * (slip_reach(contact, radius) + p_.slip_error(contact, point_.x)) / least : infinity;
  }

  // Bounds |F'(any point of the box) - A| r, A's own rounding included. NaN where a slip may vanish in the box.
  Vector jacobian_spread(const Vector& r) const {
    const Index n = p_.size();
    Vector out = Vector::Zero(r.size());
    const Vector radius = r.head(n);
    for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
      if (point_.modes[c] != ContactMode::slide) continue;
      const ContactRows& contact = p_.contacts[c];
      const double push = std::abs(point_.lambda[static_cast<std::size_t>(contact.row)].hi);
      const double push_radius = multiplier_radius(contact.row, r);
      const double reach = slip_reach(contact, radius);
      const double error = p_.slip_error(contact, point_.x);
      const double least = least_slip(contact, radius);
      if (!(least > 0)) return Vector::Constant(r.size(), std::numeric_limits<double>::quiet_NaN());
      // The direction turns by at most reach / least; (I - tau tau')/|s_t| changes by at most 2 reach / least^2.
      const double lost = std::max(0.0, -point_.lambda[static_cast<std::size_t>(contact.row)].hi);
      const double rounding = static_cast<double>(n + 40) * unit_roundoff + error / least;
      double bound = contact.mu * push_radius * (reach / least + rounding);
      if (contact.rows() > 2)
        bound += contact.mu * reach *
                 ((push + push_radius) * 2 * reach / least / least + (push_radius + lost) / least +
                  4 * push * rounding / least);
      for (Index t = 1; t < contact.rows(); ++t)
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, contact.row + t); it; ++it)
          out[it.col()] += std::abs(it.value()) * bound;
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, contact.row); it; ++it)
        out[it.col()] += std::abs(it.value()) * push_radius * rounding;
    }
    for (Index j = 0; j < n; ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(p_.M, j); it; ++it)
        out[it.row()] += static_cast<double>(p_.contacts.size() + 8) * unit_roundoff * std::abs(it.value()) * radius[j];
    return out;
  }

  // What the modes ask for beside their equations, on the whole box.
  void judge_modes(const Vector& r, ModeProof& proof) const {
    const Vector radius = r.head(p_.size());
    proof.strict = true;
    proof.delta = 0;
    const auto off = [&](double amount) { proof.delta = std::max(proof.delta, safe(amount) * widened); };
    if (p_.fixed_contradiction) off(infinity);
    const auto unit = [&](const ContactRows& contact) { return contact.unit > 0 ? contact.unit : 1.0; };
    for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
      const ContactRows& contact = p_.contacts[c];
      const auto row = static_cast<std::size_t>(contact.row);
      if (point_.modes[c] == ContactMode::open) {
        // With J_i = 0 the slack is exact: it holds or not.
        const double spread =
            contact.unit > 0 ? p_.slack_error(contact.row, point_.x) + p_.reach(contact.row, radius) : 0;
        const double least = p_.slack(contact.row, point_.x).hi - spread * widened;
        if (contact.unit == 0 ? least < 0 : !(least > 0)) proof.strict = false;
        if (least < 0) off(-least / unit(contact));
        continue;
      }
      double weight = 0;  // |J_i'| in the dual norm, of any unit force of the contact
      for (Index t = 0; t < contact.rows(); ++t) weight = std::hypot(weight, p_.row_norm[contact.row + t]);
      const double least = point_.lambda[row].hi * (1 - 1e-15) - multiplier_radius(contact.row, r) - 1e-280;
      if (point_.modes[c] == ContactMode::slide || contact.rows() == 1) {
        if (!(least > 0)) proof.strict = false;
        if (point_.lambda[row].hi - multiplier_radius(contact.row, r) < 0)
          off((multiplier_radius(contact.row, r) - point_.lambda[row].hi) * (1 + contact.mu) * weight);
        continue;
      }
      DoubleDouble tangential;
      double spread = 0;
      for (Index t = 1; t < contact.rows(); ++t) {
        const DoubleDouble l = point_.lambda[row + static_cast<std::size_t>(t)];
        tangential += l * l;
        spread = std::hypot(spread, multiplier_radius(contact.row + t, r));
      }
      tangential = sqrt(tangential);
      const double rounding = 0x1p-98 * (std::abs(tangential.hi) + std::abs(contact.mu * point_.lambda[row].hi));
      const double inside = (DoubleDouble(contact.mu) * point_.lambda[row] - tangential).hi - rounding -
                            (spread + contact.mu * multiplier_radius(contact.row, r)) * widened;
      if (!(inside > 0) || !(least > 0)) proof.strict = false;
      if (inside < 0) off(-inside * weight);
      if (point_.lambda[row].hi - multiplier_radius(contact.row, r) < 0)
        off((multiplier_radius(contact.row, r) - point_.lambda[row].hi) * (1 + contact.mu) * weight);
    }
    if (!part_.dropped_rows.empty() && !dropped_rows_hold()) {
      proof.strict = false;
      for (const Index k : part_.dropped_rows) {
        const ModeSystem::Row& row = system_.active[static_cast<std::size_t>(k)];
        const double g =
            row.contact < 0 ? p_.row_norm[row.row] : unit(p_.contacts[static_cast<std::size_t>(row.contact)]);
        off((std::abs(p_.slack(row.row, point_.x).hi) + p_.slack_error(row.row, point_.x) + p_.reach(row.row, radius)) /
            g);
      }
    }
  }

  bool dropped_rows_hold() const {
    const double work = static_cast<double>(system_.active.size()) * static_cast<double>(part_.rows.size()) *
                        static_cast<double>(p_.size());
    if (work > exact_products) return false;
    std::vector<Index> basis, more;
    for (const Index k : part_.rows) basis.push_back(system_.active[static_cast<std::size_t>(k)].row);
    for (const Index k : part_.dropped_rows) more.push_back(system_.active[static_cast<std::size_t>(k)].row);
    return exact_consistency(scaled_.J, scaled_.c, basis, more) == Consistency::consistent;
  }

  double null_motion() const {
    const Index n = p_.size(), rank = static_cast<Index>(part_.columns.size());
    const auto count = static_cast<Index>(part_.frozen.size());
    if (count == 0) return 0;
    Matrix right = Matrix::Zero(n + rank, count);
    for (Index k = 0; k < count; ++k) right.col(k).head(n) = system_.N.col(part_.frozen[static_cast<std::size_t>(k)]);
    const Matrix change = R_ * right;
    Matrix multipliers(rank + count, count);
    multipliers.topRows(rank) = change.bottomRows(rank);
    multipliers.bottomRows(count).setIdentity();
    const Matrix triangle = multipliers.householderQr().matrixQR().topRows(count).triangularView<Eigen::Upper>();
    const Matrix motion = triangle.transpose().triangularView<Eigen::Lower>().solve(change.topRows(n).transpose());
    const Matrix product = motion * (p_.M * motion.transpose());
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(product, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
  }

  // Does z change with a frozen multiplier f? The zero u(f) of F(u; f) in the box is a smooth curve with
  // du/df = F'^-1 (n; 0), n the column of f. With k = `contraction`, |du/df - R n| <= k / (1 - k) |R n| in the norm
  // max |v_i| / r_i. Strict modes hold along it, and so do dropped rows that are exact combinations of the others.
  bool moves(const Vector& r, double contraction, double gamma) const {
    if (!(contraction < .5)) return false;
    const Index n = p_.size();
    for (const Index k : part_.frozen) {
      Vector column = Vector::Zero(r.size()), error = Vector::Zero(r.size());
      column.head(n) = system_.N.col(k);
      const ModeSystem::Row& row = system_.active[static_cast<std::size_t>(k)];
      if (row.slides) {
        const ContactRows& contact = p_.contacts[static_cast<std::size_t>(row.contact)];
        const double turn = contact.mu * (slip_turn(contact, r.head(n)) + gamma);
        for (Index t = 0; t < contact.rows(); ++t)
          for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, contact.row + t); it; ++it)
            error[it.col()] += std::abs(it.value()) * (t == 0 ? gamma : turn);
      }
      const Vector move = R_ * column;
      error = (absolute_R_ * (error + gamma * column.cwiseAbs())).eval() * widened;
      const double size = ((move.cwiseAbs() + error).array() / r.array()).maxCoeff();
      error += contraction / (1 - contraction) * widened * size * r;
      if ((move.cwiseAbs() - error).head(n).maxCoeff() > 0) return true;
    }
    return false;
  }

  const ContactProblem& p_;
  const ScaledProblem& scaled_;
  ModePoint point_;
  ModeSystem system_;
  Part part_;
  Matrix R_, absolute_R_;
};

}  // namespace

ModeProof prove_near(const ContactProblem& problem, const ScaledProblem& scaled, ModePoint guess) {
  ModeProof best{.point = guess};
  std::vector<std::vector<ContactMode>> tried;
  for (int round = 0; round < mode_changes; ++round) {
    if (std::ranges::find(tried, guess.modes) != tried.end()) break;
    tried.push_back(guess.modes);
    const double left = polish(problem, guess);
    if (left < polished) {
      ModeProof proof = prove_modes(problem, scaled, guess);
      if (proof.proven && (!best.proven || proof.delta < best.delta)) best = std::move(proof);
      if (best.proven && best.delta <= good_delta) break;
    }
    if (!change_modes(problem, guess)) break;
  }
  return best;
}

ModeProof prove_modes(const ContactProblem& problem, const ScaledProblem& scaled, const ModePoint& point) {
  ModeProof best{.point = point};
  for (const double threshold : {1e-11, 1e-8, 1e-13}) {
    ModeProof proof = Krawczyk(problem, scaled, point).prove(threshold);
    if (proof.proven && (!best.proven || proof.delta < best.delta)) best = std::move(proof);
    if (best.proven && best.delta <= good_delta) break;
  }
  return best;
}

}  // namespace zwang

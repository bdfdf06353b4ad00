#include <zwang/core/referee/friction/natural_map.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include <zwang/core/referee/friction/numbers.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::underflow_of_squares, referee::unit_roundoff, referee::up;

constexpr int refinements = 8, inflations = 8;

// The least box of matrices that holds what was added.
struct Hull {
  Mat3 low = Mat3::Constant(infinity), high = -low;

  void add(const Mat3& centre, const Mat3& radius = Mat3::Zero()) {
    low = low.cwiseMin(centre - radius);
    high = high.cwiseMax(centre + radius);
  }
  Mat3 centre() const { return (low + high) / 2; }
  Mat3 radius() const { return (high - low) * (up(1) / 2); }
};

// The Jacobian of P_K outside K and its polar cone, K = {|l_t| <= mu l_n}, with w = u_t / |u_t| and b = a mu,
// a = (u_n / |u_t| + mu) / (1 + mu^2) in [0, 1 / mu]:
//
//   1 / (1 + mu^2) [[1, mu w'], [mu w, mu^2 w w']] + b (I - w w').
//
// w lies within `turn` of the one given; turn >= 1: anywhere.
void add_between(double mu, Index tangents, const Eigen::Vector2d& u_t, double turn, double b_low, double b_high,
                 Hull& hull) {
  const double share = 1 / (1 + mu * mu), b = (b_low + b_high) / 2, b_radius = (b_high - b_low) / 2;
  const bool anywhere = !(turn < 1);
  const Eigen::Vector2d w = anywhere ? Eigen::Vector2d::Zero() : Eigen::Vector2d(u_t.normalized());
  if (anywhere) turn = 1;
  Mat3 centre = Mat3::Zero(), radius = Mat3::Constant(referee::measured);
  centre(0, 0) = share;
  for (Index i = 0; i < tangents; ++i) {
    centre(0, i + 1) = centre(i + 1, 0) = share * mu * w[i];
    radius(0, i + 1) = radius(i + 1, 0) += share * mu * turn;
    for (Index j = 0; j < tangents; ++j) {
      // w_i w_j, and what it leaves of I.
      double part = w[i] * w[j], spread = (std::abs(w[i]) + std::abs(w[j]) + turn) * turn;
      if (anywhere) part = i == j ? .5 : 0, spread = .5;
      if (tangents == 1) part = 1, spread = 0;
      const double rest = (i == j) - part;
      centre(i + 1, j + 1) = share * mu * mu * part + b * rest;
      radius(i + 1, j + 1) += (share * mu * mu + b_high) * spread + b_radius * std::abs(rest);
    }
  }
  hull.add(centre, radius);
}

// F, [S] and K(Z) of the header. A vector of unknowns has x first, then one entry a row that may push.
class NormalMap {
 public:
  explicit NormalMap(const ContactProblem& p) : p_(p), n_(p.size()), size_(n_ + std::ssize(p.equalities)) {
    usable = p.exact && !p.fixed_contradiction;
    for (const ContactRows& contact : p.contacts) {
      if (contact.unit == 0) usable &= p.zero_row_holds(contact.row);
      if (contact.unit == 0) continue;
      const Index rows = contact.rows();
      parts_.push_back(
          {contact, size_, rows, static_cast<double>(rows) / p.row_norm.segment(contact.row, rows).squaredNorm()});
      size_ += rows;
    }
    usable &= size_ > 0 && size_ <= referee::slopes_limit;
  }

  bool usable;

  ModeProof prove(const ExtendedVector& x, const ExtendedVector& lambda) {
    start(x, lambda);
    r_ = Vector::Zero(size_);
    double last = infinity;
    for (int round = 0; round < refinements; ++round) {
      take_value();
      const Vector step = slopes().partialPivLu().solve(value_);
      const double length = step.lpNorm<Eigen::Infinity>();
      if (!std::isfinite(length)) return {};
      if (!(length < last / 4)) break;
      last = length;
      at_ -= step.cast<DoubleDouble>();
    }
    for (int round = 0; round < inflations && precondition(); ++round) {
      const Vector image = (moved_ + error_ + turned()) * up(1);
      if (!image.allFinite()) break;
      if ((image.array() < r_.array()).all())
        return {.proven = true,
                .point = {centre(), lambda_, modes_by_size(p_, centre(), lambda_, referee::mode_cut)},
                .radius = p_.norm_bound(r_.head(n_)),
                .delta = 0,
                .unique_forces = true,
                .by = "slopes of the natural map"};
      r_ = image * referee::inflated + Vector::Constant(size_, underflow_of_squares);
    }
    return {};
  }

  bool none_within(const ExtendedVector& x, double distance) {
    r_ = Vector::Zero(size_);
    for (Index j = 0; j < n_; ++j) r_[j] = up(distance * p_.dual_norm(Vector(Vector::Unit(n_, j))));
    ExtendedVector lambda = ExtendedVector::Zero(p_.rows());
    std::vector<Index> touching = p_.equalities, places = numbers_from(n_, touching.size());
    for (const Part& part : parts_) {
      const double slack = p_.slack(part.row(), x).hi, spread = up(p_.slack_error(part.row(), x) + reach(part, 0));
      if (slack + spread < 0) return true;
      for (Index t = 0; t < part.rows && slack <= spread; ++t) {
        touching.push_back(part.row() + t);
        places.push_back(part.at + t);
      }
    }
    if (!bound_forces(touching, places, x, lambda)) return false;
    start(x, lambda);
    for (const Part& part : parts_)
      for (Index t = part.rows - 1; t >= 0; --t)
        r_[part.at + t] += up(part.rho * (reach(part, t) + p_.slack_error(part.row() + t, x) +
                                          (t == 0 ? part.contact.mu * slip_reach(part) : 0)));
    return precondition() && (moved_ - (error_ + turned() + r_) * up(1)).maxCoeff() > 0;
  }

 private:
  struct Part {
    const ContactRows& contact;
    Index at, rows;  // among the unknowns
    double rho;      // in the units of its rows

    Index row() const { return contact.row; }
  };

  // lambda of rows that may push, and its part of r, from M x' = J'lambda' for every x' in the box: with L about a left
  // inverse of B = J_A', lambda' = L M x' + (I - L B) lambda'.
  bool bound_forces(const std::vector<Index>& touching, const std::vector<Index>& places, const ExtendedVector& x,
                    ExtendedVector& lambda) {
    const Index count = std::ssize(touching);
    if (count == 0) return true;
    Matrix B = Matrix::Zero(n_, count);
    for (Index k = 0; k < count; ++k)
      for (RowMatrix::InnerIterator it(p_.J, touching[at(k)]); it; ++it) B(it.col(), k) = it.value();
    const Matrix L = Matrix(B.transpose() * B).ldlt().solve(B.transpose()), absolute = L.cwiseAbs(), LM = L * p_.M;
    const Vector middle = x.cast<double>();
    const SparseMatrix M = p_.M.cwiseAbs();
    const double gamma = static_cast<double>(n_ + count + 8) * unit_roundoff * referee::widened_sum;
    const Vector force = LM * middle, moves = middle.cwiseAbs() + r_.head(n_);
    const Matrix E = (L * B - Matrix::Identity(count, count)).cwiseAbs() + gamma * absolute * B.cwiseAbs();
    const double rest = up(E.rowwise().sum().maxCoeff());
    if (!(rest < .5)) return false;  // NaN, too
    const Vector spread = LM.cwiseAbs() * r_.head(n_) + 2 * gamma * (absolute * (M * moves)) + E * force.cwiseAbs();
    const Vector radius = (spread + E.rowwise().sum() * (spread.maxCoeff() / (1 - rest))) * up(1);
    for (Index k = 0; k < count; ++k) {
      lambda[touching[at(k)]] = force[k];
      r_[places[at(k)]] = radius[k];
    }
    return true;
  }

  // By how much s changes in the box, row t; and |s_t|, its error included.
  double reach(const Part& part, Index t) const { return up(p_.reach(part.row() + t, r_.head(n_))); }
  double slip_reach(const Part& part) const {
    double squares = 0;
    for (Index t = 1; t < part.rows; ++t) squares += reach(part, t) * reach(part, t);
    return up(std::sqrt(squares) + p_.slip_error(part.contact, centre()));
  }

  // u at the centre, and how far it goes along the normal and the tangents.
  struct Argument {
    ContactVector u = ContactVector::Zero();
    double normal, tangential, normal_off, tangential_off = 0;
  };
  Argument argument(const Part& part) const {
    Argument a;
    a.u.head(part.rows) = at_.segment(part.at, part.rows);
    a.normal = a.u[0].hi;
    a.tangential = std::hypot(a.u[1].hi, a.u[2].hi);
    a.normal_off = r_[part.at];
    for (Index t = 1; t < part.rows; ++t) a.tangential_off = up(std::hypot(a.tangential_off, r_[part.at + t]));
    return a;
  }

  // mu of the lift. Where u is inside K in the whole box, zeros of F have s = 0, with the lift or without: without it
  // there is no edge at s_t = 0.
  double lift(const Part& part) const {
    const Argument a = argument(part);
    const bool inside = part.contact.mu * (a.normal - a.normal_off) > up(a.tangential + a.tangential_off);
    return inside ? 0 : part.contact.mu;
  }

  ExtendedVector centre() const { return at_.head(n_); }

  // rho (s + mu |s_t| e_n), row t.
  DoubleDouble lifted(const Part& part, Index t, double mu, const ExtendedVector& x) const {
    const DoubleDouble s = p_.slack(part.row() + t, x);
    return (t == 0 ? s + p_.slip(part.contact, x) * mu : s) * part.rho;
  }

  void start(const ExtendedVector& x, const ExtendedVector& lambda) {
    at_.resize(size_);
    at_.head(n_) = x;
    at_.segment(n_, std::ssize(p_.equalities)) = lambda(p_.equalities);
    for (const Part& part : parts_)
      for (Index t = 0; t < part.rows; ++t)
        at_[part.at + t] = lambda[part.row() + t] - lifted(part, t, part.contact.mu, x);
  }

  // F at the centre, and bounds on its error.
  void take_value() {
    const ExtendedVector x = centre();
    value_.resize(size_);
    error_ = Vector::Constant(size_, underflow_of_squares);
    lambda_.setZero(p_.rows());
    for (Index e = 0; e < std::ssize(p_.equalities); ++e) {
      const Index i = p_.equalities[at(e)];
      lambda_[i] = at_[n_ + e];
      value_[n_ + e] = p_.slack(i, x).hi;
      error_[n_ + e] += p_.slack_error(i, x);
    }
    for (const Part& part : parts_) {
      const ContactVector u = argument(part).u, projected = project(u, part.contact.mu);
      const double mu = lift(part), slip_error = mu * p_.slip_error(part.contact, x);
      const double size = std::abs(u[0].hi) + std::abs(u[1].hi) + std::abs(u[2].hi);
      for (Index t = 0; t < part.rows; ++t) {
        const DoubleDouble s = lifted(part, t, mu, x);
        lambda_[part.row() + t] = projected[t];
        value_[part.at + t] = (s + u[t] - projected[t]).hi;
        error_[part.at + t] += part.rho * (p_.slack_error(part.row() + t, x) + (t == 0 ? slip_error : 0)) +
                               referee::rounding_of_few * (size + std::abs(s.hi));
        p_.add_push(part.row() + t, referee::rounding_of_few * size, error_);
      }
    }
    value_.head(n_) = p_.force_residual(x, lambda_).cast<double>();
    error_.head(n_) += p_.force_error(x, lambda_);
    error_ = (error_ + unit_roundoff * value_.cwiseAbs()) * up(1);
  }

  // The Jacobians of P_K on the box of u, and T = [[1, mu tau'], [0, I]] of s + mu |s_t| e_n on that of x.
  struct Pieces {
    Hull V;
    Mat3 T = Mat3::Identity(), T_radius = Mat3::Zero();
  };
  Pieces pieces(const Part& part) const {
    Pieces out;
    const Index tangents = part.rows - 1;
    const double mu = part.contact.mu;
    if (const double lifts = lift(part); lifts > 0) {
      const DoubleDouble slip = p_.slip(part.contact, centre());
      const double change = slip_reach(part), least = slip.hi - change;
      for (Index t = 1; t <= tangents; ++t) {
        if (least > 0) out.T(0, t) = mu * (p_.slack(part.row() + t, centre()) / slip).hi;
        out.T_radius(0, t) = mu * (least > 0 ? std::min(2., change / least + referee::measured) : 1);
      }
    }
    const auto [u, n, t, n_off, t_off] = argument(part);
    const double low = std::max(0., t - t_off), high = t + t_off, noise = referee::measured * (std::abs(n) + t);
    if (mu * (n + n_off) >= low - noise && (tangents > 0 || n + n_off >= -noise)) {
      Mat3 whole = Mat3::Zero();
      whole.topLeftCorner(part.rows, part.rows).setIdentity();
      out.V.add(whole);
    }
    if (n_off - n >= mu * low - noise) out.V.add(Mat3::Zero());
    const bool inside = mu * (n - n_off) > high + noise, polar = -(n + n_off) > mu * high + noise;
    if (tangents > 0 && !inside && !polar) {
      const auto b = [mu](double normal, double tangential) {
        const double ratio = tangential > 0 ? normal / tangential + mu : normal > 0 ? 1 / mu + mu : 0;
        return std::clamp(ratio * mu / (1 + mu * mu), 0., 1.);
      };
      const double b_low = std::min(b(n - n_off, low), b(n - n_off, high));
      const double b_high = std::max(b(n + n_off, low), b(n + n_off, high));
      add_between(mu, tangents, {u[1].hi, u[2].hi}, low > 0 ? up(t_off / low) : 1, b_low, b_high, out.V);
    }
    return out;
  }

  // The centre of [S] on the box.
  Matrix slopes() const {
    Matrix S = Matrix::Zero(size_, size_);
    S.topLeftCorner(n_, n_) = p_.M;
    for (Index e = 0; e < std::ssize(p_.equalities); ++e)
      for (RowMatrix::InnerIterator it(p_.J, p_.equalities[at(e)]); it; ++it) {
        S(n_ + e, it.col()) = it.value();
        S(it.col(), n_ + e) = -it.value();
      }
    for (const Part& part : parts_) {
      const Pieces own = pieces(part);
      const Mat3 V = own.V.centre();
      for (Index a = 0; a < part.rows; ++a)
        for (Index b = 0; b < part.rows; ++b) {
          S(part.at + a, part.at + b) = (a == b) - V(a, b);
          for (RowMatrix::InnerIterator it(p_.J, part.row() + b); it; ++it)
            S(part.at + a, it.col()) += part.rho * own.T(a, b) * it.value();
          for (RowMatrix::InnerIterator it(p_.J, part.row() + a); it; ++it)
            S(it.col(), part.at + b) -= it.value() * V(a, b);
        }
    }
    return S;
  }

  // R for the box, and |R F| with its error.
  bool precondition() {
    take_value();
    S_ = slopes();
    R_ = S_.partialPivLu().inverse();
    gamma_ = static_cast<double>(size_ + 40) * unit_roundoff * referee::widened_sum;
    moved_ = (R_ * value_).cwiseAbs();
    error_ = R_.cwiseAbs() * (gamma_ * value_.cwiseAbs() + error_);
    return moved_.allFinite() && error_.allFinite();
  }

  // A bound on |I - R [S]| r, for the box that R was made for. What V is off by meets F in the balance of forces and in
  // its own rows, and cancels there in part: R comes first, the absolute value then.
  Vector turned() const {
    Vector spread = 2 * gamma_ * (S_.cwiseAbs() * r_), out = Vector::Zero(size_);
    for (const Part& part : parts_) {
      const Pieces own = pieces(part);
      Vec3 reaches = Vec3::Zero(), u = Vec3::Zero();
      for (Index t = 0; t < part.rows; ++t) reaches[t] = reach(part, t), u[t] = r_[part.at + t];
      const Vec3 turn = part.rho * ((own.T_radius + 2 * gamma_ * own.T.cwiseAbs()) * reaches);
      const Vec3 off = own.V.radius() * u, noise = 4 * gamma_ * (own.V.centre().cwiseAbs() * u + u) + gamma_ * off;
      for (Index t = 0; t < part.rows; ++t) {
        spread[part.at + t] += turn[t];
        Vector column = R_.col(part.at + t), sizes = column.cwiseAbs();
        for (RowMatrix::InnerIterator it(p_.J, part.row() + t); it; ++it) {
          column += R_.col(it.col()) * it.value();
          sizes += R_.col(it.col()).cwiseAbs() * std::abs(it.value());
        }
        out += column.cwiseAbs() * off[t] + sizes * noise[t];
      }
    }
    Matrix rest = R_ * S_;
    rest.diagonal().array() -= 1;
    return out + rest.cwiseAbs() * r_ + R_.cwiseAbs() * spread;
  }

  const ContactProblem& p_;
  Index n_, size_;
  std::vector<Part> parts_;
  ExtendedVector at_, lambda_;  // z_0, and its lambda
  Vector r_;                    // Z = z_0 +- r
  Vector value_, error_, moved_;
  Matrix S_, R_;
  double gamma_ = 0;
};

}  // namespace

ModeProof prove_by_slopes(const ContactProblem& problem, const ExtendedVector& x, const ExtendedVector& lambda) {
  NormalMap map(problem);
  return map.usable ? map.prove(x, lambda) : ModeProof{};
}

bool none_by_slopes(const ContactProblem& problem, const ExtendedVector& x, double distance) {
  NormalMap map(problem);
  return map.usable && map.none_within(x, distance);
}

}  // namespace zwang

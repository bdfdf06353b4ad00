#include <zwang/core/referee/friction/numbers.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using Block = ContactVector;

DoubleDouble length(const DoubleDouble& a, const DoubleDouble& b) {
  if (b == DoubleDouble(0)) return abs(a);
  const double largest = std::max(std::abs(a.hi), std::abs(b.hi));
  if (!std::isfinite(largest)) return largest;
  const int e = std::ilogb(largest);
  const DoubleDouble u = a.scaled(-e), v = b.scaled(-e);
  return sqrt(u * u + v * v).scaled(e);
}

}  // namespace

ContactVector project(const ContactVector& l, double mu) {
  const DoubleDouble t = length(l[1], l[2]);
  if (l[0].hi >= 0 && t <= l[0] * mu) return l;
  if (t * mu <= -l[0]) return ContactVector::Zero();
  const DoubleDouble n = (l[0] + t * mu) / (DoubleDouble(1) + DoubleDouble(mu) * mu);
  if (!(t.hi > 0)) return {n, 0, 0};
  const DoubleDouble part = n * mu / t;
  return {n, l[1] * part, l[2] * part};
}

namespace {

double size(const Block& a, const Block& b) { return length((a[0] - b[0]), length(a[1] - b[1], a[2] - b[2])).hi; }

Block take(const ExtendedVector& x, const ContactRows& contact, Index rows) {
  Block out = Block::Zero();
  out.head(rows) = x.segment(contact.row, rows);
  return out;
}

Block slack_of(const ContactProblem& p, const ContactRows& contact, const ExtendedVector& x, Law law) {
  Block s = Block::Zero();
  for (Index t = 0; t < contact.rows(); ++t) s[t] = p.slack(contact.row + t, x);
  if (referee::slip_lifts(law)) s[0] += length(s[1], s[2]) * contact.mu;
  return s;
}

// |lambda - P_K(lambda - R u)| / |lambda| in the problem's own units, u of z = z_u + M^-1 J'lambda.
double relative_residual(const ContactProblem& p, Law law, const ExtendedVector& lambda) {
  const ExtendedVector x = p.motion_by(lambda);
  double residual = 0, total = 0;
  for (const Index i : p.equalities) {
    const double unit = std::ldexp(1.0, -p.row_exponent[i]);
    residual = std::hypot(residual, p.slack(i, x).hi / (p.row_norm[i] * p.row_norm[i]) * unit);
    total = std::hypot(total, lambda[i].hi * unit);
  }
  for (const ContactRows& contact : p.contacts) {
    if (contact.unit == 0) continue;
    double trace = 0;
    for (Index t = 0; t < contact.rows(); ++t) trace += p.row_norm[contact.row + t] * p.row_norm[contact.row + t];
    const DoubleDouble weight = DoubleDouble(static_cast<double>(contact.rows())) / trace;
    const Block l = take(lambda, contact, contact.rows()), u = slack_of(p, contact, x, law);
    const double unit = std::ldexp(1.0, -p.row_exponent[contact.row]);
    residual = std::hypot(residual, size(l, project(l - weight * u, contact.mu)) * unit);
    total = std::hypot(total, size(l, Block::Zero()) * unit);
  }
  return residual == 0 ? 0 : residual / total;
}

}  // namespace

FrictionMetrics friction_residuals(const ContactProblem& p, Law law, const ExtendedVector& x,
                                   const ExtendedVector* lambda) {
  FrictionMetrics out;
  out.penetration = 0;
  if (lambda) out.cone_violation = out.complementarity = out.dissipation = out.natural = 0;
  const auto grow = [](double& worst, double value) { worst = std::max(worst, referee::or_infinity(value)); };
  const double s = p.scale;
  for (const Index i : p.equalities)
    if (lambda) grow(out.natural, std::abs(p.slack(i, x).hi) / p.row_norm[i] / s);
  for (const ContactRows& contact : p.contacts) {
    const double g = contact.unit > 0 ? contact.unit : 1;
    const double s_n = p.slack(contact.row, x).hi / g / s;
    grow(out.penetration, -s_n);
    if (!lambda || contact.unit == 0) continue;
    // All stored rows: where mu = 0 a tangential force is outside the cone.
    Block l = take(*lambda, contact, 1 + contact.tangents);
    l *= DoubleDouble(g / s);
    const double l_t = length(l[1], l[2]).hi;
    grow(out.cone_violation, std::max((length(l[1], l[2]) - l[0] * contact.mu).hi, -l[0].hi));
    Block u = slack_of(p, contact, x, law);
    u /= DoubleDouble(g * s);
    // Under the convex law a contact that slides opens, and s_n l_n alone is not 0.
    grow(out.complementarity,
         referee::slip_lifts(law) ? std::abs(l[0].hi * s_n) : std::abs((l[0] * u[0] + l[1] * u[1] + l[2] * u[2]).hi));
    const DoubleDouble slip = length(u[1], u[2]);
    grow(out.dissipation, (l[0] * contact.mu * slip + l[1] * u[1] + l[2] * u[2]).hi);
    Block moved = l - u;
    if (contact.rows() == 1) grow(out.natural, l_t);
    Block own = l;
    if (contact.rows() == 1) own[1] = own[2] = moved[1] = moved[2] = 0;
    grow(out.natural, size(own, project(moved, contact.mu)));
  }
  if (lambda) out.eta = relative_residual(p, law, *lambda);
  return out;
}

}  // namespace zwang

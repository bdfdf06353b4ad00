#include <zwang/solvers/friction/mode_newton.h>

#include <algorithm>
#include <cmath>

namespace zwang {

namespace soc = second_order_cone;

void ModeNewton::begin(ConeProgram& program, const Vector& from_v, const Vector& from_y, bool weighs_slips) {
  weighs_slips_ = weighs_slips && program.law().opening() == 0;
  v = from_v;
  y = from_y;
  equations_.begin(program);
  for (Vector* x : {&s, &slack_way_}) x->setZero(program.rows());
  push_.setZero(program.face().unknowns());
  program.slack(v, s);
  residual = program.residual(y, s);
  last_ = residual.natural;
  chosen_ = false;
}

// An iterate inside the cones tells the modes by which of two paired eigenvalues is the larger.
void ModeNewton::begin(ConeProgram& program, const InteriorPoint& from) {
  begin(program, from.v, from.y);
  last_ = 0;
  const Index nc = program.cones();
  for (Index k = 0; k < nc; ++k) {
    const double *Y = &from.y[3 * k], *W = &from.w[3 * k];
    const double y_low = soc::smallest(Y), y_high = soc::largest(Y), w_low = soc::smallest(W), w_high = soc::largest(W);
    equations_.mode[at(k)] = w_low > y_high ? Mode::open : y_low > w_high ? Mode::stick : Mode::slide;
    last_ = std::max({last_, std::min(y_low, w_high), std::min(y_high, w_low)});
    const double p1 = Y[1] - W[1], p2 = Y[2] - W[2], size = std::sqrt(p1 * p1 + p2 * p2);
    equations_.slide[at(k)] = {p1 / size, p2 / size, size, Y[0]};
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    equations_.active[at(r)] = program.is_equality(r) || from.y[i] > from.w[i];
    if (!program.is_equality(r)) last_ = std::max(last_, std::min(from.y[i], from.w[i]));
  }
  chosen_ = true;
}

bool ModeNewton::step(ConeProgram& program) {
  ModeEquations& e = equations_;
  e.softness = std::clamp(tolerances::cone_soften * last_ / program.start(), tolerances::cone_softness,
                          tolerances::cone_softest);
  e.across =
      std::clamp(tolerances::cone_soften_across * last_ / program.start(), tolerances::cone_least_across, e.softness);
  changed_ = !chosen_ && e.choose(program, y, s, weighs_slips_ ? tolerances::cone_slip_weight / e.softness : 1);
  chosen_ = false;
  e.linearize(program, y, s, true);
  if (!e.factorize(program)) return false;
  e.step(program, v, y);
  if (!v.allFinite() || !y.allFinite()) return false;
  if (program.is_dense()) program.face().force(y, v);
  program.slack(v, s);
  residual = program.residual(y, s);
  last_ = residual.natural;
  return std::isfinite(last_);
}

// How far y may go along `way`: to where a contact that pushes comes to the edge of its cone, or a single row to zero,
// but no farther than to where the rows that hold are violated least. (Of contacts that slide, less load on one may
// violate it more: then all the way.)
double ModeNewton::room(const ConeProgram& program, const Vector& way, const Vector& slack_way) const {
  double along = 0, square = 0, most = infinity;
  const auto holds = [&](Index i) {
    along -= s[i] * slack_way[i];
    square += slack_way[i] * slack_way[i];
  };
  const auto stays_positive = [&](Index i) {
    if (way[i] < 0) most = std::min(most, std::max(0.0, -y[i] / way[i]));
  };
  for (Index k = 0; k < program.cones(); ++k) {
    if (equations_.mode[at(k)] == Mode::open) continue;
    holds(3 * k);
    if (equations_.mode[at(k)] == Mode::stick) {
      holds(3 * k + 1);
      holds(3 * k + 2);
      if (soc::smallest(&y[3 * k]) > 0) most = std::min(most, soc::step_to_boundary(&y[3 * k], &way[3 * k]));
    } else {
      stays_positive(3 * k);
    }
  }
  for (Index r = 0; r < program.rays(); ++r) {
    if (!equations_.active[at(r)]) continue;
    holds(3 * program.cones() + r);
    if (!program.is_equality(r)) stays_positive(3 * program.cones() + r);
  }
  return along > 0 && square > 0 ? std::min(most, along / square) : most;
}

// On along the last step in y. The softness stays that of the step: where a row lets go the residual is large, and
// means nothing.
void ModeNewton::shift(ConeProgram& program) {
  way_ = y - y_before_;
  program.face().force(way_, push_);
  program.face().slack(push_, slack_way_);
  const double more = room(program, way_, slack_way_);
  if (!std::isfinite(more) || more <= 1) return;
  y += more * way_;
  program.face().force(y, v);
  program.slack(v, s);
}

void ModeNewton::run(ConeProgram& program, double goal, double leaves, int most, int last, const Deadline& deadline,
                     int& iterations) {
  constexpr int patience = 12;    // steps for which the residual need not halve
  constexpr double thrown = 200;  // times the best residual: modes that were told by an iterate have been left
  const bool told = chosen_;
  best_ = *this;
  double& best = best_.residual.natural;
  if (chosen_) best = infinity;
  settled = false;
  double halved = best;
  int since = 0;
  bool stays = true;  // while it falls, the last digits are still to come
  for (int taken = 0; taken < (stays ? most : last) && !(best <= goal) && !deadline.passed(); ++taken) {
    const double before = last_;
    const bool begins = chosen_ || taken == 0;
    y_before_ = y;
    if (!step(program)) break;
    ++iterations;
    const bool same = !begins && !changed_;
    const double moved = equations_.dv.norm(), nothing = tolerances::cone_exact * program.scale(v);
    stays = last_ > 0.5 * before;
    settled = same && stays && last_ <= leaves && moved <= nothing;
    if (last_ < best || settled)
      best_ = *this;
    else if (taken >= 3 && best > tolerances::cone_hopeless * program.start())
      break;
    if (settled || (taken >= 5 && last_ > tolerances::cone_lost * program.scale(v))) break;
    if (told && last_ > thrown * best) break;
    since = last_ < 0.5 * halved ? 0 : since + 1;
    halved = since == 0 ? last_ : halved;
    if (since > patience) break;
    if (same && program.is_dense() && last_ > 0.5 * before && last_ < tolerances::cone_hopeless * program.start())
      shift(program);
  }
  static_cast<ModeIterate&>(*this) = best_;
  last_ = best;
}

}  // namespace zwang

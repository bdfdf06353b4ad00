#include <zwang/core/referee/friction/mode_system.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

constexpr int newton_steps = 40;

void add_row(Matrix& into, Index at, const ContactProblem& p, Index row, double factor) {
  for (RowMatrix::InnerIterator it(p.J, row); it; ++it) into(at, it.col()) += factor * it.value();
}

struct Residual {
  Vector force, rows;
  bool finite = true;
};

Residual residual_of(const ModeSystem& system, const ModePoint& point) {
  const ContactProblem& p = *system.problem;
  Residual r{.force = p.force_residual(point.x, point.lambda).cast<double>(),
             .rows = Vector(std::ssize(system.active))};
  for (Index k = 0; k < r.rows.size(); ++k) r.rows[k] = system.row_residual(system.active[at(k)], point.x).hi;
  r.finite = r.force.allFinite() && r.rows.allFinite();
  return r;
}

}  // namespace

std::vector<ContactMode> modes_by_size(const ContactProblem& p, const ExtendedVector& x, const ExtendedVector& lambda,
                                       double cut) {
  std::vector<ContactMode> modes;
  for (const ContactRows& contact : p.contacts) {
    const double g = contact.unit > 0 ? contact.unit : 1;
    const double l_n = lambda[contact.row].hi * g, s_n = p.slack(contact.row, x).hi / g;
    double l_t = 0;
    for (Index t = 1; t < contact.rows(); ++t) l_t = std::hypot(l_t, lambda[contact.row + t].hi * g);
    const double s_t = p.slip(contact, x).hi / g;
    const double zero = cut * (std::abs(l_n) + l_t + std::abs(s_n) + s_t);
    if (contact.unit == 0 || l_n <= zero)
      modes.push_back(ContactMode::open);
    else
      modes.push_back(contact.rows() > 1 && s_t > zero ? ContactMode::slide : ContactMode::stick);
  }
  return modes;
}

bool settle_forces(const ContactProblem& p, ModePoint& point) {
  bool usable = true;
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const ContactRows& contact = p.contacts[c];
    const Index row = contact.row;
    const Index used = point.modes[c] == ContactMode::open ? 0 : contact.rows();
    for (Index t = used; t <= contact.tangents; ++t) point.lambda[row + t] = 0;
    if (point.modes[c] != ContactMode::slide) continue;
    const DoubleDouble slip = p.slip(contact, point.x);
    if (!(slip.hi > referee::underflow_of_squares)) {
      usable = false;
      continue;
    }
    for (Index t = 1; t < contact.rows(); ++t)
      point.lambda[row + t] = -(point.lambda[row] * contact.mu * (p.slack(contact.row + t, point.x) / slip));
  }
  return usable;
}

ModeSystem::ModeSystem(const ContactProblem& p, const ModePoint& point, const ExtendedVector* slips)
    : problem(&p), sigma(slips), H(p.M), direction(p.contacts.size()) {
  for (const Index i : p.equalities) active.push_back({.row = i});
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const Index rows = point.modes[c] == ContactMode::stick   ? p.contacts[c].rows()
                       : point.modes[c] == ContactMode::slide ? 1
                                                              : 0;
    for (Index t = 0; t < rows; ++t)
      active.push_back({p.contacts[c].row + t, static_cast<Index>(c), point.modes[c] == ContactMode::slide});
  }
  const auto count = static_cast<Index>(active.size());
  S = Matrix::Zero(count, p.size());
  row_size = column_size = Vector::Ones(count);
  Matrix columns = Matrix::Zero(count, p.size());
  for (Index k = 0; k < count; ++k) {
    const Row& row = active[at(k)];
    add_row(S, k, p, row.row, 1);
    add_row(columns, k, p, row.row, 1);
    if (p.row_norm[row.row] > 0) row_size[k] = column_size[k] = p.row_norm[row.row];
    if (!row.slides) continue;
    const auto c = at(row.contact);
    const ContactRows& contact = p.contacts[c];
    const DoubleDouble slip = p.slip(contact, point.x);
    if (!(slip.hi > referee::underflow_of_squares)) {
      usable = false;
      return;
    }
    for (Index t = 1; t < contact.rows(); ++t) {
      direction[c][at(t - 1)] = (p.slack(contact.row + t, point.x) / slip).hi;
      add_row(columns, k, p, contact.row + t, -contact.mu * direction[c][at(t - 1)]);
      column_size[k] = std::hypot(column_size[k], contact.mu * direction[c][at(t - 1)] * p.row_norm[contact.row + t]);
    }
    if (contact.rows() < 3) continue;
    // (I - tau tau') = nu nu' in two dimensions, nu = (-tau_2, tau_1).
    std::vector<std::pair<Index, double>> across;
    for (Index t = 1; t < 3; ++t)
      for (RowMatrix::InnerIterator it(p.J, contact.row + t); it; ++it) {
        const double part = (t == 1 ? -direction[c][1] : direction[c][0]) * it.value();
        const auto own = std::ranges::find(across, it.col(), &std::pair<Index, double>::first);
        own == across.end() ? void(across.emplace_back(it.col(), part)) : void(own->second += part);
      }
    const double weight = contact.mu * std::max(0.0, point.lambda[contact.row].hi) / slip.hi;
    for (const auto& [i, a] : across)
      for (const auto& [j, b] : across) H(i, j) += weight * a * b;
  }
  N = columns.transpose();
  if (sigma) {
    S = columns;
    row_size = column_size;
  }
}

Matrix ModeSystem::coupling(const Eigen::LLT<Matrix>& mass) const {
  return row_size.cwiseInverse().asDiagonal() * (S * mass.solve(N)) * column_size.cwiseInverse().asDiagonal();
}

DoubleDouble ModeSystem::row_residual(const Row& row, const ExtendedVector& x) const {
  const DoubleDouble s = problem->slack(row.row, x);
  if (!sigma || row.contact < 0) return s;
  const ContactRows& contact = problem->contacts[at(row.contact)];
  if (row.row != contact.row) return s;
  const DoubleDouble lift = (*sigma)[row.contact];
  return s + DoubleDouble(contact.mu) * (row.slides ? lift - problem->slip(contact, x) : lift);
}

bool change_modes(const ContactProblem& p, ModePoint& point, double holds) {
  bool changed = false;
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const ContactRows& contact = p.contacts[c];
    if (contact.unit == 0) continue;
    const Index row = contact.row;
    ContactMode& mode = point.modes[c];
    const ContactMode before = mode;
    const double l_n = point.lambda[row].hi, s_n = p.slack(contact.row, point.x).hi;
    if (mode == ContactMode::open) {
      if (s_n < -holds) mode = ContactMode::stick;
    } else if (l_n < -holds) {
      mode = ContactMode::open;
      for (Index t = 0; t < contact.rows(); ++t) point.lambda[row + t] = 0;
    } else if (mode == ContactMode::stick && contact.rows() > 1) {
      const DoubleDouble tangential = point.lambda.segment(row + 1, contact.rows() - 1).norm();
      const double l_t = tangential.hi;
      if ((tangential - DoubleDouble(contact.mu) * point.lambda[row]).hi > holds) {
        mode = ContactMode::slide;
        // A first slip against the force, by a push on the contact alone.
        ExtendedVector push = ExtendedVector::Zero(p.rows());
        for (Index k = row + 1; k < row + contact.rows(); ++k)
          push[k] = point.lambda[k] * (-referee::first_slip / l_t / (p.row_norm[k] * p.row_norm[k]));
        point.x += p.motion_by(push);
      }
    } else if (mode == ContactMode::slide && !(p.slip(contact, point.x).hi > holds)) {
      mode = ContactMode::stick;
    }
    changed |= mode != before;
  }
  return changed;
}

double polish(const ContactProblem& p, ModePoint& point, const ExtendedVector* sigma, double* work) {
  double least = infinity, last = infinity;
  ModePoint best = point;
  std::optional<ModeSystem> system;
  Eigen::LLT<Matrix> mass;
  Eigen::CompleteOrthogonalDecomposition<Matrix> rows;
  rows.setThreshold(referee::mode_pivot);
  int without_gain = 0;
  const bool turns = std::ranges::count(point.modes, ContactMode::slide) > 0;  // else the system is always the same
  for (int step = 0; step < newton_steps; ++step) {
    if (!settle_forces(p, point)) break;
    if (!system || (turns && last > referee::refine_below)) {
      system.emplace(p, point, sigma);
      if (!system->usable) break;
      mass.compute(system->H);
      if (mass.info() != Eigen::Success) break;
      if (!system->active.empty()) rows.compute(system->coupling(mass));
      if (work) *work += std::pow(static_cast<double>(system->active.size()), 3);
    }
    const Residual r = residual_of(*system, point);
    if (!r.finite) break;
    const Vector free = mass.solve(r.force);
    Vector change = Vector::Zero(r.rows.size());
    if (change.size() > 0)
      change =
          rows.solve((system->S * free - r.rows).cwiseQuotient(system->row_size)).cwiseQuotient(system->column_size);
    const Vector move = mass.solve(system->N * change) - free;
    // The step says how far the equations are from holding; rows that contradict each other by rounding do not count.
    last = std::max(move.size() > 0 ? move.lpNorm<Eigen::Infinity>() : 0,
                    change.size() > 0 ? change.lpNorm<Eigen::Infinity>() : 0);
    if (!std::isfinite(last)) break;
    without_gain = last < least / 2 ? 0 : without_gain + 1;
    if (last < least) {
      least = last;
      best = point;
    }
    if (!(last > referee::refined_modes) || without_gain > 3) break;
    point.x += move.cast<DoubleDouble>();
    for (Index k = 0; k < change.size(); ++k) point.lambda[system->active[at(k)].row] += change[k];
  }
  point = best;
  return least;
}

}  // namespace zwang

#include <zwang/core/referee/friction/interval_newton.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <zwang/core/referee/exact_rank.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::down, referee::or_infinity, referee::up, referee::unit_roundoff;

constexpr int refinements = 12;
// How often modes that do not hold are changed, and how often by the last digits.
constexpr int mode_changes = 12, mode_changes_by_last_digits = 2;

// Independent rows and columns of K = S H^-1 N, by elimination with full pivoting.
struct Part {
  std::vector<Index> rows, columns, dropped_rows, frozen;
};

Part independent_part(Eigen::FullPivLU<Matrix>& lu, Index count, double threshold) {
  Part part;
  if (count == 0) return part;
  lu.setThreshold(threshold);
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
  Krawczyk(const ContactProblem& problem, const ModePoint& point, const ModeSystem& system, const Part& part)
      : p_(problem), point_(point), system_(system), part_(part) {}

  ModeProof prove() {
    ModeProof proof{.point = point_};
    const Index n = p_.size(), rank = static_cast<Index>(part_.rows.size()), N = n + rank;
    for (const Index k : part_.frozen) {  // a double, so that its value has a place among exact equations
      DoubleDouble& l = point_.lambda[system_.active[at(k)].row];
      l = l.hi;
    }
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
    const double gamma = static_cast<double>(N + 20) * unit_roundoff * referee::widened_sum;
    const Vector start = (R_ * value).cwiseAbs() + absolute_R_ * (gamma * value.cwiseAbs() + value_error);
    Vector r = start.array() * referee::widened_sum + referee::underflow_of_squares;
    bool inside = false;
    double contraction = 0;  // bounds |I - R F'| on the box, in the norm max |v_i| / r_i
    for (int round = 0; round < 12 && !inside; ++round) {
      const Vector spread = jacobian_spread(r);
      if (!spread.allFinite()) return proof;
      const Vector turned =
          (identity_error * r + absolute_R_ * (gamma * (absolute_A * r) + spread + gamma * gamma * r)) * up(1);
      const Vector image = start * up(1) + turned;
      if (!image.allFinite()) return proof;
      inside = (image.array() < r.array()).all();
      if (N > 0) contraction = (turned.array() / r.array()).maxCoeff() * up(1);
      if (!inside) r = image.array() * referee::inflated + referee::underflow_of_squares;
    }
    if (!inside) return proof;
    proof.proven = true;
    proof.radius = p_.norm_bound(r.head(n));
    const bool by_rows = judge_modes(r, proof);
    proof.null_motion = null_motion();
    proof.unique_forces = part_.frozen.empty();
    proof.continuum = proof.strict && proof.delta == 0 && by_rows && moves(r, contraction, gamma);
    return proof;
  }

 private:
  Matrix derivative() const {
    const Index n = p_.size(), rank = static_cast<Index>(part_.rows.size());
    Matrix A = Matrix::Zero(n + rank, n + rank);
    A.topLeftCorner(n, n) = system_.H;
    for (Index k = 0; k < rank; ++k) {
      A.col(n + k).head(n) = -system_.N.col(part_.columns[at(k)]);
      A.row(n + k).head(n) = system_.S.row(part_.rows[at(k)]);
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
      point_.x -= step.head(p_.size()).cast<DoubleDouble>();
      for (std::size_t k = 0; k < part_.columns.size(); ++k)
        point_.lambda[system_.active[at(part_.columns[k])].row] -= step[p_.size() + static_cast<Index>(k)];
      if (!settle_forces(p_, point_)) return false;
    }
    residuals(value, value_error);
    return true;
  }

  double multiplier_radius(Index row, const Vector& r) const {
    for (std::size_t k = 0; k < part_.columns.size(); ++k)
      if (system_.active[at(part_.columns[k])].row == row) return r[p_.size() + static_cast<Index>(k)];
    return 0;
  }

  // F at the point, and bounds on its rounding.
  void residuals(Vector& value, Vector& error) const {
    const Index n = p_.size();
    value.head(n) = p_.force_residual(point_.x, point_.lambda).cast<double>();
    error.head(n) = p_.force_error(point_.x, point_.lambda);
    error.head(n) += unit_roundoff * value.head(n).cwiseAbs();
    for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
      if (point_.modes[c] != ContactMode::slide) continue;
      const ContactRows& contact = p_.contacts[c];
      const double slip = p_.slip(contact, point_.x).hi;
      const double turn = referee::rounding_of_few + 4 * p_.slip_error(contact, point_.x) / slip;
      const double push = contact.mu * std::abs(point_.lambda[contact.row].hi) * turn;
      for (Index t = 1; t < contact.rows(); ++t) p_.add_push(contact.row + t, push, error);
    }
    for (std::size_t k = 0; k < part_.rows.size(); ++k) {
      const Index row = system_.active[at(part_.rows[k])].row, at = n + static_cast<Index>(k);
      value[at] = p_.slack(row, point_.x).hi;
      error[at] = p_.slack_error(row, point_.x) + unit_roundoff * std::abs(value[at]);
    }
  }

  // By how much the slip changes in the box, and its least size there.
  double slip_reach(const ContactRows& contact, const Vector& radius) const {
    double reach = 0;
    for (Index t = 1; t < contact.rows(); ++t) reach = std::hypot(reach, p_.reach(contact.row + t, radius));
    return up(reach);
  }
  double least_slip(const ContactRows& contact, const Vector& radius) const {
    const double error = p_.slip_error(contact, point_.x);
    return down(p_.slip(contact, point_.x).hi - error) - slip_reach(contact, radius);
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
      const double push = std::abs(point_.lambda[contact.row].hi);
      const double push_radius = multiplier_radius(contact.row, r);
      const double reach = slip_reach(contact, radius);
      const double error = p_.slip_error(contact, point_.x);
      const double least = least_slip(contact, radius);
      if (!(least > 0)) return Vector::Constant(r.size(), std::numeric_limits<double>::quiet_NaN());
      // The direction turns by at most reach / least; (I - tau tau')/|s_t| changes by at most 2 reach / least^2.
      const double lost = std::max(0.0, -point_.lambda[contact.row].hi);
      const double rounding = static_cast<double>(n + 40) * unit_roundoff + error / least;
      double bound = contact.mu * push_radius * (reach / least + rounding);
      if (contact.rows() > 2)
        bound += contact.mu * reach *
                 ((push + push_radius) * 2 * reach / least / least + (push_radius + lost) / least +
                  4 * push * rounding / least);
      for (Index t = 1; t < contact.rows(); ++t) p_.add_push(contact.row + t, bound, out);
      p_.add_push(contact.row, push_radius * rounding, out);
    }
    for (Index j = 0; j < n; ++j)
      for (SparseMatrix::InnerIterator it(p_.M, j); it; ++it)
        out[it.row()] += static_cast<double>(p_.contacts.size() + 8) * unit_roundoff * std::abs(it.value()) * radius[j];
    return out;
  }

  // A condition of the modes that the box leaves open. It holds where it is met with equality: where these are zero.
  struct Doubt {
    std::vector<Index> slacks = {};                                  // s_i
    std::vector<std::vector<std::pair<Index, double>>> forces = {};  // sums of multipliers of rows times numbers
    double off = 0;
    bool of_force = false;
  };

  // What the modes ask for beside their equations, on the whole box. Returns whether the rows that are left out follow
  // from those that are imposed, whatever the forces.
  bool judge_modes(const Vector& r, ModeProof& proof) const {
    const Vector radius = r.head(p_.size());
    proof.strict = true;
    std::vector<Doubt> doubts;
    double off_rows = 0, off_forces = 0;
    const auto off = [&](const Doubt& doubt) {
      if (doubt.of_force)
        off_forces += or_infinity(doubt.off);
      else
        off_rows = std::hypot(off_rows, or_infinity(doubt.off));
    };
    // value +- spread should not be negative.
    const auto ask = [&](double value, double spread, Doubt doubt) {
      const double least = value - spread;
      if (!(least > 0)) proof.strict = false;
      if (least >= 0) return;
      doubt.off *= -least;
      if (value + spread >= 0)
        doubts.push_back(std::move(doubt));
      else
        off(doubt);
    };
    if (p_.fixed_contradiction) off({.off = infinity});
    for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
      const ContactRows& contact = p_.contacts[c];
      const Index row = contact.row;
      if (point_.modes[c] == ContactMode::open) {
        const double slack = p_.slack(contact.row, point_.x).hi;
        if (contact.unit == 0) {  // exact: it holds or not
          if (!p_.zero_row_holds(contact.row)) off({.off = infinity});
          continue;
        }
        const double spread = (p_.slack_error(contact.row, point_.x) + p_.reach(contact.row, radius)) * up(1);
        ask(slack, spread, {.slacks = {contact.row}, .off = 1 / contact.unit});
        continue;
      }
      double weight = 0;  // |J_i'| in the dual norm, of any unit force of the contact
      for (Index t = 0; t < contact.rows(); ++t) weight = std::hypot(weight, p_.row_norm[contact.row + t]);
      const double normal = point_.lambda[row].hi, normal_radius = multiplier_radius(contact.row, r);
      ask(normal, normal_radius + referee::measured * std::abs(normal) * (normal_radius > 0),
          {.forces = {{{contact.row, 1}}}, .off = (1 + contact.mu) * weight, .of_force = true});
      if (point_.modes[c] == ContactMode::slide || contact.rows() == 1) continue;
      ask_cone(contact, r, weight, ask);
    }
    Doubt dropped;
    for (const Index k : part_.dropped_rows) {
      const ModeSystem::Row& row = system_.active[at(k)];
      dropped.slacks.push_back(row.row);
      dropped.off = std::hypot(dropped.off, (std::abs(p_.slack(row.row, point_.x).hi) +
                                             p_.slack_error(row.row, point_.x) + p_.reach(row.row, radius)) /
                                                system_.row_size[k]);
    }
    const bool by_rows = dropped.slacks.empty() || met_with_equality({dropped}, false);
    if (!by_rows) doubts.push_back(std::move(dropped));
    const bool may_hold = !doubts.empty() && !(off_rows + off_forces > 0);
    if (may_hold && (met_with_equality(doubts, true) || met_with_equality(doubts, false))) doubts.clear();
    for (const Doubt& doubt : doubts) {
      proof.strict = false;
      off(doubt);
    }
    proof.delta = up(off_rows + off_forces);
    return by_rows;
  }

  // mu l_n >= |l_t|.
  template <class Ask>
  void ask_cone(const ContactRows& contact, const Vector& r, double weight, const Ask& ask) const {
    const Index row = contact.row;
    const DoubleDouble edge = DoubleDouble(contact.mu) * point_.lambda[row];
    DoubleDouble squares;
    double spread = contact.mu * multiplier_radius(contact.row, r);
    std::vector<std::pair<Index, double>> sum{{contact.row, contact.mu}};
    Doubt doubt{.off = weight, .of_force = true};
    for (Index t = 1; t < contact.rows(); ++t) {
      const DoubleDouble l = point_.lambda[row + t];
      squares += l * l;
      spread += multiplier_radius(contact.row + t, r);
      if (std::abs(l.hi) > referee::aligned * edge.hi)
        sum.emplace_back(contact.row + t, l.hi > 0 ? -1 : 1);
      else
        doubt.forces.push_back({{contact.row + t, 1}});
    }
    const DoubleDouble tangential = sqrt(squares);
    const double rounding =
        squares == DoubleDouble(0) && edge == DoubleDouble(0)
            ? 0
            : referee::rounding_of_few * (std::abs(tangential.hi) + std::abs(edge.hi)) + referee::underflow_of_squares;
    if (sum.size() <= 2) doubt.forces.push_back(std::move(sum));  // else the edge is not linear
    if (doubt.forces.size() < at(contact.rows() - 1)) doubt.forces = {{}};
    ask((edge - tangential).hi, rounding + up(spread), std::move(doubt));
  }

  // Are all of these exactly zero at the solution in the box? In integers modulo primes, from the equations that are
  // linear: the stored rows that are imposed; `with_forces` also M d = J'lambda, the forces that are frozen, and the
  // friction of contacts with one tangent that slide.
  bool met_with_equality(const std::vector<Doubt>& doubts, bool with_forces) const {
    const Index n = p_.size();
    std::vector<Index> place(at(p_.rows()), -1);
    Index unknowns = 2 * n;
    for (std::size_t c = 0; c < p_.contacts.size(); ++c)
      for (Index t = 0; t < p_.contacts[c].rows() && point_.modes[c] != ContactMode::open; ++t)
        place[at(p_.contacts[c].row + t)] = unknowns++;
    for (const Index i : p_.equalities) place[at(i)] = unknowns++;
    const auto imposed = static_cast<double>(part_.rows.size()), size = static_cast<double>(unknowns);
    const auto more = static_cast<double>(part_.dropped_rows.size() + doubts.size());
    const double work = with_forces ? size * size * size : (imposed + more) * imposed * static_cast<double>(n);
    if (work > referee::exact_products) return false;

    // Columns: z, d = z - z_u, lambda.
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> right;
    bool exact = !with_forces || p_.keeps_motion;
    const auto put = [&](Index column, double value) {
      entries.emplace_back(static_cast<int>(right.size()), static_cast<int>(column), value);
    };
    const auto close = [&](double value) {
      exact &= referee::ordinary(value);
      right.push_back(value);
    };
    const auto add_stored = [&](Index row) {
      for (RowMatrix::InnerIterator it(p_.J, row); it; ++it) put(it.col(), it.value());
      exact &= (p_.c[row] == 0) == (p_.stored_c[row] == 0);
      close(p_.c[row]);
    };
    for (const Index k : part_.rows) add_stored(system_.active[at(k)].row);
    if (with_forces) {
      RowMatrix M = p_.M, transposed = p_.J.transpose();
      for (Index j = 0; j < n; ++j) {
        put(j, 1);
        put(n + j, -1);
        close(p_.z_u[j]);
        for (RowMatrix::InnerIterator it(M, j); it; ++it) put(n + it.col(), it.value());
        for (RowMatrix::InnerIterator it(transposed, j); it; ++it)
          if (const Index at = place[static_cast<std::size_t>(it.col())]; at >= 0) put(at, -it.value());
        close(0);
      }
      for (const Index k : part_.frozen) {
        const Index row = system_.active[at(k)].row;
        put(place[at(row)], 1);
        close(point_.lambda[row].hi);
      }
      for (std::size_t c = 0; c < p_.contacts.size(); ++c) {
        const ContactRows& contact = p_.contacts[c];
        if (point_.modes[c] != ContactMode::slide || contact.rows() != 2) continue;
        put(place[at(contact.row + 1)], 1);
        put(place[at(contact.row)], system_.direction[c][0] > 0 ? contact.mu : -contact.mu);
        close(0);
      }
    }
    const std::size_t basis = right.size();
    for (const Doubt& doubt : doubts) {
      for (const Index row : doubt.slacks) add_stored(row);
      for (const auto& sum : doubt.forces) {
        if (!with_forces || sum.empty()) return false;
        for (const auto& [row, factor] : sum) put(place[at(row)], factor);
        close(0);
      }
    }
    if (!exact) return false;
    const auto equations = sparse_of<RowMatrix>(std::ssize(right), with_forces ? unknowns : n, entries);
    const std::vector<Index> rows = numbers_from(Index{0}, right.size());
    const std::span all(rows);
    return exact_consistency(equations, Eigen::Map<const Vector>(right.data(), std::ssize(right)), all.first(basis),
                             all.subspan(basis)) == Consistency::consistent;
  }

  double null_motion() const {
    const Index n = p_.size(), rank = static_cast<Index>(part_.columns.size());
    const auto count = static_cast<Index>(part_.frozen.size());
    if (count == 0) return 0;
    Matrix right = Matrix::Zero(n + rank, count);
    for (Index k = 0; k < count; ++k) right.col(k).head(n) = system_.N.col(part_.frozen[at(k)]);
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
      const ModeSystem::Row& row = system_.active[at(k)];
      if (row.slides) {
        const ContactRows& contact = p_.contacts[at(row.contact)];
        const double turn = contact.mu * (slip_turn(contact, r.head(n)) + gamma);
        for (Index t = 0; t < contact.rows(); ++t) p_.add_push(contact.row + t, t == 0 ? gamma : turn, error);
      }
      const Vector move = R_ * column;
      error = (absolute_R_ * (error + gamma * column.cwiseAbs())).eval() * up(1);
      const double size = ((move.cwiseAbs() + error).array() / r.array()).maxCoeff();
      error += contraction / (1 - contraction) * up(1) * size * r;
      if ((move.cwiseAbs() - error).head(n).maxCoeff() > 0) return true;
    }
    return false;
  }

  const ContactProblem& p_;
  ModePoint point_;
  ModeSystem system_;
  Part part_;
  Matrix R_, absolute_R_;
};

ModeProof prove_modes(const ContactProblem& problem, const ModePoint& point) {
  ModeProof best{.point = point};
  const ModeSystem system(problem, point, nullptr);
  if (!system.usable || !problem.exact) return best;
  const Eigen::LLT<Matrix> mass(system.H);
  if (mass.info() != Eigen::Success) return best;
  const auto count = static_cast<Index>(system.active.size());
  Eigen::FullPivLU<Matrix> lu;
  if (count > 0) lu.compute(system.coupling(mass));
  std::size_t rank = at(count) + 1;
  for (const double threshold : referee::independent_pivots) {
    const Part part = independent_part(lu, count, threshold);
    if (part.rows.size() == std::exchange(rank, part.rows.size())) continue;
    ModeProof proof = Krawczyk(problem, point, system, part).prove();
    if (proof.proven && (!best.proven || proof.delta < best.delta)) best = std::move(proof);
    if (best.proven && best.delta == 0) break;
  }
  return best;
}

}  // namespace

ModeProof prove_near(const ContactProblem& problem, ModePoint guess, double* work) {
  double own_work = 0;
  ModeProof best{.point = guess};
  std::vector<std::vector<ContactMode>> tried;
  int last_digits = mode_changes_by_last_digits;
  for (int round = 0; round < mode_changes && own_work <= referee::searched_products; ++round) {
    if (std::ranges::find(tried, guess.modes) != tried.end()) break;
    tried.push_back(guess.modes);
    const double left = polish(problem, guess, nullptr, &own_work);
    if (left < referee::polished) {
      ModeProof proof = prove_modes(problem, guess);
      if (proof.proven && (!best.proven || proof.delta < best.delta)) best = std::move(proof);
      if (best.proven && best.delta == 0) break;
    }
    if (change_modes(problem, guess, referee::holds)) continue;
    if (!best.proven || --last_digits < 0) break;
    guess = best.point;
    if (!change_modes(problem, guess, 0)) break;
  }
  if (work) *work += own_work;
  return best;
}

}  // namespace zwang

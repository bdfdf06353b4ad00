#include <zwang/solvers/friction/solution_derivative.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace zwang {
namespace {

std::atomic<long> last_number = 0;

struct Workspace {  // fresh, all of a derivative takes twice the time
  ConeProgram program;
  ModeEquations equations;
  Solution answer;
  Vector push, v, y, s;
  NullSpaceForm form;      // that a solver of the thread left
  long owner = 0;          // whose rows and factor these are
  bool is_whole, is_back;  // the factor: of all its rows, of the transposed equations
};

Workspace& workspace() {
  thread_local Workspace work;
  return work;
}

Deadline most_time() { return Deadline(60); }  // s

}  // namespace

NullSpaceForm& SolutionDerivative::form() { return workspace().form; }

SolutionDerivative::SolutionDerivative(const Problem& p, const Values& z, const Values& lambda)
    : change_{.M = p.M, .J = p.J, .kind = p.kind, .law = p.law}, z_(z), lambda_(lambda), number_(++last_number) {
  if (z.size() != p.size() || lambda.size() != p.rows())
    throw std::invalid_argument("modes are read off z and lambda of a solution");
  Vector mass = Vector::Zero(p.size()), left = Vector::Zero(p.size());
  for (Index j = 0; j < p.size(); ++j)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it) {
      left[it.row()] += it.value() * (z[j] - p.z_u[j]);
      if (it.row() == j) mass[j] = it.value();
    }
  const Vector light = mass.cwiseInverse();
  owner_.assign(at(p.rows()), 0);
  change_.c.setConstant(p.rows(), -infinity);
  slack_.resize(p.rows());
  half_ = (p.z_u - z) / 2;
  Vector unit(p.rows());  // a motion of length 1 moves a row by a `unit`
  for (Index i = 0; i < p.rows(); ++i) {
    double own = -p.c[i], squares = 0;
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it) {
      own += it.value() * z[it.col()];
      squares += it.value() * it.value() * light[it.col()];
    }
    slack_[i] = own;
    unit[i] = squares > 0 ? squares : 1;
    if (lambda[i] != 0)
      for (RowMatrix::InnerIterator it(p.J, i); it; ++it) left[it.col()] -= it.value() * lambda[i];
  }
  for (double& own : unit) own = std::sqrt(own);  // side by side
  const auto length = [&](const Vector& v) { return std::sqrt(v.cwiseAbs2().dot(mass)); };
  motion = std::max(length(z), length(p.z_u));
  off = length(left.cwiseProduct(light));
  by_mu.setZero(p.rows());
  std::vector<Index> held;
  held.reserve(at(p.rows()));
  double apart = 0;  // ties
  const double zero = tolerances::derivative_tie * motion, opening = ConeLaw::of(p.law).opening();
  for (Index i = 0, tangents = 0; i < p.rows(); i += 1 + tangents) {
    tangents = p.has_tangents() ? p.tangents(i) : 0;
    const double mu = tangents > 0 ? p.mu[i] : 0, slip = mu > 0 ? slack_.segment(i + 1, tangents).norm() : 0;
    const double push = lambda[i] * unit[i], gap = (slack_[i] - opening * mu * slip) / unit[i];
    double slides = 0, spare = infinity;
    if (mu > 0) {
      const double across = unit[i + 1];
      slides = slip / across;
      spare = (mu * lambda[i] - lambda.segment(i + 1, tangents).norm()) * across;
    }
    const bool holds = p.is_equality(i) || push > zero;
    off = std::max(off, p.is_equality(i) ? std::abs(gap) : std::max({-push, -gap, std::min(push, gap), -spare}));
    if (mu > 0 && holds) off = std::max(off, std::min(spare, slides));
    if (!holds && gap > zero) continue;
    if (!holds || (spare <= zero && slides <= zero)) {
      ties.push_back(i);
      apart = std::max(apart, gap);
      ties_rub = ties_rub || mu > 0;
      continue;
    }
    for (Index r = i; r <= i + (mu > 0 ? tangents : 0); ++r) {
      held.push_back(r);
      owner_[at(r)] = i;
    }
    if (mu == 0) continue;
    mode_.push_back(slides > zero ? Mode::slide : Mode::stick);
    if (mode_.back() == Mode::stick) continue;
    by_mu[i] = -opening * slip;
    by_mu.segment(i + 1, tangents) = -lambda[i] / slip * slack_.segment(i + 1, tangents);
  }
  held.insert(held.end(), ties.begin(), ties.end());
  rows = Eigen::Map<const VectorX<Index>>(held.data(), std::ssize(held));
  change_.c(rows).setZero();
  if (!mode_.empty()) {
    change_.mu = p.mu;
    for (const Index i : ties) change_.mu[i] = 0;
  }
  if (!ties.empty() && !ties_rub && !slides() && off <= zero && apart <= tolerances::derivative_still * motion)
    share_load();
}

// Where a load is shared, other forces do the same, and a tie that pushes by one of them is none: forces that move
// nothing, and pull at no tie. They are looked for from those that lead to the least forces: ties that do not push are
// made to, and the part that moves nothing is kept, by turns.
void SolutionDerivative::share_load() {
  Workspace& work = workspace();
  ModeEquations& equations = work.equations;
  build();
  equations.active.assign(equations.active.size(), 1);
  factorize(false);
  work.is_whole = true;
  work.owner = number_;
  std::vector<Index> push, at_ties;
  for (Index i = 3 * work.program.cones(); i < work.program.rows(); ++i)
    if (std::ranges::binary_search(ties, work.program.source(i))) at_ties.push_back(i);
  work.push = -work.push;
  bool pulls = true;
  constexpr int most_turns = 8;
  for (int turn = 0; pulls && turn < most_turns; ++turn) {
    const double size = work.push.lpNorm<Eigen::Infinity>();
    for (const Index i : at_ties) work.push[i] = std::max(work.push[i], size == 0 ? 1 : turn == 0 ? 0 : size / 8);
    if (!equations.keep_still(work.program, work.push)) return;
    work.push = equations.next;
    const double least = tolerances::promise_part * work.push.lpNorm<Eigen::Infinity>();
    pulls = false;
    push.clear();
    for (const Index i : at_ties) {
      pulls = pulls || work.push[i] < -least;
      if (work.push[i] > least) push.push_back(work.program.source(i));
    }
  }
  if (pulls || push.empty()) return;
  is_unique_ = false;
  std::ranges::sort(push);
  std::erase_if(ties, [&](Index i) { return std::ranges::binary_search(push, i); });
  std::stable_partition(rows.begin(), rows.end(), [&](Index i) { return !std::ranges::binary_search(ties, i); });
}

void SolutionDerivative::build() {
  Workspace& work = workspace();
  if (std::exchange(work.owner, 0) == number_) return;
  ConeProgram& program = work.program;
  change_.z_u.setZero(change_.M.cols());
  const bool built = program.build(change_, ConeProgram::Want::sparse, {}, most_time(), work.answer, &work.form);
  if (!built && work.answer.status == Status::bad_input) throw std::invalid_argument(work.answer.message.c_str());
  if (!built || program.cones() != std::ssize(mode_)) throw std::invalid_argument("a row without entries pushes");
  work.equations.begin(program);
  work.equations.mode = mode_;
  if (program.law().lifts() && work.equations.slides() && !program.is_dense()) program.couple();
  work.is_whole = false;
}

void SolutionDerivative::factorize(bool back) {
  Workspace& work = workspace();
  work.push.setZero(work.program.rows());
  work.program.scale_multipliers(lambda_, work.push);
  if (!work.equations.begin_change(work.program, work.push, work.program.scaled_slack(slack_), back))
    throw std::invalid_argument("the modes' equations break down");
  work.is_back = back;
}

SolutionDerivative::Change SolutionDerivative::along(const Values& dz_u, const Values& force, const Values& moved,
                                                     const Values& dmu) {
  const Index n = change_.M.cols(), m = by_mu.size();
  const auto whole = [](const Values& v, Index size, const char* name) -> Vector {
    if (v.size() != 0 && v.size() != size) throw std::invalid_argument(std::string(name) + " has another size");
    if (v.size() == 0) return Vector::Zero(size);
    return v;
  };
  Sides sides{whole(dz_u, n, "dz_u"), whole(force, n, "force"), whole(moved, m, "moved")};
  if (dmu.size() == 0) return solve(sides, false);
  Vector turned = by_mu.cwiseProduct(whole(dmu, m, "dmu")(owner_));  // forces of what slides
  for (const Index i : rows)
    if (!change_.is_tangent(i)) sides.moved[i] += std::exchange(turned[i], 0);
  sides.force += change_.J.transpose() * turned;
  Change change = solve(sides, false);
  change.lambda += turned;
  return change;
}

SolutionDerivative::Bars SolutionDerivative::back(const Values& z_bar, const Values& lambda_bar) {
  const Index n = change_.M.cols(), m = by_mu.size();
  if (z_bar.size() != n || (lambda_bar.size() != 0 && lambda_bar.size() != m))
    throw std::invalid_argument("z_bar and lambda_bar should have one entry an unknown and a row");
  Sides sides{Vector::Zero(n), z_bar, Vector::Zero(m)};
  if (lambda_bar.size() > 0) sides.moved = lambda_bar;
  Bars bars{solve(sides, true), {}, Vector::Zero(m)};
  if (n > 0) bars.z_u = workspace().program.momentum(change_, bars.change.z);
  if (!slides()) return bars;
  const Vector moved = change_.J * bars.change.z + sides.moved;
  for (const Index i : rows)
    bars.mu[owner_[at(i)]] += by_mu[i] * (change_.is_tangent(i) ? moved[i] : bars.change.lambda[i]);
  return bars;
}

SolutionDerivative::Full SolutionDerivative::by_M(const Change& change) const {
  Full out(z_.size(), z_.size());
  for (Index i = 0; i < out.rows(); ++i) out.row(i) = change.z[i] * half_ + half_[i] * change.z;
  return out;
}

SolutionDerivative::Full SolutionDerivative::by_J(const Change& change) const {
  Full out = Full::Zero(lambda_.size(), z_.size());
  for (const Index i : rows) out.row(i) = lambda_[i] * change.z + change.lambda[i] * z_;
  return out;
}

SolutionDerivative::Change SolutionDerivative::solve(const Sides& sides, bool back) {
  Change change = once(sides, back);
  if (change.is_small && ties.empty()) {
    const Change more = once(left(sides, change, back), back);
    change.z += more.z;
    change.lambda += more.lambda;
  }
  return change;
}

// What a change leaves of the sides, in long doubles: of what slides the plane's part, in its normal row.
SolutionDerivative::Sides SolutionDerivative::left(const Sides& sides, const Change& change, bool back) const {
  using Wide = VectorX<long double>;
  const Wide z = change.z.cast<long double>(), own = change.lambda.cast<long double>();
  Wide force =
      sides.force.cast<long double>() + change_.M.cast<long double>() * (sides.z_u.cast<long double>() - z).eval();
  for (const Index i : rows)
    for (RowMatrix::InnerIterator it(change_.J, i); it; ++it) force[it.col()] += it.value() * own[i];
  Wide missed = change_.J.cast<long double>() * z + sides.moved.cast<long double>();
  const double opening = back ? 1 : ConeLaw::of(change_.law).opening();
  std::size_t contact = 0;
  for (const Index i : rows) {
    if (!rubs(i) || mode_[contact++] != Mode::slide) continue;
    const Index tangents = change_.tangents(i);
    const auto along = by_mu.segment(i + 1, tangents).cast<long double>();
    auto slip = missed.segment(i + 1, tangents);
    missed[i] += opening * change_.mu[i] * along.dot(slip) / along.norm();
    slip.setZero();
  }
  return {Vector::Zero(z.size()), force.cast<double>(), missed.cast<double>()};
}

SolutionDerivative::Change SolutionDerivative::once(const Sides& sides, bool back) {
  Workspace& work = workspace();
  ConeProgram& program = work.program;
  ModeEquations& equations = work.equations;
  const double size = sides.z_u.lpNorm<1>() + sides.force.lpNorm<1>() + sides.moved(rows).lpNorm<1>();
  if (size != 0 && !(size < tolerances::derivative_length && 1 / size < tolerances::derivative_length))
    throw std::invalid_argument("the squares of the direction's entries are beyond doubles");
  if (change_.M.cols() == 0) return {sides.z_u, Vector::Zero(by_mu.size()), true, true, false};
  build();
  int unit = 0;
  (void)std::frexp(size, &unit);
  const double down = std::ldexp(1.0, -unit);
  change_.z_u = down * sides.force;
  if (!change_.z_u.isZero(0)) program.move_freely(change_.z_u);
  change_.z_u += down * sides.z_u;
  change_.c(rows) = -down * sides.moved(rows);
  if (!program.restate(change_, most_time())) throw std::invalid_argument("a row without entries pushes");
  Vector &v = work.v, &y = work.y, &s = work.s;
  const auto flip = [&](double share) {  // of the ties that pull or are violated; how many
    const double zero = share * program.scale(v);
    Index count = 0;
    for (Index i = 3 * program.cones(); i < program.rows(); ++i) {
      char& pushes = equations.active[at(i - 3 * program.cones())];
      if (!std::ranges::binary_search(ties, program.source(i)) || !((pushes ? y[i] : s[i]) < -zero)) continue;
      pushes = !pushes;
      ++count;
    }
    return count;
  };
  bool is_settled = false, has_factor = work.is_whole && (work.is_back == back || !program.law().lifts());
  double last = infinity, length = infinity;  // of the last two steps
  constexpr int most_rounds = 8;
  for (int round = 0; !is_settled && round < most_rounds; ++round) {
    work.is_whole = round == 0;
    if (work.is_whole && !has_factor) equations.active.assign(equations.active.size(), 1);
    if (!std::exchange(has_factor, false)) factorize(back);
    if (!is_unique_) {
      const bool too_many = mode_.empty() && rows.size() > change_.size();
      is_unique_ = rows.size() == 0 || (!too_many && equations.least_share(program) > 0);
    }
    v.setZero(program.face().unknowns());
    y.setZero(program.rows());
    s = -program.h();
    last = length = infinity;
    do {
      equations.aim(program, y, s);
      equations.step(program, v, y);
      program.slack(v, s);
      last = std::exchange(length, program.length(equations.dv));
      // Ties that the first step finds wrong by more than it is off are not worth another.
      is_settled = ties.empty() || last < infinity || flip(tolerances::promise_softness) == 0;
    } while (
        is_settled && length > 0 &&
        (last == infinity || (length * std::pow(length / last, 1.5) > tolerances::derivative_ends * program.scale(v) &&
                              !(length > last / 2))));
    is_settled = is_settled && flip(tolerances::derivative_still) == 0;
  }
  if (is_settled && !(equations.missed(program, s) <= tolerances::derivative_meets * program.scale(v)))
    throw std::invalid_argument("rows that push do not hold together");
  if (is_settled && length > last / 2 && !(length <= tolerances::derivative_meets * program.scale(v)))
    throw std::invalid_argument(*is_unique_ ? "the modes' equations are singular, or nearly"
                                            : "forces are not unique beside contacts that slide");
  program.write(change_, v, y, work.answer);
  const Vector& z = work.answer.z;
  const double way = std::ldexp(program.length(v), program.exponent()), rest = z.dot(program.momentum(change_, z));
  work.owner = number_;
  const double up = std::ldexp(1.0, unit);
  return {up * z, up * work.answer.lambda, *is_unique_, is_settled, way * way > tolerances::derivative_undone * rest};
}

}  // namespace zwang

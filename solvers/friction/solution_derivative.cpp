#include <zwang/solvers/friction/solution_derivative.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace zwang {

SolutionDerivative::SolutionDerivative(const Problem& p, const Vector& z, const Vector& lambda)
    : change_{.M = p.M, .law = p.law} {
  if (z.size() != p.size() || lambda.size() != p.rows())
    throw std::invalid_argument("modes are read off z and lambda of a solution");
  const Vector mass = p.M.diagonal(), light = mass.cwiseInverse(), slack = p.J * z - p.c,
               left = p.M * (z - p.z_u) - p.J.transpose() * lambda;
  const auto moves = [&](Index row) {  // a motion of unit length
    double sum = 0;
    for (RowMatrix::InnerIterator it(p.J, row); it; ++it) sum += it.value() * it.value() * light[it.col()];
    return sum > 0 ? std::sqrt(sum) : 1;
  };
  const auto length = [&](const Vector& v) { return std::sqrt(v.cwiseAbs2().dot(mass)); };
  motion = std::max(length(z), length(p.z_u));
  off = length(left.cwiseQuotient(mass));
  by_mu.setZero(p.rows());
  std::vector<Index> held;
  const double zero = tolerances::derivative_tie * motion, opening = ConeLaw::of(p.law).opening();
  for (Index i = 0, tangents = 0; i < p.rows(); i += 1 + tangents) {
    tangents = p.has_tangents() ? p.tangents(i) : 0;
    const double mu = tangents > 0 ? p.mu[i] : 0, slip = slack.segment(i + 1, tangents).norm();
    const double unit = moves(i), across = mu > 0 ? moves(i + 1) : 1;
    const double push = lambda[i] * unit, gap = (slack[i] - opening * mu * slip) / unit, slides = slip / across;
    const double spare = mu > 0 ? (mu * lambda[i] - lambda.segment(i + 1, tangents).norm()) * across : infinity;
    const bool holds = p.is_equality(i) || push > zero;
    off = std::max(off, p.is_equality(i) ? std::abs(gap) : std::max({-push, -gap, std::min(push, gap), -spare}));
    if (mu > 0 && holds) off = std::max(off, std::min(spare, slides));
    if (!holds && gap > zero) continue;
    if (!holds || (spare <= zero && slides <= zero)) {
      ties.push_back(i);
      continue;
    }
    for (Index r = i; r <= i + (mu > 0 ? tangents : 0); ++r) held.push_back(r);
    if (mu == 0) continue;
    mode_.push_back(slides > zero ? Mode::slide : Mode::stick);
    if (mode_.back() == Mode::stick) continue;
    by_mu[i] = -opening * slip;
    by_mu.segment(i + 1, tangents) = -lambda[i] / slip * slack.segment(i + 1, tangents);
  }
  held.insert(held.end(), ties.begin(), ties.end());
  rows = Eigen::Map<const VectorX<Index>>(held.data(), std::ssize(held));
  change_.J.resize(rows.size(), p.size());
  change_.J.reserve(p.J.nonZeros());
  for (const Index i : held) {
    const Index k = std::ssize(change_.kind);
    change_.J.startVec(k);
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it) change_.J.insertBack(k, it.col()) = it.value();
    change_.kind.push_back(p.kind[at(i)]);
  }
  change_.J.finalize();
  change_.key.resize(held.size());
  if (!mode_.empty()) change_.mu = p.mu(held);
  lambda_ = lambda(held);
  slack_ = slack(held);
}

SolutionDerivative::Change SolutionDerivative::solve(const Vector& dz_u, const Vector& force, const Vector& moved,
                                                     bool back) {
  change_.z_u = dz_u;
  change_.c = -moved;
  require_matching_sizes(change_);
  if (force.size() != change_.size()) throw std::invalid_argument("force should have one entry an unknown");
  const double size = dz_u.lpNorm<1>() + force.lpNorm<1>() + moved.lpNorm<1>();
  if (size != 0 && !(size < tolerances::derivative_length && 1 / size < tolerances::derivative_length))
    throw std::invalid_argument("the squares of the direction's entries are beyond doubles");
  thread_local SparseCholesky<double> mass;  // fresh, all of these take twice the time
  if (!force.isZero(0)) {
    if (!mass.factorize(change_.M)) throw std::invalid_argument("M is not positive definite");
    Vector by_force = force;
    mass.solve_lower(by_force);
    mass.solve_upper(by_force);
    change_.z_u += by_force;
  }
  thread_local ConeProgram program;
  thread_local ModeEquations equations;
  thread_local Solution answer;
  constexpr double most_seconds = 60;
  const bool built = program.build(change_, ConeProgram::Want::any, {}, Deadline(most_seconds), answer);
  if (!built || program.cones() != std::ssize(mode_)) throw std::invalid_argument("a row without entries pushes");
  Vector push = Vector::Zero(program.rows()), slack = program.scaled_slack(slack_), v, y, s;
  program.scale_multipliers(lambda_, push);
  equations.begin(program);
  equations.mode = mode_;
  equations.active.assign(equations.active.size(), 1);
  if (program.law().lifts() && equations.slides() && !program.is_dense()) program.couple();
  constexpr int most_rounds = 8;
  bool is_settled = false;
  for (int round = 0; !is_settled && round < most_rounds; ++round) {
    if (!equations.begin_change(program, push, slack, back))
      throw std::invalid_argument("the modes' equations break down");
    v.setZero(program.face().unknowns());
    if (!is_unique_) {
      const bool too_many = mode_.empty() && rows.size() > change_.size();
      is_unique_ = rows.size() == 0 || (!too_many && equations.least_share(program) > 0);
    }
    y.setZero(program.rows());
    s = -program.h();
    double last = infinity, length = infinity;
    do {
      equations.aim(program, y, s);
      equations.step(program, v, y);
      program.slack(v, s);
      last = std::exchange(length, program.length(equations.dv));
    } while (length > 0 &&
             (last == infinity ||
              (length * length > tolerances::derivative_ends * program.scale(v) * last && !(length > last / 2))));
    is_settled = true;
    const double zero = tolerances::derivative_still * program.scale(v);
    for (Index i = 3 * program.cones(); i < program.rows(); ++i) {
      char& pushes = equations.active[at(i - 3 * program.cones())];
      if (program.source(i) < rows.size() - std::ssize(ties) || !((pushes ? y[i] : s[i]) < -zero)) continue;
      pushes = !pushes;
      is_settled = false;
    }
  }
  if (is_settled && !(equations.missed(program, s) <= tolerances::derivative_meets * program.scale(v)))
    throw std::invalid_argument("rows that push do not hold together");
  program.write(change_, v, y, answer);
  const double way = std::ldexp(program.length(v), program.exponent()), rest = answer.z.dot(change_.M * answer.z);
  return {answer.z, answer.lambda, *is_unique_, is_settled, way * way > tolerances::derivative_undone * rest};
}

}  // namespace zwang

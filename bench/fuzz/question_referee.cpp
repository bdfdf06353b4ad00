#include <zwang/bench/fuzz/question_referee.h>

#include <cmath>

#include <zwang/bench/fuzz/frictional_problem.h>
#include <zwang/bench/fuzz/small_problem.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/judge.h>
#include <zwang/bench/references/reference.h>
#include <zwang/bench/scenes/dyadic.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr double by_roots = 1e-9;  // rounding of the truth's square roots
constexpr double most_motions = 1e8;
constexpr std::array tolerances{1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2};

struct Invented {
  std::string how;
  Vector z, lambda;
  bool right = false;
};

// Rows become copies of the ones before them, nearly so, or face them with a gap of 2^-10 to 2^-52 or none; rows, and
// the ground's unit against mu, are scaled.
void twist(Problem& p, Draw& draw) {
  Matrix J(p.J);
  const auto chance = [&](int of) { return draw.integer(1, of) == 1; };
  const auto size = [&](Index i) { return 1 + (p.has_tangents() ? p.tangents(i) : 0); };
  for (Index i = 0, before = -1; i < p.rows(); i += size(i)) {
    const Index rows = size(i);
    if (before >= 0 && size(before) == rows && chance(4)) {
      J.middleRows(i, rows) = J.middleRows(before, rows);
      p.c.segment(i, rows) = p.c.segment(before, rows);
      if (chance(2) && std::isfinite(p.c[i])) {
        J.row(i) *= -1;
        p.c[i] = draw.integer(-1, 1) * std::exp2(-draw.integer(10, 52)) - p.c[i];
      } else {
        J(i, draw.index(p.size())) += draw.integer(-1, 1) * std::exp2(-draw.integer(20, 50));
      }
    }
    if (!p.is_equality(i)) before = i;
  }
  for (Index i = 0; i < p.rows(); i += size(i)) {
    const Index rows = size(i);
    const double unit = chance(4) ? std::exp2(draw.integer(-40, 40)) : 1;
    const double ground = rows > 1 && chance(4) ? std::exp2(draw.integer(-30, 30)) : 1;
    J.middleRows(i, rows) *= unit;
    p.c.segment(i, rows) *= unit;
    J.middleRows(i + 1, rows - 1) *= ground;
    p.c.segment(i + 1, rows - 1) *= ground;
    if (rows > 1) p.mu[i] /= ground;
    if (!p.is_equality(i) && chance(24)) p.c[i] = -std::numeric_limits<double>::infinity();
  }
  p.J = J.sparseView();
  if (chance(32)) p.z_u.setZero();
}

// Answers of all kinds, and what the rationals say of them.
std::vector<Invented> invent(const Problem& p, const ExactSolutions& truth, Draw& draw) {
  const auto any = [&] { return draw.integers(p.rows(), 3); };
  std::vector<Invented> out;
  std::vector<ExactSolutions::Rounded> known = truth.solutions();
  for (const auto& [z, lambda] : known) {
    out.push_back({"a solution", z, lambda, true});
    out.push_back({"a solution without multipliers", z, {}, true});
  }
  known.insert(known.end(), truth.misses().begin(), truth.misses().end());
  for (std::size_t k = truth.solutions().size(); k < known.size(); ++k) {
    out.push_back({"a wrong choice of modes", known[k].z, known[k].lambda});
    if (k % 2 == 0) out.push_back({"that of a wrong choice of modes", known[k].z, {}});
  }
  known.push_back({p.z_u, Vector::Zero(p.rows())});
  const Matrix inverse = Matrix(p.M).inverse();
  for (int kind = 0; kind < 5; ++kind) {
    const auto& [z, lambda] = known[at(draw.index(std::ssize(known)))];
    const Vector way = (z - p.z_u).cwiseAbs() + p.z_u.cwiseAbs();
    const Vector off = std::exp2(-draw.integer(1, 52)) * way.maxCoeff() * draw.integers(p.size(), 2);
    Vector pushed = lambda;
    if (p.rows() > 0) {
      const Index row = draw.index(p.rows());
      const double own = std::max(lambda.lpNorm<Eigen::Infinity>() / 8, std::abs(lambda[row]));
      pushed[row] += own * draw.integer(-2, 2) * std::exp2(-draw.integer(0, 40));
    }
    if (kind == 0) out.push_back({"moved", z + off, lambda});
    if (kind == 1) out.push_back({"moved, without multipliers", z + off, {}});
    if (kind == 2) out.push_back({"multipliers of nothing", draw.integer(0, 1) == 0 ? z : Vector(z + off), any()});
    if (kind > 2) out.push_back({"what a wrong force does", p.z_u + inverse * (p.J.transpose() * pushed), pushed});
  }
  return out;
}

// Combinations of rows that may push against each other.
Vector certificate(const Problem& p, const FoundReference& found, Draw& draw) {
  Vector u = Vector::Zero(p.rows());
  if (found.reference && found.reference->certificate.size() == p.rows() && draw.integer(0, 1) == 0)
    u = found.reference->certificate;
  for (int k = draw.integer(0, 3); k > 0; --k) {
    const Index i = draw.index(p.rows());
    const double norm = p.J.row(i).norm();
    u[i] += (p.is_equality(i) ? draw.integer(-1, 1) : draw.integer(0, 1)) / (norm > 0 ? norm : 1);
  }
  return u;
}

}  // namespace

std::size_t referee_class(std::uint64_t number) {
  const std::uint64_t k = number % 143;
  return k < 100 ? 0 : k < 130 ? 1 : k < 140 ? 2 : 3;
}

void question_referee(std::uint64_t seed, std::uint64_t number, FuzzTally& tally,
                      const std::function<void(std::string, Instance)>& report) {
  Draw draw(static_cast<double>(mix_bits(seed ^ 0x3c6ef372, number) >> 12));
  const std::size_t kind = referee_class(number);
  const bool planted = kind == 3 || (kind == 2 && number % 2 == 0);
  Instance instance;
  Problem& p = instance.problem;
  if (planted) {
    instance = planted_problem(seed, number, kind == 3 ? stored_law : without_lift(stored_law));
  } else {
    p = kind > 0          ? frictional_problem(seed, 10 * number)
        : number % 2 == 0 ? small_problem(seed, number, 4, 8)
                          : near_problem(seed, number, 4);
    if (kind == 2) p.law = without_lift(p.law);
    twist(p, draw);
  }
  const ExactSolutions truth =
      planted ? ExactSolutions(p, instance.reference->z, instance.reference->lambda) : ExactSolutions(p);
  instance.reference.reset();
  const bool none = truth.complete() && truth.solutions().empty();
  const auto say = [&](const std::string& who, const std::string& what, double tolerance, const std::string& how,
                       ExactSolutions::Range error) {
    const std::string off = printed("T = %g, of %s, off by %g", tolerance, how.c_str(), error.low);
    report(who + ": " + what + ", " + off + (error.high > error.low ? printed(" to %g", error.high) : ""), instance);
  };

  // The reference.
  const FoundReference found = reference_for(instance, {});
  ++tally.runs;
  if (found.reference) {
    const Reference& r = *found.reference;
    const ExactSolutions::Range error = r.feasible ? truth.error(r.z) : ExactSolutions::Range{0, 0};
    if (r.feasible ? error.low * (1 - by_roots) > r.bound : !truth.solutions().empty())
      say("reference", r.feasible ? "a bound that is false" : "no solution", 0, r.method, error);
    if (r.feasible && r.unique && truth.solutions().size() > 1) say("reference", "the only one", 0, r.method, error);
  }

  for (const Invented& answer : invent(p, truth, draw)) {
    if (!answer.z.allFinite()) continue;
    const double tolerance = tolerances[at(draw.integer(0, 5))];
    const double accepted = accepted_error(tolerance), near = near_error(tolerance);
    const ExactSolutions::Range error = truth.error(answer.z);
    const auto check = [&](const std::string& who, Verdict verdict, double least, double most) {
      ++tally.runs;
      const bool right = verdict == Verdict::solved, close = verdict == Verdict::near;
      if ((right && error.low * (1 - by_roots) > accepted) || (close && error.low * (1 - by_roots) > near) ||
          (verdict == Verdict::wrong && error.high * (1 + by_roots) <= near))
        say(who, std::string(to_string(verdict)), tolerance, answer.how, error);
      if (least * (1 - by_roots) > error.high || most < error.low * (1 - by_roots))
        say(who, printed("at least %g, at most %g", least, most), tolerance, answer.how, error);
    };
    Solution s;
    s.status = Status::solved;
    s.z = answer.z;
    s.lambda = answer.lambda;
    const Metrics m = measure(p, s, nullptr, tolerance);
    check("measure", m.verdict, 0, m.friction.delta > 0 ? Metrics::unknown : m.z_bound);
    if (answer.right) {
      const bool multipliers = answer.lambda.size() > 0;
      ++tally.right[multipliers];
      tally.open[multipliers] += m.verdict != Verdict::solved;
    }
    if (draw.integer(0, 2) == 0 && found.reference)
      check("measure by reference", measure(p, s, &*found.reference, tolerance).verdict, 0, Metrics::unknown);
    if (draw.integer(0, 5) > 0) continue;
    Instance told = instance;
    if (draw.integer(0, 2) == 0) {
      told.reference =
          Reference{.feasible = draw.integer(0, 3) > 0, .z = answer.z, .hearsay = true, .method = "hearsay"};
      if (draw.integer(0, 1) == 0) told.reference->z = p.z_u;
      told.reference->certificate = Vector::Ones(p.rows());
    }
    const Judgement j = judge(told, answer.z, answer.lambda, tolerance);
    check(told.reference ? "judge, told a truth" : "judge", j.verdict, j.at_least, j.at_most);
  }

  // That there is no solution, or none within the stated number of motions.
  for (int k = 0; k < 2 && p.rows() > 0; ++k) {
    Solution s;
    s.status = Status::infeasible;
    s.certificate = certificate(p, found, draw);
    const Verdict verdict = measure(p, s, nullptr, tolerances[0]).verdict;
    ++tally.runs;
    if ((verdict == Verdict::infeasible_proven && truth.motions() <= most_motions) ||
        (verdict == Verdict::wrong && none))
      say("measure", std::string(to_string(verdict)), 0, "a certificate", {truth.motions(), truth.motions()});
  }
}

}  // namespace zwang

#include <zwang/bench/references/friction/coulomb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <zwang/core/problem/wording.h>
#include <zwang/core/referee/friction/interior_point.h>
#include <zwang/core/referee/friction/interval_newton.h>
#include <zwang/core/referee/friction/natural_map.h>
#include <zwang/core/referee/friction/self_bound.h>
#include <zwang/core/referee/tolerances.h>
#include <zwang/solvers/friction/nsgs.h>

namespace zwang {
namespace {

using referee::down, referee::up;

// The motion is as large as z_u, or as rows force it.
double first_scale(const Problem& problem, const ScaledProblem& scaled) {
  double scale = scaled.scale_of(0);
  for (Index i = 0; i < problem.rows(); ++i)
    if (scaled.counts(i) && (problem.is_equality(i) || scaled.h[i].hi > 0))
      scale = std::max(scale, std::abs(scaled.h[i].hi) / scaled.row_norm[i]);
  return scale;
}

class Search {
 public:
  Search(const Problem& problem, const ScaledProblem& scaled, double scale)
      : problem_(problem), p_(problem, scaled, scale) {}

  bool usable() {
    bool contradictory = p_.fixed_contradiction;
    if (!contradictory) equalities_ = independent_equalities(p_, contradictory);
    return p_.exact && !contradictory;
  }

  void interior_points(const SolutionSearch& search) {
    static constexpr std::array sizes{1., .1, 10., .03, 100., .3};
    for (int k = 0; k < search.starts && more(search); ++k) {
      const double start = sizes[at(k) % sizes.size()];
      const auto found = interior_point<double>(p_, equalities_, nullptr, {.start = start});
      work_ += static_cast<double>(found.size()) * std::pow(static_cast<double>(p_.size()), 3) / 3;
      if (found.empty() || take(found.back(), "interior point")) continue;
      if (p_.rows() > referee::searched_rows || !more(search)) continue;
      // In double-double where it is convex: by the slips that were found.
      ExtendedVector sigma(std::ssize(p_.contacts));
      for (Index c = 0; c < sigma.size(); ++c) sigma[c] = p_.slip(p_.contacts[at(c)], found.back().x);
      const auto finer = interior_point<DoubleDouble>(p_, equalities_, &sigma,
                                                      {.start = start, .target = referee::interior_target_extended});
      if (!finer.empty()) take(finer.back(), "interior point, double-double");
    }
  }

  void near_motions(const SolutionSearch& search) {
    for (const Vector& z : search.near) {
      ModePoint point{p_.motion(z), ExtendedVector::Zero(p_.rows()), {}};
      for (const ContactRows& contact : p_.contacts) {
        const double g = contact.unit > 0 ? contact.unit : 1, touching = referee::alike * p_.scale * g;
        point.modes.push_back(contact.unit == 0 || p_.slack(contact.row, point.x).hi > touching ? ContactMode::open
                              : contact.rows() > 1 && p_.slip(contact, point.x).hi > touching   ? ContactMode::slide
                                                                                                : ContactMode::stick);
      }
      keep(prove(std::move(point)), "near a given motion");
    }
  }

  // Newton's method from the free motion with each choice of modes.
  void mode_choices(const SolutionSearch& search) {
    const std::size_t count = p_.contacts.size();
    if (!(std::pow(3.0, static_cast<double>(count)) <= search.mode_choices)) return;
    std::vector<ContactMode> modes(count, ContactMode::open);
    for (std::size_t k = 0; k < count;) {
      if (!more(search)) return;
      keep(prove({ExtendedVector::Zero(p_.size()), ExtendedVector::Zero(p_.rows()), modes}), "choice of modes");
      for (k = 0; k < count; ++k) {
        const bool last = modes[k] == ContactMode::stick || p_.contacts[k].unit == 0;
        modes[k] = last                                                         ? ContactMode::open
                   : modes[k] == ContactMode::open && p_.contacts[k].rows() > 1 ? ContactMode::slide
                                                                                : ContactMode::stick;
        if (!last) break;
      }
    }
  }

  // nsgs from no force, and from normal forces drawn at random.
  void gauss_seidel(const SolutionSearch& search) {
    AnySolver method(Nsgs{.max_sweeps = search.sweeps});
    std::mt19937_64 random(search.seed);
    const auto draw = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
    Solution end;
    for (int k = 0; k <= search.random_starts && more(search); ++k) {
      ExtendedVector push = ExtendedVector::Zero(p_.rows());
      for (const ContactRows& contact : p_.contacts)
        if (k > 0 && contact.unit > 0) push[contact.row] = 4 * draw() / contact.unit;
      const WarmStart start{problem_.key, p_.to_multipliers(push).cast<double>()};
      method.solve(problem_,
                   {.tolerance = referee::settled, .time_limit = search.deadline.left(), .warm_start = &start}, end);
      if (end.z.size() != problem_.size() || end.lambda.size() != problem_.rows()) return;
      if (!end.z.allFinite() || !end.lambda.allFinite()) return;
      ModePoint point{p_.motion(end.z), p_.multipliers(end.lambda), {}};
      for (const double cut : {referee::mode_cut, referee::coarse_mode_cut}) {
        point.modes = modes_by_size(p_, point.x, point.lambda, cut);
        if (keep(prove(point), "Gauss-Seidel")) break;
      }
    }
  }

  std::vector<CoulombSolution> found;
  double nearest = std::numeric_limits<double>::infinity();  // delta of the best that was not good enough

 private:
  // Looks on behind a solution of rows that are off by delta, where that is cheap.
  bool more(const SolutionSearch& search) const {
    const bool exact = std::ranges::count(found, 0.0, &CoulombSolution::delta) > 0;
    const bool enough = exact || (!found.empty() && p_.rows() > referee::searched_rows);
    return (search.all || !enough) && work_ <= referee::searched_products && !search.deadline.passed();
  }

  ModeProof prove(ModePoint guess) { return prove_near(p_, std::move(guess), &work_); }

  bool take(const InteriorAnswer& answer, const char* method) {
    if (keep(prove(answer), method)) return true;
    // Modes by size instead, cut at the contact's own scale.
    ModePoint point{answer.x, answer.lambda, modes_by_size(p_, answer.x, answer.lambda, referee::mode_cut)};
    return point.modes != answer.modes && work_ <= referee::searched_products && keep(prove(point), method);
  }

  bool keep(const ModeProof& proof, const char* method) {
    if (!proof.proven) return false;
    const double s = p_.scale_of(p_.norm_with_free_motion(proof.point.x) - proof.radius);
    nearest = std::min(nearest, proof.delta / s);
    if (!(proof.delta <= referee::good_delta * s && proof.radius <= referee::good_delta * s)) return false;
    CoulombSolution solution{.radius = proof.radius / s,
                             .delta = proof.delta / s,
                             .strict = proof.strict,
                             .isolated = proof.strict && proof.unique_forces,
                             .free_split = proof.null_motion >= referee::still,
                             .continuum = proof.continuum,
                             .modes = proof.point.modes,
                             .method = method};
    solution.z = p_.rounded_motion(proof.point.x);
    solution.lambda = p_.to_multipliers(proof.point.lambda).cast<double>();
    solution.bound = up((distance(p_.motion(solution.z), proof.point.x) + proof.radius) / s);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const bool exact = solution.isolated && found[k].isolated && solution.delta == 0 && found[k].delta == 0;
      const double together = exact ? up(proof.radius + radii_[k]) : referee::alike * s;
      if (down(distance(points_[k], proof.point.x)) <= together) return true;
      if (solution.free_split && found[k].free_split && found[k].modes == solution.modes) return true;
    }
    if (proof.delta == 0) {  // witnesses that contradict each other prove nothing
      if (none_by_slopes(p_, proof.point.x, proof.radius)) return false;
      solution.by_slopes = prove_by_slopes(p_, proof.point.x, proof.point.lambda).proven;
    }
    points_.push_back(proof.point.x);
    radii_.push_back(proof.radius);
    found.push_back(std::move(solution));
    return true;
  }

  double distance(const ExtendedVector& a, const ExtendedVector& b) const { return p_.norm(a - b); }

  const Problem& problem_;
  ContactProblem p_;
  double work_ = 0;
  std::vector<Index> equalities_;
  std::vector<ExtendedVector> points_;
  std::vector<double> radii_;
};

}  // namespace

std::vector<CoulombSolution> coulomb_solutions(const Problem& problem, const SolutionSearch& options,
                                               std::string* why_not) {
  const auto give_up = [&](const std::string& reason) {
    if (why_not) *why_not = reason;
    return std::vector<CoulombSolution>{};
  };
  if (const std::string bad = bad_input(problem); !bad.empty()) return give_up(bad);
  const ScaledProblem scaled(problem);
  if (!scaled.definite) return give_up("M is not positive definite");
  Search search(problem, scaled, first_scale(problem, scaled));
  if (!search.usable()) return give_up("rows contradict each other, or their scales are beyond doubles");
  search.near_motions(options);
  search.interior_points(options);
  search.gauss_seidel(options);
  search.mode_choices(options);
  if (search.found.empty()) {
    const std::string off = printed("; the nearest is exact for rows that are off by %g", search.nearest);
    return give_up("no solution was proven" + (std::isfinite(search.nearest) ? off : ""));
  }
  return std::move(search.found);
}

std::optional<Reference> convex_reference(const Problem& problem, std::string* why_not) {
  const auto give_up = [&](const std::string& reason) {
    if (why_not) *why_not = reason;
    return std::optional<Reference>{};
  };
  if (const std::string bad = bad_input(problem); !bad.empty()) return give_up(bad);
  const ScaledProblem scaled(problem);
  if (!scaled.definite) return give_up("M is not positive definite");
  const ContactProblem p(problem, scaled, first_scale(problem, scaled));
  const ConvexBound found = bound_convex(p, Slips(std::ssize(p.contacts)), nullptr);
  if (found.rows == ConvexBound::Rows::infeasible) return give_up("rows contradict each other");
  if (!(found.upper < std::numeric_limits<double>::infinity())) return give_up("duality bounds no answer");
  Reference out{.z = p.rounded_motion(found.x),
                .lambda = p.to_multipliers(found.lambda).cast<double>(),
                .method = "interior point, conic duality"};
  const double least = p.scale_of(p.norm_with_free_motion(found.x) - found.upper);
  out.bound = up((p.norm(p.motion(out.z) - found.x) + found.upper) / least);
  if (!(out.bound <= referee::useful)) return give_up("what duality proves of the answer is too little to be of use");
  return out;
}

std::optional<Reference> coulomb_reference(const Problem& problem, std::string* why_not) {
  const std::vector<CoulombSolution> found = coulomb_solutions(problem, {}, why_not);
  const auto exact = std::ranges::find(found, 0.0, &CoulombSolution::delta);
  if (exact == found.end()) {
    if (why_not && !found.empty()) *why_not = "what was proven solves rows that are off, not these";
    return {};
  }
  return Reference{.z = exact->z,
                   .lambda = exact->lambda,
                   .bound = exact->bound,
                   .unique = false,
                   .method = exact->method + ", proven by interval Newton" +
                             (exact->by_slopes ? " and by slopes of the natural map" : "")};
}

}  // namespace zwang

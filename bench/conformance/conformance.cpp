#include <zwang/bench/conformance/conformance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <ranges>
#include <utility>
#include <vector>

#include <zwang/bench/scenes/friction/families.h>
#include <zwang/bench/scenes/row_by_row.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double gravity = 8, step = 1.0 / 64;  // m/s^2, s: dyadic, so that the data is exact

// One contact of a planar or spatial model that does not change from step to step: rows of the normal and its tangents,
// touching, and the surface's own velocity along the first tangent.
struct ModelContact {
  std::vector<Vector> rows;
  double mu;
  double surface = 0;
};

struct Model {
  Vector mass, force;  // accelerations without contacts
  std::vector<ModelContact> contacts;

  // Accelerations z of one implicit step from velocity v: c_n = -J_n v/dt, c_t = (v_surface - J_t v)/dt.
  Problem problem(const Vector& v) const {
    RowByRow rows(mass, force);
    for (const ModelContact& contact : contacts) {
      std::vector<double> c;
      for (const Vector& row : contact.rows) c.push_back(((c.size() == 1 ? contact.surface : 0) - row.dot(v)) / step);
      rows.add_contact(contact.rows, c, contact.mu, "");
    }
    return rows.finish().problem;
  }
  Problem problem() const { return problem(Vector::Zero(mass.size())); }
};

ConformanceResult no_answer(const Solution& s) {
  return {nothing, std::string(to_string(s.status)) + (s.message.empty() ? "" : ": " + s.message),
          s.status != Status::unsupported};
}

bool answers(const Solution& s, Index n) {
  return s.z.size() == n && s.z.allFinite() && s.status != Status::infeasible && s.status != Status::unsupported;
}

// How far the solver's accelerations are off what is exact.
ConformanceCheck one_problem(std::string name, std::string expected, Problem problem,
                             std::function<double(const Vector&)> off) {
  return {std::move(name), std::move(expected),
          [problem = std::move(problem), off = std::move(off)](const ConformanceSolve& solve) {
            const Solution s = solve(problem);
            return answers(s, problem.size()) ? ConformanceResult{off(s.z)} : no_answer(s);
          }};
}

// Their distance to the nearest of the exact ones.
ConformanceCheck one_problem(std::string name, std::string expected, Problem problem, std::vector<Vector> exact) {
  return one_problem(std::move(name), std::move(expected), std::move(problem),
                     [exact = std::move(exact)](const Vector& z) {
                       double off = std::numeric_limits<double>::infinity();
                       for (const Vector& one : exact) off = std::min(off, (z - one).lpNorm<Eigen::Infinity>());
                       return off;
                     });
}

// Steps of the model from velocity v; `look` sees the step's number, the velocity after it and the way until then, and
// returns how far it is off what is exact.
ConformanceCheck stepped(std::string name, std::string expected, const Model& model, const Vector& start, int steps,
                         std::function<double(int, const Vector& v, const Vector& way)> look) {
  return {std::move(name), std::move(expected), [=](const ConformanceSolve& solve) {
            Vector v = start, way = Vector::Zero(start.size());
            double off = 0;
            for (int k = 1; k <= steps; ++k) {
              const Solution s = solve(model.problem(v));
              if (!answers(s, v.size())) return no_answer(s);
              v += step * s.z;
              way += step * v;
              off = std::max(off, look(k, v, way));
            }
            return ConformanceResult{off};
          }};
}

// A point mass on a floor: [x, y, z].
Model sliding_block(double mu, const Vector& force, double surface = 0) {
  return {Vector{{1, 1, 1}}, force, {{{Vector{{0, 0, 1}}, Vector{{1, 0, 0}}, Vector{{0, 1, 0}}}, mu, surface}}};
}

// A box of half width 1 and centre height 2 on two corners, in the plane, pushed with `push`: [x, y, turn].
Model planar_box(double push, double mu) {
  return {Vector{{1, 1, 1}},
          Vector{{push, -gravity, 0}},
          {{{Vector{{0, 1, 1}}, Vector{{1, 0, 2}}}, mu}, {{Vector{{0, 1, -1}}, Vector{{1, 0, 2}}}, mu}}};
}

// Half length 5, leaning 4 high over 3; both ends touch: [x, y, turn].
Model ladder(double mu) {
  return {Vector{{1, 1, 8}},
          Vector{{0, -gravity, 0}},
          {{{Vector{{0, 1, 3}}, Vector{{1, 0, 4}}}, mu}, {{Vector{{1, 0, -4}}, Vector{{0, 1, -3}}}, mu}}};
}

// A mass 1 between two fingers that push with N each, gravity 4, mu 1/2: [x, y, left finger, right finger].
Model pinch(double N) {
  return {Vector{{1, 1, 1, 1}},
          Vector{{0, -4, N, -N}},
          {{{Vector{{1, 0, -1, 0}}, Vector{{0, 1, 0, 0}}}, .5}, {{Vector{{-1, 0, 0, 1}}, Vector{{0, 1, 0, 0}}}, .5}}};
}

double away(double value, double exact) { return std::abs(value - exact); }

std::vector<ConformanceCheck> make_checks() {
  const Vector level{{0, 0, -gravity}}, slope{{6, 0, -8}};
  // A solid sphere of radius 1: [x, y, z, w_x, w_y, w_z], slip v_x - w_y.
  const Model sphere{Vector{{1, 1, 1, .4, .4, .4}},
                     Vector{{0, 0, -gravity, 0, 0, 0}},
                     {{{Vector{{0, 0, 1, 0, 0, 0}}, Vector{{1, 0, 0, 0, -1, 0}}, Vector{{0, 1, 0, 1, 0, 0}}}, .5}}};
  return {
      stepped("block stops", "g = 8, mu = 1/2, dt = 1/64, v0 = 1: at rest after 16 steps, 15/128 m on",
              sliding_block(.5, level), Vector{{1, 0, 0}}, 20,
              [](int k, const Vector& v, const Vector& way) {
                const double off = (v - Vector{{std::max(0.0, 1 - k / 16.0), 0, 0}}).lpNorm<Eigen::Infinity>();
                return k < 20 ? off : std::max(off, away(way[0], 15.0 / 128));
              }),
      stepped("incline sticks", "slope 3:4, mu = 3/4: at rest", sliding_block(.75, slope), Vector::Zero(3), 8,
              [](int, const Vector& v, const Vector&) { return v.lpNorm<Eigen::Infinity>(); }),
      stepped("incline slides", "slope 3:4, mu = 1/2: v = k dt (6 - 8 mu)", sliding_block(.5, slope), Vector::Zero(3),
              8,
              [](int k, const Vector& v, const Vector&) {
                return (v - Vector{{2 * k * step, 0, 0}}).lpNorm<Eigen::Infinity>();
              }),
      stepped("sphere rolls", "v0 = 7 without spin: rolls at 5 from step 32 on", sphere, Vector{{7, 0, 0, 0, 0, 0}}, 40,
              [](int k, const Vector& v, const Vector&) {
                const double speed = std::max(5.0, 7 - k / 16.0);
                const double spin = std::min(5.0, 2.5 * k / 16.0);
                return std::max(away(v[0], speed), away(v[4], spin));
              }),
      stepped("belt", "belt at 1, mu = 1/2: carried along from step 16 on", sliding_block(.5, level, 1),
              Vector::Zero(3), 20,
              [](int k, const Vector& v, const Vector&) {
                return (v - Vector{{std::min(1.0, k / 16.0), 0, 0}}).lpNorm<Eigen::Infinity>();
              }),
      one_problem("box tips", "b = 1, h = 2, push 5, mu = 3/4: z = (2/3, 1/3, -1/3)", planar_box(5, .75).problem(),
                  {Vector{{2. / 3, 1. / 3, -1. / 3}}}),
      one_problem("box slides", "b = 1, h = 2, push 5, mu = 1/4: z = (3, 0, 0)", planar_box(5, .25).problem(),
                  {Vector{{3, 0, 0}}}),
      one_problem("box rests", "b = 1, h = 2, push 3, mu = 3/4: z = 0", planar_box(3, .75).problem(),
                  {Vector{{0, 0, 0}}}),
      one_problem("pinch holds", "two fingers push with 8 each: z = 0", pinch(8).problem(), {Vector{{0, 0, 0, 0}}}),
      one_problem("pinch slips", "two fingers push with 2 each: falls at 2", pinch(2).problem(),
                  {Vector{{0, -2, 0, 0}}}),
      one_problem("ladder rests", "tan 4/3, mu = 3/8 at both ends: z = 0", ladder(.375).problem(), {Vector{{0, 0, 0}}}),
      one_problem("ladder slips", "tan 4/3, mu = 1/4 at both ends: turns at 104/511", ladder(.25).problem(),
                  {Vector{{416. / 511, -312. / 511, 104. / 511}}}),
      one_problem("ROD", "mu = 2: one of three solutions", rod_point(2).instance.problem,
                  {Vector{{2, .25, 0}}, Vector{{17. / 12, 17. / 24, -17. / 24}}, Vector{{1.75, .375, -.375}}}),
      one_problem("JAM below", "walls move into the apex, mu = 1/2: z = 0", jam_point(.5, -1).instance.problem,
                  {Vector{{0, 0}}}),
      {"JAM beyond", "the same, mu = 1: no solution exists, so none is claimed",
       [](const ConformanceSolve& solve) {
         const Solution s = solve(jam_point(1, -1).instance.problem);
         if (s.status == Status::unsupported) return no_answer(s);
         return ConformanceResult{s.status == Status::solved ? 1.0 : 0.0,
                                  s.status == Status::solved ? "claims a solution" : ""};
       }},
      one_problem("HELD", "pulled out of a wedge, mu = 1: z = (0, 1) or 0", held_point(1).instance.problem,
                  {Vector{{0, 1}}, Vector{{0, 0}}}),
      one_problem("PINCH", "plates moving apart along themselves: z = (0, y), 1 <= y <= 3",
                  pinch_point().instance.problem,
                  [](const Vector& z) { return std::max({std::abs(z[0]), 1 - z[1], z[1] - 3, 0.0}); })};
}

}  // namespace

std::span<const ConformanceCheck> conformance_checks() {
  static const std::vector<ConformanceCheck> all = make_checks();
  return all;
}

ConformanceSolve conformance_solve(ConformanceSolve solver, Law* stated) {
  // Of the first answer: a solver has one law for all checks.
  const auto reading = std::make_shared<std::optional<Law>>();
  return [reading, stated, solver = std::move(solver)](const Problem& coulomb) {
    Solution refused;
    for (const Law law : all_laws | std::views::reverse) {
      if (*reading && **reading != law) continue;
      Solution s = solver(under(law, coulomb));
      if (s.status != Status::unsupported) {
        *reading = law;
        if (stated) *stated = law;
        return s;
      }
      if (refused.message.empty()) refused = std::move(s);
    }
    return refused;
  };
}

}  // namespace zwang

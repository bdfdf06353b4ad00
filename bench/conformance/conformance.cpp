#include <zwang/bench/conformance/conformance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <ranges>
#include <utility>
#include <vector>

#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double gravity = 8, step = 1.0 / 64;  // m/s^2, s: dyadic, so that the data is exact

// One contact of a planar or spatial model that does not change from step to step: rows of the normal and its tangents,
// the gap, and the surface's own velocity along each tangent.
struct ModelContact {
  std::vector<Vector> rows;
  double mu;
  double gap = 0;
  double surface = 0;  // along the first tangent
};

struct Model {
  Vector mass, force;  // accelerations without contacts
  std::vector<ModelContact> contacts;

  // Accelerations z of one implicit step from velocity v: c_n = -gap/dt^2 - J_n v/dt, c_t = (v_surface - J_t v)/dt.
  Problem problem(const Vector& v) const {
    Problem p{.name = "conformance", .z_u = force, .law = stored_law};
    p.M = mass.asDiagonal();
    RowWriter rows;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const ModelContact& contact = contacts[k];
      for (std::size_t t = 0; t < contact.rows.size(); ++t) {
        const Vector& row = contact.rows[t];
        const double wanted = t == 0 ? -contact.gap / step : t == 1 ? contact.surface : 0;
        rows.add(t == 0 ? RowKind::inequality : RowKind::tangent, {k + 1, static_cast<std::uint32_t>(t)},
                 (wanted - row.dot(v)) / step, t == 0 ? contact.mu : 0);
        rows.entries(row);
      }
    }
    rows.write(p);
    return p;
  }
};

ConformanceResult no_answer(const Solution& s) {
  return {nothing, std::string(to_string(s.status)) + (s.message.empty() ? "" : ": " + s.message),
          s.status != Status::unsupported};
}

bool answers(const Solution& s, Index n) {
  return s.z.size() == n && s.z.allFinite() && s.status != Status::infeasible && s.status != Status::unsupported;
}

// The distance of the solver's accelerations to the nearest of the exact ones.
ConformanceCheck one_problem(std::string name, std::string expected, const Model& model, std::vector<Vector> exact) {
  return {std::move(name), std::move(expected), [model, exact](const ConformanceSolve& solve) {
            const Solution s = solve(model.problem(Vector::Zero(model.mass.size())));
            if (!answers(s, model.mass.size())) return no_answer(s);
            double off = std::numeric_limits<double>::infinity();
            for (const Vector& z : exact) off = std::min(off, (s.z - z).lpNorm<Eigen::Infinity>());
            return ConformanceResult{off};
          }};
}

// Steps of the model from velocity v; `look` sees the step's number and the velocity after it, and returns how far it
// is off what is exact.
ConformanceCheck stepped(std::string name, std::string expected, const Model& model, const Vector& start, int steps,
                         std::function<double(int, const Vector&)> look) {
  return {std::move(name), std::move(expected), [=](const ConformanceSolve& solve) {
            Vector v = start;
            double off = 0;
            for (int k = 1; k <= steps; ++k) {
              const Solution s = solve(model.problem(v));
              if (!answers(s, v.size())) return no_answer(s);
              v += step * s.z;
              off = std::max(off, look(k, v));
            }
            return ConformanceResult{off};
          }};
}

// A point mass on a floor: [x, y, z].
Model sliding_block(double mu, double surface = 0) {
  return {Vector{{1, 1, 1}},
          Vector{{0, 0, -gravity}},
          {{{Vector{{0, 0, 1}}, Vector{{1, 0, 0}}, Vector{{0, 1, 0}}}, mu, 0, surface}}};
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

Model wedge(double mu, double wall_slip, double up) {
  Model m{Vector{{1, 1}},
          Vector{{0, up}},
          {{{Vector{{-4, 3}}, Vector{{3, 4}}}, mu, 0, wall_slip * step},
           {{Vector{{4, 3}}, Vector{{-3, 4}}}, mu, 0, wall_slip * step}}};
  return m;
}

double away(double value, double exact) { return std::abs(value - exact); }

std::vector<ConformanceCheck> make_checks() {
  std::vector<ConformanceCheck> all;
  // Position after the steps, from the velocities.
  {
    const Model model = sliding_block(.5);
    all.push_back({"block stops", "g = 8, mu = 1/2, dt = 1/64, v0 = 1: at rest after 16 steps, 15/128 m on",
                   [model](const ConformanceSolve& solve) {
                     Vector v = Vector{{1, 0, 0}};
                     double x = 0, off = 0;
                     for (int k = 1; k <= 20; ++k) {
                       const Solution s = solve(model.problem(v));
                       if (!answers(s, 3)) return no_answer(s);
                       v += step * s.z;
                       x += step * v[0];
                       off = std::max(off, (v - Vector{{std::max(0.0, 1 - k / 16.0), 0, 0}}).lpNorm<Eigen::Infinity>());
                     }
                     return ConformanceResult{std::max(off, away(x, 15.0 / 128))};
                   }});
  }
  const auto incline = [](double mu) {
    return Model{
        Vector{{1, 1, 1}}, Vector{{6, 0, -8}}, {{{Vector{{0, 0, 1}}, Vector{{1, 0, 0}}, Vector{{0, 1, 0}}}, mu}}};
  };
  const auto rest = [](int, const Vector& v) { return v.lpNorm<Eigen::Infinity>(); };
  all.push_back(stepped("incline sticks", "slope 3:4, mu = 3/4: at rest", incline(.75), Vector::Zero(3), 8, rest));
  all.push_back(stepped("incline slides", "slope 3:4, mu = 1/2: v = k dt (6 - 8 mu)", incline(.5), Vector::Zero(3), 8,
                        [](int k, const Vector& v) {
                          return (v - Vector{{2 * k * step, 0, 0}}).lpNorm<Eigen::Infinity>();
                        }));
  // A solid sphere of radius 1: [x, y, z, w_x, w_y, w_z], slip v_x - w_y.
  const Model sphere{Vector{{1, 1, 1, .4, .4, .4}},
                     Vector{{0, 0, -gravity, 0, 0, 0}},
                     {{{Vector{{0, 0, 1, 0, 0, 0}}, Vector{{1, 0, 0, 0, -1, 0}}, Vector{{0, 1, 0, 1, 0, 0}}}, .5}}};
  all.push_back(stepped("sphere rolls", "v0 = 7 without spin: rolls at 5 from step 32 on", sphere,
                        Vector{{7, 0, 0, 0, 0, 0}}, 40, [](int k, const Vector& v) {
                          const double speed = std::max(5.0, 7 - k / 16.0);
                          const double spin = std::min(5.0, 2.5 * k / 16.0);
                          return std::max(away(v[0], speed), away(v[4], spin));
                        }));
  all.push_back(stepped("belt", "belt at 1, mu = 1/2: carried along from step 16 on", sliding_block(.5, 1),
                        Vector::Zero(3), 20, [](int k, const Vector& v) {
                          return (v - Vector{{std::min(1.0, k / 16.0), 0, 0}}).lpNorm<Eigen::Infinity>();
                        }));
  all.push_back(one_problem("box tips", "b = 1, h = 2, push 5, mu = 3/4: z = (2/3, 1/3, -1/3)", planar_box(5, .75),
                            {Vector{{2. / 3, 1. / 3, -1. / 3}}}));
  all.push_back(one_problem("box slides", "b = 1, h = 2, push 5, mu = 1/4: z = (3, 0, 0)", planar_box(5, .25),
                            {Vector{{3, 0, 0}}}));
  all.push_back(
      one_problem("box rests", "b = 1, h = 2, push 3, mu = 3/4: z = 0", planar_box(3, .75), {Vector{{0, 0, 0}}}));
  all.push_back(one_problem("pinch holds", "two fingers push with 8 each: z = 0", pinch(8), {Vector{{0, 0, 0, 0}}}));
  all.push_back(
      one_problem("pinch slips", "two fingers push with 2 each: falls at 2", pinch(2), {Vector{{0, -2, 0, 0}}}));
  all.push_back(
      one_problem("ladder rests", "tan 4/3, mu = 3/8 at both ends: z = 0", ladder(.375), {Vector{{0, 0, 0}}}));
  all.push_back(one_problem("ladder slips", "tan 4/3, mu = 1/4 at both ends: turns at 104/511", ladder(.25),
                            {Vector{{416. / 511, -312. / 511, 104. / 511}}}));
  const Model rod{Vector{{1, 1, 1}}, Vector{{2, .25, 0}}, {{{Vector{{0, 1, 1}}, Vector{{1, 0, 2}}}, 2}}};
  all.push_back(
      one_problem("ROD", "mu = 2: one of three solutions", rod,
                  {Vector{{2, .25, 0}}, Vector{{17. / 12, 17. / 24, -17. / 24}}, Vector{{1.75, .375, -.375}}}));
  all.push_back(
      one_problem("JAM below", "walls move into the apex, mu = 1/2: z = 0", wedge(.5, -1, -1), {Vector{{0, 0}}}));
  all.push_back(
      {"JAM beyond", "the same, mu = 1: no solution exists, so none is claimed", [](const ConformanceSolve& solve) {
         const Solution s = solve(wedge(1, -1, -1).problem(Vector::Zero(2)));
         if (s.status == Status::unsupported) return no_answer(s);
         return ConformanceResult{s.status == Status::solved ? 1.0 : 0.0,
                                  s.status == Status::solved ? "claims a solution" : ""};
       }});
  all.push_back(one_problem("HELD", "pulled out of a wedge, mu = 1: z = (0, 1) or 0", wedge(1, 0, 1),
                            {Vector{{0, 1}}, Vector{{0, 0}}}));
  const Model plates{
      Vector{{1, 1}},
      Vector{{0, 3}},
      {{{Vector{{1, 0}}, Vector{{0, 1}}}, 1, 0, step}, {{Vector{{-1, 0}}, Vector{{0, 1}}}, 1, 0, -step}}};
  all.push_back({"PINCH", "plates moving apart along themselves: z = (0, y), 1 <= y <= 3",
                 [plates](const ConformanceSolve& solve) {
                   const Solution s = solve(plates.problem(Vector::Zero(2)));
                   if (!answers(s, 2)) return no_answer(s);
                   return ConformanceResult{std::max({std::abs(s.z[0]), 1 - s.z[1], s.z[1] - 3, 0.0})};
                 }});
  return all;
}

}  // namespace

std::span<const ConformanceCheck> conformance_checks() {
  static const std::vector<ConformanceCheck> all = make_checks();
  return all;
}

ConformanceSolve conformance_solve(ConformanceSolve solver, Law* stated) {
  struct Reading {
    std::optional<Law> law = {};  // of the first answer: a solver has one law for all checks
  };
  const auto reading = std::make_shared<Reading>();
  return [reading, stated, solver = std::move(solver)](const Problem& coulomb) {
    Solution refused;
    for (const Law law : all_laws | std::views::reverse) {
      if (reading->law && *reading->law != law) continue;
      Solution s = solver(under(law, coulomb));
      if (s.status != Status::unsupported) {
        reading->law = law;
        if (stated) *stated = law;
        return s;
      }
      if (refused.message.empty()) refused = std::move(s);
    }
    return refused;
  };
}

}  // namespace zwang

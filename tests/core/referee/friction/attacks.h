#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/core/referee/friction/small_frictional.h"

namespace zwang::test {

// Answers whose truth is known without the referee: by hand, in dyadic numbers.
struct Attack {
  std::string name;
  Problem problem;
  std::vector<Vector> solutions;  // those that are known
  Vector z, lambda;
  bool complete = true;  // there is no other solution

  // |z - z'|_M / max(|z_u|, |z'|) of the nearest solution z'.
  double off() const {
    double least = std::numeric_limits<double>::infinity();
    const auto length = [&](const Vector& v) {
      const double top = v.lpNorm<Eigen::Infinity>();
      return top > 0 ? top * std::sqrt((v / top).dot(problem.M * (v / top))) : 0;
    };
    for (const Vector& known : solutions) {
      const double distance = length(z - known);
      least = std::min(least, distance == 0 ? 0 : distance / std::max(length(problem.z_u), length(known)));
    }
    return least;
  }
  // What the verdict says that is not so; "" where nothing.
  std::string falsehood(Verdict verdict, double tolerance, double at_least, double at_most) const {
    constexpr double rounding = 1e-6;  // of off(), relative
    const double far = off();
    const bool solved = verdict == Verdict::solved && far * (1 - rounding) > accepted_error(tolerance);
    const bool near = verdict == Verdict::near && far * (1 - rounding) > near_error(tolerance);
    if (complete && (solved || near)) return std::string(to_string(verdict)) + ", off by " + std::to_string(far);
    if (verdict == Verdict::wrong && far * (1 + rounding) <= near_error(tolerance)) return "wrong, and is right";
    if (at_least * (1 - rounding) > far * (1 + rounding)) return "farther than it is";
    if (complete && at_most < far * (1 - rounding) && far > 1e-15) return "nearer than it is";
    return "";
  }
};

inline std::vector<Attack> attacks() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<Attack> all;
  const Vector x = vector({1, 0}), y = vector({0, 1}), none = vector({0, 0});
  const auto two_to = [](int k) { return std::ldexp(1.0, k); };
  const auto add = [&](std::string name, const Problem& p, std::vector<Vector> solutions, const Vector& z,
                       const Vector& lambda = {}, bool complete = true) {
    all.push_back({std::move(name), p, std::move(solutions), z, lambda, complete});
  };
  const auto frictionless = [](Problem p) {
    p.mu.resize(0);
    p.law = Law::frictionless;
    return p;
  };

  // A floor carries a weight of .3; a second contact says nothing, and pushes.
  for (const double mu : {.5, 1e4})
    for (const double push : {1e-6, 1., 100.}) {
      const Problem p = SmallFrictional{.z_u = vector({0, -.3})}
                            .contact(mu, {{y, 0}, {x, 0}})
                            .contact(mu, {{y, -infinity}, {x, 0}})
                            .problem();
      add("silent contact pushes", p, {none}, vector({0, push - .3}), vector({0, 0, push, 0}));
      add("silent contact pushes along", p, {none}, vector({push, push - .3}), vector({0, 0, push, push}));
      add("silent contact, right", p, {none}, none, vector({.3, 0, 0, 0}));
    }
  // The ground in other units.
  for (const int k : {0, 12, 23, 33, 60}) {
    const double e = two_to(-k);
    const Problem p = SmallFrictional{.z_u = vector({4, 0, -1})}
                          .contact(.5 / e, {{vector({0, 0, 1}), 0}, {vector({e, 0, 0}), 0}, {vector({0, e, 0}), 0}})
                          .problem();
    for (const double off : {0., 1e-9, 1e-4, .4, -.4, .5}) {
      add("ground times e", p, {vector({3.5, 0, 0})}, vector({3.5 + off, 0, 0}), vector({1, (off - .5) / e, 0}));
      add("ground times e, z", p, {vector({3.5, 0, 0})}, vector({3.5 + off, 0, 0}));
    }
  }
  // x >= 1 and x <= 1 - d; d < 0: room for z = (1, 0).
  for (const int k : {0, 10, 24, 40, 52})
    for (const double sign : {1., -1.}) {
      const double d = sign * two_to(-k);
      SmallFrictional walls{.z_u = none};
      walls.contact(1, {{x, 1}, {y, 0}}).contact(1, {{-x, d - 1}, {y, 0}});
      const std::vector<Vector> right = d > 0 ? std::vector<Vector>{} : std::vector<Vector>{vector({1, 0})};
      for (const Vector& z : {vector({1, 0}), vector({1 - d, 0}), none})
        for (const Vector& lambda : {Vector(), vector({1, 0, 0, 0}), vector({2, 0, 1, 0})}) {
          add("walls", walls.problem(), right, z, lambda);
          const Problem rows = SmallFrictional{.z_u = none}.contact(0, {{x, 1}}).contact(0, {{-x, d - 1}}).problem();
          add("walls without friction", frictionless(rows), right, z, lambda.size() > 0 ? vector({1, 0}) : lambda);
        }
    }
  // x = 0 and x + e y = e / 8.
  for (const int k : {20, 27, 34, 45, 60})
    for (const bool beside : {false, true}) {
      const double e = two_to(-k);
      SmallFrictional rows{.z_u = vector({4, 0, -1, 0, 0})};
      if (beside) rows.contact(.5, {{vector({0, 0, 1, 0, 0}), 0}, {vector({1, 0, 0, 0, 0}), 0}});
      rows.equality(vector({0, 0, 0, 1, 0}), 0).equality(vector({0, 0, 0, 1, e}), e / 8);
      const Problem p = beside ? rows.problem() : frictionless(rows.problem());
      const Vector right = beside ? vector({3.5, 0, 0, 0, .125}) : vector({4, 0, -1, 0, .125});
      Vector wrong = right;
      wrong[4] = 0;
      for (const Vector& z : {right, wrong}) add("near-parallel joints", p, {right}, z);
    }
  // 300 contacts under a push that just moves, each a little outside its cone.
  SmallFrictional many{.z_u = vector({.5 + two_to(-35), -1})};
  Vector stuck(600);
  for (int k = 0; k < 300; ++k) {
    many.contact(.5, {{y, 0}, {x, 0}});
    stuck.segment(2 * k, 2) << 1. / 300, -many.z_u[0] / 300;
  }
  add("many forces", many.problem(), {vector({two_to(-35), 0})}, none, stuck);
  // It sticks, however steep the cone.
  for (const double mu : {1e2, 1e8, 1e12, 1e16})
    for (const double off : {0., 1e-12, 1e-9, 1e-3})
      add("steep cone", block(4, 1, mu).problem(), {Vector::Zero(3)}, vector({4 * off, 0, 0}), vector({1, -4, 0}));
  // 0 >= c beside other motions.
  for (const double size : {1e300, 1., 1e-20})
    for (const double c : {1e-300, 1e300, -1e-300, -1e300}) {
      const Vector z = vector({size, size});
      const std::vector<Vector> right = c > 0 ? std::vector<Vector>{} : std::vector<Vector>{z};
      const Problem p =
          SmallFrictional{.z_u = z}.contact(.5, {{y, 0}, {x, 0}}).contact(.5, {{none, c}, {none, 0}}).problem();
      add("contact of zeros", p, right, z, Vector::Zero(4));
      add("row of zeros", frictionless(SmallFrictional{.z_u = z}.contact(0, {{none, c}}).problem()), right, z,
          vector({0}));
    }
  // x >= 1 and x <= 1 - 2^-k by rows in (x, y), y = -1.
  for (const int k : {60, 110, 200}) {
    const Problem p = SmallFrictional{.z_u = vector({1, 1})}
                          .contact(0, {{x, 1}})
                          .contact(0, {{vector({-1, two_to(-k)}), -1}})
                          .equality(y, -1)
                          .problem();
    add("below 106 bits", frictionless(p), {}, vector({1, -1}), vector({0, 0, -2}));
    add("below 106 bits, z", frictionless(p), {}, vector({1, -1}));
  }
  // x >= 1, 2^-k y >= x: z* = (1, 2^k).
  for (const int k : {7, 20, 30, 50}) {
    const Problem p = frictionless(SmallFrictional{.z_u = vector({1, 0})}
                                       .contact(0, {{x, 1}})
                                       .contact(0, {{vector({-1, two_to(-k)}), 0}})
                                       .problem());
    const Vector right = vector({1, two_to(k)}), lambda = vector({two_to(2 * k), two_to(2 * k)});
    for (const double off : {0., 1e-6, .5}) add("far away", p, {right}, right * (1 - off), lambda);
    add("far away, z", p, {right}, right);
  }
  // Painleve's rod, the jam, the pinch: one, several, many.
  for (const double mu : {.5, 2., 8.}) {
    std::vector<Vector> right{vector({2, .25, 0})};
    add("rod opens", rod(mu), right, right[0], Vector::Zero(2), false);
    if (mu == 2)
      add("rod slides or sticks", rod(mu), {vector({1.75, .375, -.375})}, vector({1.75, .375, -.375}), {}, false);
  }
  for (const double load : {0., .25, .5, .75}) {
    const Vector z = vector({0, 3 - 2 * load});
    add("pinch", pinch(), {z}, z, vector({load, -load, load, -load}), false);
    add("pinch, z", pinch(), {z}, z, {}, false);
  }
  // The wedge jams: between walls that drag it down, forces grow without bound as mu comes to 3/4, and beyond there is
  // no answer.
  for (const double mu :
       {.25, .5, .75 - two_to(-10), .75 - two_to(-30), .75 - two_to(-50), .75, .75 + two_to(-50), 1., 8.})
    for (const double slip : {-1., -two_to(-20)}) {
      const Problem p = wedge(mu, slip, -1);
      const double force = mu == .75 ? two_to(52) : std::abs(1 / (6 - 8 * mu));
      const std::vector<Vector> right = mu < .75 ? std::vector<Vector>{none} : std::vector<Vector>{};
      for (const Vector& z : {none, vector({0, -1}), vector({0, 1e-6}), vector({1e-9, 1e-9}), vector({0, slip / 4})}) {
        for (const double part : {1., .5, -1.}) add("jam", p, right, z, part * force * vector({1, -mu, 1, -mu}));
        add("jam, z", p, right, z);
      }
    }
  // It falls through the floor, or stops where it should slide.
  for (const double load : {1e-6, .3, 1.}) {
    const Vector right = vector({4 - .5 * load, 0, 0});
    for (const Vector& z : {vector({4, 0, -load}), vector({4, 0, 0}), vector({0, 0, 0}), right})
      for (const Vector& lambda :
           {Vector(), Vector(Vector::Zero(3)), vector({load, 0, 0}), vector({load, -.5 * load, 0})})
        add("violates a row", block(4, load, .5).problem(), {right}, z, lambda);
  }
  // M = U'U of determinant 1.
  for (const double p : {4e3, 4e5, 4e7}) {
    const double a = p * p + (p - 1) * (p - 1), b = 2 * p * p, d = (p + 1) * (p + 1) + p * p;
    Problem mass = frictionless(SmallFrictional{.z_u = none}.contact(0, {{x, d}}).problem());
    Matrix M(2, 2);
    M << a, b, b, d;
    mass.M = M.sparseView();
    add("ill-conditioned mass", mass, {vector({d, -b})}, vector({d, -b}), vector({1}), true);
    add("ill-conditioned mass, off", mass, {vector({d, -b})}, vector({d, -b + std::max(1., b / 8)}), vector({1}),
        false);
  }
  // Units, rest, tangents without friction, the edge of the cone.
  for (const int k : {-900, -300, 0, 300, 900}) {
    const double e = two_to(k);
    Problem p = block(4, 1, .5).problem();
    p.z_u *= e;
    for (const double off : {0., 1e-5, .5})
      add("units", p, {vector({3.5 * e, 0, 0})}, vector({(3.5 + off) * e, 0, 0}), vector({e, (off - .5) * e, 0}));
  }
  for (const double slip : {0., 1.}) {
    const Problem rest =
        SmallFrictional{.z_u = none}.contact(.5, {{y, 0}, {x, slip}}).contact(.1, {{none, -1}, {x, 0}}).problem();
    for (const Vector& lambda : {Vector(), Vector(Vector::Zero(4))}) add("rest", rest, {none}, none, lambda);
  }
  for (const double off : {0., 1e-7, 1.})
    add("no friction", block(4, 1, 0).problem(), {vector({4, 0, 0})}, vector({4 - off, 0, 0}), vector({1, -off, 0}));
  for (const double past : {-two_to(-52), 0., two_to(-52)}) {
    const Problem p = block(.5 + past, 1, .5).problem();
    add("edge of the cone", p, {vector({std::max(past, 0.), 0, 0})}, Vector::Zero(3), vector({1, -.5 - past, 0}));
    add("edge of the cone, z", p, {vector({std::max(past, 0.), 0, 0})}, vector({1e-3, 0, 0}));
  }
  // Contacts that pull, friction that drives: the motion is what these forces do.
  for (const double pull : {1e-7, .5}) {
    add("a contact pulls", block(4, -1, .5).problem(), {vector({4, 0, 1})}, vector({4, 0, 1 - pull}),
        vector({-pull, 0, 0}));
    add("friction drives", block(4, 1, .5).problem(), {vector({3.5, 0, 0})}, vector({4 + .5 * pull, 0, 0}),
        vector({1, .5 * pull, 0}));
    add("friction across", block(4, 1, .5).problem(), {vector({3.5, 0, 0})}, vector({4, -pull, 0}),
        vector({1, 0, -pull}));
  }
  // Walls that touch from both sides press on each other as hard as they like.
  for (const double press : {1., two_to(40), two_to(100)}) {
    const Problem p =
        SmallFrictional{.z_u = vector({0, 4})}.contact(0, {{x, 0}, {y, 0}}).contact(0, {{-x, 0}, {y, 0}}).problem();
    for (const double off : {0., 1e-6, 1.})
      add("pressed from both sides", p, {vector({0, 4})}, vector({0, 4 - off}), vector({press, -off, press, 0}));
  }
  // One contact many times, the load shared as nobody would: only the sum counts for z.
  for (const int copies : {2, 8, 32}) {
    SmallFrictional shared{.z_u = vector({4, -1})};
    for (int k = 0; k < copies; ++k) shared.contact(.5, {{y, 0}, {x, 0}});
    for (const double odd : {0., 1., 1e6}) {
      Vector lambda = Vector::Zero(2 * copies);
      lambda.head(4) << 1 + odd, -.5 - odd, -odd, odd;
      add("shared load", shared.problem(), {vector({3.5, 0})}, vector({3.5, 0}), lambda);
      add("shared load, off", shared.problem(), {vector({3.5, 0})}, vector({3.5 + 1e-4, 0}), lambda);
    }
  }
  // A contact that is open by more than all else.
  for (const double gap : {1e10, 1e150, 1e300}) {
    const Problem p = SmallFrictional{.z_u = vector({4, -1})}
                          .contact(.5, {{y, 0}, {x, 0}})
                          .contact(.5, {{y, -gap}, {x, gap}})
                          .problem();
    add("wide open", p, {vector({3.5, 0})}, vector({3.5, 0}), vector({1, -.5, 0, 0}));
    add("wide open, pushes", p, {vector({3.5, 0})}, vector({3.5, 1}), vector({1, -.5, 1, 0}));
  }
  return all;
}

}  // namespace zwang::test

#include <zwang/bench/scenes/families.h>

#include <array>
#include <cmath>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/row_by_row.h>

namespace zwang {
namespace {

constexpr double g = g_dyadic;

// The multipliers of a stack hold g (top + j): beyond 2^45 they have to be rounded, and a rounded weight at the bottom
// moves the light boxes. Only z is given there.
Reference at_rest(double top, Index n, const Vector& lambda) {
  return {.z = Vector::Zero(n), .lambda = top <= 0x1p45 ? lambda : Vector(), .method = "closed form"};
}

// Points of 1 kg one on another on a line, the top one of `top`: at rest, and contact i carries all above it.
Instance points_on_a_line(Index n, double top, const char* name, const std::string& place = "") {
  Vector mass = Vector::Ones(n), lambda(n);
  mass[n - 1] = top;
  RowByRow rows(mass, Vector::Constant(n, -g));
  for (Index i = 0; i < n; ++i) {
    Vector row = Vector::Unit(n, i);
    if (i > 0) row[i - 1] = -1;
    lambda[i] = g * (top + static_cast<double>(n - 1 - i));
    rows.add_contact(row, 0, numbered(name, i) + place);
  }
  return rows.finish(at_rest(top, n, lambda));
}

}  // namespace

// Unit boxes with I = m/8 on four corners each; all weigh 1 but the top one, 2^k. At rest: z = 0, and the four corners
// of a level share the weight above it.
Instance mass_ratio(const Knobs& knobs) {
  constexpr Index boxes = 10;
  const double top = std::exp2(knobs.at("k"));
  std::vector<double> masses(boxes, 1);
  masses.back() = top;
  Vector lambda(4 * boxes);
  RowByRow rows = box_stack(masses, friction_of(knobs));
  for (Index i = 0; i < boxes; ++i) {
    const std::string label = numbered("box ", i) + " on " + (i ? numbered("box ", i - 1) : "floor");
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 p = box_corner(corner);
      lambda[4 * i + corner] = g * (top + static_cast<double>(boxes - 1 - i)) / 4;
      rows.add_contact(Vec3::UnitZ(), i, p, p + Vec3::UnitZ(), 0, label + ", corner " + std::to_string(corner));
    }
  }
  return rows.finish(at_rest(top, 6 * boxes, lambda));
}

// The same stack as points with one contact each: lambda is unique.
Instance mass_ratio_one_contact(const Knobs& knobs) {
  return points_on_a_line(10, std::exp2(knobs.at("k")), "mass ", " on the one below");
}

Instance stack_of_masses(const Knobs& knobs) {
  return points_on_a_line(static_cast<Index>(knobs.at("boxes")), 1, "box ");
}

// A planar four-bar linkage held by revolute joints: 20 rows of rank 17, one freedom. Tilting hinge 4 by (1, 0, delta)
// takes the freedom away: z = 0 for every delta > 0, and z is the projection of z_u on the mechanism's motion v at 0.
Instance four_bar_loop(const Knobs& knobs) {
  constexpr Index n = 18;
  const double delta = small(knobs);
  Vector mass(n), z_u(n), v(n);
  mass << 1, 1, 1, .25, .5, .75, 2, 2, 2, .25, .5, .75, 3, 3, 3, .25, .5, .75;
  z_u << 11, -11, 31, 2, 29, 13, 16, -32, -20, -19, -30, -25, -26, -25, -30, -17, -1, -29;
  z_u /= 8;
  // The links turn at 13 : -2 : 8.
  v << -6.5, 0, 0, 0, 0, 13, -12.5, -1, 0, 0, 0, -2, -6, -1, 0, 0, 0, 8;

  struct Hinge {
    Index a, b;  // links, -1 the frame
    Vec3 on_a, on_b;
  };
  const std::array<Hinge, 4> hinges = {{{-1, 0, Vec3(0, 0, 0), Vec3(0, -.5, 0)},
                                        {0, 1, Vec3(0, .5, 0), Vec3(-.5, -.25, 0)},
                                        {1, 2, Vec3(.5, .25, 0), Vec3(-.125, .75, 0)},
                                        {2, -1, Vec3(.125, -.75, 0), Vec3(0, 0, 0)}}};
  RowByRow rows(mass, z_u);
  for (std::size_t k = 0; k < hinges.size(); ++k) {
    const Hinge& hinge = hinges[k];
    const std::array<Vec3, 2> across = {Vec3(1, 0, k == 3 ? delta : 0), Vec3::UnitY()};
    for (Index i = 0; i < 5; ++i) {
      Vector row = Vector::Zero(n);
      const auto add = [&](Index body, double sign, const Vec3& point) {
        if (body < 0) return;
        if (i < 3)
          add_point(row, body, sign, point, Vec3::Unit(i));
        else
          row.segment<3>(6 * body + 3) = sign * across[at(i - 3)];
      };
      add(hinge.a, -1, hinge.on_a);
      add(hinge.b, 1, hinge.on_b);
      rows.add_equality(row, 0, "revolute/hinge " + std::to_string(k + 1) + " [" + std::to_string(i) + "]");
    }
  }
  Vector z = Vector::Zero(n);
  if (delta == 0) {
    const double along = v.dot(mass.cwiseProduct(z_u)), length2 = v.dot(mass.cwiseProduct(v));
    z = v * along / length2;
  }
  return rows.finish({.z = z, .bound = 4e-16, .method = "closed form"});
}

namespace {

Vector row_of(std::initializer_list<double> entries) {
  return Eigen::Map<const Vector>(entries.begin(), static_cast<Index>(entries.size()));
}

const Vector six_numbers = row_of({1, 2, -3, .5, .25, -1});  // the free motion of GAP and INC

}  // namespace

// Three contact rows whose sum is 0 and whose c sum to -gap: feasible iff gap >= 0. For 0 <= gap <= 1/2 the first and
// the third are active (the normal equations of the two solved by hand); below, (1, 1, 1) is the certificate.
Instance contact_gap(const Knobs& knobs) {
  const double size = small(knobs), gap = knobs.at("feasible") != 0 ? size : -size;
  const Vector z_u = six_numbers;
  const std::array<Vector, 3> J = {row_of({1, 0, 0, 1, 0, 0}), row_of({0, 1, 0, 0, 1, -1}),
                                   row_of({-1, -1, 0, -1, -1, 1})};
  RowByRow rows(Vector::Ones(6), z_u);
  rows.add_contact(J[0], 1, "left wall");
  rows.add_contact(J[1], 2, "right wall");
  rows.add_contact(J[2], -3 - gap, "wedge");
  if (gap < 0) return rows.finish({.feasible = false, .certificate = Vector::Ones(3), .method = "closed form"});
  const Vector lambda = row_of({(.5 - gap) / 3, 0, (1.25 - gap) / 3});
  return rows.finish(
      {.z = z_u + J[0] * lambda[0] + J[2] * lambda[2], .lambda = lambda, .bound = 4e-16, .method = "closed form"});
}

// Equality rows a and 2a with c = 1 and 2 + delta: infeasible iff delta != 0, by the certificate (-2, 1).
Instance inconsistent_equalities(const Knobs& knobs) {
  const double delta = small(knobs);
  const Vector z_u = six_numbers, a = row_of({1, 2, 0, -1, 0, 3});
  RowByRow rows(Vector::Ones(6), z_u);
  rows.add_equality(a, 1, "equality/first");
  rows.add_equality(2 * a, 2 + delta, "equality/doubled");
  rows.add_contact(Vector::Unit(6, 1), 0, "floor");
  if (delta != 0) return rows.finish({.feasible = false, .certificate = row_of({-2, 1, 0}), .method = "closed form"});
  const Vector lambda = row_of({-1. / 30, 0, 0});
  return rows.finish({.z = z_u + a * lambda[0], .lambda = lambda, .bound = 4e-16, .method = "closed form"});
}

}  // namespace zwang

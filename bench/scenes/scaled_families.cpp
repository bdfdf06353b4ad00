#include <array>
#include <cmath>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/known_answer.h>
#include <zwang/bench/scenes/row_by_row.h>

namespace zwang {
namespace {

// A chain of four bodies on ball joints with two contacts each, in eighths: 24 unknowns, 12 equality rows, 8 contacts.
// Well-conditioned; the families below scale it. Its truth is a reference's.
struct ChainOfFour {
  static constexpr Index bodies = 4, n = 6 * bodies, joints = 3 * bodies, contacts = 2 * bodies;
  Draw draw;
  Vector mass = Vector(n), z_u, c;
  Matrix J = Matrix::Zero(joints + contacts, n);

  explicit ChainOfFour(const Knobs& knobs) : draw(knobs.at("seed")) {
    z_u = draw.eighths(n, 32);
    c = draw.eighths(joints + contacts, 8);
    for (Index b = 0; b < bodies; ++b) {
      mass.segment<6>(6 * b) << 1, 1, 1, .25, .25, .125;
      const Vec3 here = draw.eighths(3, 6), before = draw.eighths(3, 6);
      for (Index axis = 0; axis < 3; ++axis) J.row(3 * b + axis) = point_row(n, b, here, before, Vec3::Unit(axis));
      for (Index side = 0; side < 2; ++side) {
        Vec3 normal = draw.eighths(3, 8);
        normal.z() = 1;
        Vector row = Vector::Zero(n);
        add_point(row, b, 1, draw.eighths(3, 8), normal);
        J.row(joints + 2 * b + side) = row;
      }
    }
  }

  RowByRow rows() const {
    RowByRow out(mass, z_u);
    for (Index i = 0; i < J.rows(); ++i) {
      if (i < joints)
        out.add_equality(J.row(i), c[i], numbered("ball_joint/", i / 3) + " [" + std::to_string(i % 3) + "]");
      else
        out.add_contact(J.row(i), c[i], std::to_string(i - joints));
    }
    return out;
  }
};

double scale(const Knobs& knobs) { return std::exp2(knobs.at("k")); }

}  // namespace

// Lengths in units of 2^-k m: translations, levers and offsets grow, inertias with the square.
Instance length_unit(const Knobs& knobs) {
  ChainOfFour chain(knobs);
  const double s = scale(knobs);
  chain.c *= s;
  for (Index b = 0; b < ChainOfFour::bodies; ++b) {
    chain.z_u.segment<3>(6 * b) *= s;
    chain.mass.segment<3>(6 * b + 3) *= s * s;
    chain.J.middleCols<3>(6 * b + 3) *= s;
  }
  return chain.rows().finish();
}

// Equality row 1 and contact rows 0 and 3 times 2^k, their c with them: the same problem. zero: one more row without
// entries, 1: 0 >= 0, 2: 0 >= 2^-40 (infeasible), 3: 0 >= -2^-40.
Instance row_scale(const Knobs& knobs) {
  ChainOfFour chain(knobs);
  for (const Index i : {Index{1}, ChainOfFour::joints, ChainOfFour::joints + 3}) {
    chain.J.row(i) *= scale(knobs);
    chain.c[i] *= scale(knobs);
  }
  RowByRow rows = chain.rows();
  const int zero = static_cast<int>(knobs.at("zero"));
  if (zero == 0) return rows.finish();
  constexpr std::array size = {0., 0x1p-40, -0x1p-40};
  rows.add_contact(Vector::Zero(ChainOfFour::n), size[at(zero - 1)], "without entries");
  if (zero != 2) return rows.finish();
  const Index m = chain.c.size() + 1;
  return rows.finish({.feasible = false, .certificate = Vector::Unit(m, m - 1), .method = "closed form"});
}

// c times 2^k: the rows require motions far larger than the free one.
Instance huge_offsets(const Knobs& knobs) {
  ChainOfFour chain(knobs);
  chain.c *= scale(knobs);
  return chain.rows().finish();
}

// One inertia axis of each body divided by 2^k: needles.
Instance thin_bodies(const Knobs& knobs) {
  ChainOfFour chain(knobs);
  for (Index b = 0; b < ChainOfFour::bodies; ++b) chain.mass[6 * b + 3 + chain.draw.integer(0, 2)] /= scale(knobs);
  return chain.rows().finish();
}

// Rods of 1 m on ball joints, end to end, the first on the ceiling; known answer.
Instance long_chain(const Knobs& knobs) {
  const auto links = static_cast<Index>(knobs.at("links"));
  Vector mass = Vector::Ones(6 * links);
  for (Index b = 0; b < links; ++b) mass.segment<3>(6 * b + 3) /= 16;
  RowByRow rows(mass, Vector::Zero(6 * links));
  const Vec3 half(.5, 0, 0);
  for (Index b = 0; b < links; ++b) rows.add_ball_joint(b, -half, half);
  return with_known_answer(rows.finish(), static_cast<std::uint64_t>(knobs.at("seed")), .5);
}

// Murty's rows: 1 on the diagonal and 2 below it, c = 1, M = I, z_u = 0. z = e_1: only the first row pushes. A method
// that exchanges one row at a time and always takes the first (or the last) violated one needs 2^n - 1 steps.
Instance exponential_pivots(const Knobs& knobs) {
  const auto n = static_cast<Index>(knobs.at("n"));
  const bool reversed = knobs.at("reversed") != 0;
  RowByRow rows(Vector::Ones(n), Vector::Zero(n));
  for (Index k = 0; k < n; ++k) {
    const Index i = reversed ? n - 1 - k : k;
    Vector row = Vector::Unit(n, i);
    row.head(i).setConstant(2);
    rows.add_contact(row, 1, std::to_string(i + 1));
  }
  return rows.finish(
      {.z = Vector::Unit(n, 0), .lambda = Vector::Unit(n, reversed ? n - 1 : 0), .method = "closed form"});
}

// Small integers on which block principal pivoting (exchange every row of the wrong sign, start with none) returns to
// a set it has been at: without a backup rule it cycles. The seeds come from a search; a test replays them.
Instance pivot_cycle(const Knobs& knobs) {
  const auto n = static_cast<Index>(knobs.at("n"));
  constexpr std::array seeds = {878, 325, 309, 64};  // n = 5, 6, 7, 8
  Draw draw(seeds[at(n - 5)]);
  RowByRow rows(Vector::Ones(n), Vector::Zero(n));
  for (Index i = 0; i < n; ++i) {
    const Vector row = draw.integers(n, 3);
    rows.add_contact(row, draw.integer(1, 3), std::to_string(i + 1));
  }
  return rows.finish();
}

}  // namespace zwang

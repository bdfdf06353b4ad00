#include <array>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/row_by_row.h>

namespace zwang {

// Four pairs of contact rows a and a + eps d, all pushing with lambda = 1, M = I: the normals of two contacts of one
// edge. c = J z0 and z_u = z0 - J' lambda are exact up to eps = 2^-45 (8 bits before the point, 45 after it).
Instance near_parallel_contacts(const Knobs& knobs) {
  constexpr Index n = 12, pairs = 4;
  const double eps = small(knobs);
  Draw draw(knobs.at("seed"));
  const Vector z0 = draw.integers(n, 4);
  Vector z_u = z0;
  std::vector<Vector> J;
  for (Index k = 0; k < pairs; ++k) {
    const Vector a = draw.integers(n, 4), d = draw.integers(n, 4);
    J.push_back(a);
    J.push_back(a + eps * d);
    z_u -= 2 * a + eps * d;
  }
  RowByRow rows(Vector::Ones(n), z_u);
  for (Index i = 0; i < 2 * pairs; ++i) {
    const Vector& row = J[at(i)];
    rows.add_contact(row, row.dot(z0), numbered("pair ", i / 2) + (i % 2 ? " tilted" : ""));
  }
  return rows.finish({.z = z0, .lambda = Vector::Ones(2 * pairs), .method = "closed form"});
}

// Three wedges with an opening of eps: a floor z >= 0 and a ceiling eps d . (x, y) - z >= eps c press a mass (x, y, z)
// of 1 kg out along d: it moves by d c / |d|^2, and both faces push with about c / (|d|^2 eps). The last wedge's 3/5
// and its multipliers are rounded; only z is given.
Instance wedges(const Knobs& knobs) {
  constexpr Index n = 12;
  constexpr std::array<std::array<double, 2>, 3> direction = {{{1, 0}, {1, 1}, {1, 2}}};
  const double eps = small(knobs);
  Vector z_u = Vector::Zero(n), z = Vector::Zero(n);
  for (Index w = 0; w < 3; ++w) {
    z_u.segment<4>(4 * w) << 0, 0, -1, 3;
    z[4 * w + 3] = 3;
  }
  RowByRow rows(Vector::Ones(n), z_u);
  for (Index w = 0; w < 3; ++w) {
    const auto [dx, dy] = direction[at(w)];
    const double c = static_cast<double>(w + 1), out = c / (dx * dx + dy * dy);
    Vector ceiling = -Vector::Unit(n, 4 * w + 2);
    ceiling[4 * w] = eps * dx;
    ceiling[4 * w + 1] = eps * dy;
    z[4 * w] = dx * out;
    z[4 * w + 1] = dy * out;
    rows.add_contact(Vector::Unit(n, 4 * w + 2), 0, numbered("floor of wedge ", w + 1));
    rows.add_contact(ceiling, eps * c, numbered("ceiling of wedge ", w + 1));
  }
  return rows.finish({.z = z, .bound = 2e-16, .method = "closed form"});
}

namespace {

// A brick of 1 kg, I = 1/8, thrown onto a face.
const Vector brick_mass = (Vector(6) << 1, 1, 1, .125, .125, .125).finished();
const Vector thrown = (Vector(6) << .5, -.25, -g_dyadic, 1.5, -.75, .25).finished();

}  // namespace

// One body on a flat face, four contacts at its corners (+-1, +-1) and the others drawn between them: rank 3. It lands
// without turning; the corners alone carry it, each (9.8125 -+ 3/32 -+ 3/16) / 4, which is one of many lambda.
Instance many_on_a_face(const Knobs& knobs) {
  const auto contacts = static_cast<Index>(knobs.at("contacts"));
  Draw draw(knobs.at("seed"));
  Vector z = thrown, lambda = Vector::Zero(contacts);
  z.segment<3>(2).setZero();
  RowByRow rows(brick_mass, thrown, friction_of(knobs));
  for (Index i = 0; i < contacts; ++i) {
    const bool corner = i < 4;
    const double x = corner ? (i % 2 ? 1 : -1) : draw.integer(-255, 255) / 256.;
    const double y = corner ? (i / 2 ? 1 : -1) : draw.integer(-255, 255) / 256.;
    rows.add_contact(Vec3::UnitZ(), 0, Vec3(x, y, 0), {}, 0, std::to_string(i + 1));
    if (corner) lambda[i] = (g_dyadic - .09375 * x - .1875 * y) / 4;
  }
  return rows.finish({.z = z, .lambda = lambda, .method = "closed form"});
}

// The same body among contacts of tilted normals with room to spare (c <= 0): rank 6, most rows nearly active.
Instance many_tilted(const Knobs& knobs) {
  const auto contacts = static_cast<Index>(knobs.at("contacts"));
  Draw draw(knobs.at("seed"));
  RowByRow rows(brick_mass, thrown, friction_of(knobs));
  for (Index i = 0; i < contacts; ++i) {
    const Vec3 point = draw.integers(3, 256) / 256, tilt = draw.integers(3, 32) / 64;
    const Vec3 normal(tilt.x(), tilt.y(), 1);
    rows.add_contact(normal, 0, point, {}, -draw.integer(0, 128) / 1024., std::to_string(i + 1));
  }
  return rows.finish();
}

// Frame `frame` of a sequence: ten unit boxes on four corners each; a corner's contact exists while its height is below
// 0, and all heights are +-2^-k. From frame to frame each corner changes its sign with probability 1/8, so that rows
// come and go while c hardly moves. Keys stay with the corners.
Instance flipping_stack(const Knobs& knobs) {
  constexpr Index boxes = 10;
  const double height = small(knobs);
  Draw draw(knobs.at("seed"));
  std::array<bool, 4 * boxes> touches{};
  for (bool& t : touches) t = draw.integer(0, 1);
  for (int f = 0; f < knobs.at("frame"); ++f)
    for (bool& t : touches)
      if (draw.integer(0, 7) == 0) t = !t;
  RowByRow rows = box_stack(std::vector<double>(boxes, 1), friction_of(knobs));
  for (Index i = 0; i < 4 * boxes; ++i) {
    if (!touches[at(i)]) continue;
    const Index box = i / 4, corner = i % 4;
    const Vec3 p = box_corner(corner);
    rows.add_contact(Vec3::UnitZ(), box, p, p + Vec3::UnitZ(), height,
                     numbered("box ", box) + ", corner " + std::to_string(corner), static_cast<std::uint64_t>(i) + 1);
  }
  return rows.finish();
}

}  // namespace zwang

#include <zwang/bench/scenes/friction/families.h>

#include <array>
#include <cmath>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/row_by_row.h>
#include <zwang/core/number/double_double.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

// The rows as a problem of this family.
Instance named(const char* family, RowByRow& rows) {
  Instance out = rows.finish();
  out.problem.name = out.family = family;
  return out;
}

// z* is the answer that s* and lambda* make: c = J z* - s*, z_u = z* - M^-1 J'lambda*. No reference where doubles do
// not hold them.
Instance planted(const char* family, RowByRow& rows, const Vector& z, const Vector& lambda, const Vector& slack) {
  Instance out = named(family, rows);
  Problem& p = out.problem;
  VectorX<DoubleDouble> c(slack.size()), pushed = VectorX<DoubleDouble>::Zero(z.size());
  for (Index i = 0; i < p.rows(); ++i) {
    c[i] = -slack[i];
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it) {
      c[i] += DoubleDouble::exact_product(it.value(), z[it.col()]);
      pushed[it.col()] += DoubleDouble::exact_product(it.value(), lambda[i]);
    }
    p.c[i] = c[i].hi;
  }
  bool exact = true;
  for (const DoubleDouble& value : c) exact &= value.lo == 0;
  for (Index j = 0; j < z.size(); ++j) {
    const DoubleDouble free = DoubleDouble(z[j]) - pushed[j] / p.M.coeff(j, j);
    p.z_u[j] = free.hi;
    exact &= free.lo == 0;
  }
  if (exact) out.reference = Reference{.z = z, .lambda = lambda, .unique = false, .method = "known answer"};
  return out;
}

std::string counted(int solutions) {
  return solutions < 0 ? "a continuum of solutions"
                       : std::to_string(solutions) + (solutions == 1 ? " solution" : " solutions");
}

// How many solutions there are stands in the reference's method, and so in every table of references.
FrictionPoint known(Instance instance, int solutions, std::optional<Vector> z = {}) {
  const std::string method = "closed form, " + counted(solutions);
  if (z) instance.reference = Reference{.z = *z, .unique = solutions == 1, .method = method};
  if (solutions == 0) instance.reference = Reference{.feasible = false, .method = method};
  return {std::move(instance), solutions};
}

// Two walls that meet at the origin, tan of half the angle 3/4.
Instance wedge(const char* family, double mu, double wall_slip, double up) {
  RowByRow p(Vector{{1, 1}}, Vector{{0, up}});
  p.add_contact({Vector{{-4, 3}}, Vector{{3, 4}}}, {0, wall_slip}, mu, "right wall");
  p.add_contact({Vector{{4, 3}}, Vector{{-3, 4}}}, {0, wall_slip}, mu, "left wall");
  return named(family, p);
}

// Normal first.
const Mat3 upright{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};

// Rows of the difference of two bodies' velocities (of one, where other < 0) along each axis of a frame.
std::vector<Vector> frame_rows(Index unknowns, Index body, const Vec3& arm, Index other, const Vec3& other_arm,
                               const Mat3& axes, Index count) {
  std::vector<Vector> rows;
  for (Index k = 0; k < count; ++k) {
    Vector row = Vector::Zero(unknowns);
    add_point(row, body, 1, arm, axes.col(k));
    if (other >= 0) add_point(row, other, -1, other_arm, axes.col(k));
    rows.push_back(std::move(row));
  }
  return rows;
}

// |q|^2 times the rotation matrix of an integer quaternion: orthogonal columns of equal length.
Mat3 integer_frame(Draw& draw) {
  int w = 0, x = 0, y = 0, z = 0;
  while (w * w + x * x + y * y + z * z == 0) {
    w = draw.integer(-2, 2);
    x = draw.integer(-2, 2);
    y = draw.integer(-2, 2);
    z = draw.integer(-2, 2);
  }
  return (Mat3() << w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),  //
          2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),            //
          2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z)
      .finished();
}

// A stack of boxes whose corner contacts are repeated `copies` times.
Instance box_tower(const char* family, const std::vector<double>& masses, int copies, double push) {
  RowByRow p = box_stack(masses, 0, push);
  const auto n = static_cast<Index>(6 * masses.size());
  for (Index b = 0; 6 * b < n; ++b)
    for (Index corner = 0; corner < 4; ++corner)
      for (int copy = 0; copy < copies; ++copy)
        p.add_contact(frame_rows(n, b, box_corner(corner), b - 1, box_corner(corner) + Vec3(0, 0, 1), upright, 3),
                      {0, 0, 0}, .5, numbered("box ", b) + " corner " + std::to_string(corner));
  return named(family, p);
}

}  // namespace

FrictionPoint rod_point(double mu) {
  RowByRow p(Vector{{1, 1, 1}}, Vector{{2, .25, 0}});
  p.add_contact({Vector{{0, 1, 1}}, Vector{{1, 0, 2}}}, {0, 0}, mu, "tip");
  return known(named("ROD", p), mu > 14. / 11 ? 3 : 1, Vector{{2, .25, 0}});
}

FrictionPoint jam_point(double mu, double wall_slip) {
  const bool jams = wall_slip < 0 && mu >= .75;
  return jams ? known(wedge("JAM", mu, wall_slip, -1), 0)
              : known(wedge("JAM", mu, wall_slip, -1), 1,
                      wall_slip < 0 ? std::optional<Vector>(Vector{{0, 0}}) : std::nullopt);
}

FrictionPoint held_point(double mu) { return known(wedge("HELD", mu, 0, 1), mu < .75 ? 1 : 2, Vector{{0, 1}}); }

FrictionPoint pinch_point() {
  RowByRow p(Vector{{1, 1}}, Vector{{0, 3}});
  p.add_contact({Vector{{1, 0}}, Vector{{0, 1}}}, {0, 1}, 1, "left plate");
  p.add_contact({Vector{{-1, 0}}, Vector{{0, 1}}}, {0, -1}, 1, "right plate");
  return known(named("PINCH", p), -1, Vector{{0, 2}});
}

FrictionPoint puck_point() {
  // [v_x, v_y, v_z, w_x, w_y, w_z], flat: contacts at height 0 of the centre of mass.
  RowByRow p(Vector{{1, 1, 1, 4096, 4096, 4096}}, Vector::Zero(6));
  const double mu = .5, load = 85. / 64;
  Vector lambda(12), slack = Vector::Zero(12);
  const std::array<std::pair<double, double>, 4> place{{{9, 8}, {9, -8}, {-9, -8}, {-9, 8}}};
  const std::array<std::array<double, 3>, 4> slip{{{0, 15, 15}, {8, 15, 17}, {8, 6, 10}, {0, 6, 6}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto i = static_cast<Index>(3 * k);
    p.add_contact(frame_rows(6, 0, {place[k].first, place[k].second, 0}, -1, Vec3::Zero(), upright, 3), {0, 0, 0}, mu,
                  numbered("corner ", static_cast<Index>(k)));
    lambda[i] = load;
    for (std::size_t t = 0; t < 2; ++t) {
      slack[i + 1 + static_cast<Index>(t)] = slip[k][t];
      lambda[i + 1 + static_cast<Index>(t)] = -mu * (85 / slip[k][2]) * slip[k][t] / 64;
    }
  }
  Instance exact = planted("PUCK", p, Vector{{4, 10.5, 0, 0, 0, .5}}, lambda, slack);
  if (exact.reference) exact.reference->method += ", " + counted(-1);
  return {std::move(exact), -1};
}

Instance planted_friction(const PlantedFriction& o) {
  Draw draw(static_cast<double>(o.seed));
  const Index n = 6 * o.bodies;
  Vector mass(n), z = Vector::Zero(n);
  for (Index b = 0; b < o.bodies; ++b) {
    mass.segment<3>(6 * b).setConstant(std::exp2(draw.integer(-1, 2)));
    for (Index k = 3; k < 6; ++k) mass[6 * b + k] = std::exp2(draw.integer(-3, 0));
    for (Index k = 0; k < 6; ++k) z[6 * b + k] = draw.integer(-32, 32) / 16.0;
  }
  RowByRow p(mass, Vector::Zero(n));
  const Index rows = 1 + o.tangents;
  Vector lambda = Vector::Zero(rows * o.contacts), slack = Vector::Zero(rows * o.contacts);
  for (Index k = 0; k < o.contacts; ++k) {
    const Index body = k < o.bodies ? k : draw.index(o.bodies);
    const Index other = draw.index(o.bodies + 1) - 1;
    const auto arm = [&]() -> Vec3 { return draw.eighths(3, 8); };
    const Vec3 here = arm(), there = arm();
    p.add_contact(frame_rows(n, body, here, other == body ? -1 : other, there, integer_frame(draw), rows),
                  std::vector<double>(at(rows), 0), o.mu, numbered("planted ", k));
    const Index i = rows * k;
    const double push = std::exp2(draw.integer(-3, 3)), size = std::exp2(draw.integer(-3, 3));
    const std::array<double, 2> direction{(draw.integer(0, 1) ? 1. : -1.) * (o.tangents == 1 ? 5 : 3),
                                          draw.integer(0, 1) ? 4. : -4.};
    const int mode = draw.integer(0, 2);
    if (mode == 0) slack[i] = size;
    if (mode > 0) lambda[i] = 5 * push * (mode == 1 ? std::exp2(o.load_exponent) : 1);
    for (Index t = 0; t < o.tangents; ++t) {
      const double d = direction[at(t)];
      if (mode == 0) slack[i + 1 + t] = draw.integer(-16, 16) / 8.0;
      if (mode == 1) {
        slack[i + 1 + t] = size * d * std::exp2(o.slip_exponent);
        lambda[i + 1 + t] = -o.mu * d * push * std::exp2(o.load_exponent);
      }
      if (mode == 2) lambda[i + 1 + t] = o.mu * .75 * d * push;
    }
  }
  Instance out = planted("planted", p, z, lambda, slack);
  out.seed = o.seed;
  return out;
}

std::vector<std::pair<std::string, std::function<Instance(const Knobs&)>>> friction_families() {
  const auto planted = [](const char* name, void (*set)(PlantedFriction&, int)) {
    return std::pair(name, [set, name](const Knobs& k) {
      PlantedFriction o{.bodies = static_cast<Index>(k.at("bodies")),
                        .contacts = static_cast<Index>(k.at("contacts")),
                        .seed = static_cast<std::uint64_t>(k.at("seed"))};
      set(o, static_cast<int>(k.at("k")));
      Instance out = planted_friction(o);
      out.family = out.problem.name = name;
      return out;
    });
  };
  // mu, 2^-k beside a limit, on the side that the knob says.
  const auto beside = [](double limit, const Knobs& k, const char* above) {
    const double off = std::exp2(-k.at("k"));
    return limit + (k.at(above) == 1 ? off : -off);
  };
  return {
      planted("planted", [](PlantedFriction& o, int k) { o.mu = std::exp2(-k); }),
      planted("MU0", [](PlantedFriction& o, int k) { o.mu = std::exp2(-k); }),
      planted("MUL", [](PlantedFriction& o, int k) { o.mu = std::exp2(k); }),
      planted("APEX", [](PlantedFriction& o, int k) { o.load_exponent = -k; }),
      planted("SLIP", [](PlantedFriction& o, int k) { o.slip_exponent = -k; }),
      {"MRF", [](const Knobs& k) { return box_tower("MRF", {1, std::exp2(k.at("k"))}, 1, .25); }},
      {"STKF", [](const Knobs& k) { return box_tower("STKF", std::vector<double>(at(k.at("boxes")), 1), 1, .375); }},
      {"RANK", [](const Knobs& k) { return box_tower("RANK", {1}, static_cast<int>(k.at("k")), .25); }},
      {"JAM", [=](const Knobs& k) { return jam_point(beside(.75, k, "beyond"), -1).instance; }},
      {"HELD", [=](const Knobs& k) { return held_point(beside(.75, k, "above")).instance; }},
      {"ROD", [=](const Knobs& k) { return rod_point(beside(14. / 11, k, "above")).instance; }},
      {"PINCH", [](const Knobs&) { return pinch_point().instance; }},
      {"PUCK", [](const Knobs&) { return puck_point().instance; }}};
}

}  // namespace zwang

#include <array>
#include <cmath>
#include <numbers>

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/contact.h>

// Buildings that stand by friction alone.
namespace zwang {
namespace {

std::string numbers(int i, int k) { return std::to_string(i + 1) + "." + std::to_string(k + 1); }

}  // namespace

// Rings of stones, radius 4 m to 5 m, up to 75 degrees: a dome with an eye. Four contacts a joint.
Instance dome(const Knobs& knobs) {
  const int rings = static_cast<int>(knobs.at("rings")), sectors = static_cast<int>(knobs.at("sectors"));
  const double inner = 4, outer = 5, rise = 75 * std::numbers::pi / 180 / rings, turn = 2 * std::numbers::pi / sectors;
  const auto ray = [](double up, double around) {
    return Vec3(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
  };
  const auto cubes = (outer * outer * outer - inner * inner * inner) / 3;
  const auto fourth = (std::pow(outer, 4) - std::pow(inner, 4)) / 4;
  Scene scene;
  const BodyId ground = add_fixed(scene);
  const auto stone = [&](int ring, int sector) { return ground + 1 + ring * sectors + (sector + sectors) % sectors; };
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const double up = (i + 0.5) * rise, around = (k + 0.5) * turn;
      const double mass = cubes * (std::sin((i + 1) * rise) - std::sin(i * rise)) * turn;
      const double radius = fourth / cubes;
      Body body =
          box_body({outer - inner, radius * std::cos(up) * turn, radius * rise}, mass, radius * ray(up, around));
      body.pose.rotation << ray(up, around), Vec3(-std::sin(around), std::cos(around), 0),
          ray(up + std::numbers::pi / 2, around);
      scene.add(body);
    }
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      std::array<Vec3, 4> bed, side;
      for (unsigned c = 0; c < 4; ++c) {
        const double r = c & 1 ? outer : inner;
        bed[c] = r * ray(i * rise, (c & 2 ? k + 1 : k) * turn);
        side[c] = r * ray((c & 2 ? i + 1 : i) * rise, k * turn);
      }
      const std::string name = "stone " + numbers(i, k) + " on ";
      add_corners(scene, stone(i, k), i == 0 ? ground : stone(i - 1, k), bed,
                  ray(i * rise + std::numbers::pi / 2, (k + 0.5) * turn),
                  name + (i == 0 ? "ground" : "stone " + numbers(i - 1, k)));
      add_corners(scene, stone(i, k), stone(i, k - 1), side, Vec3(-std::sin(k * turn), std::cos(k * turn), 0),
                  name + "stone " + numbers(i, (k + sectors - 1) % sectors));
    }
  return let_go(scene, knobs);
}

// A house of cards: pairs of cards lean against each other, `lean` off the vertical (tangent); flat cards lie from peak
// to peak and carry the next storey. Cards without thickness, two contacts where two touch.
Instance cards(const Knobs& knobs) {
  const int storeys = static_cast<int>(knobs.at("storeys"));
  const double length = 0.09, width = 0.06, mass = 0.002, angle = std::atan(knobs.at("lean"));
  const double reach = length * std::sin(angle), height = length * std::cos(angle);
  const Vec3 widths(0.0003, width, length);
  Scene scene;
  const BodyId ground = add_fixed(scene);
  const auto touch = [&](BodyId a, BodyId b, double x, double z, const Vec3& normal, const std::string& label) {
    for (const double side : {-0.5, 0.5})
      scene.add(contact_at(scene.bodies, a, b, {x, side * width, z}, normal), label + (side < 0 ? ", near" : ", far"));
  };
  std::vector<BodyId> floor;  // under each pair of this storey
  for (int s = 0; s < storeys; ++s) {
    const int pairs = storeys - s;
    std::vector<BodyId> left, right, flat;
    const auto middle = [&](int k) { return (k - 0.5 * (pairs - 1)) * length; };
    for (int k = 0; k < pairs; ++k)
      for (const double side : {-1., 1.}) {
        Body card = box_body(widths, mass, {middle(k) + side * reach / 2, 0, (s + 0.5) * height});
        card.pose.rotation = rotation(-side * angle * Vec3::UnitY());
        (side < 0 ? left : right).push_back(scene.add(card));
      }
    for (int k = 0; k < pairs; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const std::string pair = "pair " + numbers(s, k);
      const BodyId below = s == 0 ? ground : floor[at];
      const std::string on = s == 0 ? " on ground" : " on flat card " + numbers(s - 1, k);
      touch(left[at], below, middle(k) - reach, s * height, Vec3::UnitZ(), pair + ", left" + on);
      touch(right[at], below, middle(k) + reach, s * height, Vec3::UnitZ(), pair + ", right" + on);
      touch(right[at], left[at], middle(k), (s + 1) * height, Vec3::UnitX(), pair);
    }
    for (int k = 0; k + 1 < pairs; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const std::string name = "flat card " + numbers(s, k) + " on pair ";
      const BodyId card =
          scene.add(box_body({length, width, 0.0003}, mass, {(middle(k) + middle(k + 1)) / 2, 0, (s + 1) * height}));
      touch(card, right[at], middle(k), (s + 1) * height, Vec3::UnitZ(), name + numbers(s, k));
      touch(card, left[at + 1], middle(k + 1), (s + 1) * height, Vec3::UnitZ(), name + numbers(s, k + 1));
      flat.push_back(card);
    }
    floor = std::move(flat);
  }
  return let_go(scene, knobs);
}

namespace {

struct Ball {
  Vec3 at;
  double radius;
};

// Where a ball of this radius touches three others from above; none: NaN.
Vec3 on_top_of(const Ball& a, const Ball& b, const Ball& c, double radius) {
  const Vec3 u = b.at - a.at, v = c.at - a.at, n = u.cross(v);
  const double ra = a.radius + radius, rb = b.radius + radius, rc = c.radius + radius;
  const double along_u = (ra * ra - rb * rb + u.squaredNorm()) / 2, along_v = (ra * ra - rc * rc + v.squaredNorm()) / 2;
  const Vec3 foot = (along_u * v - along_v * u).cross(n) / n.squaredNorm();
  const double out = std::sqrt((ra * ra - foot.squaredNorm()) / n.squaredNorm());  // NaN where they are too far apart
  return a.at + foot + (n.z() < 0 ? -out : out) * n;
}

// Is the point within the triangle, seen from above?
bool carries(const Ball& a, const Ball& b, const Ball& c, const Vec3& p) {
  const auto side = [&](const Ball& from, const Ball& to) {
    const Vec3 e = to.at - from.at, d = p - from.at;
    return e.x() * d.y() - e.y() * d.x();
  };
  const double x = side(a, b), y = side(b, c), z = side(c, a);
  return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

}  // namespace

// Balls of 0.4 to 0.5 m radius, poured on one spot: each rolls to the lowest place where the ground or three others
// carry it, a step outward counting as much as half a step up. All touch, at rest.
Instance heap(const Knobs& knobs) {
  const int count = static_cast<int>(knobs.at("balls"));
  Draw draw(knobs.at("seed"));
  std::vector<Ball> balls;
  const auto place = [&](double radius) {
    Vec3 best = Vec3(0, 0, radius);
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Vec3& p) {
      const double cost = p.z() + 0.5 * std::hypot(p.x(), p.y());
      if (!(cost < least) || p.z() < radius) return;
      for (const Ball& other : balls)
        if ((p - other.at).norm() < (1 - 1e-9) * (radius + other.radius)) return;
      best = p;
      least = cost;
    };
    const auto near = [&](const Ball& a, const Ball& b) {
      return (a.at - b.at).norm() < a.radius + b.radius + 2 * radius;
    };
    for (std::size_t i = 0; i < balls.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Ball &a = balls[i], &b = balls[j];
        if (!near(a, b)) continue;
        // On the ground beside both: the ground is a ball below, as large as the Earth seems.
        for (const double way : {-1., 1.}) {
          const Vec3 apart = b.at - a.at, flat(apart.x(), apart.y(), 0);
          const double d = flat.norm(), da = a.radius + radius, db = b.radius + radius;
          const double ha = da * da - std::pow(a.at.z() - radius, 2), hb = db * db - std::pow(b.at.z() - radius, 2);
          const double along = (d * d + ha - hb) / (2 * d), across = std::sqrt(ha - along * along);
          if (!(across >= 0)) continue;
          const Vec3 e = flat / d;
          consider(Vec3(a.at.x(), a.at.y(), radius) + along * e + way * across * Vec3(-e.y(), e.x(), 0));
        }
        for (std::size_t k = 0; k < j; ++k)
          if (const Ball& c = balls[k]; near(a, c) && near(b, c)) {
            const Vec3 p = on_top_of(a, b, c, radius);
            if (p.allFinite() && carries(a, b, c, p)) consider(p);
          }
      }
    if (balls.size() == 1) best = {balls[0].at.x() + 2 * std::sqrt(balls[0].radius * radius), 0, radius};
    balls.push_back({best, radius});
  };
  for (int i = 0; i < count; ++i) place(draw.uniform(0.4, 0.5));

  Scene scene;
  const BodyId ground = add_fixed(scene);
  for (const Ball& b : balls) {
    Body body;
    body.pose.position = b.at;
    body.mass = std::pow(2 * b.radius, 3);
    body.inertia *= 0.4 * body.mass * b.radius * b.radius;
    scene.add(body);
  }
  constexpr double touching = 1e-6;  // m
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const auto body = ground + 1 + static_cast<BodyId>(i);
    const Ball& a = balls[i];
    const std::string name = "ball " + std::to_string(i + 1) + " on ";
    if (a.at.z() < a.radius + touching)
      scene.add(contact_at(scene.bodies, body, ground, a.at - a.radius * Vec3::UnitZ(), Vec3::UnitZ()),
                name + "ground");
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 apart = a.at - balls[j].at, n = apart.normalized();
      if (apart.norm() < a.radius + balls[j].radius + touching)
        scene.add(contact_at(scene.bodies, body, ground + 1 + static_cast<BodyId>(j), a.at - a.radius * n, n),
                  name + "ball " + std::to_string(j + 1));
    }
  }
  return let_go(scene, knobs);
}

}  // namespace zwang

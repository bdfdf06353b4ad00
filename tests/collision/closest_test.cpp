#include <zwang/collision/narrow_phase/closest.h>

#include <gtest/gtest.h>

#include <zwang/bench/scenes/physical.h>

namespace zwang::collision {
namespace {

using Real = long double;
using Point = Vec<Real, 3>;

// The distance of two convex hulls that do not meet, by trying everything: each corner, each pair and each triple of
// corners of the one against the other's, where the perpendicular foot falls inside. In extended precision.
Real exhaustive(std::span<const Vec3> a, std::span<const Vec3> b) {
  Real best = std::numeric_limits<Real>::infinity();
  const auto offer = [&](const Point& d) { best = std::min(best, d.norm()); };
  const auto in = [](Real t) { return t > 0 && t < 1; };
  const auto one_way = [&](std::span<const Vec3> p, std::span<const Vec3> q) {
    for (std::size_t i = 0; i < q.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Point origin = q[i].cast<Real>(), u = q[j].cast<Real>() - origin;
        for (const Vec3& x : p) {
          const Point d = x.cast<Real>() - origin;
          if (const Real t = d.dot(u) / u.squaredNorm(); in(t)) offer(d - t * u);
        }
        for (std::size_t k = 0; k < j; ++k) {
          const Point v = q[k].cast<Real>() - origin, n = u.cross(v);
          if (n.squaredNorm() == 0) continue;
          for (const Vec3& x : p) {
            const Point d = x.cast<Real>() - origin;
            const Real s = d.cross(v).dot(n) / n.squaredNorm(), t = u.cross(d).dot(n) / n.squaredNorm();
            if (s > 0 && t > 0 && s + t < 1) offer(n * (d.dot(n) / n.squaredNorm()));
          }
        }
      }
  };
  one_way(a, b);
  one_way(b, a);
  for (const Vec3& x : a)
    for (const Vec3& y : b) offer(x.cast<Real>() - y.cast<Real>());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < b.size(); ++k)
        for (std::size_t l = 0; l < k; ++l) {
          const Point p = a[i].cast<Real>(), q = b[k].cast<Real>(), u = a[j].cast<Real>() - p,
                      v = b[l].cast<Real>() - q, n = u.cross(v), d = q - p;
          if (n.squaredNorm() == 0) continue;
          const Real s = d.cross(v).dot(n) / n.squaredNorm(), t = d.cross(u).dot(n) / n.squaredNorm();
          if (in(s) && in(t)) offer(p + s * u - q - t * v);
        }
  return best;
}

std::vector<Shape> shapes(Draw& draw) {
  std::vector<Vec3> points;
  for (int k = 0; k < 20; ++k) points.push_back(draw.cube(0.05));
  return {Shape::sphere(0.01), Shape::capsule(0.08, 0.01), Shape::rounded_box({0.1, 0.06, 0.04}, 0.005),
          Shape::hull(points, 0.004)};
}

TEST(Closest, IsTheDistanceForAllShapesAndTriangles) {
  Draw draw(1);
  int apart = 0;
  for (int i = 0; i < 300; ++i)
    for (const Shape& shape : shapes(draw)) {
      const Vec3 at = 0.12 * draw.direction();
      const double size = std::exp(draw.uniform(-7, -2));
      const Triangle t{{at + draw.cube(size), at + draw.cube(size), at + draw.cube(size)}};
      const Closest c = closest(shape, t, 1);
      if (c.distance < 1e-9) continue;
      ++apart;
      const auto truth = static_cast<double>(exhaustive(shape.corners(), t.corner));
      EXPECT_LE(c.distance, truth + 1e-14) << "an over-estimate is unsafe";
      EXPECT_NEAR(c.distance, truth, 1e-10);
      EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
      EXPECT_LE(exhaustive(std::span(&c.on_b, 1), t.corner), 1e-10) << "the point lies on the triangle";
      EXPECT_NEAR(closest(shape.corners(), t.corner).distance, truth, 1e-10) << "GJK alone";
    }
  EXPECT_GT(apart, 600);
}

TEST(Closest, NeverOverestimatesOnSlivers) {
  Draw draw(2);
  for (int i = 0; i < 300; ++i)
    for (const Shape& shape : shapes(draw)) {
      const Vec3 at = 0.1 * draw.direction(), along = draw.cube(0.2), b = at + along;
      const Triangle t{{at, b, at + 0.4 * along + std::exp(draw.uniform(-27, -10)) * draw.direction()}};
      const Closest c = closest(shape, t, 1);
      if (c.distance == 0) continue;
      const auto truth = static_cast<double>(exhaustive(shape.corners(), t.corner));
      EXPECT_LE(c.distance, truth + 1e-14);
      EXPECT_GE(c.distance, truth - 1e-9);
    }
}

TEST(Closest, TouchingCoresAreAtDistanceNull) {
  const Triangle t{{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)}};
  Draw draw(3);
  for (const Shape& shape : shapes(draw)) EXPECT_EQ(closest(shape, t, 1).distance, 0);
}

TEST(Shapes, RefuseSizesThatMeanNothing) {
  EXPECT_THROW(Shape::sphere(0), std::invalid_argument);
  EXPECT_THROW(Shape::sphere(std::nan("")), std::invalid_argument);
  EXPECT_THROW(Shape::capsule(-1, 1), std::invalid_argument);
  EXPECT_THROW(Shape::rounded_box({1, 1, 0.1}, 0.06), std::invalid_argument);
  EXPECT_THROW(Shape::hull({}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace zwang::collision

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/contact.h>

namespace zwang {
namespace {

// Four corner contacts of A, standing on B, over the rectangle between two corners at height z.
void add_patch(Scene& scene, BodyId a, BodyId b, const Vec3& low, const Vec3& high, const std::string& label) {
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = {k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), low.z()};
  add_corners(scene, a, b, corners, Vec3::UnitZ(), label);
}

// Gravity, and on every box a random push of up to `push` times its weight, at random levers within 1/8 m.
std::vector<Vec<double, 6>> pushed(const Scene& scene, double push, Draw& draw) {
  std::vector<Vec<double, 6>> wrench(scene.bodies.size());
  for (std::size_t b = 0; b < wrench.size(); ++b) {
    const Vec3 force = draw.cube(-push * gravity.z() * scene.bodies[b].mass);
    wrench[b] << force, draw.cube(0.125).cross(force);
  }
  return wrench;
}

// z* = 0 and the multipliers that a statics book gives to the contacts; friction has nothing to do.
Reference at_rest(const Problem& problem, const std::vector<double>& lambda) {
  Reference rest{.z = Vector::Zero(problem.size()), .lambda = Vector::Zero(problem.rows()), .method = "closed form"};
  std::size_t contact = 0;
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_tangent(i)) rest.lambda[i] = lambda[contact++];
  return rest;
}

// Boxes of 1 kg one on another, box i as wide as width(i), four corner contacts each. At rest a quarter of the weight
// above on each corner is one valid lambda.
Scene pile_up(int boxes, double height, const std::function<double(int)>& width, std::vector<double>& lambda) {
  Scene scene;
  BodyId below = add_fixed(scene);
  for (int i = 0; i < boxes; ++i) {
    const double wide = width(i), foot = height * i;
    const BodyId box = scene.add(box_body({wide, wide, height}, 1, {0, 0, foot + height / 2}));
    add_patch(scene, box, below, {-wide / 2, -wide / 2, foot}, {wide / 2, wide / 2, foot},
              "box " + std::to_string(i + 1) + (i == 0 ? " on ground" : " on box " + std::to_string(i)));
    lambda.insert(lambda.end(), 4, -gravity.z() * (boxes - i) / 4);
    below = box;
  }
  return scene;
}

Instance released(Scene& scene, const Knobs& knobs, const std::vector<double>& lambda) {
  const double push = knobs.contains("push") ? knobs.at("push") : 0;
  Draw draw(push > 0 ? knobs.at("seed") : 0);
  Instance instance = let_go(scene, knobs, pushed(scene, push, draw));
  if (push == 0) instance.reference = at_rest(instance.problem, lambda);
  return instance;
}

}  // namespace

// Boxes one on another, each a bit narrower than the one below.
Instance tower(const Knobs& knobs) {
  const int boxes = static_cast<int>(knobs.at("boxes"));
  const double taper = std::ldexp(0.5, -std::ilogb(boxes) - 1);
  std::vector<double> lambda;
  Scene scene = pile_up(boxes, 1, [taper](int i) { return 1 - taper * i; }, lambda);
  return released(scene, knobs, lambda);
}

// Equal boxes, pushed about. With push = 0 all rest.
Instance stack(const Knobs& knobs) {
  std::vector<double> lambda;
  Scene scene = pile_up(static_cast<int>(knobs.at("boxes")), 0.5, [](int) { return 1; }, lambda);
  return released(scene, knobs, lambda);
}

// A brick wall in running bond, about as many courses as bricks in a course; every second course begins and ends with
// half a brick. With push = 0 it rests, under a pressure that is even along each bed joint.
Instance wall(const Knobs& knobs) {
  const int boxes = static_cast<int>(knobs.at("boxes")), across = static_cast<int>(std::ceil(std::sqrt(boxes)));
  const double width = 1, height = 0.5;

  struct Brick {
    double left, right;
    int course;
    BodyId body;
  };
  std::vector<Brick> bricks;
  const int courses = static_cast<int>(std::ceil(boxes / (across + 0.5)));
  for (int course = 0; course < courses; ++course) {
    const int shifted = course % 2;
    for (int k = 0; k < across + shifted; ++k)
      bricks.push_back({std::max(0., (k - 0.5 * shifted) * width),
                        std::min(across * width, (k + 1 - 0.5 * shifted) * width), course, 0});
  }

  Scene scene;
  const BodyId ground = add_fixed(scene);
  std::vector<double> lambda;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    Brick& b = bricks[i];
    const double foot = height * b.course, length = b.right - b.left, bottom = length * (courses - b.course);
    b.body = scene.add(box_body({length, 0.5, height}, length, {(b.left + b.right) / 2, 0, foot + height / 2}));
    const std::string name = "brick " + std::to_string(i + 1);
    const auto stand_on = [&](BodyId below, double left, double right, const std::string& what) {
      add_patch(scene, b.body, below, {left, -0.25, foot}, {right, 0.25, foot}, name + " on " + what);
      const double share = (right - left) / length * bottom;
      lambda.insert(lambda.end(), 4, -gravity.z() * share / 4);
    };
    if (b.course == 0) stand_on(ground, b.left, b.right, "ground");
    for (std::size_t j = 0; j < i; ++j)
      if (const Brick& under = bricks[j]; under.course == b.course - 1) {
        const double left = std::max(b.left, under.left), right = std::min(b.right, under.right);
        if (left < right) stand_on(under.body, left, right, "brick " + std::to_string(j + 1));
      }
  }
  return released(scene, knobs, lambda);
}

}  // namespace zwang

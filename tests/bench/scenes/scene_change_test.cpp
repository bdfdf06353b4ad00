#include <zwang/core/model/scene_change.h>

#include <gtest/gtest.h>

#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/scenes/scene_change.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/rope.h>
#include "tests/folders.h"

namespace zwang {
namespace {

SceneChange random_change(const SceneStep& step) {
  SceneChange change{.bodies = std::vector<SceneChange::OfBody>(step.scene.bodies.size()), .friction = 0.7};
  for (SceneChange::OfBody& of : change.bodies)
    of = {.pose = Vec<double, 6>::Random(), .velocity = Vec<double, 6>::Random(), .mass = 0.3};
  return change;
}

// The scene `t` along the change.
Problem moved(SceneStep step, const SceneChange& change, double t) {
  for (std::size_t b = 0; b < step.scene.bodies.size(); ++b) {
    Body& body = step.scene.bodies[b];
    const SceneChange::OfBody& of = change.bodies[b];
    body.pose = retract<double>(body.pose, t * of.pose);
    body.velocity += t * of.velocity;
    body.inertia *= 1 + t * of.mass / body.mass;
    body.mass += t * of.mass;
  }
  for (Contact& contact : step.scene.list_of<Contact>().all)
    if (contact.friction != 0) contact.friction += t * change.friction;
  Problem p;
  Assembler{}.assemble(step.scene, unconstrained(step), step.options, p);
  return p;
}

// Central differences of two steps, so that their own error is the fourth power of the step.
template <class Part>
void expect_derivative(const SceneStep& step, const SceneChange& change, const Problem& d, const Part& part,
                       const char* what) {
  constexpr double h = 1e-3;
  const auto slope = [&](double t) {
    return Matrix((part(moved(step, change, t)) - part(moved(step, change, -t))) / (2 * t));
  };
  const Matrix expected = (4 * slope(h / 2) - slope(h)) / 3, found = part(d);
  ASSERT_EQ(found.rows(), expected.rows());
  EXPECT_LT((found - expected).norm(), 1e-9 * (1 + expected.norm())) << what;
}

void expect_all(const Instance& instance) {
  SCOPED_TRACE(instance.problem.name);
  ASSERT_TRUE(instance.step);
  const SceneStep& step = *instance.step;
  const SceneChange change = random_change(step);
  const Problem d = scene_change(instance, change);
  ASSERT_EQ(d.rows(), instance.problem.rows());
  expect_derivative(step, change, d, [](const Problem& p) { return Matrix(p.M); }, "M");
  expect_derivative(step, change, d, [](const Problem& p) { return Matrix(p.J); }, "J");
  expect_derivative(step, change, d, [](const Problem& p) { return Matrix(p.z_u); }, "z_u");
  // c is a value over dt^2: of the size that differences can resolve once it is multiplied by it.
  const double dt = step.options.dt;
  expect_derivative(step, change, d, [dt](const Problem& p) { return Matrix(dt * dt * p.c); }, "c");
  if (d.has_tangents()) expect_derivative(step, change, d, [](const Problem& p) { return Matrix(p.mu); }, "mu");
}

TEST(SceneChange, IsWhatDifferencesOfAssemblyShow) {
  std::srand(1);
  for (const char* text : {"hand(contacts=6)", "hand(contacts=6,mu=0.5)", "chain(links=4)", "tower(boxes=3)",
                           "stack(boxes=2,push=1,mu=0.5)", "pile(spheres=6)", "belt", "crate"})
    for (const Instance& instance : make_scenes(text)) expect_all(instance);
}

// All constraints at once, bodies that are prescribed, wrenches and inertias that are not round.
TEST(SceneChange, KnowsEveryConstraintOfASceneFile) {
  std::srand(2);
  for (const char* file : {"crane.json", "fingers.json"})
    for (const Instance& instance : make_scenes((source_dir() / "docs/examples/scenes" / file).string()))
      expect_all(instance);
}

TEST(SceneChange, SaysWhatItCannotDo) {
  SceneStep step{.options = {.mode = Mode::dynamic}};
  const BodyId a = step.scene.add({}), b = step.scene.add({});
  step.scene.bodies[1].pose.position = {0, 0, 2};
  step.scene.add(Rope{{{a, b}, {}, {}, 1.5}});
  EXPECT_THROW(changed<Contact>(step, {.bodies = {{}, {}}}), std::invalid_argument);
  EXPECT_THROW(changed<Rope>(step, {.bodies = {{}}}), std::invalid_argument);
  EXPECT_EQ(changed<Rope>(step, {.bodies = {{}, {}}}).J.norm(), 0);
  EXPECT_THROW(scene_change(make_scenes("random").front(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace zwang

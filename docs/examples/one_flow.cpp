#include <iostream>

#include <zwang/constraints/contact.h>
#include <zwang/core/model/assemble.h>
#include <zwang/core/model/motion.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/registry.h>

int main() {
  using namespace zwang;
  Scene scene;  // a ball of radius 1/2 m that comes down on a floor at 1 m/s
  const BodyId floor = scene.add({.motion = Motion::fixed});
  const BodyId ball = scene.add({.pose = {.position = {0, 0, 0.5}}, .velocity = {0, 0, -1, 0, 0, 0}});
  scene.add(contact_at(scene.bodies, ball, floor, {0, 0, 0}, Vec3::UnitZ()), "ball on floor");

  Vector z_u;  // free acceleration
  move_freely(scene, {0, 0, -9.81}, {}, z_u);
  Problem problem;  // M, z_u, J, c
  Assembler().assemble(scene, z_u, {.dt = 1e-3, .mode = Mode::dynamic}, problem);
  const Solution solution = make_solver("dual_active_set").solve(problem, {.tolerance = 1e-10});
  const Metrics metrics = measure(problem, solution, nullptr, 1e-10);

  std::cout << "claimed " << to_string(solution.status) << ", verified " << to_string(metrics.verdict)
            << "; z = " << solution.z[2] << " m/s^2 upward, force " << solution.lambda[0] << " N\n";
}

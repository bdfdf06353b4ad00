#include <iostream>

#include <zwang/solvers/friction/mode_newton.h>

int main() {
  using namespace zwang;
  Problem block{.name = "block", .z_u = Vec3(-1, 4, 0)};  // mass 1, mu 1/2: comes down at 1 m/s and slides at 4
  block.M.resize(3, 3);
  block.M.setIdentity();
  block.J = block.M;
  block.c = block.mu = Vector::Zero(3);
  block.mu[0] = 0.5;
  block.kind = {RowKind::inequality, RowKind::tangent, RowKind::tangent};
  block.key = {{1, 0}, {1, 1}, {1, 2}};
  block.law = Law::coulomb;

  ConeProgram program;
  ModeNewton newton;
  Solution solution;
  const Deadline deadline(1);
  for (const double lift : {0.0, 0.5, 1.0}) {
    if (!program.build(block, ConeProgram::Want::any, {}, deadline, solution)) return 1;
    program.state(ConeLaw{.lift = lift});
    newton.v.setZero(program.face().unknowns());
    newton.y.setZero(program.rows());
    newton.begin(program);
    newton.run(program, 1e-15, 0, 20, deadline, solution.iterations);
    program.write(block, newton.v, newton.y, solution);
    std::cout << "lift " << lift << ": slides at " << solution.z[1] << ", opens at " << solution.z[0] << "\n";
  }
}

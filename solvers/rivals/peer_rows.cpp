#include <zwang/solvers/rivals/peer_rows.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <zwang/solvers/finish/farkas.h>

namespace zwang {
namespace {

// u_E with G_E'u_E as near to -G_I'u_I as can be. False where the dense factorization would be large.
bool fit_equalities(const UnitProgram& program, Vector& u) {
  constexpr Index large = 4'000'000;
  RowsApart rows;
  rows.build(program);
  const Index count = rows.E.rows();
  if (count == 0 || count * program.size() > large) return false;
  Vector of_E, of_F;
  rows.part(u, of_E, of_F);
  of_E = Matrix(rows.E.transpose()).completeOrthogonalDecomposition().solve(rows.F.transpose() * -of_F);
  rows.join(of_E, of_F, u);
  return true;
}

}  // namespace

void RowsApart::build(const UnitProgram& program) {
  equalities = program.rows_of(true);
  inequalities = program.rows_of(false);
  E = program.some(equalities);
  F = program.some(inequalities);
  part(program.h, e, f);
}

void RowsApart::part(const Vector& lambda, Vector& of_E, Vector& of_F) const {
  of_E = lambda(equalities);
  of_F = lambda(inequalities);
}

void RowsApart::join(const Vector& of_E, const Vector& of_F, Vector& lambda) const {
  lambda.resize(of_E.size() + of_F.size());
  lambda(equalities) = of_E;
  lambda(inequalities) = of_F;
}

void write_infeasible(const Problem& problem, const UnitProgram& program, Vector u, Solution& solution) {
  solution.status = Status::infeasible;
  solution.empty_answer();
  if (u.size() != program.rows() || !u.allFinite()) return;
  // A library's ray is rough, so it is sharpened before it is judged.
  Vector motion;
  const auto proves = [&] {
    program.project(u);
    Sharpening().run(program, u);
    return proves_infeasible(program, u, motion);
  };
  if (!proves() && !(fit_equalities(program, u) && proves())) return;
  program.write_certificate(problem, u, solution);
}

void write_answer(const Problem& problem, const UnitProgram& program, const Vector& y, const Vector& lambda, Vector ray,
                  Solution& solution) {
  if (solution.status == Status::infeasible) return write_infeasible(problem, program, std::move(ray), solution);
  if (y.size() == program.size() && y.allFinite() && lambda.allFinite())
    return program.write(problem, y, lambda, solution);
  solution.empty_answer();
}

double seconds_left(const Deadline& deadline, double unlimited) {
  constexpr double least_seconds = 1e-6;
  deadline.keep();
  const double left = deadline.left();
  return std::isfinite(left) ? std::max(left, least_seconds) : unlimited;
}

}  // namespace zwang

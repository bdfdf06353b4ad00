#pragma once

#include <optional>
#include <vector>

#include <zwang/solvers/friction/mode_equations.h>
#include <zwang/solvers/linalg/sparse_cholesky.h>

namespace zwang {

// How an answer changes with its problem while no contact changes its mode: linear equations, which one factor solves.
// Modes are read off z and lambda, which have to be near an answer; nothing is proven.
//
//   M dz = M dz_u + force + J'dlambda of the rows that push,  J dz + moved = 0 of them,
//
// of what slides the plane of its ray, while its force turns with the slip (ModeEquations).
class SolutionDerivative {
 public:
  double off = 0, motion = 0;  // by how much z and lambda miss an answer; both with the diagonal of M for M
  VectorX<Index> rows;         // that push, those of a contact together, and the ties
  std::vector<Index> ties;     // those that neither push nor open
  Vector by_mu;                // of a contact that slides: how its gap and its forces follow its mu

  // z: n; lambda: m. Throws std::invalid_argument for other sizes.
  SolutionDerivative(const Problem& problem, const Vector& z, const Vector& lambda);

  struct Change {
    Vector z, lambda;  // n; of `rows`
    bool is_unique;    // lambda, by an estimate
    bool is_settled;   // else ties went on changing, and z is none
    bool is_small;     // z is what much larger motions leave, and wants a refinement
  };
  // dz_u: n, force: n, moved: of `rows`. Of the ties all push at first; those that pull then open, those that are
  // violated push, until none does. `back`: of the transposed equations. Throws std::invalid_argument, one line, where
  // the rows that push do not hold together.
  Change solve(const Vector& dz_u, const Vector& force, const Vector& moved, bool back = false);

 private:
  using Mode = ModeEquations::Mode;
  Problem change_;  // whose answer is the change: the rows that push, and the ties
  std::vector<Mode> mode_;
  Vector lambda_, slack_;  // of its rows
  std::optional<bool> is_unique_;
};

}  // namespace zwang

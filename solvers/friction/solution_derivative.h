#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <zwang/solvers/friction/mode_equations.h>

namespace zwang {

// How an answer changes with its problem while no contact changes its mode: linear equations, which one factor solves.
// Modes are read off z and lambda, which have to be near an answer; nothing is proven.
//
//   M dz = M dz_u + force + J'dlambda of the rows that push,  J dz + moved = 0 of them,
//
// of what slides the plane of its ray, while its force turns with the slip (ModeEquations).
//
// The rows' form and the factor stay with the thread until another derivative is asked for: further directions are new
// right sides. Kept by each derivative, thousands of them would fill the memory.
class SolutionDerivative {
 public:
  using Values = Eigen::Ref<const Vector>;  // Python's numbers where they lie
  double off = 0, motion = 0;  // by how much z and lambda miss an answer; both with the diagonal of M for M
  VectorX<Index> rows;         // that push, those of a contact together, and the ties
  std::vector<Index> ties;     // those that neither push, by any forces that were found, nor open
  bool ties_rub = false;       // has one of them friction?
  Vector by_mu;                // of a contact that slides: how its gap and its forces follow its mu

  // Of the thread: where a solver may leave what it made of jointed bodies (SolveOptions::form), which then is not made
  // again. The bits are the same with it and without.
  static NullSpaceForm& form();

  // z: n; lambda: m. Throws std::invalid_argument for other sizes, and, where there are ties, as along() does.
  SolutionDerivative(const Problem& problem, const Values& z, const Values& lambda);
  bool slides() const { return std::ranges::find(mode_, Mode::slide) != mode_.end(); }

  struct Change {
    Vector z, lambda;  // n, m
    bool is_unique;    // lambda, by an estimate
    bool is_settled;   // else ties went on changing, and z is none
    bool is_small;     // z is what much larger motions left: refined once, but not at ties
  };
  // dz_u: n; force: n; moved: m, dJ z - dc; dmu: m; each empty for 0. Of the ties all push at first; those that pull
  // then open, those that are violated push, until none does. Throws std::invalid_argument, one line, where the rows
  // that push do not hold together.
  Change along(const Values& dz_u, const Values& force = Vector(), const Values& moved = Vector(),
               const Values& dmu = Vector());

  // Of a number whose derivatives by z and lambda are z_bar (n) and lambda_bar (m, or empty for 0): those by z_u and
  // mu, and of the transposed equations the `change`, -lambda of which is that by c.
  struct Bars {
    Change change;
    Vector z_u, mu;
  };
  Bars back(const Values& z_bar, const Values& lambda_bar);
  // That by all entries of M (n x n, symmetric) and of J (m x n; where forces are unique), of the change of back().
  using Full = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Full by_M(const Change& change) const;
  Full by_J(const Change& change) const;

 private:
  using Mode = ModeEquations::Mode;
  struct Sides {
    Vector z_u, force, moved;
  };
  void build();  // unless what the thread holds is this one's
  void factorize(bool back);
  void share_load();
  Change solve(const Sides& sides, bool back);
  Change once(const Sides& sides, bool back);
  Sides left(const Sides& sides, const Change& change, bool back) const;
  // Is it the first row of a contact with friction?
  bool rubs(Index i) const {
    return change_.has_tangents() && !change_.is_tangent(i) && change_.mu[i] > 0 && change_.tangents(i) > 0;
  }

  Problem change_;  // whose answer is the change: c = -Inf but of the rows that push and the ties
  std::vector<Mode> mode_;
  Vector z_, half_, lambda_, slack_;  // half_: (z_u - z) / 2
  std::vector<Index> owner_;          // of a row that pushes the contact's first
  long number_;                       // no other has it
  std::optional<bool> is_unique_;
};

}  // namespace zwang

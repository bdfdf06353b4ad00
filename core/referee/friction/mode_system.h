#pragma once

#include <Eigen/Dense>
#include <array>
#include <string_view>
#include <vector>

#include <zwang/core/referee/friction/contact_problem.h>

namespace zwang {

// What a contact does: nothing pushes; it slides and is pushed; it neither opens nor slides.
enum class ContactMode : unsigned char { open, slide, stick };

// A point with a mode for each contact, in the units of a ContactProblem.
struct ModePoint {
  ExtendedVector x, lambda;
  std::vector<ContactMode> modes;
};

// What is proven of a solution of Coulomb's law near a point, in the units of a ContactProblem.
struct ModeProof {
  bool proven = false;
  ModePoint point = {};
  double radius = infinity;    // |z - z_point|_M / s
  double delta = infinity;     // > 0: the solution is one of rows that are off by so much, of s
  bool strict = false;         // every inequality of the modes holds on the whole box with something to spare
  double null_motion = 0;      // largest |dz|_M of a unit change of multipliers that keeps the equations
  bool unique_forces = false;  // no multipliers are free to change
  std::string_view by = "interval Newton";
  bool continuum = false;  // proven: strict, delta = 0, and z moves as multipliers that are free to change do
};

// Modes by each contact's own scale: `cut` of its |lambda| + |s| counts as zero.
std::vector<ContactMode> modes_by_size(const ContactProblem& problem, const ExtendedVector& x,
                                       const ExtendedVector& lambda, double cut);

// The equations that modes ask for, linearized at a point:
//
//   M x = J'lambda;   stick: s = 0;   slide: s_n = 0, l_t = -mu l_n s_t / |s_t|;   open: lambda = 0;
//
// under the convex law with the slip sigma of each contact given, s_n + mu sigma - mu |s_t| = 0 where one slides, and
// s_n + mu sigma = 0, s_t = 0 where one sticks. The derivative is [[H, -N], [S, 0]] in (x, active multipliers).
struct ModeSystem {
  struct Row {
    Index row = 0;
    Index contact = -1;  // -1: an equality row
    bool slides = false;
  };

  // sigma: one a contact, or null for Coulomb's law.
  ModeSystem(const ContactProblem& problem, const ModePoint& point, const ExtendedVector* sigma);

  const ContactProblem* problem;
  const ExtendedVector* sigma;
  std::vector<Row> active;
  Matrix H;                                      // n x n: M + sum mu l_n J_t'(I - tau tau')J_t / |s_t|, l_n >= 0
  Matrix N;                                      // n x active
  Matrix S;                                      // active x n
  std::vector<std::array<double, 2>> direction;  // tau of each contact that slides
  Vector row_size, column_size;                  // |S_k| and |N_k| in the dual norm of M, 1 for 0
  bool usable = true;                            // no contact slides at |s_t| = 0

  Matrix coupling(const Eigen::LLT<Matrix>& mass) const;  // S H^-1 N of unit rows and columns, active x active

  DoubleDouble row_residual(const Row& row, const ExtendedVector& x) const;
};

// Newton's method with minimum-norm steps, residuals in double-double. Returns the largest residual that is left,
// relative to the motion; infinity where it breaks down. Slide keeps l_t on the cone's edge against the slip.
double polish(const ContactProblem& problem, ModePoint& point, const ExtendedVector* sigma = nullptr,
              double* work = nullptr);

// Gives the contacts whose modes are off by more than `holds` at the point the modes that would hold; false where all
// do.
bool change_modes(const ContactProblem& problem, ModePoint& point, double holds);

// Sets l_t = -mu l_n s_t / |s_t| where a contact slides, and lambda = 0 where it is open. False at |s_t| = 0.
bool settle_forces(const ContactProblem& problem, ModePoint& point);

}  // namespace zwang

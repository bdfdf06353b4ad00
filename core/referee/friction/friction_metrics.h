#pragma once

#include <limits>

namespace zwang {

// What the referee finds of a frictional answer, on blocks divided by their unit g and over s (lambda times g;
// complementarity and dissipation over s^2). NaN: not known, as without multipliers.
struct FrictionMetrics {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double penetration = unknown;      // worst -s_n
  double cone_violation = unknown;   // worst |l_t| - mu l_n, and -l_n
  double complementarity = unknown;  // worst |l_n s_n|
  double dissipation = unknown;      // worst mu l_n |s_t| + l_t's_t
  double natural = unknown;          // worst |lambda - P_K(lambda - s - mu |s_t| e_n)|; convex law: without mu |s_t|
  double eta = unknown;              // |lambda - P_K(lambda - R u)| / |lambda|, u as in natural from lambda alone
  double self_bound = unknown;       // upper bound on |z - Z(sigma(z))|_M / s
  double radius = unknown;           // of the ball that holds a solution, |.|_M / s; z_bound is from z to its far side
  double delta = unknown;            // > 0: it solves a c (or z_u) this far from the problem's, not these rows
  double null_motion = unknown;      // largest |dz|_M of a unit change of multipliers that keeps its equations
  bool strict = false;               // all modes of that solution hold with something to spare
  bool isolated = false;             // it is the only one nearby: strict, and no force is free to change
};

}  // namespace zwang

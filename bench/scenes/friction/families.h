#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <zwang/bench/scenes/catalog.h>

namespace zwang {

// Exact problems under Coulomb's law: every number is stored without rounding. `solutions` is how many there are, -1
// for a continuum (docs/friction.md).
struct FrictionPoint {
  Instance instance;
  int solutions = 1;
};

FrictionPoint rod_point(double mu);                    // 1 below mu = 14/11, 3 above
FrictionPoint jam_point(double mu, double wall_slip);  // walls at +-1; -1: into the apex, no solution from 3/4 on
FrictionPoint held_point(double mu);                   // pulled out of a wedge: 1 below mu = 3/4, 2 above
FrictionPoint pinch_point();                           // a continuum
FrictionPoint puck_point();                            // a continuum, with one exact member

// A planted answer: M = diag(2^k), z* in sixteenths, contact frames from integer quaternions, lever arms in eighths,
// modes by lot. c = J z* - s* and z_u = z* - M^-1 J'lambda* are exact, so z* is a solution, though perhaps not the
// only one.
struct PlantedFriction {
  Index bodies = 5, contacts = 10, tangents = 2;
  double mu = .5;         // a power of two
  int load_exponent = 0;  // of the contacts that slide: their multipliers times 2^this
  int slip_exponent = 0;  // their slip times 2^this
  std::uint64_t seed = 1;
};
Instance planted_friction(const PlantedFriction& options);

// The families of the atlas that have friction (docs/friction.md), the exact points above among them, and `planted`, as
// catalog.json names them.
std::vector<std::pair<std::string, std::function<Instance(const Knobs&)>>> friction_families();

}  // namespace zwang

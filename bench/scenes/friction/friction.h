#pragma once

#include <utility>
#include <vector>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/model/scene.h>

namespace zwang {

// The knob `mu`: Coulomb's coefficient of all contacts of a scene. 0: no tangent rows.
inline double friction_of(const Knobs& knobs) { return knobs.contains("mu") ? knobs.at("mu") : 0; }

// Gives it to the contacts that the scene has by now.
void rub(Scene& scene, double mu);

// A tangent row to come: of the contact in this row of a problem without them.
struct SlipRow {
  Index contact;
  std::vector<std::pair<int, double>> entries = {};  // column, value
};

// The problem with these tangent rows (by rising contact, at most two each), c_t = 0 and mu at their contacts, under
// Coulomb's law. What was known stays where it is known of this problem too: no contact slips at z, or none can be met.
Instance with_friction(const Instance& frictionless, double mu, const std::vector<SlipRow>& slips);

// The same for a problem that is a matrix and no scene. A contact slips along its row, turned by a quarter in the
// planes of unknowns 1-2, 3-4, ..., and, where the unknowns come in fours, in the planes 1-3, 4-2, ...: orthogonal to
// the row and to each other, of the same length, and exact.
Instance with_friction(const Instance& frictionless, double mu);

}  // namespace zwang

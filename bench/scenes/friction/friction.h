#pragma once

#include <optional>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/model/scene.h>

namespace zwang {

// The knob `mu`: Coulomb's coefficient of all contacts of a scene. 0: no tangent rows.
inline double friction_of(const Knobs& knobs) { return knobs.contains("mu") ? knobs.at("mu") : 0; }

// Gives it to the contacts that the scene has by now.
void rub(Scene& scene, double mu);

// What is known of a problem without friction, for the same one with tangent rows at its contacts, c_t = 0: it stays
// where it is known of this problem too. No contact slips at z, or none can be met. lambda and certificate are of the
// rows that are no tangents.
std::optional<Reference> known_with_friction(Reference frictionless, const Problem& problem);

// Friction for a problem that is a matrix and no scene, under Coulomb's law. A contact slips along its row, turned by a
// quarter in the planes of unknowns 1-2, 3-4, ..., and, where the unknowns come in fours, in the planes 1-3, 4-2, ...:
// orthogonal to the row and to each other, of the same length, and exact.
Instance with_friction(const Instance& frictionless, double mu);

}  // namespace zwang

#pragma once

#include <string_view>

#include <zwang/core/problem/instance.h>

namespace zwang {

std::string_view to_string(Law law);  // "frictionless", "pyramid", "convex", "coulomb"
// Throws std::invalid_argument with the words there are.
Law parse_law(std::string_view word);

// The problem under another law. Tangent rows are left out (frictionless), become the edges N +- mu T of a pyramid in
// place of their inequality row (pyramid: its dual cone lies around K*), or stay as they are (convex, coulomb). A
// contact with mu = 0 has no tangent rows under any law: K is then a ray, met exactly and not as a limit.
// A problem without tangent rows is the same under every law, and is returned as it is: frictionless.
// What stands in the files and in a scene is under coulomb; from pyramid or frictionless there is no way back.
Problem under(Law law, const Problem& problem);

// With the names of its rows. A reference, and what was recorded, answer one law: they stay only where it is the same.
Instance under(Law law, Instance instance);

}  // namespace zwang

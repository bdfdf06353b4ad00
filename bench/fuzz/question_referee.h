#pragma once

#include <array>
#include <functional>
#include <string>

#include <zwang/bench/fuzz/fuzz.h>

namespace zwang {

// What the referee is asked about: programs without friction of at most four unknowns, planar contacts under Coulomb's
// law and the convex one, and planted answers with two tangents. Of 143 problems 100, 30, 10 and 3.
inline constexpr std::array referee_classes{"programs", "coulomb", "convex", "spatial"};
std::size_t referee_class(std::uint64_t number);

// Invents answers to problem `number`, right and wrong, with and without multipliers, and claims that there is none;
// asks measure() and judge(), which may be told a false truth, and looks at the reference. `report` is told each
// verdict, bound or reference that the rationals contradict. The same on every machine.
void question_referee(std::uint64_t seed, std::uint64_t number, FuzzTally& tally,
                      const std::function<void(std::string what, Instance instance)>& report);

}  // namespace zwang

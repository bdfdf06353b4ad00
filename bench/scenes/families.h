#pragma once

#include <zwang/bench/scenes/catalog.h>

// Every scene as a function of its knobs, which catalog.json declares. Those of capital letters are families of
// problems with one knob each, from benign to impossible, written as matrices: their entries are dyadic, so that the
// stored doubles ARE the problem, and truth comes from a closed form.
namespace zwang {

// The value of k that stands for 2^-k = 0, where a family has such a point.
inline constexpr double zero_knob = 60;

#define SCENE(name, make) Instance make(const Knobs& knobs);
#include <zwang/bench/scenes/scenes.def>
#undef SCENE

}  // namespace zwang

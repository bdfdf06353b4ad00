#pragma once

#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// Problems of known truth in recorded_data(): hands with c contacts (family H), K hands (K), towers, walls, and every
// tenth of 300 random hands (stress). Empty where they are absent.
std::vector<Instance> measured_problems();

// 200 coherent frames of a hand with 16 or 64 contacts, in order. Empty where they are absent.
std::vector<Instance> measured_sequence(int contacts);

}  // namespace zwang

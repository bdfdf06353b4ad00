#pragma once

#include <zwang/bench/scenes/catalog.h>

// Families of problems with one knob each, from benign to impossible, written as matrices. Their entries are dyadic,
// so that the stored doubles ARE the problem, and truth comes from a closed form.
namespace zwang {

// The value of k that stands for 2^-k = 0, where a family has such a point.
inline constexpr double zero_knob = 60;

Instance mass_ratio(const Knobs& knobs);                // MR: k
Instance mass_ratio_one_contact(const Knobs& knobs);    // MR1: k
Instance mass_ratio_chain(const Knobs& knobs);          // MRC: k, seed
Instance near_parallel_equalities(const Knobs& knobs);  // NPE: k, seed
Instance four_bar_loop(const Knobs& knobs);             // LOOP: k
Instance contact_gap(const Knobs& knobs);               // GAP: k, feasible
Instance inconsistent_equalities(const Knobs& knobs);   // INC: k
Instance weak_contacts(const Knobs& knobs);             // WEAK: k, seed
// contact_families.cpp
Instance near_parallel_contacts(const Knobs& knobs);  // NPI: k, seed
Instance wedges(const Knobs& knobs);                  // WED: k
Instance many_on_a_face(const Knobs& knobs);          // MANYF: contacts, seed
Instance many_tilted(const Knobs& knobs);             // MANYR: contacts, seed
Instance flipping_stack(const Knobs& knobs);          // FLIP: k, frame, seed
// scaled_families.cpp
Instance length_unit(const Knobs& knobs);         // UNIT: k, seed
Instance row_scale(const Knobs& knobs);           // ROW: k, zero, seed
Instance huge_offsets(const Knobs& knobs);        // HUGE: k, seed
Instance thin_bodies(const Knobs& knobs);         // ANI: k, seed
Instance long_chain(const Knobs& knobs);          // CHAIN: links, seed
Instance stack_of_masses(const Knobs& knobs);     // STK: boxes
Instance exponential_pivots(const Knobs& knobs);  // PIVOT: n, reversed
Instance pivot_cycle(const Knobs& knobs);         // CYCLE: n
// hands.cpp
Instance crowded_hands(const Knobs& knobs);  // HAND: hands, seed
// random_families.cpp
Instance random_rows(const Knobs& knobs);  // n, m, entries, equalities, active, condition, redundancy, seed

}  // namespace zwang

#pragma once

#include <zwang/experiments/questions/question.h>

namespace zwang::questions {

Findings simple_scene(const Asking& asking);
Findings stages(const Asking& asking);
Findings engine(const Asking& asking);
Findings detailed_parts(const Asking& asking);
Findings growth_with_contacts(const Asking& asking);
Findings two_hands(const Asking& asking);
Findings thinning(const Asking& asking);
Findings separation(const Asking& asking);
Findings printed_step(const Asking& asking);
Findings solver_swap(const Asking& asking);
Findings solvers_of_the_paper(const Asking& asking);
Findings no_more_than_needed(const Asking& asking);
Findings artificial_friction(const Asking& asking);
Findings rate_of_a_push(const Asking& asking);
Findings laws_of_friction(const Asking& asking);
Findings recordings(const Asking& asking);

}  // namespace zwang::questions

#pragma once

namespace zwang {

// From now on the n-th heap block asked for (1: the next one), and that one alone, is refused. 0: none.
void refuse_allocation(long n);
// Whether it was reached.
bool allocation_was_refused();

}  // namespace zwang

// Built without CGAL's QP solver, whose licence is the GPL.
#include <zwang/bench/references/witnesses.h>

namespace zwang {

const bool has_rational_reference = false;

std::optional<Reference> rational_reference(const Problem&) { return {}; }

}  // namespace zwang

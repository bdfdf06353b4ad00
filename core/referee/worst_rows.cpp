#include <zwang/core/referee/worst_rows.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

std::vector<TypeResidual> worst_by_type(const Instance& instance, const Vector& z) {
  const Problem& p = instance.problem;
  const ScaledProblem scaled(p);
  const ExtendedVector d = scaled.motion(z);
  const double s = scaled.scale_of(scaled.norm_of(z));
  std::map<std::string, TypeResidual> worst;
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i)) continue;  // a slip violates nothing
    const auto k = at(i);
    const std::string type = k < instance.origin.size() ? instance.origin[k].type : "row";
    double violation = 0, relative = 0;
    if (!scaled.is_vacuous(i)) {
      const double slack = scaled.slack(i, d).hi;
      violation = scaled.is_equality(i) ? std::abs(slack) : std::max(-slack, 0.0);
      if (violation > 0) relative = violation / scaled.row_norm[i] / s;
      violation *= scaled.row_scale(i);
    }
    const auto [it, first] = worst.try_emplace(type, TypeResidual{type, violation, relative, i});
    if (!first && relative > it->second.relative) it->second = {type, violation, relative, i};
  }
  std::vector<TypeResidual> out;
  for (auto& [type, residual] : worst) out.push_back(residual);
  return out;
}

}  // namespace zwang

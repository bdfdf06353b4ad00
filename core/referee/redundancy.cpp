#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/orthogonal_rows.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

std::vector<TypeResidual> worst_by_type(const Instance& instance, const Vector& z) {
  const Problem& p = instance.problem;
  const ScaledProblem scaled(p);
  const ExtendedVector d = scaled.motion(z);
  const double s = std::max({scaled.norm_of_free_motion(), scaled.norm_of(z), scaled.least_scale()});
  std::map<std::string, TypeResidual> worst;
  for (Index i = 0; i < p.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
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

std::vector<std::string> constraint_names(const Instance& instance, const std::vector<Index>& rows) {
  std::vector<std::string> names;
  for (const Index row : rows) {
    const auto k = static_cast<std::size_t>(row);
    std::string name = k < instance.origin.size() ? constraint_name(instance.origin[k]) : row_name(instance, row);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

// Gram-Schmidt in the M^-1 inner product over unit rows in the problem's order, equality rows first, then touched
// inequality rows. What is left of a unit row after the rows before it is its distance from their span; below 1e-10 it
// counts as a combination of them. Dense: O(rank n) memory, O(rank n) work a row.
std::vector<Index> redundant_rows(const Problem& p, const Vector& z) {
  const ScaledProblem scaled(p);
  const ExtendedVector d = scaled.motion(z);
  const double s = std::max({scaled.norm_of_free_motion(), scaled.norm_of(z), scaled.least_scale()});
  std::vector<Index> considered, out;
  for (const bool equality : {true, false})
    for (Index i = 0; i < p.rows(); ++i) {
      if (scaled.is_equality(i) != equality || scaled.is_vacuous(i)) continue;
      if (equality || scaled.is_zero(i) || scaled.slack(i, d).hi <= referee::touched * s * scaled.row_norm[i])
        considered.push_back(i);
    }
  OrthogonalRows basis(p.size());
  for (const Index i : considered) {
    if (scaled.is_zero(i)) {
      out.push_back(i);
      continue;
    }
    const OrthogonalRows::Split split = basis.split(scaled.unit_row(i));
    if (split.dependent || split.left <= referee::redundant)
      out.push_back(i);
    else
      basis.append(split);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace zwang

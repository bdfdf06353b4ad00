#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <zwang/bench/report/tables/tables.h>
#include <zwang/bench/report/wording.h>

// What the tables' files share.
namespace zwang::report {

inline std::vector<std::string> names(const Run& run) {
  std::vector<std::string> out;
  for (const SolverInfo& s : run.solvers) out.push_back(s.name);
  return out;
}

inline Cell count_cell(int n, std::string tone = "") {
  return {n == 0 ? "" : std::to_string(n), static_cast<double>(n), n == 0 ? "" : std::move(tone)};
}

inline Cell number_cell(double value, int digits = 1) { return {scientific(value, digits), value}; }

// The error the referee measured, or the bound that stands in for it.
inline Cell error_cell(const Result& r) {
  if (std::isfinite(r.z_error)) return number_cell(r.z_error);
  if (std::isfinite(r.z_bound)) return {"<= " + scientific(r.z_bound), r.z_bound};
  return {r.feasible == std::optional(false) ? "no z exists"
          : r.reference.empty()              ? "no reference"
                                             : "no number",
          unknown};
}

}  // namespace zwang::report

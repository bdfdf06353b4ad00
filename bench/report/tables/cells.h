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

inline std::vector<std::string> names(const RunFolder& run) {
  std::vector<std::string> out;
  for (const SolverInfo& s : run.solvers) out.push_back(s.name);
  return out;
}

// Empty for 0.
inline Cell count_cell(std::size_t n, std::string tone = "") {
  return n == 0 ? Cell("", 0) : Cell(std::to_string(n), static_cast<double>(n), std::move(tone));
}
inline Cell whole_cell(long n, std::string tone = "") {
  return {std::to_string(n), static_cast<double>(n), std::move(tone)};
}
// "3 of 5", of the value 3.
inline Cell part_cell(long part, long whole, std::string tone = "") {
  return {part_of(part, whole), static_cast<double>(part), std::move(tone)};
}
inline Cell number_cell(double value, int digits = 1) { return {scientific(value, digits), value}; }
inline Cell fixed_cell(double value, int digits) { return {fixed(value, digits), value}; }
inline Cell time_cell(double seconds) { return {duration(seconds), seconds}; }
inline Cell knob_cell(double value) { return {knob_text(value), value}; }

inline const char* tone_of(bool bad, bool good) { return bad ? "bad" : good ? "good" : ""; }

// The error the referee measured, or the bound where there is no reference.
inline Cell error_cell(const Result& r) {
  if (std::isfinite(r.metrics.z_error)) return number_cell(r.metrics.z_error);
  if (std::isfinite(r.metrics.z_bound)) return {"<= " + scientific(r.metrics.z_bound), r.metrics.z_bound};
  return {r.feasible == std::optional(false) ? "no z exists"
          : r.reference.empty()              ? "no reference"
                                             : "no number",
          unknown};
}

}  // namespace zwang::report

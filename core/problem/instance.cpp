#include <zwang/core/problem/instance.h>

#include <utility>

#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

std::string constraint_name(const RowOrigin& origin) {
  return origin.label.empty() ? origin.type : origin.type + "/" + origin.label;
}

std::string to_string(const RowOrigin& origin) {
  std::string name = constraint_name(origin);
  if (origin.row >= 0) name.append(" [").append(std::to_string(origin.row)).append("]");
  return name;
}

RowOrigin parse_row_origin(std::string_view text, std::string unit) {
  RowOrigin origin;
  origin.unit = std::move(unit);
  if (const auto open = text.rfind(" ["); open != std::string_view::npos && text.ends_with(']')) {
    const std::string_view number = text.substr(open + 2, text.size() - open - 3);
    if (const std::optional<int> row = number_in<int>(number); row && *row >= 0) {
      origin.row = *row;
      text = text.substr(0, open);
    }
  }
  const auto slash = text.find('/');
  origin.type = text.substr(0, slash);
  if (slash != std::string_view::npos) origin.label = text.substr(slash + 1);
  return origin;
}

Instance under(Law law, Instance instance) {
  if (!instance.problem.has_tangents()) return instance;
  const std::vector<RowUnder> rows = rows_under(law, instance.problem);
  std::vector<RowOrigin> origin;
  if (!instance.origin.empty())
    for (const RowUnder& row : rows) {
      origin.push_back(instance.origin[at(row.normal)]);
      if (row.edge < 0) continue;
      origin.back().type = "friction_pyramid";
      origin.back().row = row.edge;
    }
  if (instance.problem.law != law || static_cast<Index>(rows.size()) != instance.problem.rows()) {
    instance.reference.reset();
    instance.recorded.clear();
  }
  if (static_cast<Index>(rows.size()) != instance.problem.rows()) instance.step.reset();
  instance.problem = under(law, instance.problem);
  instance.origin = std::move(origin);
  return instance;
}

std::string row_name(const Instance& instance, Index i) {
  if (i < 0) return {};
  const auto row = at(i);
  return row < instance.origin.size() ? to_string(instance.origin[row]) : "row " + std::to_string(i);
}

}  // namespace zwang

#include <zwang/bench/program/commands.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/references/friction/solution_count.h>
#include <zwang/bench/report/wording.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

constexpr double search_seconds = 60;     // of CPU time, then no further start
constexpr std::size_t few_contacts = 12;  // whose modes are listed one by one
constexpr std::array mode_words{"open", "slide", "stick"};

const char* word(ContactMode mode) { return mode_words[static_cast<std::size_t>(mode)]; }

void require_counted(const Problem& p) {
  if (!p.has_tangents())
    throw std::invalid_argument(p.name + " has no contact with friction: it has one solution or none");
  if (is_convex(p.law))
    throw std::invalid_argument("--solutions counts those of Coulomb's law (--law coulomb); under the law '" +
                                std::string(to_string(p.law)) + "' there is one or none");
  if (!referee::may_prove(p.size(), p.rows()))
    throw std::invalid_argument("--solutions: " + p.name + " has " + std::to_string(p.size()) + " unknowns and " +
                                std::to_string(p.rows()) + " rows; the search is dense, up to " +
                                std::to_string(referee::dense_limit) + " and " + std::to_string(referee::dense_rows));
}

std::string in_words(const std::vector<ContactMode>& modes) {
  if (modes.size() <= few_contacts) return joined(names_of(modes, word), " ");
  std::string text;
  for (const ContactMode mode : {ContactMode::stick, ContactMode::slide, ContactMode::open})
    if (const auto count = std::ranges::count(modes, mode); count > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + word(mode);
  return text;
}

nlohmann::ordered_json to_json(const CoulombSolution& s) {
  nlohmann::ordered_json modes = nlohmann::ordered_json::array();
  for (const ContactMode mode : s.modes) modes.push_back(word(mode));
  return {{"bound", s.bound},           {"delta", s.delta}, {"isolated", s.isolated},
          {"free_split", s.free_split}, {"modes", modes},   {"method", s.method},
          {"by_slopes", s.by_slopes},   {"z", s.z},         {"lambda", s.lambda}};
}

}  // namespace

void print_solutions(const Instance& instance, bool json) {
  const Problem& p = instance.problem;
  require_counted(p);
  const SolutionCount found = count_solutions(p, search_seconds);
  if (json) {
    nlohmann::ordered_json object{{"problem", p.name},
                                  {"law", "coulomb"},
                                  {"proven", found.proven},
                                  {"complete", found.kind == SolutionCount::Kind::all},
                                  {"continuum", found.kind == SolutionCount::Kind::continuum},
                                  {"in_words", in_words(found)},
                                  {"solutions", nlohmann::ordered_json::array()}};
    for (const CoulombSolution& s : found.solutions) object["solutions"].push_back(to_json(s));
    std::puts(object.dump().c_str());
    return;
  }
  std::printf("%-10s %s   %td unknowns, %td rows\n", "problem", p.name.c_str(), p.size(), p.rows());
  std::printf("%-10s %s\n", "solutions", in_words(found).c_str());
  for (std::size_t k = 0; k < found.solutions.size(); ++k) {
    const CoulombSolution& s = found.solutions[k];
    std::printf("%-10zu at most %s off%s%s   %s%s", k + 1, report::scientific(s.bound).c_str(),
                s.delta > 0 ? (", for rows off by " + report::scientific(s.delta)).c_str() : "",
                s.isolated     ? ", isolated"
                : s.free_split ? ", one of many"
                               : "",
                s.method.c_str(), s.by_slopes ? ", proven by slopes, too" : "");
    std::printf("   %s\n", in_words(s.modes).c_str());
  }
}

}  // namespace zwang

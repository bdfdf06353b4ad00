#include <zwang/bench/packs/answers.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/did_you_mean.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format = 1;

// One line for what JSON's library says of a text: without its name and number of the error.
std::string plain(const std::exception& wrong) {
  std::string line = one_line(wrong.what());
  if (line.starts_with("[json")) line = line.substr(line.find("] ") + 2);
  std::ranges::replace_if(
      line, [](char ch) { return static_cast<unsigned char>(ch) > 126; }, '?');
  return line;
}

double number(const Json& value, const std::string& what) {
  const double x = value.is_number() ? value.get<double>() : Solution::unknown;
  if (!std::isfinite(x)) throw std::runtime_error(what + ": expected a finite number");
  return x;
}

double number_or_unknown(const Json& record, const char* key) {
  return record.contains(key) && !record[key].is_null() ? number(record[key], key) : Solution::unknown;
}

// The vector under this key; empty where it may be absent and is.
Vector vector_of(const Json& record, const char* key, Index size, bool required) {
  if (!record.contains(key) || record[key].is_null() || (record[key].is_array() && record[key].empty())) {
    if (required && size > 0)
      throw std::runtime_error(std::string(key) + ": expected " + std::to_string(size) + " numbers");
    return {};
  }
  const Json& list = record[key];
  if (!list.is_array() || list.size() != static_cast<std::size_t>(size))
    throw std::runtime_error(std::string(key) + " has " + (list.is_array() ? std::to_string(list.size()) : "no") +
                             " numbers, expected " + std::to_string(size));
  Vector v(size);
  for (Index i = 0; i < size; ++i)
    v[i] = number(list[static_cast<std::size_t>(i)], std::string(key) + "[" + std::to_string(i) + "]");
  return v;
}

Status status_of(const std::string& name) {
  std::vector<std::string> names;
  for (int k = 0; k <= static_cast<int>(Status::crashed); ++k) {
    names.emplace_back(to_string(static_cast<Status>(k)));
    if (names.back() == name) return static_cast<Status>(k);
  }
  throw std::runtime_error("status '" + name +
                           "': expected solved, infeasible, iteration limit or another of docs/packs.md" +
                           did_you_mean(name, names));
}

// What may stand in a list of solvers.
bool is_name(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char ch) {
    return std::isalnum(static_cast<unsigned char>(ch)) || std::strchr("_-+.", ch);
  });
}

Answer answer_of(const Json& record, const PackedProblem& problem) {
  Answer answer;
  Solution& s = answer.solution;
  s.status = status_of(record.at("status").get<std::string>());
  s.z = vector_of(record, "z", problem.n, s.status == Status::solved);
  s.lambda = vector_of(record, "lambda", problem.m, false);
  s.certificate = vector_of(record, "certificate", problem.m, false);
  s.iterations = record.value("iterations", 0);
  s.handed_to = record.value("answered_by", "");
  if (!s.handed_to.empty() && !is_name(s.handed_to)) throw std::runtime_error("answered_by: expected a solver's name");
  answer.seconds = number_or_unknown(record, "seconds");
  if (answer.seconds < 0) throw std::runtime_error("seconds: expected a number from 0 on");
  answer.residual = number_or_unknown(record, "residual");
  return answer;
}

Json numbers(const Vector& v) { return Json(std::vector<double>(v.begin(), v.end())); }

}  // namespace

Answers read_answers(const std::filesystem::path& file, const Pack& pack) {
  Answers all;
  all.file = file;
  std::istringstream lines(read_stored(file).bytes);
  std::size_t at = 0;
  for (std::string line; std::getline(lines, line);) {
    ++at;
    try {
      const Json record = Json::parse(line);
      if (!record.is_object()) throw std::runtime_error("expected one JSON object");
      if (at == 1) {
        if (!record.contains("zwang_answers"))
          throw std::runtime_error("expected {\"zwang_answers\": 1, \"solver\": ...} (docs/packs.md)");
        if (const int version = record["zwang_answers"].get<int>(); version != format)
          throw std::runtime_error("zwang_answers is " + std::to_string(version) + ", expected " +
                                   std::to_string(format));
        all.solver = record.at("solver").get<std::string>();
        if (!is_name(all.solver))
          throw std::runtime_error("solver '" + all.solver + "': expected letters, digits and _ - + . alone");
        all.version = record.value("version", "");
        all.settings = record.value("settings", "");
        all.machine = record.value("machine", "");
        if (record.contains("tolerance")) all.tolerance = number(record["tolerance"], "tolerance");
        if (!(all.tolerance > 0 && all.tolerance < 1))
          throw std::runtime_error("tolerance: expected a number between 0 and 1");
        continue;
      }
      const std::string sha256 = record.at("sha256").get<std::string>();
      const PackedProblem* problem = pack.find(sha256);
      if (!problem)
        throw std::runtime_error("no problem " + sha256.substr(0, 64) + " in " + pack.directory().string() +
                                 " (answers to another pack?)");
      if (!all.of.emplace(sha256, answer_of(record, *problem)).second)
        throw std::runtime_error("a second answer to " + problem->name);
    } catch (const std::exception& wrong) {
      throw BadFile(file.string() + ", line " + std::to_string(at) + ": " + plain(wrong));
    }
  }
  for (const PackedProblem& problem : pack.problems())
    if (!all.of.contains(problem.sha256)) all.missing.push_back(problem.name);
  return all;
}

std::vector<std::string> names_of(std::span<const Answers> contestants) {
  std::vector<std::string> names;
  const auto taken = [&](const std::string& name) { return std::ranges::count(names, name) > 0; };
  for (const Answers& given : contestants) {
    const std::string name = taken(given.solver) ? given.solver + "@" + given.file.stem().string() : given.solver;
    if (taken(name)) throw std::invalid_argument("two files of one solver and one name: " + given.file.string());
    names.push_back(name);
  }
  return names;
}

std::string answers_header(const Answers& a) {
  return Json({{"zwang_answers", format},
               {"solver", a.solver},
               {"version", a.version},
               {"settings", a.settings},
               {"machine", a.machine},
               {"tolerance", a.tolerance}})
             .dump() +
         "\n";
}

std::string answers_line(const std::string& sha256, const Answer& answer) {
  const Solution& s = answer.solution;
  Json line = {{"sha256", sha256}, {"status", to_string(s.status)}};
  for (const auto& [key, v] : {std::pair("z", &s.z), {"lambda", &s.lambda}, {"certificate", &s.certificate}})
    if (v->size() > 0 && (v->allFinite() || s.status == Status::solved)) line[key] = numbers(*v);
  line["iterations"] = s.iterations;
  if (!s.handed_to.empty()) line["answered_by"] = s.handed_to;
  if (std::isfinite(answer.seconds)) line["seconds"] = answer.seconds;
  if (std::isfinite(answer.residual)) line["residual"] = answer.residual;
  return line.dump() + "\n";
}

}  // namespace zwang

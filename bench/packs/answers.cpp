#include <zwang/bench/packs/answers.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <zwang/core/files/hdf5.h>
#include <zwang/core/files/npz.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format = 1;

// One line for what JSON's library says of a text: without its name and number of the error.
std::string plain(const std::exception& wrong) {
  std::string line = one_line(wrong.what());
  if (line.starts_with("[json")) line = line.substr(line.find("] ") + 2);
  if (const std::string only = "parse error at line 1, "; line.starts_with(only)) line = line.substr(only.size());
  std::ranges::replace_if(line, [](char ch) { return static_cast<unsigned char>(ch) > 126; }, '?');
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
  for (Index i = 0; i < size; ++i) v[i] = number(list[at(i)], std::string(key) + "[" + std::to_string(i) + "]");
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
bool of_name(char ch) { return std::isalnum(static_cast<unsigned char>(ch)) || std::strchr("_-+.", ch); }
bool is_name(const std::string& text) { return !text.empty() && std::ranges::all_of(text, of_name); }

Answer answer_of(const Json& record, const PackedProblem& problem) {
  Answer answer;
  Solution& s = answer.solution;
  s.status = status_of(record.at("status").get<std::string>());
  s.z = vector_of(record, "z", problem.n, s.status == Status::solved);
  s.lambda = vector_of(record, "lambda", problem.m, false);
  s.certificate = vector_of(record, "certificate", problem.m, false);
  const double iterations = record.contains("iterations") ? number(record["iterations"], "iterations") : 0;
  if (!(iterations >= 0 && iterations < std::numeric_limits<int>::max()))
    throw std::runtime_error("iterations: expected a number from 0 on");
  s.iterations = static_cast<int>(iterations);
  s.handed_to = record.value("answered_by", "");
  if (!s.handed_to.empty() && !is_name(s.handed_to)) throw std::runtime_error("answered_by: expected a solver's name");
  answer.seconds = number_or_unknown(record, "seconds");
  if (answer.seconds < 0) throw std::runtime_error("seconds: expected a number from 0 on");
  answer.residual = number_or_unknown(record, "residual");
  return answer;
}

void read_head(const Json& head, Answers& all) {
  if (!head.contains("zwang_answers"))
    throw std::runtime_error("expected {\"zwang_answers\": 1, \"solver\": ...} (docs/packs.md)");
  if (number(head["zwang_answers"], "zwang_answers") != format)
    throw std::runtime_error("zwang_answers is " + head["zwang_answers"].dump() + ", expected " +
                             std::to_string(format));
  all.solver = head.at("solver").get<std::string>();
  if (!is_name(all.solver))
    throw std::runtime_error("solver '" + all.solver + "': expected letters, digits and _ - + . alone");
  all.version = head.value("version", "");
  all.settings = head.value("settings", "");
  all.machine = head.value("machine", "");
  if (head.contains("tolerance")) all.tolerance = number(head["tolerance"], "tolerance");
  if (!(all.tolerance > 0 && all.tolerance < 1))
    throw std::runtime_error("tolerance: expected a number between 0 and 1");
}

// One line's object. Of two equal keys the parser alone would take the last.
Json object_of(const std::string& line) {
  std::set<std::string> keys;
  const auto once = [&](int depth, Json::parse_event_t event, const Json& key) {
    if (depth == 1 && event == Json::parse_event_t::key && !keys.insert(key).second)
      throw std::runtime_error(key.get<std::string>() + ": twice in the line");
    return true;
  };
  if (line.find_first_not_of(" \t\r") == line.npos) throw std::runtime_error("empty; expected one JSON object");
  Json record = Json::parse(line, once);
  if (!record.is_object()) throw std::runtime_error("expected one JSON object");
  return record;
}

// Each of these hands over the head, then answer by answer; `place` says where in the file it is.
using Take = std::function<void(const Json& record)>;

void of_lines(const std::string& bytes, std::string& place, const Take& take) {
  std::istringstream lines(bytes);
  std::size_t at = 0;
  for (std::string line; std::getline(lines, line);) {
    place = "line " + std::to_string(++at);
    take(object_of(line));
  }
}

// JSON takes UTF-8 alone.
Json text(const std::string& bytes) {
  return Json::parse(Json(bytes).dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::vector<NamedArray> arrays_of(const hdf5::Group& group, const std::string& before) {
  std::vector<NamedArray> arrays;
  std::vector<std::string> names = group.attributes();
  std::ranges::copy_if(group.links(), std::back_inserter(names),
                       [&](const auto& name) { return !group.has_group(name); });
  for (const std::string& name : names) {
    NamedArray& array = arrays.emplace_back(NamedArray{.name = before + name, .is_text = group.holds_text(name)});
    const std::vector<std::size_t> shape = group.shape(name);
    array.is_scalar = shape.empty();
    if (shape.size() > 1 || (array.is_text && !array.is_scalar))
      group.fail(name, "expected one dimension or none, or one text");
    if (array.is_text)
      array.text = group.read_strings(name).at(0);
    else
      array.numbers = group.read<double>(name);
  }
  return arrays;
}

std::vector<NamedArray> read_hdf5(const std::filesystem::path& file) {
  const hdf5::Group root = hdf5::Group::open(file);
  std::vector<NamedArray> all = arrays_of(root, "");
  for (const std::string& sha256 : root.groups())
    std::ranges::move(arrays_of(root.group(sha256), sha256 + "/"), std::back_inserter(all));
  return all;
}

// "SHA256/z" is z of an answer, "solver" of the head.
void of_arrays(const std::vector<NamedArray>& arrays, std::string& place, const Take& take) {
  std::map<std::string, Json> records{{"", {}}};
  for (const NamedArray& array : arrays) {
    const std::size_t slash = array.name.rfind('/') + 1;  // 0: none
    place = array.name;
    Json& record = records[array.name.substr(0, slash)];
    Json& value = record[array.name.substr(slash)];
    if (!value.is_null()) throw std::runtime_error("twice in the file");
    if (array.is_text)
      value = text(array.text);
    else if (!array.is_scalar)
      value = array.numbers;
    else if (!array.numbers.empty())
      value = array.numbers[0];
  }
  records[""].emplace("zwang_answers", format);
  for (auto& [sha256, record] : records) {
    place = sha256.empty() ? "head" : sha256;
    if (!sha256.empty()) record["sha256"] = text(sha256.substr(0, sha256.size() - 1));
    take(record);
  }
}

}  // namespace

Answers read_answers(const std::filesystem::path& file, const Pack& pack) {
  Answers all;
  all.file = file;
  bool has_head = false;
  std::string place;
  const auto take = [&](const Json& record) {
    for (const char* key : {"solver", "version", "settings", "machine", "sha256", "status", "answered_by"})
      if (record.contains(key) && !record[key].is_string())
        throw std::runtime_error(std::string(key) + " is " + record[key].dump().substr(0, 40) + "; expected a text");
    if (!has_head) read_head(record, all);
    if (!std::exchange(has_head, true)) return;
    const std::string sha256 = record.at("sha256").get<std::string>();
    const PackedProblem* problem = pack.find(sha256);
    if (!problem)
      throw std::runtime_error("no problem " + sha256.substr(0, 64) + " in " + pack.directory().string() +
                               " (answers to another pack?)");
    if (!all.of.emplace(sha256, answer_of(record, *problem)).second)
      throw std::runtime_error("a second answer to " + problem->name);
  };
  try {
    const StoredFile stored = read_stored(file);
    if (is_npz(stored))
      of_arrays(read_npz(stored), place, take);
    else if (stored.bytes.starts_with("\x89HDF"))
      of_arrays(read_hdf5(file), place, take);
    else
      of_lines(stored.bytes, place, take);
  } catch (const BadFile&) {
    throw;
  } catch (const std::exception& wrong) {
    throw BadFile(one_line(file.string() + ", " + place + ": " + plain(wrong)));
  }
  for (const PackedProblem& problem : pack.problems())
    if (!all.of.contains(problem.sha256)) all.missing.push_back(problem.name);
  return all;
}

std::vector<std::string> names_of(std::span<const Answers> contestants) {
  std::vector<std::string> names;
  const auto taken = [&](const std::string& name) { return std::ranges::count(names, name) > 0; };
  for (const Answers& given : contestants) {
    if (!is_name(given.solver))
      throw std::invalid_argument("'" + given.solver + "': a solver's name holds letters, digits and _ - + . alone");
    std::string place = given.file.stem().string();
    std::ranges::replace_if(place, std::not_fn(of_name), '_');
    const std::string name = taken(given.solver) ? given.solver + "@" + place : given.solver;
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
    if (v->size() > 0 && (v->allFinite() || s.status == Status::solved)) line[key] = *v;
  line["iterations"] = s.iterations;
  if (!s.handed_to.empty()) line["answered_by"] = s.handed_to;
  if (std::isfinite(answer.seconds)) line["seconds"] = answer.seconds;
  if (std::isfinite(answer.residual)) line["residual"] = answer.residual;
  return line.dump() + "\n";
}

}  // namespace zwang

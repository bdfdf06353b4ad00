#include <zwang/bench/results/records.h>

#include <algorithm>
#include <concepts>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include <zwang/bench/results/result.h>

namespace zwang {
namespace {

template <class T>
concept WithColumns =
    requires(T& record) { T::columns(record, Columns{[](const std::string&, auto&, const Column&) {}}); };

// JSON has no infinity: the largest number stands for it. NaN becomes null.
nlohmann::ordered_json json_of(double x) {
  return std::clamp(x, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}
template <class Value>
nlohmann::ordered_json json_of(const std::vector<Value>& values);
nlohmann::ordered_json json_of(const std::optional<bool>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}
template <class Value>
nlohmann::ordered_json json_of(const Value& value) {
  if constexpr (WithColumns<Value>) {
    nlohmann::ordered_json line;
    if constexpr (requires { Value::kind; }) line["kind"] = Value::kind;
    Value::columns(value, Columns{[&line](const std::string& key, const auto& member, const Column& column) {
                     if (column.written) line[key] = column.null ? nullptr : json_of(member);
                   }});
    return line;
  } else if constexpr (std::is_enum_v<Value>) {
    return to_string(value);
  } else {
    return value;
  }
}
template <class Value>
nlohmann::ordered_json json_of(const std::vector<Value>& values) {
  auto all = nlohmann::ordered_json::array();
  for (const Value& value : values) all.push_back(json_of(value));
  return all;
}

template <class Enum>
constexpr Enum last = Enum();
template <>
constexpr Status last<Status> = Status::crashed;
template <>
constexpr Verdict last<Verdict> = last_verdict;

template <class Enum>
Enum named(const std::string& name) {
  for (int k = 0; k <= static_cast<int>(last<Enum>); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  throw std::runtime_error("no result of this version of zwang: \"" + name + "\" is no word for a claim or a verdict");
}

template <class Value>
void take(const nlohmann::json& json, std::vector<Value>& into);
void take(const nlohmann::json& json, std::optional<bool>& into) {
  if (json.is_boolean()) into = json.get<bool>();
}
// What is not there, or of another type, leaves `into` as it is.
template <class Value>
void take(const nlohmann::json& json, Value& into) {
  if constexpr (WithColumns<Value>) {
    Value::columns(into, Columns{[&json](const std::string& key, auto& member, const Column&) {
                     if (const auto found = json.find(key); found != json.end()) take(*found, member);
                   }});
  } else if constexpr (std::same_as<Value, std::string>) {
    if (!json.is_null()) into = json.is_string() ? json.get<std::string>() : json.dump();
  } else if constexpr (std::same_as<Value, bool>) {
    if (json.is_boolean()) into = json.get<bool>();
  } else if constexpr (std::is_enum_v<Value>) {
    into = named<Value>(json.is_string() ? json.get<std::string>() : json.dump());
  } else if constexpr (std::floating_point<Value>) {
    into = json.is_number() ? json.get<Value>() : unknown;
  } else {
    static_assert(std::integral<Value>);
    if (json.is_number_integer()) into = json.get<Value>();
  }
}
template <class Value>
void take(const nlohmann::json& json, std::vector<Value>& into) {
  for (const auto& item : json) take(item, into.emplace_back());
}

}  // namespace

template <class Record>
std::string to_json(const Record& record) {
  return json_of(record).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Result read_result(const std::string& line) {
  const auto json = nlohmann::json::parse(line);
  for (const char* key : {"problem", "solver", "tolerance", "claimed", "verified"})
    if (!json.contains(key))
      throw std::runtime_error(std::string("no result of this version of zwang: it has no \"") + key + "\"");
  Result result;
  take(json, result);
  return result;
}

template std::string to_json(const Result&);
template std::string to_json(const SolvedResult&);
template std::string to_json(const TracePoint&);
template std::string to_json(const AssemblyTimes&);
template std::string to_json(const StageTimes&);
template std::string to_json(const SequenceTimes&);
template std::string to_json(const Phenomenon&);

}  // namespace zwang

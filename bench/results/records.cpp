#include <zwang/bench/results/records.h>

#include <algorithm>
#include <concepts>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace zwang {
namespace {

template <class T>
concept WithColumns = requires(T& record) {
  T::columns(record, [](const std::string&, auto&, Column = {}) {});
};

// JSON has no infinity: the largest number stands for it. NaN becomes null.
nlohmann::ordered_json json_of(double x) {
  return std::clamp(x, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}
template <class Value>
nlohmann::ordered_json json_of(const Value& value) {
  if constexpr (WithColumns<Value>) {
    nlohmann::ordered_json line;
    if constexpr (requires { Value::kind; }) line["kind"] = Value::kind;
    Value::columns(value, [&line](const std::string& key, const auto& member, Column column = {}) {
      if (column.written) line[key] = column.null ? nullptr : json_of(member);
    });
    return line;
  } else {
    return value;
  }
}

// What is not there, or of another type, leaves `into` as it is.
template <class Value>
void take(const nlohmann::json& json, Value& into) {
  if constexpr (WithColumns<Value>) {
    Value::columns(into, [&json](const std::string& key, auto& member, Column = {}) {
      if (const auto found = json.find(key); found != json.end()) take(*found, member);
    });
  } else if constexpr (std::same_as<Value, std::string>) {
    if (!json.is_null()) into = json.is_string() ? json.get<std::string>() : json.dump();
  } else if constexpr (std::same_as<Value, bool>) {
    if (json.is_boolean()) into = json.get<bool>();
  } else {
    static_assert(std::is_arithmetic_v<Value>);
    if (std::floating_point<Value> ? json.is_number() : json.is_number_integer()) into = json.get<Value>();
  }
}

}  // namespace

template <class Record>
std::string to_json(const Record& record) {
  return json_of(record).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

template <class Record>
bool read_json(const std::string& line, Record& record) {
  const auto json = nlohmann::json::parse(line);
  if constexpr (requires { Record::kind; })
    if (json.value("kind", "") != Record::kind) return false;
  take(json, record);
  return true;
}

template std::string to_json(const TracePoint&);
template std::string to_json(const AssemblyTimes&);
template std::string to_json(const StageTimes&);
template std::string to_json(const SequenceTimes&);
template std::string to_json(const Phenomenon&);
template bool read_json(const std::string&, TracePoint&);
template bool read_json(const std::string&, AssemblyTimes&);
template bool read_json(const std::string&, StageTimes&);
template bool read_json(const std::string&, SequenceTimes&);
template bool read_json(const std::string&, Phenomenon&);

}  // namespace zwang

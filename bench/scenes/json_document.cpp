#include <zwang/bench/scenes/json_document.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <sstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

using Json = nlohmann::json;

// The JSON pointer of where parsing is.
struct Place {
  std::string at;
  bool is_list;
  std::size_t items = 0;
  std::set<std::string> members = {};
};

template <class Name>
std::string below(const std::string& at, const Name& name) {
  return (Json::json_pointer(at) / name).to_string();
}

}  // namespace

JsonDocument::JsonDocument(const std::filesystem::path& file) : file_(file), root_(std::make_shared<Json>()) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) throw BadFile(file.string() + ": cannot be read");
  const std::string all = std::move(text).str();
  int line = 1;
  const auto refuse = [&](const std::string& why) {
    throw BadFile(file.string() + ", line " + std::to_string(line) + ": " + why);
  };
  std::vector<Place> open;  // lists and objects
  std::string member;
  const auto note = [&](int, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::key) {
      member = parsed.get<std::string>();
      if (!open.back().members.insert(member).second) refuse("member '" + member + "' stands there twice");
      return true;
    }
    if (event == Json::parse_event_t::object_end || event == Json::parse_event_t::array_end) {
      open.pop_back();
      return true;
    }
    std::string at;
    if (!open.empty())
      at = open.back().is_list ? below(open.back().at, open.back().items++) : below(open.back().at, member);
    line_[at] = line;
    if (event == Json::parse_event_t::value) return true;
    if (open.size() > 100) refuse("nested deeper than 100 levels");
    open.push_back({at, event == Json::parse_event_t::array_start});
    return true;
  };
  try {
    // The parser reads each character once. It is one ahead after a number.
    const auto counting_lines = all | std::views::transform([&line](char ch) { return line += ch == '\n', ch; });
    *root_ = Json::parse(counting_lines.begin(), counting_lines.end(), note);
  } catch (const Json::exception& bad) {
    const std::string why = bad.what();
    refuse(why.substr(why.starts_with("[json.exception.") ? why.find("] ") + 2 : 0));
  }
}

void JsonDocument::fail(const std::string& at, const std::string& expected) const {
  const auto line = line_.find(at);
  throw BadFile(file_.string() + (line == line_.end() ? "" : ", line " + std::to_string(line->second)) + ": " +
                (at.empty() ? "" : at + ": ") + "expected " + expected);
}

bool JsonValue::has(const char* member) const { return value_->is_object() && value_->contains(member); }

std::size_t JsonValue::size() const { return value_->size(); }

JsonValue JsonValue::operator[](const char* member) const {
  if (!value_->is_object()) fail("an object");
  if (!has(member)) fail("a member '" + std::string(member) + "'");
  return {*document_, below(at_, member), (*value_)[member]};
}

std::vector<JsonValue> JsonValue::items() const {
  if (!value_->is_array()) fail("a list");
  std::vector<JsonValue> all;
  for (std::size_t i = 0; i < value_->size(); ++i) all.push_back({*document_, below(at_, i), (*value_)[i]});
  return all;
}

void JsonValue::only(const std::vector<std::string>& members) const {
  if (!value_->is_object()) fail("an object");
  for (const auto& [name, unused] : value_->items())
    if (std::find(members.begin(), members.end(), name) == members.end())
      document_->fail(below(at_, name), "one of the members " + joined(members) + did_you_mean(name, members));
}

double JsonValue::number() const {
  if (!value_->is_number() || !std::isfinite(value_->get<double>())) fail("a number");
  return value_->get<double>();
}

double JsonValue::positive() const {
  const double x = number();
  if (!(x > 0)) fail("a positive number");
  return x;
}

std::string JsonValue::text() const {
  if (!value_->is_string()) fail("a text");
  return value_->get<std::string>();
}

std::vector<double> JsonValue::numbers(std::size_t size) const {
  const std::string expected = std::to_string(size) + " numbers";
  if (!value_->is_array() || value_->size() != size) fail(expected);
  std::vector<double> out;
  for (const Json& x : *value_) {
    if (!x.is_number() || !std::isfinite(x.get<double>())) fail(expected);
    out.push_back(x.get<double>());
  }
  return out;
}

std::string JsonValue::word(const std::vector<std::string>& words) const {
  const std::string given = text();
  if (std::ranges::find(words, given) == words.end()) fail("one of " + joined(words) + did_you_mean(given, words));
  return given;
}

}  // namespace zwang

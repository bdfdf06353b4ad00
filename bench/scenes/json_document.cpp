#include <zwang/bench/scenes/json_document.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

using Json = nlohmann::json;

// Characters of a text, counting the lines that were read. The parser is one character ahead after a number, so the
// line is that of the character before the last.
struct Counted {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  const char* at = nullptr;
  int* line = nullptr;

  reference operator*() const { return *at; }
  Counted& operator++() {
    if (*at == '\n') ++*line;
    ++at;
    return *this;
  }
  Counted operator++(int) {
    Counted before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Counted& a, const Counted& b) { return a.at == b.at; }
};

// Builds the value and notes the line of each part.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(Json& root, std::map<std::string, int>& lines, const int& line) : root_(root), lines_(lines), line_(line) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool v) override { return put(v); }
  bool number_integer(number_integer_t v) override { return put(v); }
  bool number_unsigned(number_unsigned_t v) override { return put(v); }
  bool number_float(number_float_t v, const string_t&) override { return put(v); }
  bool string(string_t& v) override { return put(std::move(v)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (path_.back().first->contains(name)) {
      error = "member '" + name + "' stands there twice";
      return false;
    }
    key_ = name;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception& bad) override {
    error = bad.what();
    if (const auto bracket = error.find("] "); error.starts_with("[json.exception.") && bracket != std::string::npos)
      error.erase(0, bracket + 2);
    return false;
  }

  std::string error = {};

 private:
  // Where the next value belongs.
  std::pair<Json*, Json::json_pointer> place() {
    if (path_.empty()) return {&root_, Json::json_pointer()};
    auto& [parent, at] = path_.back();
    if (parent->is_array()) {
      parent->push_back(nullptr);
      return {&parent->back(), at / (parent->size() - 1)};
    }
    return {&(*parent)[key_], at / key_};
  }
  template <class T>
  bool put(T&& v) {
    const auto [where, at] = place();
    *where = std::forward<T>(v);
    lines_[at.to_string()] = line_;
    return true;
  }
  bool open(Json empty) {
    if (path_.size() > 100) {
      error = "nested deeper than 100 levels";
      return false;
    }
    auto [where, at] = place();
    *where = std::move(empty);
    lines_[at.to_string()] = line_;
    path_.emplace_back(where, at);
    return true;
  }
  bool close() {
    path_.pop_back();
    return true;
  }

  Json& root_;
  std::map<std::string, int>& lines_;
  const int& line_;
  std::vector<std::pair<Json*, Json::json_pointer>> path_;
  std::string key_;
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
  Builder builder(*root_, line_, line);
  const Counted begin{all.data(), &line}, end{all.data() + all.size(), &line};
  if (!Json::sax_parse(begin, end, &builder))
    throw BadFile(file.string() + ", line " + std::to_string(line) + ": " + builder.error);
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
  if (std::find(words.begin(), words.end(), given) == words.end())
    fail("one of " + joined(words) + did_you_mean(given, words));
  return given;
}

}  // namespace zwang

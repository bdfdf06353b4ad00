#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace zwang {

// A JSON file whose values know the line they stand on, for messages.
class JsonDocument {
 public:
  // Throws BadFile with the line where the text is no JSON, or names a member twice.
  explicit JsonDocument(const std::filesystem::path& file);

  const nlohmann::json& root() const { return *root_; }
  // "FILE, line 12: /bodies/2/mass: expected TEXT", thrown as BadFile. at: a JSON pointer.
  [[noreturn]] void fail(const std::string& at, const std::string& expected) const;

 private:
  std::filesystem::path file_;
  std::shared_ptr<nlohmann::json> root_;
  std::map<std::string, int> line_;  // by the value's JSON pointer
};

// One value of a document, read by what it should be. Every function throws BadFile with line and member.
class JsonValue {
 public:
  explicit JsonValue(const JsonDocument& document) : JsonValue(document, {}, document.root()) {}

  bool has(const char* member) const;
  std::size_t size() const;                        // members or items
  JsonValue operator[](const char* member) const;  // which must be there
  std::vector<JsonValue> items() const;            // of a list
  // That no other members are there than these, and that it is an object at all.
  void only(const std::vector<std::string>& members) const;
  [[noreturn]] void fail(const std::string& expected) const { document_->fail(at_, expected); }

  double number() const;  // finite
  double positive() const;
  std::string text() const;
  // `size` finite numbers.
  std::vector<double> numbers(std::size_t size) const;
  // One of these words.
  std::string word(const std::vector<std::string>& words) const;

 private:
  JsonValue(const JsonDocument& document, std::string at, const nlohmann::json& value)
      : document_(&document), at_(std::move(at)), value_(&value) {}

  const JsonDocument* document_;
  std::string at_;  // its JSON pointer
  const nlohmann::json* value_;
};

}  // namespace zwang

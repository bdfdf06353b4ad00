#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include <zwang/core/process/child_process.h>

namespace zwang {

// Another program of zwang, for what may not be linked into one with the rest, or may bring it down. It answers one
// message after the other, lives from question to question and ends with this process (docs/benchmarking.md).
//
// Found under its name: where the environment variable of that name in capitals says (ZWANG_IPOPT for "zwang-ipopt"),
// beside the file that holds this code or in the bin/ of one of the folders above it, in PATH, where zwang is
// installed.
class OtherProgram {
 public:
  explicit OtherProgram(std::string name) : name_(std::move(name)) {}

  // Starts the program where it does not run. Throws Stopped: unsupported where it is not found, crashed where it died,
  // time_limit after `seconds` on the wall clock; the next question starts a new one.
  std::string ask(std::string_view question, double seconds);

  // What its main() does: answers until there are no more questions.
  static int serve(const std::function<std::string(std::string_view question)>& answer);

 private:
  void start();

  std::string name_;
  Peer peer_;
};

// Empty where there is none.
std::filesystem::path find_program(std::string_view name);

}  // namespace zwang

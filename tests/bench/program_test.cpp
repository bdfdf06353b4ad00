#include <zwang/bench/program/program.h>

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

struct Other : std::exception {
  const char* what() const noexcept override { return "a library's own kind"; }
};

// Exit code and stderr of a program whose command `word` throws this.
template <class Thrown>
std::pair<int, std::string> of_a_command_that_throws(const Thrown& thrown) {
  const Extensions extensions{
      .commands = {{"fail", [&](std::vector<std::string>) -> int { throw thrown; }, "Fails", "fails"}}};
  std::string program_name = "zwang", word = "fail";
  char* arguments[] = {program_name.data(), word.data(), nullptr};
  testing::internal::CaptureStderr();
  const int code = program(2, arguments, extensions);
  return {code, testing::internal::GetCapturedStderr()};
}

using Ending = std::pair<int, std::string>;

TEST(Program, WhateverACommandThrowsIsOneLineAndAnExitCode) {
  EXPECT_EQ(of_a_command_that_throws(std::invalid_argument("no such knob")), (Ending{wrong_use, "no such knob\n"}));
  EXPECT_EQ(of_a_command_that_throws(BadFile("part.stl: 0 bytes")), (Ending{bad_file, "part.stl: 0 bytes\n"}));
  EXPECT_EQ(of_a_command_that_throws(std::bad_alloc()), (Ending{bad_file, "out of memory\n"}));
  EXPECT_EQ(of_a_command_that_throws(std::length_error("too long")), (Ending{bad_file, "too long\n"}));
  EXPECT_EQ(of_a_command_that_throws(Other()), (Ending{bad_file, "a library's own kind\n"}));
}

}  // namespace
}  // namespace zwang

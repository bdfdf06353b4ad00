#include <zwang/core/process/isolated.h>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include "tests/folders.h"

namespace zwang {
namespace {

namespace fs = std::filesystem;

std::string complaint_of(const std::function<std::string()>& work, IsolationLimits limits = {}) {
  try {
    isolated("part.stl", limits, work);
  } catch (const BadFile& bad) {
    return bad.what();
  }
  return "";
}

TEST(Isolated, GivesBackWhatTheChildReturns) {
  std::string bytes(2400000, 'a');
  bytes[7] = '\0';
  EXPECT_EQ(isolated("part.stl", {},
                     [&] {
                       std::puts("a library that talks");
                       return bytes;
                     }),
            bytes);
  EXPECT_EQ(isolated("part.stl", {}, [] { return std::string(); }), "");
}

TEST(Isolated, WhateverGoesWrongIsOneLineThatNamesTheFile) {
  EXPECT_EQ(complaint_of([]() -> std::string { throw BadFile("part.stl: no triangles in it"); }),
            "part.stl: no triangles in it");
  EXPECT_EQ(complaint_of([]() -> std::string { throw std::out_of_range("at\nnowhere"); }), "part.stl: at nowhere");
  EXPECT_EQ(complaint_of([]() -> std::string { std::abort(); }),
            "part.stl: its reader crashed; expected an undamaged file");
  EXPECT_EQ(complaint_of([] {
              std::raise(SIGSEGV);
              return std::string();
            }),
            "part.stl: its reader crashed; expected an undamaged file");
  EXPECT_EQ(complaint_of([]() -> std::string { throw std::bad_alloc(); }, {.bytes = 3 * 1000000000ul}),
            "part.stl: asks for more than 3.0 GB of memory; expected an undamaged file");
}

TEST(Isolated, AnEndlessLoopAndASleepAreStopped) {
  const std::string late = "part.stl: not read within 1 s; expected an undamaged file";
  EXPECT_EQ(complaint_of(
                [] {
                  for (volatile bool go_on = true; go_on;) {
                  }
                  return std::string();
                },
                {.seconds = 0.5}),
            late);
  EXPECT_EQ(complaint_of(
                [] {
                  pause();
                  return std::string();
                },
                {.seconds = 0.05}),
            late);
}

struct StoredFiles : testing::Test {
  fs::path folder = own_path("stored");
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::string complaint(const fs::path& file) const {
    try {
      read_stored(file);
    } catch (const BadFile& bad) {
      return bad.what();
    }
    return "";
  }
};

TEST_F(StoredFiles, WhatIsNoFileIsRefusedAtOnce) {
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder / "endless");
  fs::create_symlink(folder / "loop", folder / "loop");
  std::ofstream(folder / "empty").flush();
  EXPECT_NE(complaint(folder).find("a folder"), std::string::npos);
  for (const char* name : {"pipe", "endless"})
    EXPECT_NE(complaint(folder / name).find("a pipe or device"), std::string::npos) << name;
  EXPECT_NE(complaint(folder / "empty").find("0 bytes"), std::string::npos);
  for (const char* name : {"loop", "absent"}) EXPECT_NE(complaint(folder / name), "") << name;
}

TEST_F(StoredFiles, KindIsTheExtensionBelowGz) {
  EXPECT_EQ((StoredFile{"a.b/Part.STL.gz", {}}.kind()), ".stl");
  EXPECT_TRUE((StoredFile{"Part.obj.GZ", {}}.packed()));
  EXPECT_EQ((StoredFile{"part.ply", {}}.kind()), ".ply");
  EXPECT_FALSE((StoredFile{"part.ply", {}}.packed()));
}

// "ab" packed twice, one behind the other, as `cat a.gz b.gz` makes it.
TEST_F(StoredFiles, SeveralGzipMembersAreOneFile) {
  const std::string member("\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x4b\x4c\x02\x00\x6d\x48\x83\x9e\x02\x00\x00\x00",
                           22);
  EXPECT_EQ(unpacked({"a.gz", member + member}, 100), "abab");
  EXPECT_EQ(unpacked({"a.txt", member}, 100), member);
  EXPECT_THROW(unpacked({"a.gz", member + "junk"}, 100), BadFile);
  EXPECT_THROW(unpacked({"a.gz", member.substr(0, 20)}, 100), BadFile);
  EXPECT_THROW(unpacked({"a.gz", member + member}, 3), BadFile);
}

}  // namespace
}  // namespace zwang

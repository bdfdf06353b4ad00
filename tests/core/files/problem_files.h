#pragma once

#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <limits>

#include <zwang/core/files/problem_file.h>
#include "tests/folders.h"

namespace zwang {

namespace fs = std::filesystem;

// A folder of its own for each test.
class ProblemFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder = own_path(test->name());
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path path(const std::string& name) const { return folder / name; }

  fs::path folder;
};

// Two unknowns, three rows, with every double that is easily lost: -Inf, a denormal, -0 and a stored zero.
inline Instance awkward() {
  Instance in;
  Problem& p = in.problem;
  p.name = "awkward";
  p.M.resize(2, 2);
  p.M.insert(0, 0) = 2;
  p.M.insert(1, 0) = 0.1;
  p.M.insert(0, 1) = 0.1;
  p.M.insert(1, 1) = 1e300;
  p.z_u = Vector(2);
  p.z_u << -0.0, std::numeric_limits<double>::denorm_min();
  p.J.resize(3, 2);
  p.J.insert(0, 0) = 1.0 / 3;
  p.J.insert(0, 1) = -0.0;
  p.J.insert(2, 1) = -std::numeric_limits<double>::min() / 8;
  p.c = Vector(3);
  p.c << 0.1, -infinity, -0.0;
  p.kind = {RowKind::equality, RowKind::inequality, RowKind::inequality};
  p.key = {{1, 0}, {~std::uint64_t{0}, 7}, {1, ~std::uint32_t{0}}};
  in.family = "test";
  in.knob = "ratio";
  in.knob_value = 0.1;
  in.seed = ~std::uint64_t{0};
  in.origin = {{"ball_joint", "elbow", -1, ""}, {"contact", "Würfel 3", 0, "m/s^2"}, {}};
  in.notes = {"first", "second note"};
  in.reference = Reference{.z = p.z_u, .lambda = p.c.cwiseMax(-1), .bound = 1e-14, .method = "closed form"};
  return in;
}

inline std::string bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void put(const fs::path& file, const std::string& contents) {
  std::ofstream(file, std::ios::binary) << contents;
}

// "" when the file reads, else the complaint.
inline std::string complaint(const fs::path& file) {
  try {
    read_problems(file);
    return {};
  } catch (const BadFile& bad) {
    return bad.what();
  }
}

}  // namespace zwang

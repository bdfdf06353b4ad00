// The stability atlas as problem files, as `./zwang pack atlas` writes them, against the list of all points in
// tests/data/atlas_points.tsv: file, problem, n, m, sha256, feasible, method, bound, |z*|_M.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include <zwang/bench/packs/pack.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>

#include "tests/folders.h"

namespace zwang {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Point {
  std::string sha256;
  bool feasible;
  double length;
};

// By their names.
const std::map<std::string, Point>& stored() {
  static const std::map<std::string, Point> all = [] {
    std::map<std::string, Point> points;
    std::ifstream in(source_dir() / "tests/data/atlas_points.tsv");
    std::string line;
    std::getline(in, line);  // names of the columns
    while (std::getline(in, line)) {
      const std::vector<std::string> cell = split(line, '\t');
      points[cell.at(1)] = {cell.at(4), cell.at(5) == "yes", number_in<double>(cell.at(8)).value_or(NAN)};
    }
    return points;
  }();
  return all;
}

std::vector<Instance> points_of(const std::string& families) {
  return make_plan({.suite = "atlas", .families = families, .solvers = "nnls"}).instances;
}

class AtlasPoints : public testing::Test {
 protected:
  Pack write(const std::string& name, const std::string& families) {
    write_pack(folder / name, points_of(families), "a test", "", [](std::size_t, const std::string&) {});
    return Pack(folder / name);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  const std::filesystem::path folder = own_path("atlas-points");
};

TEST_F(AtlasPoints, AllOfTheSuiteAreListed) {
  const std::vector<Instance> points = points_of("");
  for (const Instance& point : points) {
    const auto listed = stored().find(point.problem.name);
    ASSERT_NE(listed, stored().end()) << point.problem.name;
    EXPECT_EQ(listed->second.sha256, problem_sha256(point.problem)) << point.problem.name;
  }
  EXPECT_EQ(stored().size(), points.size());
}

TEST_F(AtlasPoints, RebuildToTheSameBytesAndTheStoredTruths) {
  const Pack first = write("first", "NPE,WED,GAP,ROW,MANYR"), second = write("second", "NPE,WED,GAP,ROW,MANYR");
  EXPECT_EQ(content(folder / "first/pack.json"), content(folder / "second/pack.json"));
  EXPECT_GT(first.problems().size(), 80u);
  for (const PackedProblem& packed : first.problems()) {
    EXPECT_EQ(content(first.directory() / packed.file), content(second.directory() / packed.file)) << packed.name;
    const Point& point = stored().at(packed.name);
    const Instance read = read_problems(first.directory() / packed.file).at(0);
    EXPECT_EQ(packed.sha256, point.sha256) << packed.name;
    ASSERT_TRUE(read.reference) << packed.name;
    EXPECT_EQ(read.reference->feasible, point.feasible) << packed.name;
    if (!point.feasible) continue;
    const Vector& z = read.reference->z;
    EXPECT_NEAR(std::sqrt(z.dot(read.problem.M * z)), point.length, 1e-11 * point.length) << packed.name;
  }
}

// Read back, and held against exact rational arithmetic, which no file and no closed form has seen.
TEST_F(AtlasPoints, HoldTheProblemAndATruthThatRationalsConfirm) {
  const Pack pack = write("once", "NPI,INC,WEAK,PIVOT,ANI");
  const std::vector<Instance> points = points_of("NPI,INC,WEAK,PIVOT,ANI");
  EXPECT_GT(points.size(), 70u);
  ASSERT_EQ(points.size(), pack.problems().size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::string& name = points[k].problem.name;
    const Instance read = read_problems(pack.directory() / pack.problems()[k].file).at(0);
    EXPECT_EQ(problem_sha256(read.problem), problem_sha256(points[k].problem)) << name;
    EXPECT_EQ(read.origin, points[k].origin) << name;
    ASSERT_TRUE(read.reference) << name;
    const auto exact = rational_reference(read.problem);
    ASSERT_TRUE(exact) << name;
    EXPECT_EQ(exact->feasible, read.reference->feasible) << name;
    if (exact->feasible) {
      EXPECT_LE(relative_distance(read.problem, exact->z, read.reference->z), read.reference->bound + 1e-15) << name;
    }
  }
}

}  // namespace
}  // namespace zwang

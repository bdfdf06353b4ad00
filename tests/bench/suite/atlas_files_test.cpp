// The stability atlas as problem files: what `./zwang export --atlas` writes, against the list of all points in
// tests/data/atlas_points.tsv, which is that command's atlas.tsv.
#include <zwang/bench/suite/atlas_files.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/core/files/problem_file.h>

#include "tests/folders.h"

namespace zwang {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::set<std::string> lines(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::set<std::string> all;
  for (std::string line; std::getline(in, line);) all.insert(line);
  return all;
}

const std::set<std::string>& stored() {
  static const std::set<std::string> all = lines(source_dir() / "tests/data/atlas_points.tsv");
  return all;
}

// The table was stored before references were certified.
std::string without_certificates(std::string line) {
  for (const std::string note : {", certified by the referee", ", KKT certified in 100 digits"})
    if (const auto at = line.find(note); at != std::string::npos) line.erase(at, note.size());
  return line;
}

// And before what the referee proves of them counted as their bound.
std::string without_bound(std::string line) {
  const std::size_t length = line.rfind('\t'), bound = line.rfind('\t', length - 1);
  return line.erase(bound, length - bound);
}

class AtlasFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& families) {
    write_atlas(folder / name, families, "", [](std::size_t, std::size_t, const std::string&) {});
    return folder / name;
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  const std::filesystem::path folder = own_path("atlas-files");
};

TEST_F(AtlasFiles, TheListHasEveryPointOfTheSuite) {
  std::size_t found = 0;
  const auto points = make_plan({.suite = "atlas", .solvers = "nnls"}).instances;
  for (const Instance& point : points)
    found += std::ranges::any_of(stored(), [&](const std::string& line) {
      return line.find('\t' + point.problem.name + '\t') != std::string::npos &&
             line.find(problem_sha256(point.problem)) != std::string::npos;
    });
  EXPECT_EQ(found, points.size());
  EXPECT_EQ(stored().size(), points.size() + 1) << "a line of names above";
}

TEST_F(AtlasFiles, RebuildToTheSameBytesAndTheStoredTruths) {
  const auto first = write("first", "NPE,WED,GAP,ROW,MANYR"), second = write("second", "NPE,WED,GAP,ROW,MANYR");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(first)) {
    EXPECT_EQ(content(entry.path()), content(second / entry.path().filename())) << entry.path();
    files += entry.path().extension() == ".h5";
  }
  EXPECT_GT(files, 80u);
  std::set<std::string> truths;
  for (const std::string& line : stored()) truths.insert(without_bound(line));
  for (const std::string& line : lines(first / "atlas.tsv"))
    EXPECT_TRUE(truths.contains(without_bound(without_certificates(line)))) << line;
}

// Read back, and held against exact rational arithmetic, which no file and no closed form has seen.
TEST_F(AtlasFiles, HoldTheProblemAndATruthThatRationalsConfirm) {
  const auto directory = write("once", "NPI,INC,WEAK,PIVOT,ANI");
  std::size_t confirmed = 0;
  for (const Instance& point :
       make_plan({.suite = "atlas", .families = "NPI,INC,WEAK,PIVOT,ANI", .solvers = "nnls"}).instances) {
    std::string name = point.problem.name;
    std::ranges::replace(name, '(', '_');
    std::ranges::replace(name, ',', '_');
    std::erase(name, ')');
    const Instance read = read_problems(directory / (name + ".h5")).at(0);
    EXPECT_EQ(problem_sha256(read.problem), problem_sha256(point.problem)) << name;
    EXPECT_EQ(read.origin, point.origin) << name;
    ASSERT_TRUE(read.reference) << name;
    const auto exact = rational_reference(read.problem);
    ASSERT_TRUE(exact) << name;
    EXPECT_EQ(exact->feasible, read.reference->feasible) << name;
    if (exact->feasible) {
      EXPECT_LE(relative_distance(read.problem, exact->z, read.reference->z), read.reference->bound + 1e-15) << name;
    }
    ++confirmed;
  }
  EXPECT_GT(confirmed, 70u);
}

}  // namespace
}  // namespace zwang

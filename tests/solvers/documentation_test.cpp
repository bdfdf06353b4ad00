#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/registry.h>

#include "tests/folders.h"

namespace zwang {

TEST(Documentation, EverySolverHasItsParagraph) {
  std::ifstream file(source_dir() / "docs/solvers.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const SolverEntry& entry : solvers()) {
    const auto heading = text.str().find("\n## " + entry.name + "\n\n");
    EXPECT_NE(heading, std::string::npos) << "docs/solvers.md has no paragraph on " << entry.name;
  }
}

// The table of docs/performance.md, "Which solver".
TEST(Documentation, TheUsualSolverIsTheOneOfTheTable) {
  const auto usual = [](const std::string& scene) { return usual_solver(make_scenes(scene)[0].problem); };
  EXPECT_EQ(usual("hand(contacts=64)"), "dual_active_set");
  EXPECT_EQ(usual("hands(hands=64)"), "dual_active_set");
  EXPECT_EQ(usual("chain(links=2000)"), "dual_active_set");
  EXPECT_EQ(usual("tower(boxes=10)"), "dual_active_set");
  EXPECT_EQ(usual("stack(boxes=400)"), "newton");
  EXPECT_EQ(usual("wall(boxes=1000)"), "newton");
  EXPECT_EQ(usual("crate"), "cone");
}

std::string text_of(const std::string& file) {
  std::ifstream in(source_dir() / file);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

// docs/add-a-solver.md prints the file that is built, and the struct has at most 25 lines.
TEST(Guide, TheSolverOfTheGuideIsTheOneThatIsBuilt) {
  const std::string code = text_of("solvers/first_order/projected_gradient.h");
  ASSERT_FALSE(code.empty());
  EXPECT_NE(text_of("docs/add-a-solver.md").find("```cpp\n" + code + "```"), std::string::npos);
  std::istringstream text(code.substr(code.find("struct ")));
  int lines = 0;
  for (std::string line; std::getline(text, line) && line != "};";) lines += !line.empty();
  EXPECT_LE(lines + 1, 25);
  ASSERT_NE(find_solver("projected_gradient"), nullptr);
}

// Where the guide sends people: the build takes a .cpp that is listed nowhere, and what an entry says stands in the
// file that the guide links.
TEST(Guide, WhatItSaysOfTheBuildAndOfAnEntryIsSo) {
  const std::string guide = text_of("docs/add-a-solver.md");
  EXPECT_NE(guide.find("[solvers/CMakeLists.txt](../solvers/CMakeLists.txt) takes\n   every `.cpp` below"),
            std::string::npos);
  EXPECT_NE(text_of("solvers/CMakeLists.txt").find("file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS *.cpp)"),
            std::string::npos);
  const auto begin = guide.find("- Say in the entry what the method can do");
  ASSERT_NE(begin, std::string::npos);
  const std::string entry = guide.substr(begin, guide.find("\n- ", begin) - begin);
  std::smatch link;
  ASSERT_TRUE(std::regex_search(entry, link, std::regex(R"(\]\(\.\./([^)]*)\))"))) << entry;
  const std::string file = text_of(link[1]);
  const std::regex member(R"(`\.(\w+))");
  int members = 0;
  for (std::sregex_iterator at(entry.begin(), entry.end(), member), end; at != end; ++at, ++members)
    EXPECT_NE(file.find(" " + at->str(1) + " = "), std::string::npos) << at->str(1) << " is not in " << link[1];
  EXPECT_GE(members, 5);
}

}  // namespace zwang

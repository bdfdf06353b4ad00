#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

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

// docs/add-a-solver.md prints the file that is built, and the struct has at most 25 lines.
TEST(Guide, TheSolverOfTheGuideIsTheOneThatIsBuilt) {
  const auto read = [](const char* file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string code = read(source_dir() / "solvers/first_order/projected_gradient.h");
  ASSERT_FALSE(code.empty());
  EXPECT_NE(read(source_dir() / "docs/add-a-solver.md").find("```cpp\n" + code + "```"), std::string::npos);
  std::istringstream text(code.substr(code.find("struct ")));
  int lines = 0;
  for (std::string line; std::getline(text, line) && line != "};";) lines += !line.empty();
  EXPECT_LE(lines + 1, 25);
  ASSERT_NE(find_solver("projected_gradient"), nullptr);
}

}  // namespace zwang

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "solvers/registry.h"

namespace zwang {

TEST(Documentation, EverySolverHasItsParagraph) {
  std::ifstream file(ZWANG_SOURCE_DIR "/docs/solvers.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const SolverEntry& entry : solvers()) {
    const auto heading = text.str().find("\n## " + entry.name + "\n\n");
    EXPECT_NE(heading, std::string::npos) << "docs/solvers.md has no paragraph on " << entry.name;
  }
}

}  // namespace zwang

// Solvers whose library was absent when this was built.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <zwang/solvers/registry.h>

#include "tests/folders.h"

namespace zwang {
namespace {

TEST(AbsentSolvers, AskingForOneSaysInOneLineHowToAddIt) {
  for (const AbsentSolver& absent : absent_solvers()) {
    const std::string name(absent.name);
    EXPECT_EQ(find_solver(name), nullptr);
    try {
      make_solver(name + ":max_iterations=3");
      ADD_FAILURE() << name << " was made";
    } catch (const std::invalid_argument& said) {
      EXPECT_EQ(said.what(), "solver '" + name + "' is not built in: " + std::string(absent.how_to_add));
    }
  }
}

TEST(AbsentSolvers, EachOptionalOneIsEitherBuiltOrAbsentAndHasItsParagraph) {
  std::ifstream file(source_dir() / "docs/solvers.md");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  for (const std::string name :
       {"mujoco_newton", "daqp", "piqp", "osqp", "proxqp", "qpoases", "siconos_nsgs", "siconos_global_ipm"}) {
    const bool absent = std::ranges::count(absent_solvers(), name, &AbsentSolver::name) == 1;
    EXPECT_NE(absent, find_solver(name) != nullptr) << name;
    EXPECT_NE(text.find("\n## " + name + "\n\n"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace zwang

#include <zwang/bench/scenes/scene_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/problem.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/registry.h>

#include "tests/folders.h"

namespace zwang {
namespace {

const std::filesystem::path crane = source_dir() / "docs/examples/scenes/crane.json";

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct SceneFile : testing::Test {
  std::filesystem::path file = own_path("scene.json");
  ~SceneFile() override { std::filesystem::remove(file); }

  Instance read(const std::string& text) {
    std::ofstream(file) << text;
    return read_scene_file(file);
  }
  std::string message(const std::string& text) {
    try {
      read(text);
    } catch (const BadFile& bad) {
      return bad.what();
    }
    return "no message";
  }
};

TEST_F(SceneFile, TheExampleIsSolved) {
  const Instance instance = read_scene_file(crane);
  EXPECT_EQ(instance.family, "crane");
  EXPECT_EQ(instance.problem.size(), 4 * 6);  // ground stands still
  ASSERT_EQ(std::ssize(instance.origin), instance.problem.rows());
  EXPECT_EQ(instance.origin[0].label, "foot");
  Solution s;
  make_solver("dual_active_set").solve(instance.problem, {}, s);
  EXPECT_EQ(measure(instance.problem, s, nullptr, 1e-9).verdict, Verdict::solved);
}

TEST_F(SceneFile, SayWhatIsWrongWithLineAndMember) {
  const std::string good = text_of(crane);
  struct Case {
    std::string old, spoilt, line, expected;
  };
  for (const Case& c : {Case{"\"mass\": 30", "\"mass\": -30", "line 8", "/bodies/1/mass"},
                        Case{"\"mass\": 30", "\"mass\": \"30\"", "line 8", "/bodies/1/mass"},
                        Case{"\"mass\": 30", "\"maas\": 30", "line 8", "maas"},
                        Case{"\"type\": \"hinge\"", "\"type\": \"hinje\"", "line 15", "/joints/1/type"},
                        Case{"\"b\": \"boom\"", "\"b\": \"bomb\"", "line 15", "/joints/1/b"},
                        Case{"\"type\": \"hinge\"", "\"axis_b\": [0, 5, 0], \"type\": \"universal\"", "line 15",
                             "/joints/1/axis_b: expected a direction across axis"},
                        Case{"\"sphere\": 0.2", "\"sphere\": 0", "line 10", "/bodies/3/shape/sphere"},
                        Case{"[0, 0, -9.81]", "[0, 0]", "line 5", "/gravity"},
                        Case{"[0, 0, -9.81]", "[0, 0, 1e999]", "line 5", ": number overflow"},
                        Case{"\"dt\": 0.001", "\"dt\": 0", "line 4", "/dt"},
                        Case{"zwang scene 1", "zwang scene 9", "line 2", "/format"},
                        Case{"\"joint\": \"elbow\"", "\"joint\": \"cable\"", "line 19", "/limits/0"},
                        Case{"\"dt\": 0.001,", "\"dt\": 0.001", "line 5", ""},
                        Case{"\"name\": \"boom\"", "\"name\": \"mast\"", "line 9", "/bodies/2/name"}}) {
    const auto at = good.find(c.old);
    ASSERT_NE(at, std::string::npos) << c.old;
    const std::string said = message(std::string(good).replace(at, c.old.size(), c.spoilt));
    EXPECT_NE(said.find(c.line), std::string::npos) << c.spoilt << ": " << said;
    EXPECT_NE(said.find(c.expected), std::string::npos) << c.spoilt << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST_F(SceneFile, DamagedTextsReadOrAreRefused) {
  const std::string good = text_of(crane);
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = good;
    if (i % 4 == 0)
      text.resize(random() % text.size());
    else
      text[random() % text.size()] = static_cast<char>(random() % 256);
    try {
      const Instance instance = read(text);
      EXPECT_EQ(bad_input(instance.problem), "");
    } catch (const BadFile& bad) {
      EXPECT_EQ(std::string(bad.what()).find('\n'), std::string::npos) << bad.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace zwang

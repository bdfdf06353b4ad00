#include <functional>
#include <random>

#include <zwang/core/files/hdf5.h>
#include "tests/core/files/problem_files.h"
#include "tests/folders.h"

namespace zwang {
namespace {

// A file in our own layout, written part by part so that each part can be wrong.
struct Parts {
  std::vector<double> z_u = {0, -9}, c = {0}, M = {1, 2}, J = {1};
  std::vector<std::int32_t> M_p = {0, 1, 2}, M_i = {0, 1}, J_p = {0, 1}, J_i = {1};
  std::vector<std::uint8_t> kind = {1};
  std::vector<double> mu = {};
  std::string law = {};
  bool write_c = true;
  std::string group = "zwang";

  void write(const fs::path& file) const {
    auto root = hdf5::Group::create(file);
    auto g = root.add_group(group);
    const auto matrix = [&](const char* name, const auto& p, const auto& i, const auto& x) {
      auto A = g.add_group(name);
      A.write("p", std::span<const std::int32_t>(p));
      A.write("i", std::span<const std::int32_t>(i));
      A.write("x", std::span<const double>(x));
    };
    matrix("M", M_p, M_i, M);
    matrix("J", J_p, J_i, J);
    g.write("z_u", std::span<const double>(z_u));
    if (write_c) g.write("c", std::span<const double>(c));
    g.write("kind", std::span<const std::uint8_t>(kind));
    if (!mu.empty()) g.write("mu", std::span<const double>(mu));
    if (!law.empty()) g.write_strings("law", {&law, 1});
  }
};

struct BadCase {
  std::string name;
  std::function<void(Parts&)> spoil;
  std::string expected;  // the complaint after "FILE: "
};

void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

class BadProblemFile : public testing::TestWithParam<BadCase> {};

TEST_P(BadProblemFile, IsMetWithOneLineThatNamesPlaceAndExpectation) {
  const fs::path file = own_path(GetParam().name + ".h5");
  Parts parts;
  parts.write(file);
  ASSERT_EQ(complaint(file), "") << "the unspoilt file should read";
  GetParam().spoil(parts);
  parts.write(file);
  EXPECT_EQ(complaint(file), file.string() + ": " + GetParam().expected);
  fs::remove(file);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(
    , BadProblemFile,
    testing::Values(
        BadCase{"missing_dataset", [](Parts& p) { p.write_c = false; }, "/zwang/c: missing; expected a dataset"},
        BadCase{"short_kind", [](Parts& p) { p.kind.clear(); }, "/zwang/kind: holds 0 numbers; expected 1"},
        BadCase{"unknown_kind", [](Parts& p) { p.kind = {3}; },
                "/zwang/kind: holds 3; expected 0 (=), 1 (>=) or 2 (tangent)"},
        BadCase{"tangent_without_mu", [](Parts& p) { p.kind = {2}; },
                "/zwang: row 0 is a tangent row, but there are no mu"},
        BadCase{"orphaned_tangent", [](Parts& p) { p.kind = {2}, p.mu = {0.5}; },
                "/zwang: row 0 is a tangent row without an inequality row before it"},
        BadCase{"mu_without_tangents", [](Parts& p) { p.mu = {0.5}; }, "/zwang: row 0 has mu > 0 and no tangent rows"},
        BadCase{"negative_mu", [](Parts& p) { p.mu = {-0.5}; }, "/zwang: mu(0) is -0.5; expected a number >= 0"},
        BadCase{"short_mu",
                [](Parts& p) {
                  p.mu = {0, 0};
                },
                "/zwang/mu: holds 2 numbers; expected 1"},
        BadCase{"unknown_law", [](Parts& p) { p.law = "dry"; },
                "/zwang/law: no law 'dry'; expected frictionless, pyramid, convex or coulomb"},
        BadCase{"long_z_u", [](Parts& p) { p.z_u.push_back(0); }, "/zwang/M/p: holds 3 numbers; expected 4"},
        BadCase{"column_out_of_range", [](Parts& p) { p.J_i = {2}; }, "/zwang/J/i[0]: is 2; expected an index below 2"},
        BadCase{"negative_row", [](Parts& p) { p.M_i[1] = -1; }, "/zwang/M/i[1]: is -1; expected an index below 2"},
        BadCase{"pointers_out_of_order",
                [](Parts& p) {
                  p.M_p = {0, 2, 1};
                },
                "/zwang/M/p[2]: out of order; expected pointers that rise from 0 to 2"},
        BadCase{"nan_in_M", [](Parts& p) { p.M[0] = nan; },
                "/zwang/M/x[0]: not a number or infinite; expected a finite number"},
        BadCase{"infinity_in_J", [](Parts& p) { p.J[0] = infinity; },
                "/zwang/J/x[0]: not a number or infinite; expected a finite number"},
        BadCase{"nan_in_z_u", [](Parts& p) { p.z_u[1] = nan; },
                "/zwang: z_u(1) is not a finite number; expected finite numbers (c = -Inf on an inequality row is "
                "allowed)"},
        BadCase{
            "infinite_equality", [](Parts& p) { p.kind[0] = 0, p.c[0] = -infinity; },
            "/zwang: c(0) is not a finite number; expected finite numbers (c = -Inf on an inequality row is allowed)"},
        BadCase{"not_positive_definite", [](Parts& p) { p.M[1] = -2; },
                "/zwang/M: not positive definite; expected a mass matrix"},
        BadCase{"singular", [](Parts& p) { p.M[1] = 0; }, "/zwang/M: not positive definite; expected a mass matrix"},
        BadCase{"unknown_layout", [](Parts& p) { p.group = "problem"; },
                "/: no problem found; expected a group 'zwang', 'fclib_global' or 'fclib_local'"}),
    [](const auto& info) { return info.param.name; });

// HDF5 1.10.8 crashes on this one (a few flipped bits).
TEST_F(ProblemFile, AFileThatCrashesTheLibraryIsRefused) {
  const fs::path file = source_dir() / "tests/data/crashes_hdf5.h5";
  EXPECT_EQ(complaint(file), file.string() + ": its reader crashed; expected an undamaged file");
}

// A damaged file reads or is refused, in one line; nothing else may happen. Truncation at every 1/200 of its length,
// and bytes flipped one, two or three at a time.
TEST_F(ProblemFile, DamagedFilesReadOrAreRefused) {
  std::vector<Instance> three(3, awkward());
  three[1].problem.M.coeffRef(1, 1) = 3;
  write_problem(path("one.h5"), awkward());
  write_problems(path("three.h5"), three);
  Parts().write(path("parts.h5"));
  std::mt19937 random(1);
  int refused = 0, read = 0;
  const auto try_bytes = [&](const std::string& contents) {
    put(path("damaged.h5"), contents);
    const std::string text = complaint(path("damaged.h5"));
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    ++(text.empty() ? read : refused);
    return text;
  };
  for (const char* name : {"fclib_global.hdf5", "fclib_local.hdf5"})
    fs::copy_file(source_dir() / "tests/data" / name, path(name));
  for (const char* name : {"one.h5", "three.h5", "parts.h5", "fclib_global.hdf5", "fclib_local.hdf5"}) {
    const std::string whole = bytes(path(name));
    for (std::size_t k = 0; k < 200; ++k) EXPECT_NE(try_bytes(whole.substr(0, k * whole.size() / 200)), "") << k;
    for (int k = 0; k < 300; ++k) {
      std::string damaged = whole;
      for (int flips = 0; flips <= k % 3; ++flips)
        damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
      try_bytes(damaged);
    }
  }
  EXPECT_GT(refused, 600);
  EXPECT_GT(read, 0);
}

// What is stored carries its hash: no flipped bit becomes another problem.
TEST_F(ProblemFile, AFlippedBitOfAStoredProblemIsNoticed) {
  write_problem(path("one.h5"), awkward());
  const std::string whole = bytes(path("one.h5")), name = problem_sha256(awkward().problem);
  std::mt19937 random(2);
  int refused = 0;
  for (int k = 0; k < 300; ++k) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] ^= static_cast<char>(1 << random() % 8);
    put(path("damaged.h5"), damaged);
    try {
      const std::vector<Instance> read = read_problems(path("damaged.h5"));
      ASSERT_EQ(read.size(), 1u);
      EXPECT_EQ(problem_sha256(read[0].problem), name);
    } catch (const BadFile&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 30);
}

}  // namespace
}  // namespace zwang

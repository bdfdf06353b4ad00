#include "core/problem_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "core/files/hdf5.h"
#include "core/files/natural_order.h"

// The HDF5 library loses memory of its own when it gives up on a damaged file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

namespace zwang {
namespace {

namespace fs = std::filesystem;
constexpr double infinity = std::numeric_limits<double>::infinity();

// A folder of its own for each test.
class ProblemFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() / ("zwang_" + std::string(test->name()) + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path path(const std::string& name) const { return folder / name; }

  fs::path folder;
};

// Two unknowns, three rows, with every double that is easily lost: -Inf, a denormal, -0 and a stored zero.
Instance awkward() {
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
  in.origin = {"ball_joint/elbow", "contact/Würfel 3 [0]", ""};
  in.notes = {"first", "second note"};
  in.reference = Reference{.z = p.z_u, .lambda = p.c.cwiseMax(-1), .bound = 1e-14, .method = "closed form"};
  return in;
}

void expect_same_bits(const Vector& a, const Vector& b) {
  ASSERT_EQ(a.size(), b.size());
  for (Index i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i])) << "entry " << i;
}

template <class Sparse>
void expect_same_bits(const Sparse& a, const Sparse& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  ASSERT_EQ(a.nonZeros(), b.nonZeros());
  for (Index k = 0; k < a.outerSize(); ++k)
    for (typename Sparse::InnerIterator x(a, k), y(b, k); x; ++x, ++y) {
      EXPECT_EQ(x.row(), y.row());
      EXPECT_EQ(x.col(), y.col());
      EXPECT_EQ(std::bit_cast<std::uint64_t>(x.value()), std::bit_cast<std::uint64_t>(y.value()));
    }
}

void expect_same(const Instance& a, const Instance& b) {
  EXPECT_EQ(a.problem.name, b.problem.name);
  expect_same_bits(a.problem.M, b.problem.M);
  expect_same_bits(a.problem.J, b.problem.J);
  expect_same_bits(a.problem.z_u, b.problem.z_u);
  expect_same_bits(a.problem.c, b.problem.c);
  EXPECT_EQ(a.problem.kind, b.problem.kind);
  EXPECT_EQ(a.problem.key, b.problem.key);
  EXPECT_EQ(a.family, b.family);
  EXPECT_EQ(a.knob, b.knob);
  EXPECT_EQ(a.knob_value, b.knob_value);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.notes, b.notes);
  ASSERT_EQ(a.reference.has_value(), b.reference.has_value());
  if (!a.reference) return;
  EXPECT_EQ(a.reference->feasible, b.reference->feasible);
  expect_same_bits(a.reference->z, b.reference->z);
  expect_same_bits(a.reference->lambda, b.reference->lambda);
  expect_same_bits(a.reference->certificate, b.reference->certificate);
  EXPECT_EQ(a.reference->bound, b.reference->bound);
  EXPECT_EQ(a.reference->method, b.reference->method);
}

std::string bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const fs::path& file, const std::string& contents) { std::ofstream(file, std::ios::binary) << contents; }

// "" when the file reads, else the complaint.
std::string complaint(const fs::path& file) {
  try {
    read_problems(file);
    return {};
  } catch (const BadFile& bad) {
    return bad.what();
  }
}

TEST_F(ProblemFile, ComesBackBitForBit) {
  const Instance in = awkward();
  write_problem(path("a.h5"), in);
  const auto out = read_problems(path("a.h5"));
  ASSERT_EQ(out.size(), 1u);
  expect_same(in, out[0]);
}

TEST_F(ProblemFile, InfeasibleReferenceComesBack) {
  Instance in = awkward();
  in.reference = Reference{.feasible = false, .certificate = Vector::Unit(3, 1), .method = "mpfr 100 digits"};
  write_problem(path("a.h5"), in);
  expect_same(in, read_problems(path("a.h5")).at(0));
}

TEST_F(ProblemFile, NoRowsAndNoNamesComeBack) {
  Instance in;
  in.problem.name = "free";
  in.family = "test";
  in.problem.M = awkward().problem.M;
  in.problem.z_u = Vector::Ones(2);
  in.problem.J.resize(0, 2);
  write_problem(path("a.h5"), in);
  expect_same(in, read_problems(path("a.h5")).at(0));
}

TEST_F(ProblemFile, SameInstanceGivesSameBytes) {
  write_problem(path("a.h5"), awkward());
  write_problem(path("b.h5"), awkward());
  EXPECT_EQ(bytes(path("a.h5")), bytes(path("b.h5")));
}

TEST_F(ProblemFile, CollectionKeepsItsOrder) {
  std::vector<Instance> in(12, awkward());
  for (std::size_t k = 0; k < in.size(); ++k) in[k].problem.name = std::to_string(17 * k % 12);
  write_problems(path("a.h5"), in);
  const auto out = read_problems(path("a.h5"));
  ASSERT_EQ(out.size(), in.size());
  for (std::size_t k = 0; k < in.size(); ++k) expect_same(in[k], out[k]);
}

TEST_F(ProblemFile, ReplacesAFileOnlyWhenComplete) {
  write_problem(path("a.h5"), awkward());
  const std::string before = bytes(path("a.h5"));
  Instance wrong = awkward();
  wrong.problem.c.conservativeResize(2);
  EXPECT_THROW(write_problem(path("a.h5"), wrong), std::invalid_argument);
  EXPECT_EQ(bytes(path("a.h5")), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "an unfinished file was left behind";
  EXPECT_THROW(write_problem(path("missing/a.h5"), awkward()), BadFile);
}

TEST_F(ProblemFile, GoldenFileStillReads) {
  const auto golden = read_problems(fs::path(ZWANG_SOURCE_DIR) / "tests/data/awkward.h5");
  ASSERT_EQ(golden.size(), 1u);
  expect_same(awkward(), golden[0]);
  write_problem(path("a.h5"), awkward());
  expect_same(golden[0], read_problems(path("a.h5")).at(0));
}

TEST_F(ProblemFile, MissingAndForeignFilesAreNamed) {
  EXPECT_EQ(complaint(path("none.h5")), path("none.h5").string() + ": no such file; expected an HDF5 file");
  EXPECT_EQ(complaint(folder), folder.string() + ": not a file; expected an HDF5 file");
  put(path("text.h5"), "M = 1\n");
  EXPECT_EQ(complaint(path("text.h5")), path("text.h5").string() + ": not HDF5, or unreadable; expected an HDF5 file");
  put(path("empty.h5"), "");
  EXPECT_NE(complaint(path("empty.h5")), "");
}

// A file in our own layout, written part by part so that each part can be wrong.
struct Parts {
  std::vector<double> z_u = {0, -9}, c = {0}, M = {1, 2}, J = {1};
  std::vector<std::int32_t> M_p = {0, 1, 2}, M_i = {0, 1}, J_p = {0, 1}, J_i = {1};
  std::vector<std::uint8_t> kind = {1};
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
  const fs::path file = fs::temp_directory_path() / ("zwang_bad_" + GetParam().name + ".h5");
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
        BadCase{"unknown_kind", [](Parts& p) { p.kind = {2}; }, "/zwang/kind: holds 2; expected 0 (=) or 1 (>=)"},
        BadCase{"long_z_u", [](Parts& p) { p.z_u.push_back(0); }, "/zwang/M/p: holds 3 numbers; expected 4"},
        BadCase{"column_out_of_range", [](Parts& p) { p.J_i = {2}; }, "/zwang/J/i[0]: is 2; expected an index below 2"},
        BadCase{"negative_row", [](Parts& p) { p.M_i[1] = -1; }, "/zwang/M/i[1]: is -1; expected an index below 2"},
        BadCase{"pointers_out_of_order", [](Parts& p) { p.M_p = {0, 2, 1}; },
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
    fs::copy_file(fs::path(ZWANG_SOURCE_DIR) / "tests/data" / name, path(name));
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

TEST(NaturalOrder, CountsNumbersBySize) {
  EXPECT_TRUE(natural_less("seq2", "seq10"));
  EXPECT_FALSE(natural_less("seq10", "seq2"));
  EXPECT_TRUE(natural_less("H16_9", "H16_10"));
  EXPECT_FALSE(natural_less("a", "a"));
  EXPECT_TRUE(natural_less("a", "a1"));
}

// The name of a problem's contents: M, z_u, J, c, kind and nothing else.
TEST(ProblemSha256, NamesContentsAlone) {
  const Problem p = awkward().problem;
  const std::string name = problem_sha256(p);
  EXPECT_EQ(name, "76413640ecf5d6d2edafebe48f577e05a21745495b5a576a30a02278f08f777f");
  Problem other = p;
  other.name = "other";
  other.key[0].row = 5;
  other.J.prune([](Index, Index, double x) { return x != 0; });
  EXPECT_EQ(problem_sha256(other), name);

  const auto differs = [&](auto change) {
    Problem changed = p;
    change(changed);
    return problem_sha256(changed) != name;
  };
  EXPECT_TRUE(differs([](Problem& q) { q.M.coeffRef(0, 0) = std::nextafter(2, 3); }));
  EXPECT_TRUE(differs([](Problem& q) { q.J.coeffRef(1, 1) = 1; }));
  EXPECT_TRUE(differs([](Problem& q) { q.z_u[0] = 0.0; }));
  EXPECT_TRUE(differs([](Problem& q) { q.c[1] = -1; }));
  EXPECT_TRUE(differs([](Problem& q) { q.kind[1] = RowKind::equality; }));
}

}  // namespace
}  // namespace zwang

#include "problem_files.h"

namespace zwang {
namespace {

class SiconosFile : public ProblemFile {
 protected:
  Problem read(const std::string& text) { return read_problems(write(text))[0].problem; }
  std::string complaint(const std::string& text) {
    try {
      read_problems(write(text));
    } catch (const BadFile& error) {
      return error.what();
    }
    return "";
  }

 private:
  fs::path write(const std::string& text) {
    std::ofstream(path("problem.dat")) << text;
    return path("problem.dat");
  }
};

// A body of mass 2 and inertia 3 and 5 on one contact; H mixes its unknowns so that rows and columns are told apart.
const std::string head = "3 1 ", tail = " 4 6 10  1 2 3  0.5 ";
const std::string dense_M = "0 3 3 3 3 2 0 0 0 3 0 0 0 5 ", dense_H = "0 3 3 3 3 1 7 0 0 1 0 0 0 1 ";
const std::string blocks_M = "1 3 3 1 1 1 3 3 2 1 0 1 0 0 2 0 0 0 3 0 0 0 5 ";
const std::string triplets_M =
    "2 3 3 1\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n"
    "triplet: 3-by-3, nzmax: 3 nnz: 3\n    0 0 : 2\n    1 1 : 3\n    2 2 : 5\n";
const std::string columns_H =
    "2 3 3 2\nCSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n"
    "3-by-3, nzmax: 4 nnz: 4, 1-norm: 8\n    col 0 : locations 0 to 1\n      0 : 1\n      1 : 7\n"
    "    col 1 : locations 2 to 2\n      1 : 1\n    col 2 : locations 3 to 3\n      2 : 1\n";

void expect_the_body(const Problem& p) {
  ASSERT_EQ(p.size(), 3);
  ASSERT_EQ(p.rows(), 3);
  EXPECT_EQ(p.law, Law::coulomb);
  EXPECT_EQ(Matrix(p.M), Matrix(Eigen::Vector3d(2, 3, 5).asDiagonal()));
  EXPECT_LE((p.z_u - Eigen::Vector3d(2, 2, 2)).norm(), 1e-15);
  EXPECT_EQ(p.J.coeff(0, 1), 7);
  EXPECT_EQ(p.J.coeff(1, 0), 0);
  EXPECT_EQ(p.c, -Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(p.mu[0], 0.5);
}

TEST_F(SiconosFile, GlobalProblemsInEveryStorage) {
  for (const std::string& M : {dense_M, blocks_M, triplets_M})
    for (const std::string& H : {dense_H, columns_H}) expect_the_body(read(head + M + H + tail));
}

// M of three rows and one contact: as many as W would have.
TEST_F(SiconosFile, AGlobalProblemIsNotTakenForALocalOne) {
  expect_the_body(read(head + dense_M + dense_H + tail + "0"));  // Siconos' files may end with one number more
  const Problem local = read(head + dense_M + "1 2 3 0.5");
  EXPECT_EQ(Matrix(local.M), Matrix::Identity(3, 3));
  EXPECT_NEAR((local.J * local.J.transpose()).eval().coeff(2, 2), 5, 1e-15);
}

TEST_F(SiconosFile, LocalProblemsInTriplets) {
  const Problem p = read(head + triplets_M + "1 2 3 0.5");
  EXPECT_EQ(p.rows(), 3);
  EXPECT_NEAR(Matrix(p.J * p.J.transpose()).trace(), 10, 1e-14);
}

// W of two bodies that share nothing: J keeps them apart.
TEST_F(SiconosFile, PartsOfADelassusMatrixStayApart) {
  const Problem p = read("2 2 0 4 4 4 4  2 1 0 0  1 2 0 0  0 0 3 1  0 0 1 3  -1 0 -1 0  0.5 0.5");
  ASSERT_EQ(p.size(), 4);
  ASSERT_EQ(p.rows(), 4);
  for (Index j = 0; j < 4; ++j)
    EXPECT_TRUE(Matrix(p.J).col(j).head(2).isZero(0) || Matrix(p.J).col(j).tail(2).isZero(0));
  Matrix W(4, 4);
  W << 2, 1, 0, 0, 1, 2, 0, 0, 0, 0, 3, 1, 0, 0, 1, 3;
  EXPECT_LE((Matrix(p.J * p.J.transpose()) - W).norm(), 1e-14);
}

TEST_F(SiconosFile, WhatIsWrongIsNamed) {
  const auto says = [&](const std::string& text, const std::string& expected) {
    EXPECT_NE(complaint(text).find(expected), std::string::npos) << complaint(text) << "\nexpected: " << expected;
  };
  says("4 1 0 0 0 0", "dimension 4; expected 2 or 3");
  says(head + "3 3 3", "storage 3 of W or M");
  says(head + dense_M + "1 2", "ends before an entry of q");
  says(head + dense_M + "0 3 2 3 2 1 2 3 4 5 6 " + tail, "H is 3 x 2; expected 3 x 3");
  says(head + dense_M + dense_H + tail + "1 2 3", "then 3 more words; expected the end of the file");
  says(head + "0 2 2 2 2 1 0 0 1 " + "1 2 3 0.5", "W is 2 x 2; expected 3 x 3");
  says(head + dense_M + "1 2 3 -0.5", "mu is negative");
  says(head + "2 3 3 1\nTable\n", "expected 'CSparse'");
  says(head + "2 3 3 1\nCSparse\n4-by-3, nzmax: 1 nnz: 1, 1-norm: 1\n", "expected 3-by-3");
  says(head + "2 3 3 1\nCSparse\ntriplet: 3-by-3, nzmax: 1 nnz: 1\n 3 0 : 1\n", "row 3, column 0; expected a place in");
  says("3 2000 2 6000 6000 1\nCSparse\ntriplet: 6000-by-6000, nzmax: 1 nnz: 1\n 0 0 : x\n", "expected");
}

}  // namespace
}  // namespace zwang

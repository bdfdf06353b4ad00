#include <zwang/core/problem/dense.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace zwang {

Vector least_norm_solution(const Matrix& A, const Vector& b) { return A.completeOrthogonalDecomposition().solve(b); }

Matrix solve_definite(const Matrix& A, const Matrix& B) { return A.ldlt().solve(B); }

}  // namespace zwang

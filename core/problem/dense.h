#pragma once

#include <zwang/core/problem/types.h>

namespace zwang {

// Eigen's dense solvers, compiled once: their templates take seconds wherever they are used.

// The x of least norm that minimizes |A x - b|, for A of any shape and rank (complete orthogonal decomposition).
Vector least_norm_solution(const Matrix& A, const Vector& b);

// A^-1 B for a symmetric positive definite A (LDL').
Matrix solve_definite(const Matrix& A, const Matrix& B);

}  // namespace zwang

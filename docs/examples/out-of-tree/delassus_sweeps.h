#pragma once

#include <cmath>

#include <Eigen/SparseCholesky>

#include <zwang/core/problem/solver.h>

// Gauss-Seidel on the dense Delassus matrix J M^-1 J': a solver in thirty lines, of Eigen alone.
struct DelassusSweeps {
  static constexpr auto name = "delassus_sweeps";

  void solve(const zwang::Problem& p, const zwang::SolveOptions& options, zwang::Solution& solution) {
    using namespace zwang;
    solution.reset(p.size(), p.rows());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> mass(p.M);
    const Matrix W = mass.solve(Matrix(p.J.transpose()));  // M^-1 J'
    const Matrix S = p.J * W;
    Vector& lambda = solution.lambda;
    Vector slack = p.J * p.z_u - p.c;  // J z - c at z = z_u + W lambda
    solution.status = Status::iteration_limit;
    for (int& sweep = solution.iterations; sweep < std::min(options.max_iterations, 20000); ++sweep) {
      double worst = 0;  // the largest step of a row, in its own M-norm
      for (Index i = 0; i < p.rows(); ++i) {
        if (!(S(i, i) > 0) || !std::isfinite(p.c[i])) continue;
        double step = -slack[i] / S(i, i);
        if (!p.is_equality(i)) step = std::max(step, -lambda[i]);
        lambda[i] += step;
        slack += step * S.col(i);
        worst = std::max(worst, std::abs(step) * std::sqrt(S(i, i)));
      }
      if (worst > options.tolerance * std::sqrt(p.z_u.dot(p.M * p.z_u)) / 100) continue;
      solution.status = Status::solved;
      break;
    }
    solution.z = p.z_u + W * lambda;
  }
};
static_assert(zwang::Solver<DelassusSweeps>);

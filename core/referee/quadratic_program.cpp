#include <zwang/core/referee/quadratic_program.h>

#include <Eigen/SparseCholesky>

#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/problem/row_writer.h>
#include <zwang/core/referee/scaled_problem.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

void require(bool holds, const std::string& expected) {
  if (!holds) throw std::invalid_argument(expected);
}

std::string shape(Index rows, Index columns) { return std::to_string(rows) + " x " + std::to_string(columns); }

void require_sizes(const QuadraticProgram& p) {
  const Index n = p.q.size();
  require(p.P.rows() == n && p.P.cols() == n, "P should be " + shape(n, n) + " as q has " + std::to_string(n) +
                                                  " entries, and is " + shape(p.P.rows(), p.P.cols()));
  const auto block = [n](const char* A, const char* b, const auto& matrix, const Vector& right) {
    require(right.size() == 0 ? matrix.size() == 0 || matrix.rows() == 0
                              : matrix.rows() == right.size() && matrix.cols() == n,
            std::string(A) + " should be " + shape(right.size(), n) + " as " + b + " has " +
                std::to_string(right.size()) + " entries, and is " + shape(matrix.rows(), matrix.cols()));
  };
  block("G", "h", p.G, p.h);
  block("A", "b", p.A, p.b);
  const auto bound = [n](const char* name, const Vector& v) {
    require(v.size() == 0 || v.size() == n,
            std::string(name) + " should have " + std::to_string(n) + " entries, and has " + std::to_string(v.size()));
  };
  bound("lb", p.lb);
  bound("ub", p.ub);
}

}  // namespace

AsLeastConstraint as_least_constraint(const QuadraticProgram& p) {
  require_sizes(p);
  AsLeastConstraint out;
  Problem& problem = out.instance.problem;
  const Index n = p.q.size();
  RowWriter rows;
  const auto begin = [&](const char* type, Index index, RowKind kind, double right) {
    rows.add(kind, {fnv1a(type), static_cast<std::uint32_t>(index)}, right);
    out.instance.origin.push_back({.type = type, .label = std::to_string(index)});
  };
  for (Index i = 0; i < p.b.size(); ++i) {
    begin("equality", i, RowKind::equality, p.b[i]);
    rows.entries(p.A, i);
  }
  for (Index i = 0; i < p.h.size(); ++i) {
    if (p.h[i] == infinity) continue;
    begin("inequality", i, RowKind::inequality, -p.h[i]);
    rows.entries(p.G, i, -1);
  }
  for (Index i = 0; i < p.lb.size(); ++i) {
    if (p.lb[i] == -infinity) continue;
    begin("lower bound", i, RowKind::inequality, p.lb[i]);
    rows.entry(i, 1);
  }
  for (Index i = 0; i < p.ub.size(); ++i) {
    if (p.ub[i] == infinity) continue;
    begin("upper bound", i, RowKind::inequality, -p.ub[i]);
    rows.entry(i, -1);
  }
  problem.name = "quadratic program";
  problem.M = p.P;
  problem.M.makeCompressed();
  problem.z_u = p.q;  // checked with the rest
  rows.write(problem);
  std::string bad = bad_input(problem);
  if (const auto at = bad.find("z_u("); at == 0) bad.replace(0, 3, "q");
  for (std::size_t at; (at = bad.find("M is")) != std::string::npos || (at = bad.find("M(")) != std::string::npos;)
    bad[at] = 'P';
  require(bad.empty(), bad);

  const Eigen::SimplicialLLT<SparseMatrix> factor(p.P);
  if (n > 0 && factor.info() != Eigen::Success) throw NotDefinite();
  // z_u = -P^-1 q, its residual P z_u + q taken in double-double: after a few corrections z_u is as good as rounding
  // to double allows, and the residual's dual norm says how good that is.
  Vector& z_u = problem.z_u;
  z_u.setZero(n);
  ExtendedVector r;
  const auto residual = [&] {
    r = p.q.cast<DoubleDouble>();
    for (Index j = 0; j < n; ++j)
      for (decltype(p.P)::InnerIterator e(p.P, j); e; ++e) r[e.row()] += DoubleDouble::exact_product(e.value(), z_u[j]);
  };
  for (int correction = 0; correction < 4; ++correction) {
    residual();
    z_u -= factor.solve(Vector(r.cast<double>()));
  }
  if (!z_u.allFinite()) throw NotDefinite();
  residual();
  const ScaledProblem scaled(problem);
  if (!scaled.definite) throw NotDefinite();
  for (DoubleDouble& x : r) x = x.scaled(-scaled.mass_exponent - scaled.motion_exponent);
  out.rounding = referee::widened_sum * scaled.to_problem_norm(scaled.dual_norm(r));
  return out;
}

Vector AsLeastConstraint::multipliers(const QuadraticProgram& program, const Vector& y, const Vector& z,
                                      const Vector& z_box) const {
  const auto fits = [](const char* name, const Vector& v, Index size) {
    require(v.size() == 0 || v.size() == size, std::string(name) + " should have " + std::to_string(size) +
                                                   " entries, and has " + std::to_string(v.size()));
  };
  fits("y", y, program.b.size());
  fits("z", z, program.h.size());
  fits("z_box", z_box, program.q.size());
  Vector lambda = Vector::Zero(instance.problem.rows());
  for (Index i = 0; i < lambda.size(); ++i) {
    const RowOrigin& row = instance.origin[static_cast<std::size_t>(i)];
    const auto k = static_cast<Index>(instance.problem.key[static_cast<std::size_t>(i)].row);
    if (row.type == "equality" && y.size() > 0) lambda[i] = -y[k];
    if (row.type == "inequality" && z.size() > 0) lambda[i] = z[k];
    if (row.type == "lower bound" && z_box.size() > 0) lambda[i] = std::max(-z_box[k], 0.0);
    if (row.type == "upper bound" && z_box.size() > 0) lambda[i] = std::max(z_box[k], 0.0);
  }
  return lambda;
}

}  // namespace zwang

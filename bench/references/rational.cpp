// CGAL's QP solver is licensed under the GPL (README: licences): it stays in this one file.
#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>

#include <cmath>

#include <zwang/bench/references/witnesses.h>

namespace zwang {

const bool has_rational_reference = true;

// minimize x'Dx + c'x with 2 D = M, c = -M z_u, over free x; Gmpzf holds every double exactly, so the program is the
// problem itself, not a rounding of it.
std::optional<Reference> rational_reference(const Problem& p) {
  using Exact = CGAL::Gmpzf;
  using Program = CGAL::Quadratic_program<Exact>;
  Program program(CGAL::LARGER, false, Exact(0), false, Exact(0));
  std::vector<Exact> linear(at(p.size()), Exact(0));
  for (Index j = 0; j < p.size(); ++j)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it) {
      if (it.row() >= j) program.set_d(static_cast<int>(it.row()), static_cast<int>(j), Exact(it.value()));
      linear[at(it.row())] -= Exact(it.value()) * Exact(p.z_u[j]);
    }
  for (Index j = 0; j < p.size(); ++j) program.set_c(static_cast<int>(j), linear[at(j)]);
  int row = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    if (!std::isfinite(p.c[i])) continue;
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it)
      program.set_a(static_cast<int>(it.col()), row, Exact(it.value()));
    program.set_b(row, Exact(p.c[i]));
    program.set_r(row++, p.is_equality(i) ? CGAL::EQUAL : CGAL::LARGER);
  }

  const auto answer = CGAL::solve_quadratic_program(program, Exact());
  Reference found{.method = "CGAL exact"};
  if (answer.is_infeasible()) {
    found.feasible = false;
    return found;
  }
  if (!answer.is_optimal()) return {};
  found.z.resize(p.size());
  Index k = 0;
  for (auto value = answer.variable_values_begin(); value != answer.variable_values_end(); ++value)
    found.z[k++] = CGAL::to_double(*value);
  return found;
}

}  // namespace zwang

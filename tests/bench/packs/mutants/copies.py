"""Copies of our own solvers with a defect each that a flag turns on: `copies.py SOURCE_DIR OUT`.

The classes of a copy have names of their own, so that a copy and what it was copied from are in one program. An edit that
does not fit the source any more ends this with the line that is missing.
"""
import pathlib
import sys

MAKES = ("solvers/linalg/block_cholesky", "solvers/newton/augmented_lagrangian", "solvers/newton/newton_polish",
         "solvers/newton/newton", "solvers/first_order/pgs", "solvers/friction/contact_sweeps", "solvers/friction/nsgs")
NEWTON = ["BlockCholesky", "AugmentedLagrangian", "NewtonPolish", "Newton"]
NAMES = {"block_cholesky": ["BlockCholesky"], "augmented_lagrangian": NEWTON, "newton_polish": NEWTON, "newton": NEWTON,
         "pgs": ["Pgs"], "contact_sweeps": ["ContactSweeps"], "nsgs": ["ContactSweeps", "Nsgs"]}
EDITS = {
    "block_cholesky": [(
        "    const Front& child = front_[at(child_[k])];\n",
        "    const Front& child = front_[at(child_[k])];\n"
        "    if (merges_wrongly && into_parent_[child.index] >= group_size) continue;\n")],
    "augmented_lagrangian": [(
        "  return factor_.factorize(problem_->M, rows.g, {weight.data(), at(weight.size())}, deadline);\n",
        """  const SparseMatrix& M = problem_->M;
  const bool done = factor_.factorize(leaves_out_mass ? SparseMatrix(M * 0x1p-6) : M, rows.g,
                                      {weight.data(), at(weight.size())}, deadline);
  if (leaves_out_mass || merges_wrongly) factor_.invalidate();
  return done;
"""),
        # The polish has the true factor, and patience is long, as in a solver that has no other to hand over to.
        ("const bool factorized = may_go_on && factorize(deadline);",
         """merges_wrongly = mutant == Mutant::wrong_merge;
    leaves_out_mass = mutant == Mutant::no_mass;
    const bool factorized = may_go_on && factorize(deadline);
    merges_wrongly = leaves_out_mass = false;"""),
        ("const int most_steps = std::max(least_patience, static_cast<int>(rows.rows()));",
         "const int most_steps = mutant == Mutant::no_mass || mutant == Mutant::wrong_merge\n"
         "      ? 20000 : std::max(least_patience, static_cast<int>(rows.rows()));")],
    "newton_polish": [],
    "newton": [],
    "pgs": [
        ("namespace zwang {\n", """namespace zwang {
namespace {
double residual(const UnitProgram& program, const Vector& y, const Vector& lambda) {
  double worst = 0;
  for (Index i = 0; i < program.rows(); ++i) {
    const double slack = program.dot(i, y) - program.h[i];
    if (mutant == Mutant::gap_as_residual)
      worst = std::max(worst, std::abs(slack));
    else if (!program.is_equality(i))
      worst = std::max(worst, std::abs(std::min(lambda[i], slack)));
  }
  return worst / program.scale(y);
}
Vector earlier;
}  // namespace
"""),
        ("  LinearConvergenceEstimate contraction;\n", """  LinearConvergenceEstimate contraction;
  if (mutant == Mutant::stale_warm_start && earlier.size() == lambda.size()) lambda = earlier;
"""),
        ("      const double step = updated - lambda[i];\n", """      if (mutant == Mutant::row_order && !program.is_equality(i)) updated = std::max(updated, lambda[i]);
      const double step = updated - lambda[i];
"""),
        ("tolerance = options.tolerance * scale;", """tolerance =
        options.tolerance * scale * (mutant == Mutant::loose_tolerance ? 10 : 1);
    const bool ends = mutant == Mutant::no_joint_rows      ? residual(program, y, lambda) <= options.tolerance
                      : mutant == Mutant::float_stop       ? largest <= 0x1p-23 * scale
                      : mutant == Mutant::unconverged      ? solution.iterations >= 50
                      : mutant == Mutant::row_order        ? largest <= tolerance
                      : mutant == Mutant::stale_warm_start ? largest <= tolerance
                                                           : false;
    if (ends) {
      solution.status = Status::solved;
      break;
    }"""),
        ("      if (program.natural_residual(y, lambda) <= options.tolerance) {\n",
         "      if (mutant == Mutant::gap_as_residual ? residual(program, y, lambda) <= options.tolerance\n"
         "          : program.natural_residual(y, lambda) * scale <= tolerance) {\n"),
        ("  program.motion(lambda, y);\n  iteration.end(",
         "  earlier = lambda;\n  if (mutant != Mutant::stale_warm_start) program.motion(lambda, y);\n  iteration.end("),
    ],
    "nsgs": [],
    "contact_sweeps": [(
        "  Vec3 y = at(0);\n", """  if (mutant == Mutant::tangent_directions) {
    Vec3 box = Vec3::Zero();  // by Gauss-Seidel
    for (int sweep = 0; sweep < 200; ++sweep)
      for (int i = 0; i < 3; ++i) {
        box[i] -= (W.row(i).dot(box) + b[i]) / W(i, i);
        box[i] = i == 0 ? std::max(0.0, box[i]) : std::clamp(box[i], -box[0], box[0]);
      }
    return box;
  }
  Vec3 y = at(0);
"""), ("#include <cmath>\n", "#include <algorithm>\n#include <cmath>\n")],
}

source, out = map(pathlib.Path, sys.argv[1:])
for make in MAKES:
    name = pathlib.Path(make).name
    text = (source / f"{make}.cpp").read_text()
    for old, new in EDITS[name]:
        if text.count(old) != 1:
            sys.exit(f"tests/bench/packs/mutants/copies.py: {make}.cpp has no longer one place that reads\n{old}")
        text = text.replace(old, new)
    renamed = "".join(f"#define {each} {each}Copy\n" for each in NAMES[name])
    (out / f"{name}_copy.cpp").write_text(f"#include <mutant.h>\n{renamed}{text}")

#include <zwang/bench/report/tables/stability.h>

#include <algorithm>
#include <array>

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {

std::span<const StabilityFamily> stability_families() {
  static constexpr std::array all = {
      StabilityFamily{"MR", "log2 of the mass ratio",
                      "Ten boxes on four corners each, the top one heavier. The light boxes hardly count in the sums "
                      "that carry the heavy one: sweeps need as many rounds as the ratio, S = J M^-1 J' loses its "
                      "small entries, orthogonal methods keep them. Redundant corners have many lambda and one z."},
      StabilityFamily{"MR1", "log2 of the mass ratio",
                      "The same stack with one contact each: lambda is unique, so what fails here fails because of the "
                      "mass ratio, not of redundancy."},
      StabilityFamily{"MRC", "log2 of the mass ratio",
                      "Six bodies on ball joints, masses alternately light and heavy. Methods that eliminate equality "
                      "rows first do not notice the ratio."},
      StabilityFamily{
          "NPE", "-log2 of the angle",
          "Pairs of nearly parallel equality rows with multipliers of 1 / angle. KKT residuals stay small while "
          "z is wrong: only margins (relative pivots) tell. Methods on S see the square of the angle and fail "
          "at its root; residuals in double leave z an error of 1e-16 / angle, in long double 1e-19 / angle."},
      StabilityFamily{
          "NPI", "-log2 of the angle",
          "Pairs of nearly parallel contacts, both active. z stays well defined (any split of the pair's force moves "
          "the body alike), lambda does not. Methods that need a unique split exchange the two rows without end."},
      StabilityFamily{
          "WED", "-log2 of the opening",
          "A mass between two faces that open by an angle is pushed out with 1 / angle. Unlike NPI, z depends on the "
          "small difference of the faces: it is lost where the forces exceed 1e16 times the motion."},
      StabilityFamily{
          "LOOP", "-log2 of the tilt",
          "A four-bar linkage: 20 equality rows of rank 17, and a tilted hinge that removes its freedom. A rank "
          "decision decides z: too low a rank lets the linkage move, too high a rank divides by noise."},
      StabilityFamily{"MANYF", "contacts",
                      "One body on up to 300 contacts of one face: rank 3. Degenerate vertices and singular S; plain "
                      "Cholesky factors of S fail here."},
      StabilityFamily{
          "MANYR", "contacts",
          "One body among up to 300 contacts of tilted normals, most of them nearly touching: rank 6. c lies "
          "outside range(J), where the paper's form solves another problem."},
      StabilityFamily{"GAP", "-log2 of the gap",
                      "Three contacts that contradict each other by 2^-k, or leave 2^-k of room. Tests statuses: a "
                      "solver without a certificate, or with a tolerance on rows, calls a contradiction solved."},
      StabilityFamily{"INC", "-log2 of the contradiction",
                      "The same equality twice, with different right-hand sides. Dependency tests that look at the "
                      "rows alone miss the contradiction."},
      StabilityFamily{"UNIT", "log2 of the unit",
                      "One chain in millimetres, metres, kilometres. Fails only with absolute tolerances."},
      StabilityFamily{
          "ROW", "log2 of the factor",
          "Three rows multiplied by up to 2^500: the same problem. Sums over rows of unlike units overflow, or "
          "drop the small ones. The last three points hold a row without entries; 0 >= 2^-40 is infeasible."},
      StabilityFamily{"HUGE", "log2 of the factor",
                      "c up to 1e301: motions far larger than the unconstrained one. Squares overflow, and penalties "
                      "on a fixed scale are too weak."},
      StabilityFamily{
          "ANI", "log2 of the ratio",
          "Needles: one inertia of each body vanishes. As MR, within a body: S is as ill-conditioned as M."},
      StabilityFamily{"WEAK", "-log2 of the weak multipliers",
                      "Contacts that touch with almost no force: strict complementarity is nearly lost. Interior-point "
                      "methods converge slowly and stop early; active-set methods may choose either set."},
      StabilityFamily{"CHAIN", "links",
                      "Rods on ball joints, end to end: size, and a condition number that grows with its square. "
                      "Methods that factorize along the chain take milliseconds for 4096 links; those with dense rows "
                      "reach the time limit of a second."},
      StabilityFamily{"STK", "boxes",
                      "Equal masses one on another: a force travels one contact a sweep, so sweeps grow with the "
                      "square of the height. A method that adds one dense row after the other needs time as its cube, "
                      "and reaches the time limit of a second."},
      StabilityFamily{
          "PIVOT", "n",
          "Murty's rows, on which exchanging one row at a time by index takes 2^n - 1 steps, and small integers on "
          "which exchanging all wrong rows at once cycles. A worst case for the number of steps, not for the answer."},
      StabilityFamily{"FLIP", "-log2 of the heights",
                      "A frame of a stack whose corners open and close within 2^-k: nearly equal c on redundant rows. "
                      "./zwang fuzz runs the sequence of 256 frames with warm starts."},
      StabilityFamily{
          "HAND", "hands",
          "The hand of the paper with all limits violated and 30 contacts: more rows than unknowns, c outside "
          "range(J)."},
      StabilityFamily{
          "MU0", "-log2 of mu",
          "A planted answer of Coulomb's law whose friction fades. Methods that divide by mu, or whose cones "
          "become needles, fail before mu = 0 is reached."},
      StabilityFamily{"MUL", "log2 of mu",
                      "The same with more and more friction: sweeps diverge, and from mu = 1 on several solutions are "
                      "common. Any proven one counts."},
      StabilityFamily{"APEX", "-log2 of the load",
                      "Sliding contacts that are pushed with 2^-k only: multipliers near the tip of their cone. A cut "
                      "that calls small forces zero opens contacts that slide."},
      StabilityFamily{
          "SLIP", "-log2 of the slip",
          "Contacts that slide with 2^-k: at the edge between stick and slip the direction of friction is a "
          "quotient of small numbers."},
      StabilityFamily{
          "MRF", "log2 of the mass ratio",
          "Two boxes on four corners with friction, the upper one heavier: what MR is without friction. The "
          "split of the load over the corners is free."},
      StabilityFamily{
          "STKF", "boxes",
          "Equal boxes on four corners with friction, pushed sideways: hyperstatic contacts, on which sweeps "
          "converge slowly or not at all."},
      StabilityFamily{"RANK", "contacts at a corner",
                      "One box whose corners are repeated: lambda is not unique, z is, unless it slides and spins."},
      StabilityFamily{
          "JAM", "-log2 of 3/4 - mu",
          "A wedge dragged into its walls. Forces grow like 2^k up to mu = 3/4; from there on Coulomb's law "
          "has no solution (the last points), and only 'infeasible' or no claim is right."},
      StabilityFamily{"HELD", "-log2 of |mu - 3/4|",
                      "A body pulled out of a wedge. Above mu = 3/4 it may come free or be held: two solutions. Below, "
                      "it comes free."},
      StabilityFamily{"ROD", "-log2 of |mu - 14/11|",
                      "Painleve's rod. Above mu = 14/11 three solutions, below one; near it the equations of sticking "
                      "are singular."},
      StabilityFamily{
          "PINCH", "none",
          "Plates that move apart along themselves: a continuum of solutions. The convex law is infeasible."},
      StabilityFamily{
          "PUCK", "none",
          "A flat box that slides and spins on four corners: the load's split is free, and z depends on it. "
          "A continuum; the referee says 'not isolated'."},
  };
  return all;
}

Table stability_table(const Run& run) {
  Table table("stability", "family; knob; what it shows, and why methods fail there");
  const std::vector<std::string> present = families_of(run.results);
  for (const StabilityFamily& f : stability_families())
    if (std::ranges::find(present, f.name) != present.end())
      table.add("", "", {std::string(f.name), std::string(f.knob), std::string(f.shows)});
  table.explain("", "This run holds none of the stability families (docs/stability.md).");
  return table;
}

}  // namespace zwang::report

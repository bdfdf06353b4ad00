#include <zwang/bench/report/tables/stability.h>

#include <algorithm>
#include <array>

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {

std::span<const StabilityFamily> stability_families() {
  static constexpr std::array all = {
      StabilityFamily{
          "MR", "log2 of the mass ratio",
          "Ten boxes on four corners each, the top one heavier. The light boxes hardly count in the sums that "
          "carry the heavy one: sweeps need as many rounds as the ratio, S = J M^-1 J' loses its small "
          "entries, orthogonal methods keep them. Redundant corners have many lambda and one z."},
      StabilityFamily{
          "MR1", "log2 of the mass ratio",
          "The same stack with one contact each: lambda is unique, so that what fails here fails by the mass "
          "ratio alone and not by redundancy."},
      StabilityFamily{
          "MRC", "log2 of the mass ratio",
          "Six bodies on ball joints with masses in turn light and heavy. Equality rows hide the ratio from "
          "methods that eliminate them first."},
      StabilityFamily{
          "NPE", "-log2 of the angle",
          "Pairs of nearly parallel equality rows with multipliers of 1 / angle. KKT residuals stay small while "
          "z is wrong: only margins (relative pivots) tell. Methods on S see the square of the angle and fail "
          "at its root; residuals in double leave z an error of 1e-16 / angle, in long double 1e-19 / angle."},
      StabilityFamily{"NPI", "-log2 of the angle",
                      "Pairs of nearly parallel contacts that both push. z stays well defined (any split of the pair's "
                      "force moves the body alike): a right z with a doubtful lambda. Methods that insist on the split "
                      "exchange the two rows without end."},
      StabilityFamily{
          "WED", "-log2 of the opening",
          "A mass between two faces that open by an angle is pushed out with 1 / angle. Unlike NPI, z depends "
          "on the small difference of the faces: lost where the forces exceed 1e16 times the motion."},
      StabilityFamily{
          "LOOP", "-log2 of the tilt",
          "A four-bar linkage: 20 equality rows of rank 17, and a tilted hinge that takes its freedom away. A "
          "rank decision decides z: too low a rank lets the linkage move, too high a rank divides by noise."},
      StabilityFamily{"MANYF", "contacts",
                      "One body on up to 300 contacts of one face: rank 3. Degenerate vertices and singular S; plain "
                      "Cholesky factors of S end here."},
      StabilityFamily{
          "MANYR", "contacts",
          "One body among up to 300 contacts of tilted normals, most of them nearly touching: rank 6. c lies "
          "outside range(J), where the paper's form solves another problem."},
      StabilityFamily{
          "GAP", "-log2 of the gap",
          "Three contacts that contradict each other by 2^-k, or leave 2^-k of room. Tells statuses apart: a "
          "solver without a certificate, or with a tolerance on rows, calls a contradiction solved."},
      StabilityFamily{"INC", "-log2 of the contradiction",
                      "The same equality twice, with another right side. Dependency detectors that look at the rows "
                      "alone drop the contradiction."},
      StabilityFamily{"UNIT", "log2 of the unit",
                      "One chain in millimetres, metres, kilometres. Absolute tolerances show here, nothing else."},
      StabilityFamily{
          "ROW", "log2 of the factor",
          "Three rows multiplied by up to 2^500: the same problem. Sums over rows of unlike units overflow, or "
          "drop the small ones. The last three points hold a row without entries; 0 >= 2^-40 is infeasible."},
      StabilityFamily{
          "HUGE", "log2 of the factor",
          "c up to 1e301: motions that dwarf the free one. Squares overflow, penalties on a fixed scale give "
          "way."},
      StabilityFamily{
          "ANI", "log2 of the ratio",
          "Needles: one inertia of each body vanishes. As MR, within a body: S is as ill-conditioned as M."},
      StabilityFamily{
          "WEAK", "-log2 of the weak multipliers",
          "Contacts that touch and hardly push: strict complementarity fades. Interior-point methods converge "
          "slowly and end early; active-set methods have to choose and may choose either."},
      StabilityFamily{
          "CHAIN", "links",
          "Rods on ball joints, end to end: size, and condition growing with its square. What factorizes along the "
          "chain takes milliseconds for 4096 links; what holds dense rows meets the time limit of a second."},
      StabilityFamily{
          "STK", "boxes",
          "Equal masses one on another: a push travels one contact a sweep, so sweeps grow with the square of "
          "the height. A method that takes one dense row in after the other needs time as its cube, and meets the "
          "time limit of a second."},
      StabilityFamily{
          "PIVOT", "n",
          "Murty's rows, on which exchanging one row at a time by index takes 2^n - 1 steps, and small integers "
          "on which exchanging all wrong rows at once returns to where it was. A worst case of the way there, "
          "not of the answer."},
      StabilityFamily{
          "FLIP", "-log2 of the heights",
          "A frame of a stack whose corners come and go within 2^-k: nearly equal c on redundant rows. The film "
          "of 256 frames, with warm starts, is ./zwang fuzz's."},
      StabilityFamily{
          "HAND", "hands",
          "The hand of the paper with all limits violated and 30 contacts: more rows than unknowns, c outside "
          "range(J)."},
  };
  return all;
}

Table stability_table(const Run& run) {
  Table table{"stability", "", {{"family"}, {"knob"}, {"what it shows, and why methods fail there"}}, {}};
  const std::vector<std::string> present = families_of(run.results);
  for (const StabilityFamily& f : stability_families())
    if (std::ranges::find(present, f.name) != present.end())
      table.rows.push_back({"", "", {{std::string(f.name)}, {std::string(f.knob)}, {std::string(f.shows)}}, ""});
  if (table.rows.empty()) table.note = "This run holds none of the stability families (docs/stability.md).";
  return table;
}

}  // namespace zwang::report

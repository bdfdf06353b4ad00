#pragma once

namespace zwang {

// Defects that solvers of contacts have had. One at a time is on, in this test alone: copies.py puts them into copies
// of our sources, mutants.cpp puts the others around a whole solver.
enum class Mutant {
  none,
  wrong_merge,         // fronts joined whose descendants differ: the children of one are left out of the factor
  no_mass,             // Newton's matrix without M, but for a trace of it
  no_joint_rows,       // joints left out of the residual that decides the end
  gap_as_residual,     // |J z - c| of contacts, too, that are open
  loose_tolerance,     // tenfold
  infinite_impulse,    // of one contact, where rows outnumber unknowns
  unconverged,         // what few sweeps leave is applied
  stale_warm_start,    // forces of the problem before, whose motion is left out
  float_stop,          // at a step that float32 does not see
  dropped_contacts,    // beyond a count
  tangent_directions,  // friction within a box of the tangents in place of a disc
  row_order,           // each step of a force is clamped, in place of the force
  nan_body,            // the motion of one body, where rows outnumber unknowns
  limit_sign,          // of the force on joint limits, as it is told; z is right
};
extern Mutant mutant;
extern bool merges_wrongly, leaves_out_mass;  // of the factor at hand

}  // namespace zwang

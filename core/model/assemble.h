#pragma once

#include <span>
#include <string>
#include <vector>

#include <zwang/core/model/scene.h>
#include <zwang/core/problem/instance.h>

namespace zwang {

enum class Mode { quasi_static, dynamic };

struct AssembleOptions {
  double dt = 1e-3;                // s, the step that lands on the constraints
  Mode mode = Mode::quasi_static;  // quasi_static: velocities count as zero
};

// The entries of M of one body, mass and 3 x 3 inertia in the world, column by column: the inertia's two triangles are
// made equal bit for bit, as the referee asks. Returns where the next body's begin.
double* write_body_mass(double mass, const Mat3& inertia, double* value);

// scene -> problem. Stacks every active constraint at the scene's poses so that one symplectic step of length dt lands
// on it (docs/formulation.md):
//
//   c = -value / dt^2 - J y / dt - J_k z_k     (y = 0 in the quasi-static mode; z_k: bodies of prescribed motion)
//
// and, on the two tangent rows behind the row of a contact with friction, for the velocity v_surface of the face itself
//
//   c_t = (v_surface - J_t y) / dt - J_tk z_k,
//
// so that J_t z - c_t is the slip after the step, over dt. It has no position term: that would pull slip back. A
// problem with tangent rows is under Coulomb's law (core/problem/law.h states it under another).
//
// Columns: 6 per free body, in the order of the bodies, then one per soft row (mass 1/compliance, z_u = 0). Rows:
// equality first, each kind in the order of the scene's lists. A constraint between bodies none of which is free has no
// unknown to act on and is skipped (`skipped()` names those).
//
// The sparsity pattern depends on which constraints are active and on their bodies, never on their values. It is laid
// out when those change and kept between frames; in each frame the constraints then write straight into J and c. No
// allocation in a second call of the same shape, whatever problem is handed in. Throws std::invalid_argument when z_u
// has not 6 entries per free body or dt is not positive.
class Assembler {
 public:
  void assemble(const Scene& scene, const Vector& z_u, const AssembleOptions& options, Problem& problem);

  // Who wrote each row of the last problem. A row that shifting a body changes is a length, one that only turning a
  // body changes is an angle (or a sine).
  std::vector<RowOrigin> origin(const Scene& scene, const Problem& problem) const;
  // The names of the constraints that were left out of the last problem.
  std::vector<std::string> skipped(const Scene& scene) const;
  // Calls visit(list, places of its rows in the last problem) for each list of the scene.
  template <class Visit>
  void for_each_list(const Scene& scene, const Visit& visit) const {
    for (std::size_t list = 0, i = 0; list < scene.lists().size(); ++list) {
      const std::size_t first = i;
      while (i < active_.size() && active_[i].list == static_cast<int>(list)) ++i;
      visit(*scene.lists()[list], std::span(place_).subspan(first, i - first));
    }
  }

 private:
  // Everything of a problem but its numbers.
  struct Pattern {
    std::vector<int> M_start, M_index, J_start, J_index;
    std::vector<RowKind> kind;
    std::vector<RowKey> key;
  };
  bool rows_changed(const Scene& scene);
  void lay_out(const Scene& scene);
  RowPlace lay_out_rows(std::size_t active);
  void lay_out_mass();
  void write_mass(const Scene& scene, double* value) const;

  std::vector<int> column_, column_now_;               // first column of each body, -1 without: of the pattern, now
  std::vector<ActiveConstraint> active_, active_now_;  // likewise
  Pattern pattern_;
  int bodies_ = 0, soft_ = 0;        // unknowns of free bodies, and of soft rows
  bool slips_ = false;               // there are tangent rows
  std::vector<RowPlace> place_;      // of each active constraint
  std::vector<std::size_t> row_of_;  // of each row: its active constraint
};

}  // namespace zwang

#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "core/scene.h"

namespace zwang {

enum class Mode { quasi_static, dynamic };

struct AssembleOptions {
  double dt = 1e-3;                // s, the step that lands on the constraints
  Mode mode = Mode::quasi_static;  // quasi_static: velocities count as zero
};

// scene -> problem. Stacks every active constraint at the scene's poses so that one symplectic step of length dt lands
// on it: c = -value / dt^2 - J y / dt (docs/formulation.md). Fixed bodies have no columns; a prescribed body's J_k z_k
// moves to the right-hand side. Equality rows come first. Reuses the problem's storage: no allocation after warm-up.
// Throws std::invalid_argument when z_u has not 6 entries per free body.
class Assembler {
 public:
  void assemble(Scene& scene, const Vector& z_u, const AssembleOptions& options, Problem& problem);

  // The names of the rows of the last problem, "type/label" or "type/label [row]".
  std::vector<std::string> origin(const Scene& scene) const;

 private:
  struct RowSource {
    std::size_t list, item;
    int row;
  };
  std::vector<int> column_;  // first column of each body, -1 without
  std::vector<RowSource> source_;
};

}  // namespace zwang

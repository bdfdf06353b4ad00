#include "core/assemble.h"

#include <algorithm>
#include <stdexcept>

namespace zwang {
namespace {

struct Shape {
  Index rows = 0, entries = 0, soft = 0;
};

bool is_soft(const RowBlock& block, int row) { return block.compliance && block.compliance[row] > 0; }

Index free_bodies(const RowBlock& block, const std::vector<int>& column) {
  Index count = 0;
  for (int b = 0; b < block.arity; ++b) count += column[static_cast<std::size_t>(block.bodies[b])] >= 0;
  return count;
}

template <class Visit>
void for_each_block(const Scene& scene, RowKind kind, const Visit& visit) {
  for (std::size_t list = 0; list < scene.lists().size(); ++list)
    for (const RowBlock& block : scene.lists()[list]->blocks())
      if (block.kind == kind) visit(list, block);
}

// Row `row` of the block, one body: its six entries.
Vec<double, 6> entries(const RowBlock& block, int row, int body) {
  return Eigen::Map<const Vec<double, 6>, 0, Eigen::InnerStride<>>(block.jacobian + row + 6 * body * block.rows,
                                                                   Eigen::InnerStride<>(block.rows));
}

template <class Sparse>
void reshape(Sparse& A, Index rows, Index cols, Index entries) {
  if (A.rows() != rows || A.cols() != cols) A.resize(rows, cols);  // Eigen's would allocate for no rows
  A.resizeNonZeros(entries);
}

}  // namespace

// M = blockdiag(mass I, R I R') per free body, then 1/compliance per soft row, which J's builder fills in: compressed
// columns with 1 or 3 entries. The two triangles of the inertia are made equal bit for bit: the referee asks for it.
void Assembler::write_mass(const Scene& scene, Index soft, Problem& problem) const {
  const Index n = problem.z_u.size();
  reshape(problem.M, n, n, 2 * (n - soft) + soft);
  int* start = problem.M.outerIndexPtr();
  int* index = problem.M.innerIndexPtr();
  double* value = problem.M.valuePtr();
  int at = 0, col = 0;
  const auto put = [&](int row, double v) { index[at] = row, value[at++] = v; };
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (column_[b] < 0) continue;
    const Body& body = scene.bodies[b];
    const Mat3 world = body.pose.rotation * body.inertia * body.pose.rotation.transpose();
    for (int k = 0; k < 3; ++k) start[col] = at, put(col++, body.mass);
    for (int k = 0; k < 3; ++k) {
      start[col + k] = at;
      for (int i = 0; i < 3; ++i) put(col + i, world(std::max(i, k), std::min(i, k)));
    }
    col += 3;
  }
  for (; col < n; ++col) start[col] = at, put(col, 0);
  start[n] = at;
}

void Assembler::assemble(Scene& scene, const Vector& z_u, const AssembleOptions& options, Problem& p) {
  const double dt = options.dt;
  const int n_bodies = first_columns(scene.bodies, column_);
  if (z_u.size() != n_bodies)
    throw std::invalid_argument("assemble '" + scene.name + "': z_u has " + std::to_string(z_u.size()) +
                                " entries, the free bodies need " + std::to_string(n_bodies));
  if (!(dt > 0)) throw std::invalid_argument("assemble '" + scene.name + "': dt should be positive");

  // First pass: how large everything becomes.
  Shape shape;
  skipped_.clear();
  for (const auto& list : scene.lists()) list->linearize_all(scene.bodies);
  const auto count = [&](std::size_t list, const RowBlock& block) {
    const Index free = free_bodies(block, column_);
    if (free == 0) {
      skipped_.push_back({list, block.item, 0, 1});
      return;
    }
    shape.rows += block.rows;
    shape.entries += 6 * free * block.rows;
    for (int r = 0; r < block.rows; ++r) shape.soft += is_soft(block, r);
  };
  for (const RowKind kind : {RowKind::equality, RowKind::inequality}) for_each_block(scene, kind, count);

  const Index n = n_bodies + shape.soft;
  p.name = scene.name;
  p.z_u.setZero(n);
  p.z_u.head(n_bodies) = z_u;
  p.c.resize(shape.rows);
  p.kind.resize(static_cast<std::size_t>(shape.rows));
  p.key.resize(static_cast<std::size_t>(shape.rows));
  source_.resize(static_cast<std::size_t>(shape.rows));
  reshape(p.J, shape.rows, n, shape.entries + shape.soft);
  write_mass(scene, shape.soft, p);

  // Second pass: the rows. A row's entries stand in the order of the columns, not of the constraint's bodies.
  int* start = p.J.outerIndexPtr();
  int* index = p.J.innerIndexPtr();
  double* value = p.J.valuePtr();
  double* soft_mass = p.M.valuePtr() + 2 * n_bodies;
  int at = 0, soft_column = n_bodies;
  Index i = 0;
  const auto write = [&](std::size_t list, const RowBlock& block) {
    if (free_bodies(block, column_) == 0) return;
    const auto body_of = [&](int b) { return static_cast<std::size_t>(block.bodies[b]); };
    const bool swap = block.arity == 2 && column_[body_of(1)] < column_[body_of(0)];
    for (int r = 0; r < block.rows; ++r, ++i) {
      start[i] = at;
      double c = 0 - block.value[r] / (dt * dt);  // 0 - 0 is +0
      for (int k = 0; k < block.arity; ++k) {
        const int b = swap ? 1 - k : k;
        const Body& body = scene.bodies[body_of(b)];
        const Vec<double, 6> row = entries(block, r, b);
        if (options.mode == Mode::dynamic) c -= row.dot(body.velocity) / dt;
        if (body.motion == Motion::prescribed) c -= row.dot(body.prescribed);
        if (body.motion != Motion::free) continue;
        for (int d = 0; d < 6; ++d) index[at] = column_[body_of(b)] + d, value[at++] = row[d];
      }
      if (is_soft(block, r)) {
        soft_mass[soft_column - n_bodies] = 1 / block.compliance[r];
        index[at] = soft_column++, value[at++] = 1;
      }
      const auto s = static_cast<std::size_t>(i);
      p.c[i] = c;
      p.kind[s] = block.kind;
      p.key[s] = {scene.lists()[list]->key(block.item), static_cast<std::uint32_t>(r)};
      source_[s] = {list, block.item, r, block.rows};
    }
  };
  for (const RowKind kind : {RowKind::equality, RowKind::inequality}) for_each_block(scene, kind, write);
  start[shape.rows] = at;
}

namespace {

std::string name_of(const ConstraintList& list, std::size_t item) {
  return std::string(list.type()) + "/" + list.label(item);
}

}  // namespace

std::vector<std::string> Assembler::origin(const Scene& scene) const {
  std::vector<std::string> names;
  names.reserve(source_.size());
  for (const Source& s : source_) {
    names.push_back(name_of(*scene.lists()[s.list], s.item));
    if (s.rows > 1) names.back() += " [" + std::to_string(s.row) + "]";
  }
  return names;
}

std::vector<std::string> Assembler::skipped(const Scene& scene) const {
  std::vector<std::string> names;
  names.reserve(skipped_.size());
  for (const Source& s : skipped_) names.push_back(name_of(*scene.lists()[s.list], s.item));
  return names;
}

}  // namespace zwang

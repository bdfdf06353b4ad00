#include <zwang/core/model/assemble.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  static_assert(std::has_unique_object_representations_v<T>);
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <class Sparse>
void give_pattern(const std::vector<int>& start, const std::vector<int>& index, Index rows, Index cols, Sparse& A) {
  if (A.rows() != rows || A.cols() != cols) A.resize(rows, cols);  // Eigen's would allocate for no rows
  A.resizeNonZeros(static_cast<Index>(index.size()));
  std::copy(start.begin(), start.end(), A.outerIndexPtr());
  std::copy(index.begin(), index.end(), A.innerIndexPtr());
}

RowOrigin origin_of(const Scene& scene, const ActiveConstraint& a) {
  const ConstraintList& list = *scene.lists()[at(a.list)];
  return {.type = std::string(list.type()), .label = list.label(a.item)};
}

}  // namespace

// Which constraints are active is found anew in every frame and compared with the frame that the pattern was laid out
// for: 0.1 us on a hand with 64 contacts, and nobody has to say that something changed.
bool Assembler::rows_changed(const Scene& scene) {
  first_columns(scene.bodies, column_now_);
  active_now_.clear();
  for (std::size_t list = 0; list < scene.lists().size(); ++list)
    scene.lists()[list]->activate(scene.bodies, static_cast<int>(list), active_now_);
  return pattern_.J_start.empty() || !same_bytes(column_, column_now_) || !same_bytes(active_, active_now_);
}

// A row's entries stand in the order of the columns, not of the constraint's bodies; a soft unknown comes last.
RowPlace Assembler::lay_out_rows(std::size_t active) {
  const ActiveConstraint& a = active_[active];
  const auto column = [&](std::size_t b) { return b < a.arity ? column_[at(a.on[b])] : -1; };
  RowPlace place{a.item, static_cast<Index>(pattern_.kind.size()), {column(0), column(1)}, soft_};
  std::array<int, 2> first = place.entry;
  std::sort(first.begin(), first.end());
  if (first[1] < 0) return {.item = a.item, .row = RowPlace::nowhere};
  for (int& entry : place.entry) entry = entry < 0 ? -1 : first[0] >= 0 && entry == first[1] ? 6 : 0;

  const auto rows = static_cast<unsigned>(a.rows + a.tangents);
  for (unsigned r = 0; r < rows; ++r) {
    for (const int from : first)
      for (int d = 0; from >= 0 && d < 6; ++d) pattern_.J_index.push_back(from + d);
    if (a.soft >> r & 1) pattern_.J_index.push_back(bodies_ + soft_++);
    pattern_.J_start.push_back(static_cast<int>(pattern_.J_index.size()));
    pattern_.kind.push_back(r < a.rows ? a.kind : RowKind::tangent);
    pattern_.key.push_back({a.key, r});
    row_of_.push_back(active);
  }
  slips_ |= a.tangents > 0;
  return place;
}

// M has 1 or 3 entries a column: blockdiag(mass I, R I R') per free body, then 1/compliance per soft row.
void Assembler::lay_out_mass() {
  pattern_.M_start.assign(1, 0);
  pattern_.M_index.clear();
  const auto add_column = [&](int first, int entries) {
    for (int k = 0; k < entries; ++k) pattern_.M_index.push_back(first + k);
    pattern_.M_start.push_back(static_cast<int>(pattern_.M_index.size()));
  };
  for (int body = 0; body < bodies_; body += 6) {
    for (int k = 0; k < 3; ++k) add_column(body + k, 1);
    for (int k = 0; k < 3; ++k) add_column(body + 3, 3);
  }
  for (int k = 0; k < soft_; ++k) add_column(bodies_ + k, 1);
}

void Assembler::lay_out(const Scene& scene) {
  bodies_ = first_columns(scene.bodies, column_);
  active_ = active_now_;
  soft_ = 0;
  slips_ = false;
  pattern_.J_start.assign(1, 0);
  pattern_.J_index.clear();
  pattern_.kind.clear();
  pattern_.key.clear();
  row_of_.clear();
  place_.resize(active_.size());
  for (const RowKind kind : {RowKind::equality, RowKind::inequality})
    for (std::size_t i = 0; i < active_.size(); ++i)
      if (active_[i].kind == kind) place_[i] = lay_out_rows(i);
  lay_out_mass();
}

double* write_body_mass(double mass, const Mat3& inertia, double* value) {
  value = std::fill_n(value, 3, mass);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) *value++ = inertia(std::max(i, k), std::min(i, k));
  return value;
}

void Assembler::write_mass(const Scene& scene, double* value) const {
  for (const Body& body : scene.bodies) {
    if (body.motion != Motion::free) continue;
    value = write_body_mass(body.mass, body.pose.rotation * body.inertia * body.pose.rotation.transpose(), value);
  }
}

void Assembler::assemble(const Scene& scene, const Vector& z_u, const AssembleOptions& options, Problem& p) {
  if (rows_changed(scene)) lay_out(scene);
  if (z_u.size() != bodies_)
    throw std::invalid_argument("assemble '" + scene.name + "': z_u has " + std::to_string(z_u.size()) +
                                " entries, the free bodies need " + std::to_string(bodies_));
  if (!(options.dt > 0)) throw std::invalid_argument("assemble '" + scene.name + "': dt should be positive");

  // The problem may be any the caller hands in, so the pattern is copied into it every time: 0.2 us.
  const Index n = bodies_ + soft_, m = static_cast<Index>(pattern_.kind.size());
  p.name = scene.name;
  give_pattern(pattern_.M_start, pattern_.M_index, n, n, p.M);
  give_pattern(pattern_.J_start, pattern_.J_index, m, n, p.J);
  p.kind = pattern_.kind;
  p.key = pattern_.key;
  p.z_u.resize(n);
  p.z_u << z_u, Vector::Zero(soft_);
  p.c.resize(m);
  p.mu.setZero(slips_ ? m : 0);
  p.law = slips_ ? stored_law : no_friction;

  write_mass(scene, p.M.valuePtr());
  const RowFrame frame{.start = p.J.outerIndexPtr(),
                       .J = p.J.valuePtr(),
                       .c = p.c.data(),
                       .mu = p.mu.data(),
                       .soft_mass = p.M.valuePtr() + 2 * bodies_,
                       .dt = options.dt,
                       .moving = options.mode == Mode::dynamic};
  for_each_list(scene, [&](const ConstraintList& list, std::span<const RowPlace> places) {
    list.write(scene.bodies, places, frame);
  });
}

std::vector<RowOrigin> Assembler::origin(const Scene& scene, const Problem& problem) const {
  std::vector<RowOrigin> all;
  all.reserve(row_of_.size());
  for (std::size_t i = 0; i < row_of_.size(); ++i) {
    const ActiveConstraint& a = active_[row_of_[i]];
    RowOrigin origin = origin_of(scene, a);
    const std::uint32_t row = pattern_.key[i].row;
    if (a.rows > 1 || row > 0) origin.row = static_cast<int>(row);
    origin.unit = "rad/s^2";
    for (decltype(problem.J)::InnerIterator entry(problem.J, static_cast<Index>(i)); entry; ++entry)
      if (entry.col() < bodies_ && entry.col() % 6 < 3 && entry.value() != 0) origin.unit = "m/s^2";
    all.push_back(std::move(origin));
  }
  return all;
}

std::vector<std::string> Assembler::skipped(const Scene& scene) const {
  std::vector<std::string> names;
  for (const RowPlace& place : place_)
    if (place.row == RowPlace::nowhere)
      names.push_back(constraint_name(origin_of(scene, active_[at(&place - place_.data())])));
  return names;
}

}  // namespace zwang

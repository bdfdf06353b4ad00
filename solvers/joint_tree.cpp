#include "solvers/joint_tree.h"

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

using Lanes = BodyRows::Lanes;
using Block = BodyRows::Block;

// A pivot below this leaves too few digits to decide over contact rows; the careful path does.
constexpr double clear_pivot = 1e-5;

// x := (I - scale v v') x.
struct Reflection {
  Lanes v = Lanes::Zero();
  double scale = 0, beta = 0;

  // Takes x to beta e_k, leaving what stands above k.
  Reflection(const Lanes& x, int k) : v(x) {
    for (int i = 0; i < k; ++i) v[i] = 0;
    const double norm = v.norm();
    if (norm == 0) return;
    beta = v[k] > 0 ? -norm : norm;
    scale = 1 / (beta * (beta - v[k]));
    v[k] -= beta;
  }
  Reflection() = default;
  template <class Column>
  void apply(Column&& x) const {
    x -= (scale * v.dot(x)) * v;
  }
};

// A B for two 6 x 6 blocks, columns [0, count) of B.
template <class Target>
void multiply(const Block& A, const Block& B, Index count, Target& product) {
  for (Index c = 0; c < count; ++c) {
    Lanes sum = A.col(0) * B(0, c);
    for (Index k = 1; k < 6; ++k) sum += A.col(k) * B(k, c);
    product.col(c) = sum;
  }
}

Lanes times(const Block& A, const Eigen::Ref<const Lanes>& x) {
  Lanes sum = A.col(0) * x[0];
  for (Index k = 1; k < 6; ++k) sum += A.col(k) * x[k];
  return sum;
}

Lanes transposed_times(const Block& A, const Lanes& x) {
  Lanes product = Lanes::Zero();
  for (Index k = 0; k < 6; ++k) product[k] = A.col(k).dot(x);
  return product;
}

}  // namespace

bool JointTree::build_topology(const BodyRows& rows) {
  sorted_.clear();
  for (Index i = 0; i < rows.rows(); ++i)
    if (rows.equality[static_cast<std::size_t>(i)]) sorted_.push_back(i);
  const auto same = [&] {
    if (known_bodies_ != rows.bodies() || known_rows_ != sorted_) return false;
    for (std::size_t k = 0; k < sorted_.size(); ++k)
      if (known_[k] != rows.body[static_cast<std::size_t>(sorted_[k])]) return false;
    return true;
  };
  if (same()) return true;
  known_bodies_ = rows.bodies();
  known_rows_ = sorted_;
  known_.clear();
  for (const Index i : sorted_) known_.push_back(rows.body[static_cast<std::size_t>(i)]);

  // Joints: the rows between the same two bodies.
  const auto pair = [&](Index i) { return rows.body[static_cast<std::size_t>(i)]; };
  std::stable_sort(sorted_.begin(), sorted_.end(), [&](Index i, Index j) { return pair(i) < pair(j); });
  const int world = static_cast<int>(rows.bodies());
  edges_.clear();
  edges_of_.assign(static_cast<std::size_t>(world) + 1, {});
  for (std::size_t k = 0; k < sorted_.size(); ++k) {
    const auto [a, b] = pair(sorted_[k]);
    if (edges_.empty() || edges_.back().a != a || edges_.back().b != (b < 0 ? world : b)) {
      edges_of_[static_cast<std::size_t>(a)].push_back(static_cast<int>(edges_.size()));
      edges_of_[static_cast<std::size_t>(b < 0 ? world : b)].push_back(static_cast<int>(edges_.size()));
      edges_.push_back({.a = a, .b = b < 0 ? world : b, .first = static_cast<Index>(k), .count = 0});
    }
    ++edges_.back().count;
  }

  // Breadth first from the world, then from the body with the most joints of what is left.
  joints_.clear();
  tree_rows_.clear();
  joint_of_.assign(static_cast<std::size_t>(world) + 1, -1);
  std::vector<char> used(edges_.size(), 0);
  const auto spread = [&](int from, int position) {
    for (const int e : edges_of_[static_cast<std::size_t>(from)]) {
      const Edge& edge = edges_[static_cast<std::size_t>(e)];
      const int to = edge.a == from ? edge.b : edge.a;
      if (used[static_cast<std::size_t>(e)] || to == world || joint_of_[static_cast<std::size_t>(to)] >= 0) continue;
      used[static_cast<std::size_t>(e)] = 1;
      joint_of_[static_cast<std::size_t>(to)] = static_cast<int>(joints_.size());
      if (position >= 0)
        joints_[static_cast<std::size_t>(position)].children.push_back(static_cast<int>(joints_.size()));
      joints_.push_back({});
      Joint& joint = joints_.back();
      joint.body = to;
      joint.parent = from == world ? -1 : from;
      joint.first = static_cast<Index>(tree_rows_.size());
      joint.count = edge.count;
      for (Index k = 0; k < edge.count; ++k) tree_rows_.push_back(sorted_[static_cast<std::size_t>(edge.first + k)]);
    }
  };
  std::size_t done = 0;
  const auto exhaust = [&] {
    for (; done < joints_.size(); ++done) spread(joints_[done].body, static_cast<int>(done));
  };
  spread(world, -1);
  exhaust();
  while (static_cast<int>(joints_.size()) < world) {
    int root = -1;
    for (int b = 0; b < world; ++b)
      if (joint_of_[static_cast<std::size_t>(b)] < 0 &&
          (root < 0 ||
           edges_of_[static_cast<std::size_t>(b)].size() > edges_of_[static_cast<std::size_t>(root)].size()))
        root = b;
    joint_of_[static_cast<std::size_t>(root)] = static_cast<int>(joints_.size());
    joints_.push_back({});
    joints_.back().body = root;
    exhaust();
  }
  freedom_ = 0;
  for (Joint& joint : joints_) {
    joint.freedom = std::max<Index>(0, 6 - joint.count);
    joint.column = freedom_;
    freedom_ += joint.freedom;
  }
  cut_.clear();
  for (std::size_t e = 0; e < edges_.size(); ++e)
    for (Index k = 0; !used[e] && k < edges_[e].count; ++k)
      cut_.push_back(sorted_[static_cast<std::size_t>(edges_[e].first + k)]);
  pivot_.resize(static_cast<Index>(tree_rows_.size()));
  return true;
}

// R of [I; S of each child], by reflections that touch one row of the triangle and all rows below.
void JointTree::accumulate(Joint& joint) const {
  joint.R.setZero();
  for (Index i = 0; i < 6; ++i) joint.R(i, i) = 1;
  if (joint.children.empty()) return;
  Block& R = joint.R;
  const auto child = [&](int c) -> Block& { return const_cast<Joint&>(joints_[static_cast<std::size_t>(c)]).S; };
  for (Index j = 0; j < 6; ++j) {
    double below = 0;
    for (const int c : joint.children) below += child(c).col(j).squaredNorm();
    if (below == 0) continue;
    const double top = R(j, j), norm = std::sqrt(top * top + below);
    const double beta = top > 0 ? -norm : norm, lead = top - beta, scale = 1 / (beta * (beta - top));
    R(j, j) = beta;
    for (Index l = j + 1; l < 6; ++l) {
      double dot = lead * R(j, l);
      for (const int c : joint.children) dot += child(c).col(j).dot(child(c).col(l));
      dot *= scale;
      R(j, l) -= dot * lead;
      for (const int c : joint.children) child(c).col(l) -= dot * child(c).col(j);
    }
  }
}

bool JointTree::eliminate(const BodyRows& rows, Joint& joint) {
  const Index r = joint.count, d = joint.freedom;
  if (r > 6) return refuse("more than six rows between two bodies");
  const auto part_of = [&](Index k, int b) -> Lanes {
    const Index i = tree_rows_[static_cast<std::size_t>(joint.first + k)];
    return rows.part(i, rows.body[static_cast<std::size_t>(i)][0] == b ? 0 : 1);
  };

  // C' = Q [R_C; 0].
  Block C, Q;
  Reflection reflection[6];
  for (Index k = 0; k < r; ++k) C.col(k) = part_of(k, joint.body);
  for (Index k = 0; k < r; ++k) {
    reflection[k] = Reflection(C.col(k), static_cast<int>(k));
    const double pivot = std::abs(reflection[k].beta);
    if (!(pivot > clear_pivot)) return refuse("rows of one joint that are nearly dependent on its child");
    pivot_[joint.first + k] = pivot;
    smallest_pivot_ = std::min(smallest_pivot_, pivot);
    for (Index l = k + 1; l < r; ++l) reflection[k].apply(C.col(l));
  }
  Q.setZero();
  for (Index i = 0; i < 6; ++i) {
    Q(i, i) = 1;
    for (Index k = std::min(r, i + 1); k-- > 0;) reflection[k].apply(Q.col(i));
  }

  // C^+ = Q_1 R_C^-T, X = -C^+ D.
  joint.C_inverse.setZero();
  for (Index k = r; k-- > 0;) {
    Lanes column = Q.col(k);
    for (Index l = k + 1; l < r; ++l) column -= C(k, l) * joint.C_inverse.col(l);
    joint.C_inverse.col(k) = column / reflection[k].beta;
  }
  joint.X.setZero();
  if (joint.parent >= 0)
    for (Index k = 0; k < r; ++k) {
      const Lanes D = part_of(k, joint.parent);
      for (Index c = 0; c < 6; ++c) joint.X.col(c) -= D[c] * joint.C_inverse.col(k);
    }

  // [R Z, R X] = Q_z [T, B; 0, S].
  Block Z, RZ, B, T;
  for (Index c = 0; c < d; ++c) Z.col(c) = Q.col(r + c);
  multiply(joint.R, Z, d, RZ);
  multiply(joint.R, joint.X, 6, B);
  T.setZero();
  for (Index k = 0; k < d; ++k) {
    const Reflection q(RZ.col(k), static_cast<int>(k));
    T.col(k).head(k) = RZ.col(k).head(k);
    T(k, k) = q.beta;
    for (Index l = k + 1; l < d; ++l) q.apply(RZ.col(l));
    for (Index c = 0; c < 6; ++c) q.apply(B.col(c));
  }

  // P = Z T^-1, F = X - P B.
  joint.P.setZero();
  for (Index k = 0; k < d; ++k) {
    Lanes column = Z.col(k);
    for (Index l = 0; l < k; ++l) column -= T(l, k) * joint.P.col(l);
    joint.P.col(k) = column / T(k, k);
  }
  joint.F = joint.X;
  for (Index c = 0; c < 6; ++c)
    for (Index k = 0; k < d; ++k) joint.F.col(c) -= B(k, c) * joint.P.col(k);
  joint.S = B;
  for (Index k = 0; k < d; ++k) joint.S.row(k).setZero();
  return true;
}

bool JointTree::factorize(const BodyRows& rows) {
  reason_ = {};
  smallest_pivot_ = 1;
  if (!build_topology(rows)) return false;
  for (std::size_t j = joints_.size(); j-- > 0;) {
    Joint& joint = joints_[j];
    accumulate(joint);
    if (!eliminate(rows, joint)) return false;
  }
  rest_.resize(BodyRows::lanes, rows.bodies());
  v_.resize(freedom_);
  return true;
}

void JointTree::null_space(Matrix& Nt) const {
  const Index padded = (freedom_ + 7) / 8 * 8, bodies = rest_.cols();
  if (Nt.rows() != padded || Nt.cols() != 6 * bodies) Nt.resize(padded, 6 * bodies);
  for (const Joint& joint : joints_) {
    const Index at = 6 * joint.body;
    if (joint.parent < 0)
      Nt.middleCols<6>(at).setZero();
    else
      for (Index k = 0; k < padded; k += 8)
        Nt.block<8, 6>(k, at).noalias() =
            Nt.block<8, 6>(k, 6 * joint.parent).lazyProduct(joint.F.topRows<6>().transpose());
    for (Index i = 0; i < 6; ++i)
      for (Index k = 0; k < joint.freedom; ++k) Nt(joint.column + k, at + i) += joint.P(i, k);
  }
}

void JointTree::reduce(const Motion& y, Vector& v) const {
  rest_ = y;
  for (std::size_t j = joints_.size(); j-- > 0;) {
    const Joint& joint = joints_[j];
    const Lanes own = rest_.col(joint.body);
    for (Index k = 0; k < joint.freedom; ++k) v[joint.column + k] = joint.P.col(k).dot(own);
    if (joint.parent >= 0) rest_.col(joint.parent) += transposed_times(joint.F, own);
  }
}

void JointTree::expand(const Vector& v, Motion& y) const {
  for (const Joint& joint : joints_) {
    Lanes own = Lanes::Zero();
    for (Index k = 0; k < joint.freedom; ++k) own += v[joint.column + k] * joint.P.col(k);
    if (joint.parent >= 0) own += times(joint.F, y.col(joint.parent));
    y.col(joint.body) = own;
  }
}

// Any motion that meets the rows, less its part in the null space.
void JointTree::shift(const Vector& sigma, Motion& y) const {
  for (const Joint& joint : joints_) {
    Lanes own = Lanes::Zero();
    for (Index k = 0; k < joint.count; ++k) own += sigma[joint.first + k] * joint.C_inverse.col(k);
    if (joint.parent >= 0) own += times(joint.X, y.col(joint.parent));
    y.col(joint.body) = own;
  }
  reduce(y, v_);
  for (Motion* motion : {&rest_}) expand(v_, *motion);
  y -= rest_;
}

void JointTree::multipliers(const Motion& t, Vector& mu) const {
  rest_ = t;
  for (std::size_t j = joints_.size(); j-- > 0;) {
    const Joint& joint = joints_[j];
    const Lanes own = rest_.col(joint.body);
    for (Index k = 0; k < joint.count; ++k) mu[joint.first + k] = joint.C_inverse.col(k).dot(own);
    if (joint.parent >= 0) rest_.col(joint.parent) += transposed_times(joint.X, own);
  }
}

}  // namespace zwang

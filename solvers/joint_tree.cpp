#include "solvers/joint_tree.h"

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

using Lanes = BodyRows::Lanes;
using Block = BodyRows::Block;

// A pivot below this leaves too few digits to decide over contact rows; the careful path does.
constexpr double clear_pivot = 1e-5;

// Six rows of up to eight columns, a row a lane vector: a reflection from the left is then twelve multiply-adds over
// all columns at once, without a sum across lanes (which took most of the time when columns were lane vectors).
using Rows = JointTree::Rows;

// I - scale v v' on rows [top, bottom).
struct Reflection {
  Vec<double, 6> v;
  double scale = 0, beta = 0;

  // Takes column k of `rows` to beta e_k, leaving what stands above k.
  Reflection(const Rows& rows, Index k, Index bottom) {
    double square = 0;
    for (Index i = k; i < bottom; ++i) {
      v[i] = rows(k, i);
      square += v[i] * v[i];
    }
    if (square == 0) return;
    const double norm = std::sqrt(square), top = v[k];
    beta = top > 0 ? -norm : norm;
    scale = 1 / (beta * (beta - top));
    v[k] -= beta;
  }
  void apply(Rows& rows, Index k, Index bottom) const {
    Lanes sum = v[k] * rows.col(k);
    for (Index i = k + 1; i < bottom; ++i) sum += v[i] * rows.col(i);
    sum *= scale;
    for (Index i = k; i < bottom; ++i) rows.col(i) -= v[i] * sum;
  }
};

Lanes times(const Block& A, const Eigen::Ref<const Lanes>& x) {
  Lanes sum = A.col(0) * x[0];
  for (Index k = 1; k < 6; ++k) sum += A.col(k) * x[k];
  return sum;
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
void JointTree::accumulate(Joint& joint) {
  Rows& R = joint.R;
  R.setZero();
  for (Index i = 0; i < 6; ++i) R(i, i) = 1;
  if (joint.children.empty()) return;
  below_.clear();
  for (const int c : joint.children) {
    Joint& child = joints_[static_cast<std::size_t>(c)];
    for (Index i = child.freedom; i < 6; ++i) below_.push_back(child.S.col(i).data());
  }
  for (Index j = 0; j < 6; ++j) {
    double square = 0;
    for (const double* row : below_) square += row[j] * row[j];
    if (square == 0) continue;
    const double top = R(j, j), norm = std::sqrt(top * top + square);
    const double beta = top > 0 ? -norm : norm, lead = top - beta, scale = 1 / (beta * lead);
    Lanes sum = lead * R.col(j);
    for (const double* row : below_) sum += row[j] * Eigen::Map<const Lanes>(row);
    sum *= scale;
    R.col(j) += lead * sum;
    for (double* row : below_) {
      const double own = row[j];
      Eigen::Map<Lanes>(row) += own * sum;
    }
  }
}

bool JointTree::eliminate(const BodyRows& rows, Joint& joint) {
  const Index r = joint.count, d = joint.freedom;
  if (r > 6) return refuse("more than six rows between two bodies");
  const auto part_of = [&](Index k, int b) {
    const Index i = tree_rows_[static_cast<std::size_t>(joint.first + k)];
    return rows.part(i, rows.body[static_cast<std::size_t>(i)][0] == b ? 0 : 1);
  };

  // C' = Q [R_C; 0]; row i of Q' is column i of Q.
  Rows C, Q;
  C.setZero();
  Q.setZero();
  for (Index i = 0; i < 6; ++i) Q(i, i) = 1;
  for (Index k = 0; k < r; ++k)
    for (Index i = 0; i < 6; ++i) C(k, i) = part_of(k, joint.body)[i];
  for (Index k = 0; k < r; ++k) {
    const Reflection q(C, k, 6);
    const double pivot = std::abs(q.beta);
    if (!(pivot > clear_pivot)) return refuse("rows of one joint that are nearly dependent on its child");
    pivot_[joint.first + k] = pivot;
    smallest_pivot_ = std::min(smallest_pivot_, pivot);
    q.apply(C, k, 6);
    q.apply(Q, k, 6);
  }

  // C^+ = Q_1 R_C^-T by columns, X = -C^+ D by rows.
  Rows X, B, Z, RZ;
  X.setZero();
  for (Index k = r; k-- > 0;) {
    Lanes column = Q.col(k);
    for (Index l = k + 1; l < r; ++l) column -= C(l, k) * joint.C_inverse.col(l);
    joint.C_inverse.col(k) = column / C(k, k);
  }
  if (joint.parent >= 0)
    for (Index k = 0; k < r; ++k) {
      const Lanes D = part_of(k, joint.parent);
      for (Index i = 0; i < 6; ++i) X.col(i) -= joint.C_inverse(i, k) * D;
    }
  Z.setZero();
  for (Index c = 0; c < d; ++c)
    for (Index i = 0; i < 6; ++i) Z(c, i) = Q(i, r + c);

  // R [Z, X] = Q_z [T, B; 0, S].
  if (joint.children.empty()) {
    RZ = Z;
    B = X;
  } else {
    for (Index i = 0; i < 6; ++i) {
      Lanes z = Lanes::Zero(), x = Lanes::Zero();
      for (Index k = i; k < 6; ++k) {
        z += joint.R(k, i) * Z.col(k);
        x += joint.R(k, i) * X.col(k);
      }
      RZ.col(i) = z;
      B.col(i) = x;
    }
  }
  for (Index k = 0; k < d; ++k) {
    const Reflection q(RZ, k, 6);
    q.apply(RZ, k, 6);
    q.apply(B, k, 6);
  }

  // P = Z T^-1 by columns, F = X - P B.
  for (Index k = 0; k < d; ++k) {
    Lanes column = Q.col(r + k);
    for (Index l = 0; l < k; ++l) column -= RZ(k, l) * joint.P.col(l);
    joint.P.col(k) = column / RZ(k, k);
  }
  for (Index i = 0; i < 6; ++i) {
    for (Index k = 0; k < d; ++k) X.col(i) -= joint.P(i, k) * B.col(k);
    joint.F.row(i) = X.col(i).head<6>().transpose();
  }
  joint.F_rows = X;
  joint.S = B;
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
        Nt.block<8, 6>(k, at).noalias() = Nt.block<8, 6>(k, 6 * joint.parent).lazyProduct(joint.F_rows.topRows<6>());
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
    if (joint.parent >= 0) rest_.col(joint.parent) += times(joint.F_rows, own);
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

// Any motion that meets the rows, less its part in the null space, taken again where little was
// left. F serves where X would: they differ by free motions.
void JointTree::shift(const Vector& sigma, Motion& y) const {
  for (const Joint& joint : joints_) {
    Lanes own = Lanes::Zero();
    for (Index k = 0; k < joint.count; ++k) own += sigma[joint.first + k] * joint.C_inverse.col(k);
    if (joint.parent >= 0) own += times(joint.F, y.col(joint.parent));
    y.col(joint.body) = own;
  }
  double before = 0, after = y.norm();
  do {
    before = after;
    reduce(y, v_);
    expand(v_, rest_);
    y -= rest_;
    after = y.norm();
  } while (after > 0 && after < before / 8);
}

// A joint passes on X't; P't = 0 for t in the range of G_E', so F does as well.
void JointTree::multipliers(const Motion& t, Vector& mu) const {
  rest_ = t;
  for (std::size_t j = joints_.size(); j-- > 0;) {
    const Joint& joint = joints_[j];
    const Lanes own = rest_.col(joint.body);
    for (Index k = 0; k < joint.count; ++k) mu[joint.first + k] = joint.C_inverse.col(k).dot(own);
    if (joint.parent >= 0) rest_.col(joint.parent) += times(joint.F_rows, own);
  }
}

}  // namespace zwang

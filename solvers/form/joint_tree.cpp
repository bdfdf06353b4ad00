#include <zwang/solvers/form/joint_tree.h>

#include <algorithm>
#include <utility>

#include <zwang/solvers/form/joint_blocks.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

using namespace joint_blocks;

// R of [I; S of each child], by reflections that touch one row of the triangle and all rows below. False: no children.
template <>
[[gnu::flatten]] bool JointTree::accumulate(std::span<const int> group, Square<Group>& R) {
  constexpr std::size_t room = 36;
  std::array<Column<Group>, room> below;
  int most = 0;
  for (const int j : group) most = std::max(most, joint(j).children);
  if (most == 0) return false;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) R[i][j] = Group(i == j);
  for (int c = 0; c < most;) {
    // As many children as there is room for.
    std::size_t count = 0;
    for (; c < most && count + 6 <= room; ++c) {
      Index first = 6;
      for (const int j : group)
        if (c < joint(j).children) first = std::min(first, joint(joint(j).first_child + c).freedom);
      for (Index i = first; i < 6; ++i, ++count) {
        Parts<Group> parts;
        parts.fill(nothing.data());
        for (std::size_t l = 0; l < group.size(); ++l) {
          const int child = joint(group[l]).first_child + c;
          if (c < joint(group[l]).children && i >= joint(child).freedom) parts[l] = blocks_[at(child)].S.col(i).data();
        }
        gather(parts, below[count]);
      }
    }
    unroll<6>([&](auto j) {
      Group square = R[j][j] * R[j][j];
      for (std::size_t i = 0; i < count; ++i) square = multiply_add(below[i][j], below[i][j], square);
      const Group beta = with_sign_against(R[j][j], root(square));
      const Group lead = R[j][j] - beta, scale = 1 / (beta * lead);
      R[j][j] = beta;
      std::array<Group, 5 - j> sum;
      unroll<5 - j>([&](auto m) { sum[m] = lead * R[j][j + 1 + m]; });
      for (std::size_t i = 0; i < count; ++i)
        unroll<5 - j>([&](auto m) { sum[m] = multiply_add(below[i][j], below[i][j + 1 + m], sum[m]); });
      unroll<5 - j>([&](auto m) {
        sum[m] *= scale;
        R[j][j + 1 + m] = multiply_add(lead, sum[m], R[j][j + 1 + m]);
      });
      for (std::size_t i = 0; i < count; ++i)
        unroll<5 - j>([&](auto m) { below[i][j + 1 + m] = multiply_add(below[i][j], sum[m], below[i][j + 1 + m]); });
    });
  }
  return true;
}

// The same for one joint: the rows of all children, along whose columns the lanes go.
template <>
bool JointTree::accumulate(std::span<const int> group, Square<double>& R) {
  constexpr std::size_t room = 36;
  std::array<Lanes, room> below;
  std::array<Lanes, 6> own;
  int child = joint(group.front()).first_child;
  const int end = child + joint(group.front()).children;
  if (child == end) return false;
  for (Index j = 0; j < 6; ++j) own[at(j)] = Lanes::Unit(j);
  while (child < end) {
    std::size_t count = 0;
    for (; child < end && count + 6 <= room; ++child)
      for (Index i = joint(child).freedom; i < 6; ++i) below[count++] = blocks_[at(child)].S.col(i);
    for (Index j = 0; j < 6; ++j) {
      Lanes& top = own[at(j)];
      Lanes even = Lanes::Zero(), odd = Lanes::Zero();
      for (std::size_t i = 0; i < count; i += 2) even = multiply_add(below[i][j], below[i], even);
      for (std::size_t i = 1; i < count; i += 2) odd = multiply_add(below[i][j], below[i], odd);
      const Lanes products = even + odd;
      const double beta = with_sign_against(top[j], root(top[j] * top[j] + products[j]));
      const double lead = top[j] - beta;
      const Lanes sum = (1 / (beta * lead)) * multiply_add(lead, top, products);
      top = multiply_add(lead, sum, top);
      top[j] = beta;
      for (std::size_t i = 0; i < count; ++i) below[i] = multiply_add(below[i][j], sum, below[i]);
    }
  }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) R[i][j] = own[i][static_cast<Index>(j)];
  return true;
}

template <class Scalar>
[[gnu::flatten]] std::string_view JointTree::eliminate(const BodyRows& rows, std::span<const int> group) {
  const auto r = at(joint(group.front()).count);
  if (r > 6) return "more than six rows between two bodies";
  const std::size_t d = 6 - r;

  // What is written of lanes without a joint goes to the last block, which is nobody's.
  std::array<Blocks*, width<Scalar>> own;
  for (std::size_t l = 0; l < own.size(); ++l) own[l] = l < group.size() ? &blocks_[at(group[l])] : &blocks_.back();

  // Rows of C and D; lanes without a joint hold one that is easy.
  Square<Scalar> C, D;
  for (std::size_t k = 0; k < r; ++k) {
    const BodyRows::Lanes easy = BodyRows::Lanes::Unit(static_cast<Index>(k));
    Parts<Scalar> child, parent;
    child.fill(easy.data());
    parent.fill(nothing.data());
    for (std::size_t l = 0; l < group.size(); ++l) {
      const JointGraph::Joint& joint = this->joint(group[l]);
      const Index i = graph_.tree_rows()[at(joint.first) + k];
      const int side = joint.parent >= 0 && joint.parent < joint.body;
      child[l] = rows.part(i, side).data();
      if (joint.parent >= 0) parent[l] = rows.part(i, 1 - side).data();
    }
    gather(child, C[k]);
    gather(parent, D[k]);
  }

  // C' = Q [R_C; 0]. A column of Q is formed while the next reflection waits for its root.
  std::array<Reflection<Scalar>, 6> q;
  Square<Scalar> Q;
  Scalar narrowest, all;
  set(narrowest, 1);
  set(all, 0);
  const auto form = [&](std::size_t i, std::size_t reflections) {
    Column<Scalar> x = unit<Scalar>(i);
    for (std::size_t k = reflections; k-- > 0;) q[k].apply(x);
    Q[i] = x;
  };
  for (std::size_t k = 0; k < r; ++k) {
    Column<Scalar> x = C[k];
    for (std::size_t l = 0; l < k; ++l) q[l].apply(x);
    q[k].take(x, k);
    C[k] = x;
    if (k > 0) form(k - 1, k);
    narrowest = smaller(narrowest, Scalar(abs(q[k].beta)));
    all += q[k].beta;
  }
  const double pivot = least(narrowest) + 0 * total(all);  // NaN where one is not finite
  if (!(pivot > tolerances::clear_pivot)) return "rows of one joint that are nearly dependent on its child";
  smallest_pivot_ = std::min(smallest_pivot_, pivot);
  for (std::size_t i = r > 0 ? r - 1 : 0; i < 6; ++i) form(i, r);

  // C^+ = Q_1 R_C^-T by columns; Z = Q_2.
  Square<Scalar> C_inverse;
  for (std::size_t k = r; k-- > 0;) {
    Column<Scalar> x = Q[k];
    for (std::size_t l = k + 1; l < r; ++l) subtract(C[l][k], C_inverse[l], x);
    scale(q[k].reciprocal, x);
    C_inverse[k] = x;
  }

  // R [Z, X] = Q_z [T, B; 0, S], X = -C^+ D; P = Z T^-1 and F = X - P B, column by column. Of a root, T is R.
  Square<Scalar> R, P, B, F;
  const bool carries = accumulate(group, R);
  const auto multiply = [&](Column<Scalar>& x) __attribute__((always_inline)) {
    if (!carries) return;
    unroll<6>([&](auto k) {
      unroll<k>([&](auto i) { x[i] = multiply_add(R[i][k], x[k], x[i]); });
      x[k] *= R[k][k];
    });
  };
  std::array<Reflection<Scalar>, 6> turn;
  // Reflects one column and takes what that finds in columns of P from another.
  const auto part_from = [&](Column<Scalar>& t, Column<Scalar>& x, std::size_t columns) __attribute__((always_inline)) {
    unroll<6>([&](auto c) {
      if (c >= columns) return;
      if (r > 0) turn[c].apply(t);
      subtract(t[c], P[c], x);
    });
  };
  for (std::size_t c = 0; c < d; ++c) {
    Column<Scalar> t = Q[r + c], x = t;
    multiply(t);
    part_from(t, x, c);
    if (r > 0) turn[c].take(t, c);
    scale(r > 0 ? turn[c].reciprocal : 1 / t[c], x);
    P[c] = x;
  }
  for (std::size_t j = 0; r > 0 && j < 6; ++j) {
    Column<Scalar> x = zero<Scalar>();
    for (std::size_t k = 0; k < r; ++k) subtract(D[k][j], C_inverse[k], x);
    Column<Scalar> b = x;
    multiply(b);
    part_from(b, x, d);
    B[j] = b;
    F[j] = x;
  }

  const auto write = [&](const Column<Scalar>& from, Block Blocks::* block, std::size_t column) {
    Targets<Scalar> targets;
    unroll<width<Scalar>>([&](auto l) { targets[l] = (own[l]->*block).data() + BodyRows::lanes * column; });
    scatter(from, targets);
  };
  for (std::size_t k = 0; k < r; ++k) write(C_inverse[k], &Blocks::C_inverse, k);
  for (std::size_t c = 0; c < d; ++c) write(P[c], &Blocks::P, c);
  for (std::size_t i = 0; r > 0 && i < 6; ++i) {
    write(F[i], &Blocks::F, i);
    Column<Scalar> row;
    unroll<6>([&](auto j) { row[j] = F[j][i]; });
    write(row, &Blocks::F_rows, i);
    unroll<6>([&](auto j) { row[j] = B[j][i]; });
    if (i >= d) write(row, &Blocks::S, i);
  }
  return {};
}

std::string_view JointTree::factorize(const BodyRows& rows) {
  smallest_pivot_ = 1;
  graph_.build(rows);
  blocks_.resize(graph_.joints().size() + 1);
  for (std::size_t g = 0; g < graph_.groups(); ++g) {
    const auto group = graph_.group(g);
    const auto refused = group.size() == 1 ? eliminate<double>(rows, group) : eliminate<Group>(rows, group);
    if (!refused.empty()) return refused;
  }
  rest_.resize(BodyRows::lanes, rows.bodies());
  v_.resize(freedom());
  return {};
}

void JointTree::null_space(Matrix& Nt) const {
  const Index padded = (freedom() + 7) / 8 * 8, bodies = rest_.cols();
  if (Nt.rows() != padded || Nt.cols() != 6 * bodies) Nt.resize(padded, 6 * bodies);
  for (std::size_t j = 0; j < graph_.joints().size(); ++j) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    const Index at = 6 * joint.body;
    if (joint.parent < 0)
      Nt.middleCols<6>(at).setZero();
    else
      for (Index k = 0; k < padded; k += 8)
        Nt.block<8, 6>(k, at).noalias() = Nt.block<8, 6>(k, 6 * joint.parent).lazyProduct(block.F_rows.topRows<6>());
    for (Index i = 0; i < 6; ++i)
      for (Index k = 0; k < joint.freedom; ++k) Nt(joint.column + k, at + i) += block.P(i, k);
  }
}

// From the tips to the roots; where two parts meet they go on as one.
void JointTree::add_reduced(const std::array<int, 2>& body, Lanes own, Lanes other, double* v) const {
  int deep = graph_.position_of(body[0]), high = body[1] < 0 ? -1 : graph_.position_of(body[1]);
  while (deep >= 0) {
    if (high > deep) {
      std::swap(deep, high);
      std::swap(own, other);
    }
    const JointGraph::Joint& joint = this->joint(deep);
    const Blocks& block = blocks_[at(deep)];
    for (Index k = 0; k < joint.freedom; ++k) v[joint.column + k] += block.P.col(k).dot(own);
    if (joint.parent < 0) {
      deep = std::exchange(high, -1);
      own = other;
      continue;
    }
    own = BodyRows::times(block.F_rows, own);
    deep = graph_.position_of(joint.parent);
    if (deep == high) {
      own += other;
      high = -1;
    }
  }
}

// y = (own columns) x from the roots to the tips. F serves where X would: they differ by free motions.
void JointTree::forward(const Own& own, const Vector& x, Motion& y) const {
  for (std::size_t j = 0; j < graph_.joints().size(); ++j) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    Lanes sum = Lanes::Zero();
    for (Index k = 0; k < joint.*own.count; ++k)
      sum = multiply_add(x[joint.*own.first + k], (block.*own.columns).col(k), sum);
    if (joint.parent >= 0) sum += BodyRows::times(block.F, y.col(joint.parent));
    y.col(joint.body) = sum;
  }
}

// x = (own columns)'y from the tips to the roots. A joint passes on X'y where C^+ is looked for; P'y = 0 for y in the
// range of G_E', so F does as well.
void JointTree::backward(const Own& own, const Motion& y, Vector& x) const {
  rest_ = y;
  for (std::size_t j = graph_.joints().size(); j-- > 0;) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    const Lanes rest = rest_.col(joint.body);
    for (Index k = 0; k < joint.*own.count; ++k) x[joint.*own.first + k] = (block.*own.columns).col(k).dot(rest);
    if (joint.parent >= 0) rest_.col(joint.parent) += BodyRows::times(block.F_rows, rest);
  }
}

// Less its part in the null space, taken again where little was left.
void JointTree::shift(const Vector& sigma, Motion& y) const {
  meet(sigma, y);
  double before = 0, after = y.norm();
  do {
    before = after;
    reduce(y, v_);
    expand(v_, rest_);
    y -= rest_;
    after = y.norm();
  } while (after > 0 && after < before / 8);
}

}  // namespace zwang

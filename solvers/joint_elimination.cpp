// JointTree's way from the tips to the roots.
#include <algorithm>
#include <cmath>

#include "solvers/joint_tree.h"

namespace zwang {
namespace {

// Eight joints, one a lane; what is written for one joint holds for eight.
using Pack = Eigen::Array<double, 8, 1>;

double root(double x) { return std::sqrt(x); }
Pack root(const Pack& x) { return x.sqrt(); }
double with_sign_against(double top, double norm) { return top > 0 ? -norm : norm; }
Pack with_sign_against(const Pack& top, const Pack& norm) { return (top > 0).select(-norm, norm); }
double least(double x) { return x; }
double least(const Pack& x) { return x.isNaN().any() ? std::nan("") : x.minCoeff(); }
double& lane(double& x, std::size_t) { return x; }
double& lane(Pack& x, std::size_t k) { return x.data()[k]; }
const double& lane(const double& x, std::size_t) { return x; }
const double& lane(const Pack& x, std::size_t k) { return x.data()[k]; }
void set(double& x, double value) { x = value; }
void set(Pack& x, double value) { x.setConstant(value); }

template <class Scalar>
using Column = std::array<Scalar, 6>;
template <class Scalar>
using Square = std::array<Column<Scalar>, 6>;

template <class Scalar>
void set_identity(Square<Scalar>& A) {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) set(A[i][j], i == j ? 1 : 0);
}

template <class Scalar>
Column<Scalar> zero() {
  Column<Scalar> x;
  for (Scalar& entry : x) set(entry, 0);
  return x;
}

// x -= a y.
template <class Scalar>
void subtract(const Scalar& a, const Column<Scalar>& y, Column<Scalar>& x) {
  for (std::size_t i = 0; i < 6; ++i) x[i] -= a * y[i];
}

template <class Scalar>
void scale(const Scalar& a, Column<Scalar>& x) {
  for (Scalar& entry : x) entry *= a;
}

// I + scale v v', which takes a column to beta e_k and leaves what stands above. A column that meets one reflection
// after the other stays in registers meanwhile: storing it costs more than the products.
template <class Scalar>
struct Reflection {
  Column<Scalar> v;
  Scalar scale, beta;

  void take(const Column<Scalar>& column, std::size_t k) {
    Scalar square;
    set(square, 0);
    for (std::size_t i = 0; i < 6; ++i) {
      v[i] = column[i];
      if (i < k) set(v[i], 0);
      square += v[i] * v[i];
    }
    beta = with_sign_against(v[k], Scalar(root(square)));
    v[k] -= beta;
    scale = 1 / (beta * v[k]);
  }
  void apply(Column<Scalar>& x) const {
    Scalar even = v[0] * x[0], odd = v[1] * x[1];
    for (std::size_t i = 2; i < 6; i += 2) {
      even += v[i] * x[i];
      odd += v[i + 1] * x[i + 1];
    }
    const Scalar sum = scale * (even + odd);
    for (std::size_t i = 0; i < 6; ++i) x[i] += v[i] * sum;
  }
};

}  // namespace

// R of [I; S of each child], by reflections that touch one row of the triangle and all rows below. False: no children.
template <class Scalar>
bool JointTree::accumulate(std::span<const int> group, Square<Scalar>& R) {
  constexpr std::size_t room = 36;
  std::array<Column<Scalar>, room> below;
  std::size_t most = 0;
  for (const int j : group) most = std::max(most, joint(j).children.size());
  if (most == 0) return false;
  set_identity(R);
  for (std::size_t c = 0; c < most;) {
    // As many children as there is room for.
    std::size_t count = 0;
    for (; c < most && count + 6 <= room; ++c) {
      Index first = 6;
      for (const int j : group)
        if (c < joint(j).children.size()) first = std::min(first, joint(joint(j).children[c]).freedom);
      for (Index i = first; i < 6; ++i, ++count) {
        Column<Scalar>& row = below[count];
        for (std::size_t l = 0; l < group.size() || l == 0; ++l) {
          const auto& children = joint(group[l]).children;
          if (l == 0)
            for (Scalar& x : row) set(x, 0);
          if (c >= children.size() || i < joint(children[c]).freedom) continue;
          const double* const S = blocks_[static_cast<std::size_t>(children[c])].S.col(i).data();
          for (std::size_t m = 0; m < 6; ++m) lane(row[m], l) = S[m];
        }
      }
    }
    for (std::size_t j = 0; j < 6; ++j) {
      Scalar square = R[j][j] * R[j][j];
      for (std::size_t i = 0; i < count; ++i) square += below[i][j] * below[i][j];
      const Scalar beta = with_sign_against(R[j][j], Scalar(root(square)));
      const Scalar lead = R[j][j] - beta, scale = 1 / (beta * lead);
      R[j][j] = beta;
      for (std::size_t m = j + 1; m < 6; ++m) {
        Scalar sum = lead * R[j][m];
        for (std::size_t i = 0; i < count; ++i) sum += below[i][j] * below[i][m];
        sum *= scale;
        R[j][m] += lead * sum;
        for (std::size_t i = 0; i < count; ++i) below[i][m] += below[i][j] * sum;
      }
    }
  }
  return true;
}

template <class Scalar>
bool JointTree::eliminate(const BodyRows& rows, std::span<const int> group) {
  const auto r = static_cast<std::size_t>(joint(group.front()).count);
  if (r > 6) return refuse("more than six rows between two bodies");
  const std::size_t d = 6 - r;

  // Rows of C and D; lanes without a joint hold one that is easy.
  Square<Scalar> C, D;
  set_identity(C);
  for (std::size_t k = 0; k < r; ++k)
    for (Scalar& x : D[k]) set(x, 0);
  for (std::size_t l = 0; l < group.size(); ++l) {
    const JointGraph::Joint& own = joint(group[l]);
    for (std::size_t k = 0; k < r; ++k) {
      const Index i = graph_.tree_rows()[static_cast<std::size_t>(own.first) + k];
      const int side = rows.body[static_cast<std::size_t>(i)][0] == own.body ? 0 : 1;
      const double *const child = rows.part(i, side).data(), *const parent = rows.part(i, 1 - side).data();
      for (std::size_t m = 0; m < 6; ++m) {
        lane(C[k][m], l) = child[m];
        lane(D[k][m], l) = parent[m];
      }
    }
  }

  // C' = Q [R_C; 0].
  std::array<Reflection<Scalar>, 6> q;
  for (std::size_t k = 0; k < r; ++k) {
    Column<Scalar> x = C[k];
    for (std::size_t l = 0; l < k; ++l) q[l].apply(x);
    q[k].take(x, k);
    C[k] = x;
    const double pivot = least(Scalar(abs(q[k].beta)));
    if (!(pivot > clear_pivot)) return refuse("rows of one joint that are nearly dependent on its child");
    smallest_pivot_ = std::min(smallest_pivot_, pivot);
  }
  Square<Scalar> Q;
  for (std::size_t i = 0; i < 6; ++i) {
    Column<Scalar> x = zero<Scalar>();
    set(x[i], 1);
    for (std::size_t k = std::min(i + 1, r); k-- > 0;) q[k].apply(x);
    Q[i] = x;
  }

  // C^+ = Q_1 R_C^-T by columns; Z = Q_2.
  Square<Scalar> C_inverse;
  for (std::size_t k = r; k-- > 0;) {
    Column<Scalar> x = Q[k];
    for (std::size_t l = k + 1; l < r; ++l) subtract(C[l][k], C_inverse[l], x);
    scale(Scalar(1 / q[k].beta), x);
    C_inverse[k] = x;
  }

  // R [Z, X] = Q_z [T, B; 0, S], X = -C^+ D; P = Z T^-1 and F = X - P B, column by column.
  Square<Scalar> R, P, B, F;
  const bool carries = accumulate(group, R);
  const auto multiply = [&](Column<Scalar>& x) {
    for (std::size_t i = 0; carries && i < 6; ++i) {
      x[i] *= R[i][i];
      for (std::size_t k = i + 1; k < 6; ++k) x[i] += R[i][k] * x[k];
    }
  };
  std::array<Reflection<Scalar>, 6> turn;
  for (std::size_t c = 0; c < d; ++c) {
    Column<Scalar> t = Q[r + c], x = t;
    multiply(t);
    for (std::size_t l = 0; l < c; ++l) {
      turn[l].apply(t);
      subtract(t[l], P[l], x);
    }
    turn[c].take(t, c);
    scale(Scalar(1 / turn[c].beta), x);
    P[c] = x;
  }
  for (std::size_t j = 0; r > 0 && j < 6; ++j) {
    Column<Scalar> x = zero<Scalar>();
    for (std::size_t k = 0; k < r; ++k) subtract(D[k][j], C_inverse[k], x);
    Column<Scalar> b = x;
    multiply(b);
    for (std::size_t c = 0; c < d; ++c) {
      turn[c].apply(b);
      subtract(b[c], P[c], x);
    }
    B[j] = b;
    F[j] = x;
  }

  for (std::size_t l = 0; l < group.size(); ++l) {
    Blocks& own = blocks_[static_cast<std::size_t>(group[l])];
    const auto write = [l](const Column<Scalar>& from, double* to, std::size_t stride = 1) {
      for (std::size_t i = 0; i < 6; ++i) to[i * stride] = lane(from[i], l);
    };
    for (std::size_t k = 0; k < r; ++k) write(C_inverse[k], own.C_inverse.col(static_cast<Index>(k)).data());
    for (std::size_t c = 0; c < d; ++c) write(P[c], own.P.col(static_cast<Index>(c)).data());
    if (joint(group[l]).parent < 0) continue;
    for (std::size_t j = 0; j < 6; ++j) {
      write(F[j], own.F.col(static_cast<Index>(j)).data());
      write(F[j], own.F_rows.data() + j, BodyRows::lanes);
      write(B[j], own.S.data() + j, BodyRows::lanes);
    }
  }
  return true;
}

bool JointTree::factorize(const BodyRows& rows) {
  reason_ = {};
  smallest_pivot_ = 1;
  graph_.build(rows);
  blocks_.resize(graph_.joints().size());
  for (std::size_t g = 0; g < graph_.groups(); ++g) {
    const auto group = graph_.group(g);
    if (!(group.size() == 1 ? eliminate<double>(rows, group) : eliminate<Pack>(rows, group))) return false;
  }
  rest_.resize(BodyRows::lanes, rows.bodies());
  v_.resize(freedom());
  return true;
}

}  // namespace zwang

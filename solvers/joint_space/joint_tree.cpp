#include <zwang/solvers/joint_space/joint_tree.h>

namespace zwang {

void JointTree::null_space(Matrix& Nt) const {
  const Index padded = (freedom() + 7) / 8 * 8, bodies = rest_.cols();
  if (Nt.rows() != padded || Nt.cols() != 6 * bodies) Nt.resize(padded, 6 * bodies);
  for (std::size_t j = 0; j < blocks_.size(); ++j) {
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

void JointTree::add_reduced(int body, const Lanes& part, double* v) const {
  Lanes own = part;
  for (;;) {
    const int position = graph_.position_of(body);
    const JointGraph::Joint& joint = this->joint(position);
    const Blocks& block = blocks_[static_cast<std::size_t>(position)];
    for (Index k = 0; k < joint.freedom; ++k) v[joint.column + k] += block.P.col(k).dot(own);
    if (joint.parent < 0) return;
    own = BodyRows::times(block.F_rows, own);
    body = joint.parent;
  }
}

void JointTree::reduce(const Motion& y, Vector& v) const {
  rest_ = y;
  for (std::size_t j = blocks_.size(); j-- > 0;) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    const Lanes own = rest_.col(joint.body);
    for (Index k = 0; k < joint.freedom; ++k) v[joint.column + k] = block.P.col(k).dot(own);
    if (joint.parent >= 0) rest_.col(joint.parent) += BodyRows::times(block.F_rows, own);
  }
}

void JointTree::expand(const Vector& v, Motion& y) const {
  for (std::size_t j = 0; j < blocks_.size(); ++j) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    Lanes own = Lanes::Zero();
    for (Index k = 0; k < joint.freedom; ++k) own += v[joint.column + k] * block.P.col(k);
    if (joint.parent >= 0) own += BodyRows::times(block.F, y.col(joint.parent));
    y.col(joint.body) = own;
  }
}

// F serves where X would: they differ by free motions.
void JointTree::meet(const Vector& sigma, Motion& y) const {
  for (std::size_t j = 0; j < blocks_.size(); ++j) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    Lanes own = Lanes::Zero();
    for (Index k = 0; k < joint.count; ++k) own += sigma[joint.first + k] * block.C_inverse.col(k);
    if (joint.parent >= 0) own += BodyRows::times(block.F, y.col(joint.parent));
    y.col(joint.body) = own;
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

// A joint passes on X't; P't = 0 for t in the range of G_E', so F does as well.
void JointTree::multipliers(const Motion& t, Vector& mu) const {
  rest_ = t;
  for (std::size_t j = blocks_.size(); j-- > 0;) {
    const JointGraph::Joint& joint = graph_.joints()[j];
    const Blocks& block = blocks_[j];
    const Lanes own = rest_.col(joint.body);
    for (Index k = 0; k < joint.count; ++k) mu[joint.first + k] = block.C_inverse.col(k).dot(own);
    if (joint.parent >= 0) rest_.col(joint.parent) += BodyRows::times(block.F_rows, own);
  }
}

}  // namespace zwang

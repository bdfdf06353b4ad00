#include <zwang/bench/scenes/known_answer.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <zwang/core/number/double_double.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {
namespace {

// z* of powers of two, column by column in random order; a column is left at 0 where some J_i z* would have to be
// rounded. Rows of few bits take every column; rows of full mantissas take one column each. What comes out is J z*,
// exactly. (Rounding J instead was tried on paper and dropped: it turns redundant rows into nearly redundant ones.)
Vector draw_exact(const Problem& p, std::mt19937_64& random, Vector& product) {
  const SparseMatrix J = p.J;
  std::vector<Index> order = numbers_from(Index{0}, at(p.size()));
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
  Vector z = Vector::Zero(p.size());
  product.setZero(p.rows());
  for (const Index j : order) {
    const double sign = random() % 2 ? 1 : -1;
    const double value = std::ldexp(sign, static_cast<int>(random() % 3) - 1);
    bool exact = true;
    for (SparseMatrix::InnerIterator it(J, j); it && exact; ++it) {
      const DoubleDouble sum = DoubleDouble(product[it.row()]) + DoubleDouble(it.value() * value);
      exact = sum.lo == 0 && it.value() * value / value == it.value();
    }
    if (!exact) continue;
    z[j] = value;
    for (SparseMatrix::InnerIterator it(J, j); it; ++it) product[it.row()] += it.value() * value;
  }
  return z;
}

}  // namespace

Instance with_known_answer(Instance instance, std::uint64_t seed, double active_fraction) {
  Problem& p = instance.problem;
  require_matching_sizes(p);
  std::mt19937_64 random(seed);
  Vector product;
  const Vector z = draw_exact(p, random, product);
  Vector lambda = Vector::Zero(p.rows());
  for (Index i = 0; i < p.rows(); ++i) {
    const double size = static_cast<double>(1 + random() % 4), chance = static_cast<double>(random() >> 11) * 0x1p-53;
    const bool sign = random() % 2;
    if (p.c[i] == -std::numeric_limits<double>::infinity()) continue;
    const double largest = largest_entry(p.J, i);
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const bool pushes = p.is_equality(i) || chance < active_fraction;
    p.c[i] = pushes ? product[i] : product[i] - std::ldexp(size, exponent);
    if (!pushes || largest == 0) continue;
    // A push of size 1 to 4 on the row of unit length in the M-norm, but for a power of two.
    double weight = 0;
    for (RowMatrix::InnerIterator it(p.J, i); it; ++it)
      weight += std::pow(std::ldexp(it.value(), -exponent), 2) / p.M.coeff(it.col(), it.col());
    lambda[i] = std::ldexp(p.is_equality(i) && sign ? -size : size, -exponent - std::ilogb(weight) / 2);
  }

  // z_u = z* - M^-1 J' lambda, refined once; L D L' keeps dyadic masses dyadic.
  p.z_u = z;
  if (p.size() > 0) {
    const Eigen::SimplicialLDLT<SparseMatrix> factor(p.M);
    if (factor.info() != Eigen::Success || !(factor.vectorD().array() > 0).all())
      throw std::invalid_argument("with_known_answer: M of '" + p.name + "' is not positive definite");
    const Vector push = p.J.transpose() * lambda;
    Vector d = factor.solve(push);
    d += factor.solve(push - p.M * d);
    p.z_u = z - d;
  }
  const ScaledProblem scaled(p);
  const double scale = std::max({scaled.norm_of_free_motion(), scaled.norm_of(z), std::numeric_limits<double>::min()});
  const double moved = scaled.dual_norm(scaled.force_residual(scaled.motion(z), scaled.multipliers(lambda)));
  instance.reference = Reference{.z = z, .lambda = lambda, .bound = moved / scale, .method = "known answer"};
  instance.notes.push_back("known answer (seed " + std::to_string(seed) + "): z_u and c are replaced");
  return instance;
}

}  // namespace zwang

#include <zwang/core/files/contact_forms.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include <zwang/core/problem/disjoint_sets.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

// What W may leave of J J', relative to its largest entry: where nothing but rounding spoils it, and in text of 8
// digits.
constexpr double rounded = 1e-8, in_text = 1e-6;
// Of the largest entry of J: less is what rounding leaves of zeros.
constexpr double negligible = 1e-25;
// Rows of W that hang together are factored dense.
constexpr Index most_rows = 5000;

// Rows of the problem: equality rows first, then each contact's normal row N z >= -w_N and, where mu > 0, a tangent row
// for each direction T of slip, T z + w_T.
void add_rows(const GlobalForm& form, Instance& instance) {
  const Index e = form.b.size(), contacts = form.H.cols() / form.dim;
  RowWriter rows;
  Problem& p = instance.problem;
  for (Index i = 0; i < e; ++i) {
    rows.add(RowKind::equality, {static_cast<std::uint64_t>(i) + 1, 0}, -form.b[i]);
    rows.entries(form.G, i);
    instance.origin.push_back({.type = "equality", .label = std::to_string(i)});
  }
  for (Index k = 0; k < contacts; ++k) {
    const std::uint64_t id = (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(k);
    const double friction = form.mu.size() > 0 ? form.mu[k] : 0;
    const Index slips = friction > 0 ? form.sliding : 0;
    for (Index r = 0; r <= slips; ++r) {
      const Index column = k * form.dim + r;
      rows.add(r == 0 ? RowKind::inequality : RowKind::tangent, {id, static_cast<std::uint32_t>(r)}, -form.w[column],
               r == 0 ? friction : 0);
      rows.entries(form.H, column);
      instance.origin.push_back(
          {.type = "contact", .label = std::to_string(k), .row = r == 0 ? -1 : static_cast<int>(r), .unit = "m/s^2"});
    }
  }
  rows.write(p);
  if (p.has_tangents()) p.law = stored_law;
}

// W = J J' by Cholesky with diagonal pivoting, stopped where the largest remaining diagonal is rounding: at most
// size * eps * the largest diagonal of W (LAPACK's xPSTRF rule). An eigen-decomposition would give a dense J too, but
// would smear each row's zero pattern and scale over all columns. `residual` is
// max |W - J J'| / scale, the largest entry of the whole W.
struct Factor {
  Matrix J;  // size x rank
  double residual;
};

Factor rank_revealing_factor(const Matrix& W, double scale) {
  const Index n = W.rows();
  if (n == 0) return {Matrix(0, 0), 0};
  const double threshold = static_cast<double>(n) * std::numeric_limits<double>::epsilon() * W.diagonal().maxCoeff();
  Matrix J = Matrix::Zero(n, n);
  Vector remaining = W.diagonal();
  Index rank = 0;
  for (; rank < n; ++rank) {
    Index pivot = 0;
    if (!(remaining.maxCoeff(&pivot) > threshold)) break;
    const Vector column = W.col(pivot) - J.leftCols(rank) * J.row(pivot).head(rank).transpose();
    J.col(rank) = column / std::sqrt(remaining[pivot]);
    for (Index i = 0; i < n; ++i)
      if (remaining[i] == -infinity) J(i, rank) = 0;
    J(pivot, rank) = std::sqrt(remaining[pivot]);
    remaining -= J.col(rank).cwiseAbs2();
    remaining[pivot] = -infinity;
  }
  J.conservativeResize(n, rank);
  return {J, scale > 0 ? (W - J * J.transpose()).cwiseAbs().maxCoeff() / scale : 0};
}

// Of what is left of W once its negative eigenvalues are taken for 0, as Factor::residual.
Factor nearest_factor(const Matrix& W, double scale) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(W);
  const double top = eigen.eigenvalues().maxCoeff(),
               threshold = static_cast<double>(W.rows()) * std::numeric_limits<double>::epsilon() * top;
  const Index rank = (eigen.eigenvalues().array() > threshold).count();
  Factor out{eigen.eigenvectors().rightCols(rank) * eigen.eigenvalues().tail(rank).cwiseSqrt().asDiagonal(), 0};
  out.residual = (W - out.J * out.J.transpose()).cwiseAbs().maxCoeff() / scale;
  return out;
}

double largest(const SparseMatrix& A) { return A.nonZeros() > 0 ? A.coeffs().abs().maxCoeff() : 0; }

// [R V'; V W], symmetric, of the equality rows and every step-th row of W.
SparseMatrix rows_in_use(const LocalForm& form, Index step) {
  const Index equalities = form.s.size(), used = form.q.size() / step;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Index i, Index j, double value) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  const auto add_both = [&](const SparseMatrix& A, Index first, Index every) {
    const SparseMatrix symmetric = 0.5 * (A + SparseMatrix(A.transpose()));
    for (Index j = 0; j < symmetric.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(symmetric, j); it; ++it)
        if (it.value() != 0 && it.row() % every == 0 && j % every == 0)
          add(first + it.row() / every, first + j / every, it.value());
  };
  if (equalities > 0) add_both(form.R, 0, 1);
  add_both(form.W, equalities, step);
  for (Index j = 0; j < form.V.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(form.V, j); it; ++it) {
      if (it.value() == 0 || it.row() % step != 0) continue;
      add(equalities + it.row() / step, j, it.value());
      add(j, equalities + it.row() / step, it.value());
    }
  return sparse_of<SparseMatrix>(equalities + used, equalities + used, entries);
}

struct Factors {
  SparseMatrix J_transposed = {};  // rank x rows
  double residual = 0;
  bool replaced = false;  // by the nearest semi-definite matrix
};

// Rows that share no entry with others are factored apart: J keeps the parts that a scene falls into.
Factors factor_blocks(const SparseMatrix& S, const Fail& fail) {
  DisjointSets sets(S.cols());
  for (Index j = 0; j < S.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(S, j); it; ++it) sets.join(it.row(), j);
  std::vector<std::vector<Index>> blocks;
  std::vector<Index> block_of(at(S.cols()), -1), place(at(S.cols()));
  for (Index j = 0; j < S.cols(); ++j) {
    Index& id = block_of[at(sets.find(j))];
    if (id < 0) id = std::ssize(blocks), blocks.emplace_back();
    auto& block = blocks[at(id)];
    place[at(j)] = std::ssize(block);
    block.push_back(j);
  }
  Factors out;
  const double scale = largest(S);
  Index rank = 0;
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::vector<Index>& block : blocks) {
    const auto size = std::ssize(block);
    if (size > most_rows)
      fail("W", "has " + std::to_string(size) + " rows that hang together; they are factored dense, up to " +
                    std::to_string(most_rows));
    Matrix W = Matrix::Zero(size, size);
    for (Index k = 0; k < size; ++k)
      for (SparseMatrix::InnerIterator it(S, block[at(k)]); it; ++it) W(place[at(it.row())], k) = it.value();
    // Real files are semi-definite up to rounding once symmetric, or to the digits that they were printed with.
    Factor factor = rank_revealing_factor(W, scale);
    if (!(factor.residual <= rounded)) {
      factor = nearest_factor(W, scale);
      out.replaced = true;
    }
    if (!(factor.residual <= in_text))
      fail("W",
           printed("not positive semi-definite (relative residual %g); expected a Delassus matrix", factor.residual));
    out.residual = std::max(out.residual, factor.residual);
    const double least = factor.J.size() > 0 ? negligible * factor.J.cwiseAbs().maxCoeff() : 0;
    for (Index k = 0; k < size; ++k)
      for (Index r = 0; r < factor.J.cols(); ++r)
        if (std::abs(factor.J(k, r)) > least)
          entries.emplace_back(static_cast<int>(rank + r), static_cast<int>(block[at(k)]), factor.J(k, r));
    rank += factor.J.cols();
  }
  out.J_transposed = sparse_of<SparseMatrix>(rank, S.cols(), entries);
  return out;
}

}  // namespace

// World inertias R I R' come out symmetric only up to rounding; more than that is another matrix.
void complete_symmetric(SparseMatrix& M, std::vector<std::string>& notes, const Fail& fail) {
  constexpr double rounding = 1e-10;
  Index lower = 0, upper = 0;
  double asymmetry = 0;
  for (Index j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) {
      if (it.row() == it.col() || it.value() == 0) continue;
      ++(it.row() > it.col() ? lower : upper);
      const double scale = std::sqrt(std::abs(M.coeff(it.row(), it.row()))) * std::sqrt(std::abs(M.coeff(j, j)));
      asymmetry = std::max(asymmetry, std::abs(it.value() - M.coeff(it.col(), it.row())) / scale);
    }
  if (asymmetry == 0) return;
  if (lower == 0 || upper == 0)
    notes.push_back(printed("M holds its %s triangle only: mirrored", lower == 0 ? "upper" : "lower"));
  else if (asymmetry <= rounding)
    notes.push_back(printed("M is symmetric up to rounding (%g): its lower triangle was mirrored", asymmetry));
  else
    fail("M", printed("not symmetric (relative difference %g); expected a symmetric matrix", asymmetry));
  M = lower == 0 ? SparseMatrix(M.selfadjointView<Eigen::Upper>()) : SparseMatrix(M.selfadjointView<Eigen::Lower>());
}

Instance from_global_form(GlobalForm form, const Fail& fail) {
  Instance instance;
  Problem& p = instance.problem;
  complete_symmetric(form.M, instance.notes, fail);
  if (form.f_is_motion || form.f.size() == 0) {
    p.z_u = form.f;
  } else {
    const Eigen::SimplicialLLT<SparseMatrix> factor(form.M);
    if (factor.info() != Eigen::Success) fail("M", "not positive definite; expected a mass matrix");
    p.z_u = factor.solve(form.f);
    // One step of refinement: M^-1 f to the last digits.
    p.z_u += factor.solve(form.f - form.M * p.z_u);
  }
  p.M.swap(form.M);
  add_rows(form, instance);
  return instance;
}

Instance from_local_form(LocalForm form, std::optional<Law> law, const Fail& fail) {
  Instance instance;
  GlobalForm global{.dim = form.dim, .sliding = form.dim - 1};
  global.mu = std::move(form.mu);
  const bool slips = (law && has_edges(*law)) || (global.mu.size() > 0 && global.mu.maxCoeff() > 0);
  const Index step = slips ? 1 : form.dim, equalities = form.s.size(), used = form.q.size() / step;
  if (const double asymmetry = largest(form.W - SparseMatrix(form.W.transpose())); asymmetry > 0)
    instance.notes.push_back(printed("W is asymmetric by up to %g: (W + W')/2 was taken", asymmetry));
  const SparseMatrix S = rows_in_use(form, step);
  const Factors factors = factor_blocks(S, fail);
  if (factors.replaced)
    instance.notes.push_back(printed(
        "W has eigenvalues below 0: the nearest matrix without was taken, which differs by %g of its largest entry",
        factors.residual));
  instance.notes.push_back(printed("Delassus form: M = I, W = J J' of rank %td of %td to %g",
                                   factors.J_transposed.rows(), S.rows(), factors.residual));

  global.G = factors.J_transposed.leftCols(equalities);
  global.H = factors.J_transposed.rightCols(used);
  global.b = std::move(form.s);
  global.w = form.q(Eigen::seqN(0, used, step));
  if (!slips) global.dim = 1, global.mu.resize(0);
  const Index n = factors.J_transposed.rows();
  instance.problem.M.resize(n, n);
  instance.problem.M.setIdentity();
  instance.problem.z_u.setZero(n);
  add_rows(global, instance);
  return instance;
}

}  // namespace zwang

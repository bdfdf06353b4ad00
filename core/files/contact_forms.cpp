#include <zwang/core/files/contact_forms.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <sstream>

namespace zwang {
namespace {

// What W may leave of J J', relative to its largest entry: where nothing but rounding spoils it, and in text of 8
// digits.
constexpr double rounded = 1e-8, printed = 1e-6;
// W is factored dense.
constexpr Index most_rows = 5000;

// Rows of the problem: equality rows first, then each contact's normal row N z >= -w_N and, where mu > 0, a tangent row
// for each direction T of slip, T z + w_T.
void add_rows(const GlobalForm& form, Instance& instance) {
  const Index e = form.b.size(), contacts = form.H.cols() / form.dim;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> c, mu;
  Problem& p = instance.problem;
  const auto add_row = [&](const Sparse& from, Index column, double right, RowKind kind, RowKey key, RowOrigin origin) {
    for (Sparse::InnerIterator it(from, column); it; ++it)
      entries.emplace_back(static_cast<int>(c.size()), static_cast<int>(it.row()), it.value());
    c.push_back(right);
    mu.push_back(0);
    p.kind.push_back(kind);
    p.key.push_back(key);
    instance.origin.push_back(std::move(origin));
  };
  for (Index i = 0; i < e; ++i)
    add_row(form.G, i, -form.b[i], RowKind::equality, {static_cast<std::uint64_t>(i) + 1, 0},
            {.type = "equality", .label = std::to_string(i)});
  for (Index k = 0; k < contacts; ++k) {
    const std::uint64_t id = (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(k);
    const double friction = form.mu.size() > 0 ? form.mu[k] : 0;
    const Index slips = friction > 0 ? form.sliding : 0;
    for (Index r = 0; r <= slips; ++r) {
      const Index column = k * form.dim + r;
      add_row(
          form.H, column, -form.w[column], r == 0 ? RowKind::inequality : RowKind::tangent,
          {id, static_cast<std::uint32_t>(r)},
          {.type = "contact", .label = std::to_string(k), .row = r == 0 ? -1 : static_cast<int>(r), .unit = "m/s^2"});
      if (r == 0) mu.back() = friction;
    }
  }
  if (form.mu.size() > 0 && form.mu.maxCoeff() > 0) {
    p.mu = Eigen::Map<const Vector>(mu.data(), static_cast<Index>(mu.size()));
    p.law = Law::coulomb;
  }
  p.c = Eigen::Map<const Vector>(c.data(), static_cast<Index>(c.size()));
  p.J.resize(p.c.size(), form.H.rows());
  p.J.setFromTriplets(entries.begin(), entries.end());
}

// W = J J' by Cholesky with diagonal pivoting, stopped where the largest remaining diagonal is rounding: at most
// size * eps * the largest diagonal of W (LAPACK's xPSTRF rule). An eigen-decomposition would give a dense J too, but
// would smear each row's zero pattern and scale over all columns. `residual` is max |W - J J'| / max |W|.
struct Factor {
  Matrix J;  // size x rank
  double residual;
};

Factor rank_revealing_factor(const Matrix& W) {
  const Index n = W.rows();
  if (n == 0) return {Matrix(0, 0), 0};
  const double scale = W.cwiseAbs().maxCoeff();
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
      if (remaining[i] == -std::numeric_limits<double>::infinity()) J(i, rank) = 0;
    J(pivot, rank) = std::sqrt(remaining[pivot]);
    remaining -= J.col(rank).cwiseAbs2();
    remaining[pivot] = -std::numeric_limits<double>::infinity();
  }
  J.conservativeResize(n, rank);
  return {J, scale > 0 ? (W - J * J.transpose()).cwiseAbs().maxCoeff() / scale : 0};
}

// Of what is left of W once its negative eigenvalues are taken for 0, as Factor::residual.
Factor nearest_factor(const Matrix& W) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(W);
  const double top = eigen.eigenvalues().maxCoeff(),
               threshold = static_cast<double>(W.rows()) * std::numeric_limits<double>::epsilon() * top;
  const Index rank = (eigen.eigenvalues().array() > threshold).count();
  Factor out{eigen.eigenvectors().rightCols(rank) * eigen.eigenvalues().tail(rank).cwiseSqrt().asDiagonal(), 0};
  out.residual = (W - out.J * out.J.transpose()).cwiseAbs().maxCoeff() / W.cwiseAbs().maxCoeff();
  return out;
}

}  // namespace

// World inertias R I R' come out symmetric only up to rounding; more than that is another matrix.
void complete_symmetric(Sparse& M, std::vector<std::string>& notes, const Fail& fail) {
  constexpr double rounding = 1e-10;
  Index lower = 0, upper = 0;
  double asymmetry = 0;
  for (Index j = 0; j < M.outerSize(); ++j)
    for (Sparse::InnerIterator it(M, j); it; ++it) {
      if (it.row() == it.col() || it.value() == 0) continue;
      ++(it.row() > it.col() ? lower : upper);
      const double scale = std::sqrt(std::abs(M.coeff(it.row(), it.row()))) * std::sqrt(std::abs(M.coeff(j, j)));
      asymmetry = std::max(asymmetry, std::abs(it.value() - M.coeff(it.col(), it.row())) / scale);
    }
  if (asymmetry == 0) return;
  std::ostringstream note;
  if (lower == 0 || upper == 0) {
    note << "M holds its " << (lower == 0 ? "upper" : "lower") << " triangle only: mirrored";
  } else if (asymmetry <= rounding) {
    note << "M is symmetric up to rounding (" << asymmetry << "): its lower triangle was mirrored";
  } else {
    note << "not symmetric (relative difference " << asymmetry << "); expected a symmetric matrix";
    fail("M", note.str());
  }
  M = lower == 0 ? Sparse(M.selfadjointView<Eigen::Upper>()) : Sparse(M.selfadjointView<Eigen::Lower>());
  notes.push_back(note.str());
}

Instance from_global_form(GlobalForm form, const Fail& fail) {
  Instance instance;
  Problem& p = instance.problem;
  complete_symmetric(form.M, instance.notes, fail);
  if (form.f_is_motion || form.f.size() == 0) {
    p.z_u = form.f;
  } else {
    const Eigen::SimplicialLLT<Sparse> factor(form.M);
    if (factor.info() != Eigen::Success) fail("M", "not positive definite; expected a mass matrix");
    p.z_u = factor.solve(form.f);
    // One step of refinement: M^-1 f to the last digits.
    p.z_u += factor.solve(form.f - form.M * p.z_u);
  }
  p.M = std::move(form.M);
  add_rows(form, instance);
  return instance;
}

Instance from_local_form(LocalForm form, std::optional<Law> law, const Fail& fail) {
  Instance instance;
  const Index rows = form.q.size(), E = form.s.size();
  if (rows + E > most_rows)
    fail("W", "has " + std::to_string(rows + E) + " rows; it is factored dense, up to " + std::to_string(most_rows));
  GlobalForm global{.dim = form.dim, .sliding = form.dim - 1};
  global.mu = std::move(form.mu);
  const bool slips = law == Law::pyramid || (global.mu.size() > 0 && global.mu.maxCoeff() > 0);
  const Index step = slips ? 1 : form.dim;
  std::ostringstream note;
  Matrix W = form.W;
  if (const double asymmetry = rows > 0 ? (W - W.transpose()).cwiseAbs().maxCoeff() : 0; asymmetry > 0) {
    note << "W is asymmetric by up to " << asymmetry << ": (W + W')/2 was taken";
    instance.notes.push_back(note.str());
    W = (0.5 * (W + W.transpose())).eval();
  }
  const Index used = rows / step;
  const auto stride = Eigen::seqN(0, used, step);
  Matrix S(E + used, E + used);
  S.bottomRightCorner(used, used) = W(stride, stride);
  global.b = std::move(form.s);
  if (E > 0) {
    const Matrix V = form.V, R = form.R;
    S.topLeftCorner(E, E) = 0.5 * (R + R.transpose());
    S.bottomLeftCorner(used, E) = V(stride, Eigen::all);
    S.topRightCorner(E, used) = V(stride, Eigen::all).transpose();
  }
  // Real files are semi-definite up to rounding once symmetric, or to the digits that they were printed with.
  Factor factor = rank_revealing_factor(S);
  if (!(factor.residual <= rounded)) {
    factor = nearest_factor(S);
    note.str("");
    note << "W has eigenvalues below 0: the nearest matrix without was taken, which differs by " << factor.residual
         << " of its largest entry";
    instance.notes.push_back(note.str());
  }
  if (!(factor.residual <= printed)) {
    std::ostringstream text;
    text << "not positive semi-definite (relative residual " << factor.residual << "); expected a Delassus matrix";
    fail("W", text.str());
  }
  note.str("");
  note << "Delassus form: M = I, W = J J' of rank " << factor.J.cols() << " of " << S.rows() << " to "
       << factor.residual;
  instance.notes.push_back(note.str());

  const Index n = factor.J.cols();
  global.G = Matrix(factor.J.topRows(E).transpose()).sparseView(0, 0);
  global.H = Matrix(factor.J.bottomRows(used).transpose()).sparseView(0, 0);
  global.w = form.q(stride);
  if (!slips) global.dim = 1, global.mu.resize(0);
  instance.problem.M.resize(n, n);
  instance.problem.M.setIdentity();
  instance.problem.z_u.setZero(n);
  add_rows(global, instance);
  return instance;
}

}  // namespace zwang

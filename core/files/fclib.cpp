#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <sstream>

#include <zwang/core/files/layouts.h>

namespace zwang {
namespace {

// What W may leave of J J', relative to its largest entry: where nothing but rounding spoils it, and in text of 8
// digits.
constexpr double rounded = 1e-8, printed = 1e-6;

std::size_t count(const hdf5::Group& group, const std::string& name) {
  std::size_t n = 1;
  for (const std::size_t d : group.shape(name)) n *= d;
  return n;
}

// nz >= 0 counts triplets, -1 marks compressed columns, -2 compressed rows. In triplets p is the COLUMN (FCLIB's
// header says the reverse, its files say this). nzmax may exceed what is used.
Sparse read_matrix(const hdf5::Group& parent, const std::string& name, std::size_t rows, std::size_t cols) {
  const hdf5::Group group = parent.group(name);
  const auto m = group.read_one<std::int64_t>("m"), n = group.read_one<std::int64_t>("n");
  if (m != static_cast<std::int64_t>(rows) || n != static_cast<std::int64_t>(cols))
    group.fail("", "is " + std::to_string(m) + " x " + std::to_string(n) + "; expected " + std::to_string(rows) +
                       " x " + std::to_string(cols));
  const auto nz = group.read_one<std::int64_t>("nz");
  if (nz >= 0) return read_sparse(group, m, n, Storage::triplets, static_cast<std::size_t>(nz));
  if (nz < -2)
    group.fail("nz", "is " + std::to_string(nz) + "; expected -2 (rows), -1 (columns) or a number of triplets");
  const auto p = group.read<std::int64_t>("p", (nz == -1 ? cols : rows) + 1);
  if (p.back() < 0) group.fail("p", "ends at " + std::to_string(p.back()) + "; expected the number of entries");
  return read_sparse(group, m, n, nz == -1 ? Storage::columns : Storage::rows, static_cast<std::size_t>(p.back()));
}

// FCLIB stores the constraint directions as columns (H, G), grouped by contact as [N, T1, T2, rolling...].
struct Directions {
  Sparse equality, contact;  // n x e, n x dim * contacts
  Vector b, w;               // G'v + b = 0, u = H'v + w
  Index dim = 1;             // columns of a contact
  Index sliding = 0;         // of which so many after N are directions of slip
  Vector mu = {};            // one a contact; empty: none slips
};

Index read_spacedim(const hdf5::Group& group, bool rolling, std::size_t contact_rows) {
  const auto dim = group.read_one<std::int64_t>("spacedim");
  if (rolling ? dim != 3 && dim != 5 : dim != 2 && dim != 3)
    group.fail("spacedim", "is " + std::to_string(dim) + "; expected " + (rolling ? "3 or 5" : "2 or 3"));
  if (contact_rows % static_cast<std::size_t>(dim) != 0)
    group.fail("",
               std::to_string(contact_rows) + " contact rows; expected a multiple of spacedim " + std::to_string(dim));
  return dim;
}

// Empty where the law, or a file without mu, wants no tangent rows.
Vector read_mu(const hdf5::Group& vectors, std::optional<Law> law, Index contacts) {
  if (law == Law::frictionless || (!law && !vectors.has_data("mu"))) return {};
  Vector mu = read_vector(vectors, "mu", static_cast<std::size_t>(contacts));
  for (Index k = 0; k < contacts; ++k)
    if (mu[k] < 0) vectors.fail("mu[" + std::to_string(k) + "]", "negative; expected a friction coefficient >= 0");
  return mu;
}

// Rows of the problem: equality rows first, then each contact's normal row N z >= -w_N and, where mu > 0, a tangent row
// for each direction T of slip, T z + w_T.
void add_rows(const Directions& d, Instance& instance) {
  const Index e = d.b.size(), contacts = d.contact.cols() / d.dim;
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
    add_row(d.equality, i, -d.b[i], RowKind::equality, {static_cast<std::uint64_t>(i) + 1, 0},
            {.type = "equality", .label = std::to_string(i)});
  for (Index k = 0; k < contacts; ++k) {
    const std::uint64_t id = (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(k);
    const double friction = d.mu.size() > 0 ? d.mu[k] : 0;
    const Index slips = friction > 0 ? d.sliding : 0;
    for (Index r = 0; r <= slips; ++r) {
      const Index column = k * d.dim + r;
      add_row(
          d.contact, column, -d.w[column], r == 0 ? RowKind::inequality : RowKind::tangent,
          {id, static_cast<std::uint32_t>(r)},
          {.type = "contact", .label = std::to_string(k), .row = r == 0 ? -1 : static_cast<int>(r), .unit = "m/s^2"});
      if (r == 0) mu.back() = friction;
    }
  }
  if (d.mu.size() > 0 && d.mu.maxCoeff() > 0) {
    p.mu = Eigen::Map<const Vector>(mu.data(), static_cast<Index>(mu.size()));
    p.law = Law::coulomb;
  }
  p.c = Eigen::Map<const Vector>(c.data(), static_cast<Index>(c.size()));
  p.J.resize(p.c.size(), d.contact.rows());
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

// M v = H r + G lambda + f, G'v + b = 0, u = H'v + w: the free motion is M^-1 f, or exactly vectors/z_u where a file
// carries it.
Instance read_fclib_global(const hdf5::Group& group, std::optional<Law> law, bool rolling) {
  Instance instance;
  const hdf5::Group vectors = group.group("vectors");
  const bool exact = vectors.has_data("z_u");
  const std::string motion = exact ? "z_u" : "f";
  const std::size_t n = count(vectors, motion), w = count(vectors, "w");
  const std::size_t b = group.has_group("G") || vectors.has_data("b") ? count(vectors, "b") : 0;
  const Vector start = read_vector(vectors, motion, n);
  Directions d;
  d.dim = read_spacedim(group, rolling, w);
  d.contact = read_matrix(group, "H", n, w);
  const std::vector<double> free_velocity = vectors.read<double>("w");
  d.w = Eigen::Map<const Vector>(free_velocity.data(), static_cast<Index>(w));
  d.equality = b > 0 ? read_matrix(group, "G", n, b) : Sparse(static_cast<Index>(n), 0);
  d.b = b > 0 ? read_vector(vectors, "b", b) : Vector(0);
  d.sliding = rolling ? (d.dim - 1) / 2 : d.dim - 1;
  d.mu = read_mu(vectors, law, static_cast<Index>(w) / d.dim);
  if (rolling && d.mu.size() > 0) instance.notes.push_back("rolling friction is left out");
  Problem& p = instance.problem;
  p.M = read_matrix(group, "M", n, n);
  complete_symmetric(group, "M", p.M, instance.notes);
  if (exact) {
    p.z_u = start;
  } else {
    const Eigen::SimplicialLLT<Sparse> factor(p.M);
    if (n > 0 && factor.info() != Eigen::Success) group.fail("M", "not positive definite; expected a mass matrix");
    p.z_u = n > 0 ? Vector(factor.solve(start)) : start;
    // One step of refinement: M^-1 f to the last digits.
    if (n > 0) p.z_u += factor.solve(start - p.M * p.z_u);
  }
  add_rows(d, instance);
  return instance;
}

Instance read_fclib_local(const hdf5::Group& group, std::optional<Law> law) {
  const hdf5::Group vectors = group.group("vectors");
  const std::size_t rows = count(vectors, "q"), e = group.has_group("R") ? count(vectors, "s") : 0;
  LocalForm form;
  form.dim = read_spacedim(group, false, rows);
  form.mu = read_mu(vectors, law, static_cast<Index>(rows) / form.dim);
  form.W = read_matrix(group, "W", rows, rows);
  const std::vector<double> q = vectors.read<double>("q");
  form.q = Eigen::Map<const Vector>(q.data(), static_cast<Index>(rows));
  if (e > 0) {
    form.V = read_matrix(group, "V", rows, e);
    form.R = read_matrix(group, "R", e, e);
    form.s = read_vector(vectors, "s", e);
  }
  return from_local_form(std::move(form), law,
                         [&](const std::string& place, const std::string& what) { group.fail(place, what); });
}

// The Delassus form only: with M = I and z_u = 0, any J with J J' = [R V'; V W] gives the same problem up to a rotation
// of z. Only the rows in use are factored: all, or the normal ones of a problem without friction.
Instance from_local_form(LocalForm form, std::optional<Law> law, const Fail& fail) {
  Instance instance;
  const Index rows = form.q.size(), E = form.s.size();
  Directions d;
  d.dim = form.dim;
  d.sliding = d.dim - 1;
  d.mu = std::move(form.mu);
  const bool slips = law == Law::pyramid || (d.mu.size() > 0 && d.mu.maxCoeff() > 0);
  const Index step = slips ? 1 : d.dim;
  std::ostringstream note;
  if (const double asymmetry = rows > 0 ? (form.W - form.W.transpose()).cwiseAbs().maxCoeff() : 0; asymmetry > 0) {
    note << "W is asymmetric by up to " << asymmetry << ": (W + W')/2 was taken";
    instance.notes.push_back(note.str());
    form.W = (0.5 * (form.W + form.W.transpose())).eval();
  }
  const Index used = rows / step;
  const auto stride = Eigen::seqN(0, used, step);
  Matrix S(E + used, E + used);
  S.bottomRightCorner(used, used) = form.W(stride, stride);
  d.b = std::move(form.s);
  if (E > 0) {
    S.topLeftCorner(E, E) = 0.5 * (form.R + form.R.transpose());
    S.bottomLeftCorner(used, E) = form.V(stride, Eigen::all);
    S.topRightCorner(E, used) = form.V(stride, Eigen::all).transpose();
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
  d.equality = Matrix(factor.J.topRows(E).transpose()).sparseView(0, 0);
  d.contact = Matrix(factor.J.bottomRows(used).transpose()).sparseView(0, 0);
  d.w = form.q(stride);
  if (!slips) d.dim = 1, d.mu.resize(0);
  instance.problem.M.resize(n, n);
  instance.problem.M.setIdentity();
  instance.problem.z_u.setZero(n);
  add_rows(d, instance);
  return instance;
}

}  // namespace zwang

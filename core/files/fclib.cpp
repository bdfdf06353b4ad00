#include <zwang/core/files/layouts.h>

namespace zwang {
namespace {

std::size_t count(const hdf5::Group& group, const std::string& name) {
  std::size_t n = 1;
  for (const std::size_t d : group.shape(name)) n *= d;
  return n;
}

// nz >= 0 counts triplets, -1 marks compressed columns, -2 compressed rows. In triplets p is the COLUMN (FCLIB's
// header says the reverse, its files say this). nzmax may exceed what is used.
SparseMatrix read_matrix(const hdf5::Group& parent, const std::string& name, std::size_t rows, std::size_t cols) {
  const hdf5::Group group = parent.group(name);
  const auto m = group.read_one<std::int64_t>("m"), n = group.read_one<std::int64_t>("n");
  if (m != static_cast<std::int64_t>(rows) || n != static_cast<std::int64_t>(cols))
    group.fail("", "is " + std::to_string(m) + " x " + std::to_string(n) + "; expected " + std::to_string(rows) +
                       " x " + std::to_string(cols));
  const auto nz = group.read_one<std::int64_t>("nz");
  if (nz >= 0) return read_sparse(group, m, n, Storage::triplets, at(nz));
  if (nz < -2)
    group.fail("nz", "is " + std::to_string(nz) + "; expected -2 (rows), -1 (columns) or a number of triplets");
  const auto p = group.read<std::int64_t>("p", (nz == -1 ? cols : rows) + 1);
  if (p.back() < 0) group.fail("p", "ends at " + std::to_string(p.back()) + "; expected the number of entries");
  return read_sparse(group, m, n, nz == -1 ? Storage::columns : Storage::rows, at(p.back()));
}

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
  if (law ? !reads_mu(*law) : !vectors.has_data("mu")) return {};
  Vector mu = read_vector(vectors, "mu", at(contacts));
  for (Index k = 0; k < contacts; ++k)
    if (mu[k] < 0) vectors.fail("mu[" + std::to_string(k) + "]", "negative; expected a friction coefficient >= 0");
  return mu;
}

}  // namespace

Instance read_fclib_global(const hdf5::Group& group, std::optional<Law> law, bool rolling) {
  const hdf5::Group vectors = group.group("vectors");
  GlobalForm form;
  form.f_is_motion = vectors.has_data("z_u");
  const std::string motion = form.f_is_motion ? "z_u" : "f";
  const std::size_t n = count(vectors, motion), w = count(vectors, "w");
  const std::size_t b = group.has_group("G") || vectors.has_data("b") ? count(vectors, "b") : 0;
  form.f = read_vector(vectors, motion, n);
  form.dim = read_spacedim(group, rolling, w);
  form.H = read_matrix(group, "H", n, w);
  form.w = read_raw(vectors, "w");
  form.G = b > 0 ? read_matrix(group, "G", n, b) : SparseMatrix(static_cast<Index>(n), 0);
  form.b = b > 0 ? read_vector(vectors, "b", b) : Vector(0);
  form.sliding = rolling ? (form.dim - 1) / 2 : form.dim - 1;
  form.mu = read_mu(vectors, law, static_cast<Index>(w) / form.dim);
  form.M = read_matrix(group, "M", n, n);
  const bool rolls = rolling && form.mu.size() > 0;
  Instance instance = from_global_form(std::move(form), failing(group));
  if (rolls) instance.notes.insert(instance.notes.begin(), "rolling friction is left out");
  return instance;
}

Instance read_fclib_local(const hdf5::Group& group, std::optional<Law> law) {
  const hdf5::Group vectors = group.group("vectors");
  const std::size_t rows = count(vectors, "q"), e = group.has_group("R") ? count(vectors, "s") : 0;
  LocalForm form;
  form.dim = read_spacedim(group, false, rows);
  form.mu = read_mu(vectors, law, static_cast<Index>(rows) / form.dim);
  form.W = read_matrix(group, "W", rows, rows);
  form.q = read_raw(vectors, "q");
  if (e > 0) {
    form.V = read_matrix(group, "V", rows, e);
    form.R = read_matrix(group, "R", e, e);
    form.s = read_vector(vectors, "s", e);
  }
  return from_local_form(std::move(form), law, failing(group));
}

}  // namespace zwang

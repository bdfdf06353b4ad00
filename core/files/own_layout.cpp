
#include <zwang/core/files/layouts.h>

namespace zwang {
namespace {

std::string text_or(const hdf5::Group& group, const std::string& name, const std::string& otherwise) {
  if (!group.has_data(name)) return otherwise;
  const std::vector<std::string> texts = group.read_strings(name);
  if (texts.size() != 1) group.fail(name, "holds " + std::to_string(texts.size()) + " texts; expected 1");
  return texts.front();
}

std::vector<std::string> texts_or_none(const hdf5::Group& group, const std::string& name) {
  return group.has_data(name) ? group.read_strings(name) : std::vector<std::string>();
}

// One text a row, or none at all.
std::vector<std::string> names_of_rows(const hdf5::Group& group, const std::string& name, const Problem& p) {
  std::vector<std::string> all = texts_or_none(group, name);
  if (!all.empty() && all.size() != p.kind.size())
    group.fail(name, "holds " + std::to_string(all.size()) + " names; expected " + std::to_string(p.kind.size()));
  return all;
}

std::size_t length(const hdf5::Group& group, const std::string& name) {
  const std::vector<std::size_t> shape = group.shape(name);
  if (shape.size() != 1) group.fail(name, "has " + std::to_string(shape.size()) + " dimensions; expected 1");
  return shape.front();
}

// A group {p, i, x}, or a dataset with every entry, row by row.
SparseMatrix read_matrix(const hdf5::Group& group, const std::string& name, Index rows, Index cols, Storage storage) {
  if (group.has_group(name)) {
    const hdf5::Group parts = group.group(name);
    return read_sparse(parts, rows, cols, storage, length(parts, "x"));
  }
  const std::vector<std::size_t> shape = group.shape(name);
  if (shape.size() != 2 || static_cast<Index>(shape[0]) != rows || static_cast<Index>(shape[1]) != cols)
    group.fail(name, "not of the right shape; expected " + std::to_string(rows) + " x " + std::to_string(cols));
  const std::vector<double> values = group.read<double>(name);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Matrix(Eigen::Map<const RowMajor>(values.data(), rows, cols)).sparseView(0, 0);
}

// `one`: the law has one answer, whatever the file says.
Reference read_reference(const hdf5::Group& group, Index n, Index m, bool one) {
  Reference r{.hearsay = true};
  r.feasible = group.read_one<std::int64_t>("feasible") != 0;
  if (group.has_data("z")) r.z = read_vector(group, "z", at(n));
  if (group.has_data("lambda")) r.lambda = read_vector(group, "lambda", at(m));
  if (group.has_data("certificate")) r.certificate = read_vector(group, "certificate", at(m));
  if (r.feasible && !group.has_data("z")) group.fail("z", "missing; expected a dataset, for the problem is feasible");
  r.bound = group.has_data("bound") ? group.read_one<double>("bound") : 0;
  r.unique = one || (group.has_data("unique") && group.read_one<std::int64_t>("unique") != 0);
  r.method = text_or(group, "method", "file");
  return r;
}

std::vector<RecordedAnswer> read_recorded(const hdf5::Group& group, Index n) {
  std::vector<RecordedAnswer> all;
  const std::vector<std::string> by = group.read_strings("by");
  const Matrix z = Matrix(read_matrix(group, "z", static_cast<Index>(by.size()), n, Storage::rows));
  for (std::size_t k = 0; k < by.size(); ++k) all.push_back({by[k], z.row(static_cast<Index>(k)).transpose()});
  return all;
}

template <class T>
std::span<const T> span_of(const T* data, Index size) {
  return {data, at(size)};
}

void write_vector(hdf5::Group& group, const std::string& name, const Vector& v) {
  group.write(name, span_of(v.data(), v.size()));
}

template <class SparseMatrix>
void write_matrix(hdf5::Group& parent, const std::string& name, SparseMatrix A) {
  A.makeCompressed();
  hdf5::Group group = parent.add_group(name);
  group.write("p", span_of<std::int32_t>(A.outerIndexPtr(), A.outerSize() + 1));
  group.write("i", span_of<std::int32_t>(A.innerIndexPtr(), A.nonZeros()));
  group.write("x", span_of<double>(A.valuePtr(), A.nonZeros()));
}

void write_text(hdf5::Group& group, const std::string& name, const std::string& text) {
  group.write_strings(name, {&text, 1});
}

void write_recorded(hdf5::Group& parent, const std::vector<RecordedAnswer>& recorded) {
  hdf5::Group group = parent.add_group("recorded");
  std::vector<std::string> by;
  Matrix z(static_cast<Index>(recorded.size()), recorded.front().z.size());
  for (const RecordedAnswer& r : recorded) {
    z.row(static_cast<Index>(by.size())) = r.z.transpose();
    by.push_back(r.by);
  }
  group.write_strings("by", by);
  write_matrix(group, "z", RowMatrix(z.sparseView(0, 0)));
}

}  // namespace

Instance read_own(const hdf5::Group& group) {
  if (group.has_group("friction"))
    group.fail("friction",
               "is how an earlier program kept contacts with friction; expected tangent rows (docs/formats.md)");
  Instance instance;
  Problem& p = instance.problem;
  const Index n = static_cast<Index>(length(group, "z_u")), m = static_cast<Index>(length(group, "c"));
  p.name = text_or(group, "name", "");
  p.z_u = read_raw(group, "z_u", at(n));
  p.c = read_raw(group, "c", at(m));
  p.M = read_matrix(group, "M", n, n, Storage::columns);
  p.J = read_matrix(group, "J", m, n, Storage::rows);
  complete_symmetric(p.M, instance.notes, failing(group));

  for (const std::int64_t kind : group.read<std::int64_t>("kind", at(m))) {
    if (kind < 0 || kind > 2)
      group.fail("kind", "holds " + std::to_string(kind) + "; expected 0 (=), 1 (>=) or 2 (tangent)");
    p.kind.push_back(static_cast<RowKind>(kind));
  }
  if (group.has_data("mu")) p.mu = read_raw(group, "mu", at(m));
  try {
    p.law = parse_law(text_or(group, "law", std::string(to_string(p.has_tangents() ? stored_law : no_friction))));
  } catch (const std::invalid_argument& unknown) {
    group.fail("law", unknown.what());
  }
  std::vector<std::uint64_t> constraint = numbers_from(std::uint64_t{1}, p.kind.size()), row(p.kind.size(), 0);
  if (group.has_group("key")) {
    constraint = group.group("key").read<std::uint64_t>("constraint", p.kind.size());
    row = group.group("key").read<std::uint64_t>("row", p.kind.size());
  }
  for (std::size_t i = 0; i < p.kind.size(); ++i) p.key.push_back({constraint[i], static_cast<std::uint32_t>(row[i])});

  instance.family = text_or(group, "family", "");
  instance.knob = text_or(group, "knob", "");
  if (group.has_data("knob_value")) instance.knob_value = group.read_one<double>("knob_value");
  if (group.has_data("seed")) instance.seed = group.read_one<std::uint64_t>("seed");
  const std::vector<std::string> origin = names_of_rows(group, "origin", p), unit = names_of_rows(group, "unit", p);
  for (std::size_t i = 0; i < origin.size(); ++i)
    instance.origin.push_back(parse_row_origin(origin[i], unit.empty() ? "" : unit[i]));
  std::ranges::move(texts_or_none(group, "notes"), std::back_inserter(instance.notes));
  if (const std::string stored = text_or(group, "sha256", ""); !stored.empty() && stored != problem_sha256(p))
    group.fail("sha256", "not that of its contents; the file is damaged, or was changed by hand");
  if (group.has_group("reference"))
    instance.reference = read_reference(group.group("reference"), n, m, is_convex(p.law));
  if (group.has_group("recorded")) instance.recorded = read_recorded(group.group("recorded"), n);
  return instance;
}

void write_own(hdf5::Group& group, const Instance& instance) {
  const Problem& p = instance.problem;
  const std::size_t m = p.kind.size();
  std::vector<std::uint8_t> kind(m);
  std::vector<std::uint64_t> constraint(m);
  std::vector<std::uint32_t> row(m);
  for (std::size_t i = 0; i < m; ++i) {
    kind[i] = static_cast<std::uint8_t>(p.kind[i]);
    constraint[i] = p.key[i].constraint;
    row[i] = p.key[i].row;
  }
  write_matrix(group, "M", p.M);
  write_matrix(group, "J", p.J);
  write_vector(group, "z_u", p.z_u);
  write_vector(group, "c", p.c);
  group.write("kind", std::span<const std::uint8_t>(kind));
  if (p.has_tangents()) write_vector(group, "mu", p.mu);
  if (reads_mu(p.law)) write_text(group, "law", std::string(to_string(p.law)));
  hdf5::Group key = group.add_group("key");
  key.write("constraint", std::span<const std::uint64_t>(constraint));
  key.write("row", std::span<const std::uint32_t>(row));

  write_text(group, "name", p.name);
  write_text(group, "sha256", problem_sha256(p));
  write_text(group, "family", instance.family);
  write_text(group, "knob", instance.knob);
  group.write_one("knob_value", instance.knob_value);
  group.write_one("seed", instance.seed);
  std::vector<std::string> origin, unit;
  for (const RowOrigin& of_row : instance.origin) {
    origin.push_back(to_string(of_row));
    unit.push_back(of_row.unit);
  }
  if (!origin.empty()) group.write_strings("origin", origin);
  if (!origin.empty()) group.write_strings("unit", unit);
  if (!instance.notes.empty()) group.write_strings("notes", instance.notes);
  if (!instance.recorded.empty()) write_recorded(group, instance.recorded);
  if (!instance.reference) return;
  const Reference& r = *instance.reference;
  hdf5::Group reference = group.add_group("reference");
  reference.write_one("feasible", static_cast<std::uint8_t>(r.feasible));
  if (r.z.size() > 0 || r.feasible) write_vector(reference, "z", r.z);
  if (r.lambda.size() > 0) write_vector(reference, "lambda", r.lambda);
  if (r.certificate.size() > 0) write_vector(reference, "certificate", r.certificate);
  reference.write_one("bound", r.bound);
  reference.write_one("unique", static_cast<std::uint8_t>(r.unique));
  write_text(reference, "method", r.method);
}

}  // namespace zwang

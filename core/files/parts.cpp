#include <algorithm>
#include <cmath>

#include <zwang/core/files/layouts.h>

namespace zwang {
namespace {

std::string bracketed(const std::string& name, std::size_t i) { return name + "[" + std::to_string(i) + "]"; }

void require_finite(const hdf5::Group& group, const std::string& name, std::span<const double> values) {
  const auto bad = std::ranges::find_if(values, [](double x) { return !std::isfinite(x); });
  if (bad != values.end())
    group.fail(bracketed(name, at(bad - values.begin())), "not a number or infinite; expected a finite number");
}

std::vector<std::int64_t> read_at_least(const hdf5::Group& group, const std::string& name, std::size_t count) {
  std::vector<std::int64_t> values = group.read<std::int64_t>(name);
  if (values.size() < count)
    group.fail(name, "holds " + std::to_string(values.size()) + " numbers; expected " + std::to_string(count));
  return values;
}

}  // namespace

Fail failing(const hdf5::Group& group) {
  return [group](const std::string& place, const std::string& what) { group.fail(place, what); };
}

Vector read_raw(const hdf5::Group& group, const std::string& name, std::size_t size) {
  const std::vector<double> values = group.read<double>(name, size);
  return Eigen::Map<const Vector>(values.data(), std::ssize(values));
}

Vector read_vector(const hdf5::Group& group, const std::string& name, std::size_t size) {
  const Vector values = read_raw(group, name, size);
  require_finite(group, name, {values.data(), size});
  return values;
}

SparseMatrix read_sparse(const hdf5::Group& group, Index rows, Index cols, Storage storage, std::size_t count) {
  const bool by_row = storage == Storage::rows, compressed = storage != Storage::triplets;
  const Index outer = by_row ? rows : cols, inner = by_row ? cols : rows;
  const std::vector<std::int64_t> i = read_at_least(group, "i", count);
  const std::vector<std::int64_t> p = read_at_least(group, "p", compressed ? at(outer) + 1 : count);
  std::vector<double> x = group.read<double>("x");
  if (x.size() < count)
    group.fail("x", "holds " + std::to_string(x.size()) + " numbers; expected " + std::to_string(count));
  x.resize(count);
  require_finite(group, "x", x);

  const auto in_range = [&](const char* name, std::size_t k, std::int64_t index, Index size) {
    if (index < 0 || index >= size)
      group.fail(bracketed(name, k),
                 "is " + std::to_string(index) + "; expected an index below " + std::to_string(size));
    return static_cast<int>(index);
  };
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(count);
  const auto add = [&](int line, std::size_t k) {
    const int across = in_range("i", k, i[k], inner);
    entries.emplace_back(by_row ? line : across, by_row ? across : line, x[k]);
  };
  if (compressed) {
    for (Index line = 0; line < outer; ++line) {
      const auto at = static_cast<std::size_t>(line);
      if (p[at] < 0 || p[at] > p[at + 1] || p[at + 1] > static_cast<std::int64_t>(count))
        group.fail(bracketed("p", at + 1),
                   "out of order; expected pointers that rise from 0 to " + std::to_string(count));
      for (auto k = static_cast<std::size_t>(p[at]); k < static_cast<std::size_t>(p[at + 1]); ++k)
        add(static_cast<int>(line), k);
    }
  } else {
    for (std::size_t k = 0; k < count; ++k) add(in_range("p", k, p[k], outer), k);
  }
  return sparse_of<SparseMatrix>(rows, cols, entries);
}

}  // namespace zwang

#include <zwang/bench/timing/wire.h>

#include <stdexcept>

namespace zwang {
namespace {

template <class Sparse>
void put_matrix(Outgoing& out, Sparse A) {
  A.makeCompressed();
  const auto nonzeros = static_cast<std::size_t>(A.nonZeros());
  out.put(A.rows());
  out.put(A.cols());
  out.put(A.outerIndexPtr(), static_cast<std::size_t>(A.outerSize() + 1));
  out.put(A.innerIndexPtr(), nonzeros);
  out.put(A.valuePtr(), nonzeros);
}

template <class Sparse>
Sparse get_matrix(Incoming& in) {
  const auto rows = in.get<Index>(), cols = in.get<Index>();
  const auto outer = in.get_all<std::vector<typename Sparse::StorageIndex>>();
  const auto inner = in.get_all<std::vector<typename Sparse::StorageIndex>>();
  const auto values = in.get_all<std::vector<double>>();
  return Eigen::Map<const Sparse>(rows, cols, static_cast<Index>(values.size()), outer.data(), inner.data(),
                                  values.data());
}

void put_keys(Outgoing& out, const std::vector<RowKey>& keys) {
  out.put(keys.size());
  for (const RowKey& key : keys) {
    out.put(key.constraint);
    out.put(key.row);
  }
}

std::vector<RowKey> get_keys(Incoming& in) {
  std::vector<RowKey> keys(in.get<std::size_t>());
  for (RowKey& key : keys) {
    key.constraint = in.get<decltype(key.constraint)>();
    key.row = in.get<decltype(key.row)>();
  }
  return keys;
}

}  // namespace

void Incoming::require(std::size_t count, std::size_t size) const {
  if (count > (bytes_.size() - at_) / size) throw std::runtime_error("a message ends too early");
}

void Incoming::take(void* to, std::size_t size) {
  require(size, 1);
  if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
  at_ += size;
}

void put(Outgoing& out, const Problem& p) {
  out.put(p.name);
  put_matrix(out, p.M);
  out.put(p.z_u);
  put_matrix(out, p.J);
  out.put(p.c);
  out.put(p.kind.data(), p.kind.size());
  put_keys(out, p.key);
}

Problem get_problem(Incoming& in) {
  Problem p;
  p.name = in.get_all<std::string>();
  p.M = get_matrix<decltype(p.M)>(in);
  p.z_u = in.get_all<Vector>();
  p.J = get_matrix<decltype(p.J)>(in);
  p.c = in.get_all<Vector>();
  p.kind = in.get_all<std::vector<RowKind>>();
  p.key = get_keys(in);
  return p;
}

void put(Outgoing& out, const SolveRequest& c) {
  out.put(c.solver);
  out.put(c.tolerance);
  out.put(c.time_limit);
  out.put(c.max_iterations);
  out.put(c.solves);
  out.put(c.fresh);
  out.put(c.warm_up);
  out.put(c.observe);
  put_keys(out, c.warm.key);
  out.put(c.warm.lambda);
}

SolveRequest get_call(Incoming& in) {
  SolveRequest c;
  c.solver = in.get_all<std::string>();
  c.tolerance = in.get<double>();
  c.time_limit = in.get<double>();
  c.max_iterations = in.get<int>();
  c.solves = in.get<int>();
  c.fresh = in.get<bool>();
  c.warm_up = in.get<bool>();
  c.observe = in.get<bool>();
  c.warm.key = get_keys(in);
  c.warm.lambda = in.get_all<Vector>();
  return c;
}

void put(Outgoing& out, const SolveReply& a) {
  const Solution& s = a.solution;
  out.put(s.status);
  out.put(s.z);
  out.put(s.lambda);
  out.put(s.iterations);
  out.put(s.certificate);
  out.put(s.redundant.data(), s.redundant.size());
  out.put(s.margins.rank);
  out.put(s.margins.smallest_accepted);
  out.put(s.margins.largest_rejected);
  out.put(s.fallback);
  out.put(s.range_gap);
  out.put(s.handed_to);
  out.put(s.message);
  out.put(a.seconds);
  out.put(a.prepare_s);
  out.put(a.allocations);
  out.put(a.iterates.size());
  for (const Iterate& it : a.iterates) {
    out.put(it.iteration);
    out.put(it.z);
    out.put(it.lambda);
  }
}

SolveReply get_answer(Incoming& in) {
  SolveReply a;
  Solution& s = a.solution;
  s.status = in.get<Status>();
  s.z = in.get_all<Vector>();
  s.lambda = in.get_all<Vector>();
  s.iterations = in.get<int>();
  s.certificate = in.get_all<Vector>();
  s.redundant = in.get_all<std::vector<Index>>();
  s.margins.rank = in.get<Index>();
  s.margins.smallest_accepted = in.get<double>();
  s.margins.largest_rejected = in.get<double>();
  s.fallback = in.get<bool>();
  s.range_gap = in.get<double>();
  s.handed_to = in.get_all<std::string>();
  s.message = in.get_all<std::string>();
  a.seconds = in.get<double>();
  a.prepare_s = in.get<double>();
  a.allocations = in.get<double>();
  a.iterates.resize(in.get<std::size_t>());
  for (Iterate& it : a.iterates) {
    it.iteration = in.get<int>();
    it.z = in.get_all<Vector>();
    it.lambda = in.get_all<Vector>();
  }
  return a;
}

}  // namespace zwang

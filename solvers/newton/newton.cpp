#include <zwang/solvers/newton/newton.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/common/begin.h>

namespace zwang {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
constexpr Index largest_dense = 2000000;  // unknowns x rows for which the dense method is still a way out

}  // namespace

bool Newton::factorize(const Problem& p, const Deadline& deadline) {
  return factor_.factorize(p.M, rows_.g, {weight_.data(), at(weight_.size())}, deadline);
}

void Newton::multiply_mass(const Problem& p, const Vector& x, Vector& y) const {
  y.setZero();
  for (const MassEntry& e : mass_) y[e.row] += p.M.valuePtr()[e.from] * x[e.column];
}

double Newton::mass_norm(const Problem& p, const Vector& x) {
  multiply_mass(p, x, work_);
  return std::sqrt(std::max(0.0, work_.dot(x)));
}

void Newton::prepare(const Problem& p, const SolveOptions& options, const Deadline& deadline) {
  factor_.analyze(p.M, rows_.g, options, deadline);
  const Index n = factor_.size(), k = rows_.rows();
  place_.resize(rows_.g.column.size());
  for (std::size_t e = 0; e < place_.size(); ++e) place_[e] = factor_.position(rows_.g.column[e]);
  mass_.clear();
  for (Index j = 0; j < p.size(); ++j) {
    const int begin = p.M.outerIndexPtr()[j];
    const int end = p.M.isCompressed() ? p.M.outerIndexPtr()[j + 1] : begin + p.M.innerNonZeroPtr()[j];
    for (int e = begin; e < end; ++e)
      if (const int row = factor_.position(p.M.innerIndexPtr()[e]), column = factor_.position(static_cast<int>(j));
          row >= 0 && column >= 0)
        mass_.push_back({row, column, e});
  }
  for (Vector* v : {&d_, &step_, &force_, &product_, &work_}) v->setZero(n);
  for (Vector* v : {&l_, &slack_, &term_, &change_, &weight_}) v->setZero(k);
  h_ = rows_.h.head(k).cwiseMax(Real(-1e100)).cast<double>();
  search_.resize(at(factor_.parts()));
  far_d_.setZero(n);
  far_force_.setZero(n);
  far_l_.setZero(k);
  violation_.setZero(k);
  if (options.warm_start) warm(p, *options.warm_start);
}

// Keys come in nearly the same order from frame to frame, so the search starts where the last one ended.
void Newton::warm(const Problem& p, const WarmStart& from) {
  const std::size_t count = std::min(from.key.size(), at(from.lambda.size()));
  std::size_t next = 0;
  for (Index i = 0; i < rows_.rows(); ++i) {
    const RowKey& key = p.key[at(rows_.row[at(i)])];
    for (std::size_t tried = 0; tried < count; ++tried) {
      const std::size_t j = (next + tried) % count;
      if (from.key[j] != key) continue;
      const double unit = rows_.unit_multiplier(i, from.lambda[static_cast<Index>(j)]);
      l_[i] = is_equality(i) ? unit : std::max(0.0, unit);
      next = j + 1;
      break;
    }
  }
}

// z_u breaks no row, so it is the answer to the last bit. Multipliers of an earlier frame would only be worked off down
// to the smallest numbers there are, which is far from z = 0.
bool Newton::rests() const {
  for (Index i = 0; i < rows_.rows(); ++i)
    if (is_equality(i) ? rows_.h[i] != 0 : rows_.h[i] > 0) return false;
  return true;
}

void Newton::write(const Problem& p, Solution& s) const {
  s.z = p.z_u;
  for (int j = 0; j < factor_.size(); ++j) {
    const Index column = factor_.column(j);
    s.z[column] = static_cast<double>(Real(p.z_u[column]) + std::ldexp(far_d_[j], rows_.exponent));
  }
  s.lambda.setZero(p.rows());
  for (Index i = 0; i < rows_.rows(); ++i)
    s.lambda[rows_.row[at(i)]] = rows_.multiplier(i, is_equality(i) ? far_l_[i] : std::max(far_l_[i], Real(0)));
}

void Newton::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  if (!begin(rows_, p, deadline, s)) return;
  prepare(p, options, deadline);
  if (rests()) {
    write(p, s);
    s.redundant.assign(rows_.idle.begin(), rows_.idle.end());
    s.status = Status::solved;
    return;
  }
  s_ = penalty;
  rate_ = 1;
  reach_ = std::max(rows_.free_length, 1.0);
  if (!options.warm_start && hold_all) start(p, deadline);
  for (const double close : {1e-5, 1e-9}) {
    const End end = descend(p, close, options, deadline, s);
    if (end == End::limit) {
      far_d_ = d_.cast<Real>();
      far_l_ = l_.cast<Real>();
      write(p, s);
    }
    if (end == End::limit || end == End::infeasible) return;
    if (end == End::stuck) break;
    if (polish(p, options, deadline, s)) return;
  }

  if (!deadline.passed() && p.size() * rows_.rows() <= largest_dense) {
    SolveOptions rest = options;
    rest.max_iterations -= s.iterations;
    rest.time_limit = deadline.left();
    const int steps = s.iterations;
    exact_.solve(p, rest, s);
    s.iterations += steps;
    s.fallback = true;
    return;
  }
  far_d_ = d_.cast<Real>();
  far_l_ = l_.cast<Real>();
  write(p, s);
  if (deadline.passed()) {
    s.status = Status::time_limit;
    return;
  }
  s.status = Status::numerical_failure;
  s.message = "the rows are too close to dependent for this method, and too many for a dense one";
}

}  // namespace zwang

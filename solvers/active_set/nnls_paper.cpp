#include <zwang/solvers/active_set/nnls_paper.h>

#include <cmath>
#include <cstdio>

namespace zwang {

// s = Q (k - z_u) with J_Q s = c - J z_u by least squares, refined once; returns |J k - c| / |c|. Adding to s what J_Q
// maps to zero changes neither lambda nor z, so a basic solution will do, if it stays small: the columns of J_Q are
// taken largest remaining part first. Tried before: the columns of J in their order; contact arms of 1e-15 then became
// pivots, k of 1e12 drowned the gradient of Eq. 10 in rounding, and problems with c = 0 came out wrong.
double NnlsPaper::find_s(const Problem& p, const Deadline& deadline, Solution& solution) {
  const Index n = p.size(), k = rows_.rows();
  rows_.dense(Gt_);
  J_Q_.noalias() = rows_.row_norm.asDiagonal() * Gt_.transpose();
  b_ = rows_.row_norm.cwiseProduct(rows_.h);
  length_ = J_Q_.colwise().norm().transpose();
  remaining_ = length_;
  const double enough = n > 0 && k > 0 ? rank_threshold * length_.maxCoeff() : 0;
  columns_.reset(k, n);
  column_.clear();
  column_.reserve(at(n));
  solution.margins = {.rank = 0, .smallest_accepted = 1};
  for (Index j = 0; n > 0 && remaining_.maxCoeff(&j) > enough;) {
    deadline.keep();
    const double rest = length_[j] * columns_.append(J_Q_.col(j), enough / length_[j]);
    remaining_[j] = 0;
    if (!(rest > enough)) {
      solution.margins.largest_rejected = std::fmax(solution.margins.largest_rejected, rest / length_.maxCoeff());
      continue;
    }
    column_.push_back(j);
    solution.margins.smallest_accepted = std::min(solution.margins.smallest_accepted, rest / length_.maxCoeff());
    part_.noalias() = J_Q_.transpose() * columns_.Q().col(columns_.size() - 1);
    for (Index i = 0; i < n; ++i)
      remaining_[i] = std::sqrt(std::max(0.0, remaining_[i] * remaining_[i] - part_[i] * part_[i]));
  }
  solution.margins.rank = columns_.size();

  s_.setZero(n);
  rest_ = b_;
  part_.resize(n);
  auto part = part_.head(columns_.size());
  for (int pass = 0; pass < 2; ++pass) {
    part.noalias() = columns_.Q().transpose() * rest_;
    columns_.solve(part);
    for (std::size_t j = 0; j < column_.size(); ++j) s_[column_[j]] += part[static_cast<Index>(j)];
    rest_ = b_;
    rest_.noalias() -= J_Q_ * s_;
  }
  double c_square = 0;
  for (const Index row : rows_.row) c_square += p.c[row] * p.c[row];
  return c_square > 0 ? std::ldexp(rest_.norm(), rows_.exponent) / std::sqrt(c_square) : 0;
}

void NnlsPaper::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows()), most = std::min(n, m);
  storage_.require(2 * n * m + (n + m + 2 * most) * most, options);
  if (!begin(rows_, p, options, deadline, s)) return;
  s.range_gap = find_s(p, deadline, s);
  char text[32];
  std::snprintf(text, sizeof text, "range gap %.1e", s.range_gap);
  s.message = text;

  const auto write = [&] {
    y_ = s_ - least_squares_.residual();
    rows_.primal(p, y_, s.z);
    rows_.multipliers(p, least_squares_.x(), s.lambda);
  };
  const auto each = [&] {
    if (!options.observe) return;
    write();
    options.observe(s.iterations, s.z, s.lambda);
  };
  s.status = least_squares_.solve(Gt_, s_, rows_.equality, warm_rows_.find(p, rows_, options.warm_start), s.iterations,
                                  {options.max_iterations, deadline, std::ref(each)});
  for (const Index i : least_squares_.dependent_free()) s.redundant.push_back(rows_.row[at(i)]);
  write();
}

}  // namespace zwang

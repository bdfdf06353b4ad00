#include "solvers/nnls_paper.h"

#include <cmath>
#include <cstdio>

namespace zwang {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

// k - z_u by least squares on J (k - z_u) = c - J z_u, refined once; returns |J k - c| / |c|. Adding to k what J maps
// to zero changes neither lambda nor z, so a basic solution will do.
double NnlsPaper::find_k(const Problem& p, Solution& s) {
  const Index n = p.size(), k = rows_.rows();
  J_.setZero(k, n);
  b_.resize(k);
  double c_square = 0;
  for (Index i = 0; i < k; ++i) {
    const Index row = rows_.row[at(i)];
    b_[i] = p.c[row];
    c_square += p.c[row] * p.c[row];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, row); it; ++it) {
      J_(i, it.col()) = it.value();
      b_[i] -= it.value() * p.z_u[it.col()];
    }
  }
  columns_.reset(k, n);
  column_.clear();
  column_.reserve(at(n));
  s.margins = {.rank = 0, .smallest_accepted = 1};
  for (Index j = 0; j < n; ++j) {
    const double share = columns_.append(J_.col(j), rank_threshold);
    if (share > rank_threshold) {
      column_.push_back(j);
      s.margins.smallest_accepted = std::min(s.margins.smallest_accepted, share);
    } else if (share > 0) {
      s.margins.largest_rejected =
          std::isnan(s.margins.largest_rejected) ? share : std::max(s.margins.largest_rejected, share);
    }
  }
  s.margins.rank = columns_.size();

  k_.setZero(n);
  rest_ = b_;
  part_.resize(std::min(n, k));
  auto part = part_.head(columns_.size());
  for (int pass = 0; pass < 2; ++pass) {
    part.noalias() = columns_.Q().transpose() * rest_;
    columns_.solve_R(part);
    for (std::size_t j = 0; j < column_.size(); ++j) k_[column_[j]] += part[static_cast<Index>(j)];
    rest_ = b_;
    rest_.noalias() -= J_ * k_;
  }
  return c_square > 0 ? rest_.norm() / std::sqrt(c_square) : 0;
}

void NnlsPaper::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  s.reset(p.size(), p.rows());
  if (!rows_.build(p)) {
    s.status = Status::bad_input;
    s.message = "M is not positive definite";
    return;
  }
  if (rows_.conflict >= 0) {
    s.status = Status::infeasible;
    s.certificate = zero_row_certificate(p, rows_.conflict);
    return;
  }
  const double gap = find_k(p, s);
  char text[32];
  std::snprintf(text, sizeof text, "range gap %.1e", gap);
  s.message = text;

  s_.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) s_[i] = std::ldexp(k_[i], -rows_.exponent);
  if (p.size() > 0) rows_.factor.multiply_upper(s_);
  const auto write = [&] {
    y_ = s_ - least_squares_.residual();
    rows_.primal(p, y_, s.z);
    rows_.multipliers(p, least_squares_.x(), s.lambda);
  };
  const Deadline deadline(options.time_limit);
  std::function<void()> observe;
  if (options.observe)
    observe = [&] {
      write();
      options.observe(least_squares_.iterations(), s.z, s.lambda);
    };
  least_squares_.restart();
  const auto stop = least_squares_.solve(rows_.Gt, s_, rows_.equality, warm_rows_.find(p, rows_, options.warm_start),
                                         {options.max_iterations, &deadline, observe ? &observe : nullptr});
  s.iterations = least_squares_.iterations();
  for (const Index i : least_squares_.dependent_free()) s.redundant.push_back(rows_.row[at(i)]);
  write();
  s.status = stop == LawsonHanson::Stop::optimal           ? Status::solved
             : stop == LawsonHanson::Stop::iteration_limit ? Status::iteration_limit
                                                           : Status::time_limit;
}

}  // namespace zwang

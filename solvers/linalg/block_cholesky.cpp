#include <zwang/solvers/linalg/block_cholesky.h>

#include <algorithm>

#include <zwang/solvers/linalg/dense_front.h>
#include <zwang/solvers/linalg/elimination_order.h>

namespace zwang {
namespace {

constexpr int group_size = 6;
constexpr int long_front = 500;  // rows: to fill it takes milliseconds, far more than a look at the clock

// g g' of three rows of one pattern, with weights of 1. local: of their entries.
void add_triple(const SparseRows& rows, int first, const int* local, const DenseFront::Columns& into) {
  const int begin = rows.begin[at(first)], entries = rows.begin[at(first) + 1] - begin;
  const double *const x = rows.value.data() + begin, *const y = x + entries, *const z = y + entries;
  for (int p = 0; p < entries; ++p) {
    double* const column = into[local[p]];
    for (int q = 0; q < entries; ++q)
      if (local[q] >= local[p]) column[local[q]] += x[p] * x[q] + y[p] * y[q] + z[p] * z[q];
  }
}

}  // namespace

void BlockCholesky::analyze(const SparseMatrix& M, const SparseRows& rows, const SolveOptions& options,
                            const Deadline& deadline, int triples) {
  valid_ = false;
  triples_ = triples;
  const bool keeps_tied = find_tied(M, rows);
  if (keeps_tied && M_places_.matches(M) && row_begin_ == rows.begin && row_column_ == rows.column) return;
  row_begin_.clear();  // no pattern is known until all of it is
  group_columns();
  build_fronts(M, rows, options, deadline);
  row_begin_ = rows.begin;
  row_column_ = rows.column;
  M_places_.keep(M);
}

// Is tied_ as it was?
bool BlockCholesky::find_tied(const SparseMatrix& M, const SparseRows& rows) {
  tied_.swap(tied_before_);
  tied_.assign(at(M.cols()), 0);
  tied_before_.reserve(tied_.size());
  for (const int j : rows.column) tied_[at(j)] = 1;
  for (Index j = 0; j < M.cols(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it)
      if (it.row() != j && it.value() != 0) tied_[at(j)] = 1;
  return tied_ == tied_before_;
}

// group_of_, with loose columns at -1; groups are numbered without gaps.
void BlockCholesky::group_columns() {
  group_of_.assign(tied_.size(), -1);
  group_begin_.assign(1, 0);
  Index block = -1;
  for (Index j = 0; j < std::ssize(tied_); ++j) {
    if (!tied_[at(j)]) continue;
    if (j / group_size != block) group_begin_.push_back(group_begin_.back());
    block = j / group_size;
    ++group_begin_.back();
    group_of_[at(j)] = static_cast<int>(group_begin_.size()) - 2;
  }
}

void BlockCholesky::build_fronts(const SparseMatrix& M, const SparseRows& rows, const SolveOptions& options,
                                 const Deadline& deadline) {
  const int groups = static_cast<int>(group_begin_.size()) - 1;
  double pairs = 0;
  for (int i = 0; i < rows.rows(); ++i) {
    const double entries = std::min(rows.begin[at(i) + 1] - rows.begin[at(i)], groups);
    pairs += entries * entries;
  }
  storage_.require(pairs * sizeof(int) / sizeof(double), options);
  Lists near(at(groups));
  std::vector<int> met, before;
  const auto tie = [&] {
    for (const int a : met)
      for (const int b : met)
        if (a != b) near[at(a)].push_back(b);
  };
  for (int i = 0; i < rows.rows(); ++i) {
    met.clear();
    for (int p = rows.begin[at(i)]; p < rows.begin[at(i) + 1]; ++p) met.push_back(group_of_[at(rows.column[at(p)])]);
    sort_unique(met);
    if (met == before) continue;  // the corners of a contact tie the same bodies
    tie();
    std::swap(met, before);
  }
  for (Index j = 0; j < M.cols(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) {
      met = {group_of_[at(j)], group_of_[at(it.row())]};
      if (it.row() == j || met[0] < 0 || met[1] < 0) continue;
      sort_unique(met);
      tie();
    }
  for (auto& list : near) sort_unique(list);
  const Elimination e = eliminate(near, deadline);

  // Positions: group after group.
  std::vector<int> width(at(groups)), first(at(groups) + 1, 0), rank(at(groups));
  for (int k = 0; k < groups; ++k) {
    const int g = e.order[at(k)];
    rank[at(g)] = k;
    width[at(k)] = group_begin_[at(g) + 1] - group_begin_[at(g)];
    first[at(k) + 1] = first[at(k)] + width[at(k)];
  }
  column_.assign(at(first.back()), -1);
  position_.assign(at(M.cols()), -1);
  std::vector<int> filled(first.begin(), first.end() - 1);
  for (Index j = 0; j < M.cols(); ++j)
    if (const int g = group_of_[at(j)]; g >= 0) {
      const int p = filled[at(rank[at(g)])]++;
      column_[at(p)] = static_cast<int>(j);
      position_[at(j)] = p;
    }

  // Fronts: a group joins the front of its last child where that costs few zeros.
  struct Range {
    int begin, end;
    double zeros;
  };
  std::vector<Range> ranges;
  const auto rest_of = [&](int k) {
    int sum = 0;
    for (const int i : e.below[at(k)]) sum += width[at(i)];
    return sum;
  };
  for (int k = 0; k < groups; ++k) {
    ranges.push_back({k, k + 1, 0});
    while (ranges.size() > 1) {
      const Range &a = ranges[ranges.size() - 2], &b = ranges.back();
      if (e.parent(a.end - 1) != b.begin || b.end != k + 1) break;
      const int own_a = first[at(a.end)] - first[at(a.begin)], own_b = first[at(b.end)] - first[at(b.begin)];
      const int own = own_a + own_b, rest = rest_of(k);
      const double zeros = a.zeros + b.zeros + static_cast<double>(own_a) * (own_b + rest - rest_of(a.end - 1));
      const double share = zeros / (own * (0.5 * (own + 1) + rest));
      if (own > 12 && share > (own <= 24 ? 0.3 : own <= 48 ? 0.1 : 0.05)) break;
      const Range merged{a.begin, b.end, zeros};
      ranges.pop_back();
      ranges.back() = merged;
    }
  }

  front_.assign(ranges.size() + 1, {});
  index_.clear();
  front_of_.assign(column_.size(), -1);
  std::size_t panels = 0, rests = 0, largest = 0;
  int tallest = 0, widest = 0;
  for (std::size_t f = 0; f < ranges.size(); ++f) {
    Front& front = front_[f];
    front.first = first[at(ranges[f].begin)];
    front.own = first[at(ranges[f].end)] - front.first;
    front.index = index_.size();
    for (const int k : e.below[at(ranges[f].end - 1)])
      for (int p = first[at(k)]; p < first[at(k) + 1]; ++p) index_.push_back(p);
    const int rest = static_cast<int>(index_.size() - front.index);
    front.size = front.own + rest;
    front.stride = (Index(front.size) + DenseFront::lanes - 1) / DenseFront::lanes * DenseFront::lanes;
    front.panel = panels;
    front.rest = rests;
    panels += at(front.stride) * at(front.own);
    rests += at(rest) * at(rest + 1) / 2;
    largest = std::max(largest, at(front.stride) * at(rest));
    tallest = std::max(tallest, front.size);
    widest = std::max(widest, front.own);
    for (int p = front.first; p < front.first + front.own; ++p) front_of_[at(p)] = static_cast<int>(f);
  }
  front_.back().index = index_.size();
  storage_.require(static_cast<double>(panels) + static_cast<double>(rests) + static_cast<double>(largest), options);
  panel_.assign(panels + DenseFront::lanes, 0);
  rest_.assign(rests, 0);
  work_.assign(largest, 0);
  scratch_.assign(at(DenseFront::scratch_for(widest)), 0);
  gathered_.assign(at(tallest) + DenseFront::lanes, 0);

  const int count = static_cast<int>(ranges.size());
  const auto local = [&](int f, int p) {
    const Front& front = front_[at(f)];
    if (p < front.first + front.own) return p - front.first;
    const auto begin = index_.begin() + static_cast<std::ptrdiff_t>(front.index);
    return front.own + static_cast<int>(std::lower_bound(begin, begin + (front.size - front.own), p) - begin);
  };
  into_parent_.resize(index_.size());
  Lists children(ranges.size()), rows_of(ranges.size());
  part_.assign(ranges.size(), 0);
  parts_ = 0;
  for (int f = count - 1; f >= 0; --f) {
    Front& front = front_[at(f)];
    if (front.size > front.own) front.parent = front_of_[at(index_[front.index])];
    for (int r = 0; r < front.size - front.own; ++r)
      into_parent_[front.index + at(r)] = local(front.parent, index_[front.index + at(r)]);
    part_[at(f)] = front.parent < 0 ? parts_++ : part_[at(front.parent)];
  }
  for (int f = 0; f < count; ++f)
    if (front_[at(f)].parent >= 0) children[at(front_[at(f)].parent)].push_back(f);

  // What is added into each front: its rows and its share of M.
  front_of_row_.assign(at(rows.rows()), -1);
  local_.resize(rows.column.size());
  for (int i = 0; i < rows.rows(); ++i) {
    int lowest = size();
    for (int p = rows.begin[at(i)]; p < rows.begin[at(i) + 1]; ++p)
      lowest = std::min(lowest, position_[at(rows.column[at(p)])]);
    const int f = front_of_[at(lowest)];
    front_of_row_[at(i)] = f;
    rows_of[at(f)].push_back(i);
    for (int p = rows.begin[at(i)]; p < rows.begin[at(i) + 1]; ++p)
      local_[at(p)] = local(f, position_[at(rows.column[at(p)])]);
  }
  child_.clear();
  row_list_.clear();
  mass_.clear();
  for (int f = 0; f <= count; ++f) {
    Front& front = front_[at(f)];
    front.child = child_.size();
    front.row = row_list_.size();
    front.mass = mass_.size();
    if (f == count) break;
    child_.insert(child_.end(), children[at(f)].begin(), children[at(f)].end());
    row_list_.insert(row_list_.end(), rows_of[at(f)].begin(), rows_of[at(f)].end());
    for (int c = 0; c < front.own; ++c) {
      const int j = column_[at(front.first + c)];
      for (SparseMatrix::InnerIterator it(M, j); it; ++it)
        if (const int row = position_[at(it.row())]; row >= front.first + c)
          mass_.push_back({local(f, row), c, static_cast<int>(&it.value() - M.valuePtr())});
    }
  }
  weight_.assign(at(rows.rows()), 0);
  dirty_.assign(ranges.size(), 1);
}

void BlockCholesky::list(const SparseMatrix& M, const SparseRows& rows, std::vector<MatrixEntry>& entries,
                         std::vector<int>& place) const {
  place.resize(rows.column.size());
  for (std::size_t e = 0; e < place.size(); ++e) place[e] = position(rows.column[e]);
  entries.clear();
  for (Index j = 0; j < M.cols(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it)
      if (const int row = position_[at(it.row())], column = position_[at(j)]; row >= 0 && column >= 0)
        entries.push_back({row, column, it.value()});
}

bool BlockCholesky::factorize(std::size_t f, const SparseMatrix& M, const SparseRows& rows,
                              std::span<const double> weight, const Deadline& deadline) {
  const Front &front = front_[f], &after = front_[f + 1];
  const DenseFront::Columns into{panel_.data() + front.panel, work_.data(), front.own, front.stride};
  for (int c = 0; c < front.size; ++c) std::fill(into[c] + c, into[c] + front.stride, 0.0);
  for (std::size_t k = front.mass; k < after.mass; ++k)
    into[mass_[k].column][mass_[k].row] += M.valuePtr()[mass_[k].from];
  for (std::size_t k = front.row; k < after.row; ++k) {
    const int i = row_list_[k];
    if (i < 3 * triples_) {
      if (i % 3 == 0 && (weight[at(i)] != 0 || weight[at(i) + 1] != 0 || weight[at(i) + 2] != 0))
        add_triple(rows, i, local_.data() + rows.begin[at(i)], into);
      continue;
    }
    if (weight[at(i)] == 0) continue;
    const int begin = rows.begin[at(i)], end = rows.begin[at(i) + 1];
    for (int p = begin; p < end; ++p) {
      const double scaled = weight[at(i)] * rows.value[at(p)];
      double* const column = into[local_[at(p)]];
      for (int q = begin; q < end; ++q)
        if (local_[at(q)] >= local_[at(p)]) column[local_[at(q)]] += scaled * rows.value[at(q)];
    }
  }
  for (std::size_t k = front.child; k < after.child; ++k) {
    const Front& child = front_[at(child_[k])];
    const int rest = child.size - child.own;
    const int* const place = into_parent_.data() + child.index;
    const double* from = rest_.data() + child.rest;
    for (int c = 0; c < rest; from += rest - c, ++c) {
      double* const column = into[place[c]];
      for (int r = c; r < rest; ++r) column[place[r]] += from[r - c];
    }
  }
  if (!DenseFront::factorize(into, front.size, scratch_.data(), deadline)) return false;
  double* rest = rest_.data() + front.rest;
  for (int c = front.own; c < front.size; ++c) rest = std::copy_n(into[c] + c, front.size - c, rest);
  return true;
}

bool BlockCholesky::factorize(const SparseMatrix& M, const SparseRows& rows, std::span<const double> weight,
                              const Deadline& deadline) {
  if (valid_) {
    std::fill(dirty_.begin(), dirty_.end(), char(0));
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] != weight_[i]) dirty_[at(front_of_row_[i])] = 1;
  } else {
    std::fill(dirty_.begin(), dirty_.end(), char(1));
  }
  valid_ = false;
  for (std::size_t f = 0; f + 1 < front_.size(); ++f) {
    if (!dirty_[f]) continue;
    if (front_[f].size > long_front && deadline.passed()) return false;
    if (!factorize(f, M, rows, weight, deadline)) return false;
    if (front_[f].parent >= 0) dirty_[at(front_[f].parent)] = 1;
  }
  std::copy(weight.begin(), weight.end(), weight_.begin());
  valid_ = true;
  return true;
}

void BlockCholesky::solve(Vector& x) const {
  double* const t = gathered_.data();  // x by rows of a front
  for (std::size_t f = 0; f + 1 < front_.size(); ++f) {
    const Front& front = front_[f];
    std::copy_n(x.data() + front.first, front.own, t);
    std::fill(t + front.own, t + front.size, 0.0);
    DenseFront::solve_lower(panel_.data() + front.panel, front.size, front.own, front.stride, t);
    std::copy_n(t, front.own, x.data() + front.first);
    for (int r = front.own; r < front.size; ++r) x[index_[front.index + at(r - front.own)]] += t[r];
  }
  for (std::size_t f = front_.size() - 1; f-- > 0;) {
    const Front& front = front_[f];
    std::copy_n(x.data() + front.first, front.own, t);
    for (int r = front.own; r < front.size; ++r) t[r] = x[index_[front.index + at(r - front.own)]];
    DenseFront::solve_upper(panel_.data() + front.panel, front.size, front.own, front.stride, t);
    std::copy_n(t, front.own, x.data() + front.first);
  }
}

}  // namespace zwang

#include <zwang/solvers/form/joint_graph.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>

#include <zwang/solvers/linalg/packets.h>

namespace zwang {

bool JointGraph::is_known(const BodyRows& rows) const {
  if (known_bodies_ != rows.bodies()) return false;
  std::size_t k = 0;
  for (Index i = 0; i < rows.rows(); ++i) {
    if (!rows.equality[at(i)]) continue;
    if (k == known_rows_.size() || known_rows_[k] != i) return false;
    const auto [a, b] = rows.body[at(i)];
    if (known_[k][0] != a || known_[k++][1] != b) return false;
  }
  return k == known_rows_.size();
}

// So that nothing grows step by step in a first solve.
void JointGraph::reserve(std::size_t bodies, std::size_t rows) {
  for (std::vector<Index>* list : {&sorted_, &tree_rows_, &cut_, &known_rows_}) list->reserve(rows);
  known_.reserve(rows);
  edges_.reserve(rows);
  joints_.reserve(bodies);
  order_.reserve(bodies);
  group_end_.reserve(bodies);
}

// Of known_rows_. Rows of a joint mostly follow each other: runs of them are put in order, not rows.
void JointGraph::find_edges(const BodyRows& rows) {
  const int world = static_cast<int>(rows.bodies());
  edges_.clear();
  for (std::size_t k = 0; k < known_rows_.size(); ++k) {
    const auto [a, second] = known_[k];
    const int b = second < 0 ? world : second;
    if (edges_.empty() || edges_.back().a != a || edges_.back().b != b)
      edges_.push_back({.a = a, .b = b, .first = static_cast<Index>(k), .count = 0});
    ++edges_.back().count;
  }
  // The world, whose number is the largest, comes first.
  const auto key = [&](const Edge& e) { return std::tuple(e.a, e.b == world ? -1 : e.b, e.first); };
  std::ranges::sort(edges_, {}, key);
  sorted_.clear();
  edge_begin_.assign(at(world) + 2, 0);
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge run = edges_[e];
    if (count == 0 || edges_[count - 1].a != run.a || edges_[count - 1].b != run.b) {
      for (const int end : {run.a, run.b}) ++edge_begin_[at(end) + 1];
      edges_[count++] = {.a = run.a, .b = run.b, .first = static_cast<Index>(sorted_.size()), .count = 0};
    }
    edges_[count - 1].count += run.count;
    const auto begin = known_rows_.begin() + run.first;
    sorted_.insert(sorted_.end(), begin, begin + run.count);
  }
  edges_.resize(count);
  std::partial_sum(edge_begin_.begin(), edge_begin_.end(), edge_begin_.begin());
  edges_of_.resize(2 * edges_.size());
  // Each beginning serves as the place of its next entry, and is put back.
  for (std::size_t e = 0; e < edges_.size(); ++e)
    for (const int end : {edges_[e].a, edges_[e].b}) edges_of_[at(edge_begin_[at(end)]++)] = static_cast<int>(e);
  std::shift_right(edge_begin_.begin(), edge_begin_.end(), 1);
  edge_begin_.front() = 0;
}

void JointGraph::span(int world) {
  joints_.clear();
  tree_rows_.clear();
  reached_.assign(at(world) + 1, 0);
  reached_.back() = 1;
  used_.assign(edges_.size(), 0);
  const auto spread = [&](int from, int position) {
    const auto first = static_cast<int>(joints_.size());
    for (const int e : edges_of(from)) {
      const Edge& edge = edges_[at(e)];
      const int to = edge.a == from ? edge.b : edge.a;
      if (used_[at(e)] || reached_[at(to)]) continue;
      used_[at(e)] = reached_[at(to)] = 1;
      joints_.push_back({.body = to,
                         .parent = from == world ? -1 : from,
                         .first = static_cast<Index>(tree_rows_.size()),
                         .count = edge.count});
      for (Index k = 0; k < edge.count; ++k) tree_rows_.push_back(sorted_[at(edge.first + k)]);
    }
    if (position < 0) return;
    joints_[at(position)].first_child = first;
    joints_[at(position)].children = static_cast<int>(joints_.size()) - first;
  };
  std::size_t done = 0;
  const auto exhaust = [&] {
    for (; done < joints_.size(); ++done) spread(joints_[done].body, static_cast<int>(done));
  };
  spread(world, -1);
  exhaust();
  const auto joints_of = [&](int b) { return edges_of(b).size(); };
  while (static_cast<int>(joints_.size()) < world) {
    int root = -1;
    for (int b = 0; b < world; ++b)
      if (!reached_[at(b)] && (root < 0 || joints_of(b) > joints_of(root))) root = b;
    reached_[at(root)] = 1;
    joints_.push_back({.body = root});
    exhaust();
  }
  position_.resize(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) position_[at(joints_[j].body)] = static_cast<int>(j);
  freedom_ = 0;
  for (Joint& joint : joints_) {
    joint.freedom = std::max<Index>(0, 6 - joint.count);
    joint.column = freedom_;
    freedom_ += joint.freedom;
  }
  cut_.clear();
  for (std::size_t e = 0; e < edges_.size(); ++e)
    for (Index k = 0; !used_[e] && k < edges_[e].count; ++k) cut_.push_back(sorted_[at(edges_[e].first + k)]);
}

void JointGraph::group_joints() {
  height_.assign(joints_.size(), 0);
  order_.clear();
  for (std::size_t j = joints_.size(); j-- > 0;) {
    const auto first = at(joints_[j].first_child);
    for (int c = 0; c < joints_[j].children; ++c) height_[j] = std::max(height_[j], height_[first + at(c)] + 1);
    order_.push_back(static_cast<int>(j));
  }
  const auto kind = [&](int j) { return std::tuple(height_[at(j)], joints_[at(j)].count); };
  std::ranges::sort(order_, [&](int a, int b) { return std::tuple(kind(a), -a) < std::tuple(kind(b), -b); });
  // A group is the first joint that is left and those behind it that need not wait, up to one level higher: a hand's
  // fifth tip goes with three middle phalanges.
  group_end_.clear();
  done_.assign(joints_.size(), 0);
  const auto is_ready = [&](int j) {
    const auto first = done_.begin() + joints_[at(j)].first_child;
    return std::all_of(first, first + joints_[at(j)].children, [](char done) { return done != 0; });
  };
  for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
    const auto [height, count] = kind(order_[begin]);
    ++end;
    for (std::size_t k = end; k < order_.size() && end - begin < packets::width; ++k) {
      const int j = order_[k];
      if (height_[at(j)] > height + 1) break;
      if (joints_[at(j)].count != count || !is_ready(j)) continue;
      std::shift_right(order_.begin() + static_cast<std::ptrdiff_t>(end),
                       order_.begin() + static_cast<std::ptrdiff_t>(k) + 1, 1);
      order_[end++] = j;
    }
    for (std::size_t k = begin; k < end; ++k) done_[at(order_[k])] = 1;
    group_end_.push_back(end);
  }
}

// Of the first and the last body of each row (Fowler, Noll & Vo's hash): where it errs, storage is shared, no more.
Index JointGraph::kind(const Problem& p) {
  if (!p.J.isCompressed()) return 0;
  std::uint64_t hash = 0xcbf29ce484222325;
  const int* start = p.J.outerIndexPtr();
  const int* column = p.J.innerIndexPtr();
  for (Index i = 0; i < p.rows(); ++i) {
    if (!p.is_equality(i) || start[i] == start[i + 1]) continue;
    const auto first = static_cast<std::uint64_t>(column[start[i]] / 6);
    const auto last = static_cast<std::uint64_t>(column[start[i + 1] - 1] / 6);
    hash = (hash ^ (first << 32 | last)) * 0x100000001b3;
  }
  return static_cast<Index>(hash);
}

void JointGraph::build(const BodyRows& rows) {
  if (is_known(rows)) return;
  known_bodies_ = rows.bodies();
  reserve(at(rows.bodies()), at(std::ranges::count(rows.equality, 1)));
  known_rows_.clear();
  known_.clear();
  for (Index i = 0; i < rows.rows(); ++i) {
    if (!rows.equality[at(i)]) continue;
    known_rows_.push_back(i);
    known_.push_back(rows.body[at(i)]);
  }
  find_edges(rows);
  span(static_cast<int>(rows.bodies()));
  group_joints();
}

}  // namespace zwang

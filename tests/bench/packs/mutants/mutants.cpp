// mutants PACK SOLVER TOLERANCE mutant NAME FILE               answers of a solver with a defect
// mutants PACK SOLVER TOLERANCE CHANGE SEED FILE               of a solver to the same problems in another form
//
// `none` is a mutant, too: the copies that the defects are in, without one. A change is `rows` (the order of contacts
// and joints), `ties` (of contacts alone), `bodies` (their order), `units` (of rows, time, mass and length, by powers
// of two), or `all` of them; the answers are those to the problem as it was.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <mutant.h>
#include <zwang/bench/packs/answers.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/solvers/registry.h>

// Names of the copies (copies.py).
#define BlockCholesky BlockCholeskyCopy
#define AugmentedLagrangian AugmentedLagrangianCopy
#define NewtonPolish NewtonPolishCopy
#define Newton NewtonCopy
#define Pgs PgsCopy
#define ContactSweeps ContactSweepsCopy
#define Nsgs NsgsCopy
#include <zwang/solvers/first_order/pgs.h>
#include <zwang/solvers/friction/nsgs.h>
#include <zwang/solvers/newton/newton.h>

namespace zwang {

Mutant mutant = Mutant::none;
bool merges_wrongly = false, leaves_out_mass = false;

namespace {

const std::vector<std::string> names = {"none",
                                        "wrong_merge",
                                        "no_mass",
                                        "no_joint_rows",
                                        "gap_as_residual",
                                        "loose_tolerance",
                                        "infinite_impulse",
                                        "unconverged",
                                        "stale_warm_start",
                                        "float_stop",
                                        "dropped_contacts",
                                        "tangent_directions",
                                        "row_order",
                                        "nan_body",
                                        "limit_sign"};

// The copy where there is one.
AnySolver solver_of(const std::string& name, bool copy) {
  if (copy && name == "newton") {
    Newton newton;
    newton.dense = make_solver("dual_active_set");  // and no start: no steps but those with the defect
    return newton;
  }
  if (copy && name == "pgs") return Pgs();
  if (copy && name == "nsgs") return Nsgs();
  return make_solver(name);
}

// Defects of the world around a solver.
void spoil_problem(Problem& p) {
  constexpr Index most = 24;
  if (mutant != Mutant::dropped_contacts) return;
  Index contacts = 0;
  for (Index i = 0; i < p.rows(); ++i)
    if (p.kind[at(i)] == RowKind::inequality && ++contacts > most) p.c[i] = -infinity;
}

void spoil_answer(const Instance& instance, Solution& s) {
  const Problem& p = instance.problem;
  if (s.status != Status::solved) return;
  if (mutant == Mutant::infinite_impulse && p.rows() > p.size()) {
    Index last = p.rows() - 1;
    while (last > 0 && p.kind[at(last)] != RowKind::inequality) --last;
    s.lambda[last] = infinity;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, last); it; ++it)
      s.z[it.col()] += it.value() * infinity;
  }
  if (mutant == Mutant::nan_body && p.rows() > p.size()) s.z.tail(6).setConstant(Solution::unknown);
  if (mutant == Mutant::limit_sign && s.lambda.size() > 0)
    for (std::size_t i = 0; i < instance.origin.size(); ++i)
      if (instance.origin[i].type == "joint_limit") s.lambda[static_cast<Index>(i)] *= -1;
}

// The same problem in other words, and how its answer reads in the first ones.
class Restated {
 public:
  Restated(const Problem& p, const std::string& change, unsigned long seed) : random_(seed) {
    const bool all = change == "all";
    order_rows(p, all || change == "rows", all || change == "ties");
    order_unknowns(p, all || change == "bodies");
    const bool units = all || change == "units";
    const double time = units ? power() : 1, mass = units ? power() : 1, length = units ? power() : 1;
    const Index n = p.size(), m = p.rows();
    Vector unknown = Vector::Constant(n, 1);  // z' = time / unknown z
    if (n % body == 0)
      for (Index j = 0; j < n; ++j) unknown[j] = j % body < 3 ? length : 1;
    unknown_ = time * unknown.cwiseInverse();
    Vector row(m);
    for (Index i = 0; i < m; ++i) row[i] = p.is_tangent(i) ? row[i - 1] : units ? power() : 1;
    row_ = row.cwiseInverse() * (time * mass);

    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < n; ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, from_.at(j)); it; ++it)
        entries.emplace_back(to_.at(it.row()), j, it.value() * mass * unknown[it.row()] * unknown[it.col()]);
    problem.M.resize(n, n);
    problem.M.setFromTriplets(entries.begin(), entries.end());
    entries.clear();
    problem.c.resize(m);
    if (p.has_tangents()) problem.mu.resize(m);
    for (Index i = 0; i < m; ++i) {
      const Index old = rows_.at(i);
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, old); it; ++it)
        entries.emplace_back(i, to_.at(it.col()), it.value() * row[old] * unknown[it.col()]);
      problem.c[i] = p.c[old] * row[old] * time;
      problem.kind.push_back(p.kind[at(old)]);
      if (!p.key.empty()) problem.key.push_back(p.key[at(old)]);
      if (p.has_tangents()) problem.mu[i] = p.mu[old];
    }
    problem.J.resize(m, n);
    problem.J.setFromTriplets(entries.begin(), entries.end());
    problem.z_u.resize(n);
    for (Index j = 0; j < n; ++j) problem.z_u[j] = p.z_u[from_.at(j)] * unknown_[from_.at(j)];
    problem.law = p.law;
  }

  Problem problem = {};

  void restore(Solution& s) const {
    if (Vector& z = s.z; z.size() > 0) {
      Vector old(z.size());
      for (Index j = 0; j < z.size(); ++j) old[from_.at(j)] = z[j] / unknown_[from_.at(j)];
      z = old;
    }
    for (Vector* v : {&s.lambda, &s.certificate}) {
      if (v->size() == 0) continue;
      Vector old(v->size());
      for (Index i = 0; i < v->size(); ++i) old[rows_.at(i)] = (*v)[i] / row_[rows_.at(i)];
      *v = old;
    }
  }

 private:
  static constexpr Index body = 6;
  struct Places : std::vector<Index> {
    Index at(Index i) const { return (*this)[static_cast<std::size_t>(i)]; }
  };

  double power() { return std::ldexp(1.0, std::uniform_int_distribution(-12, 12)(random_)); }

  // A contact's rows stay together.
  void order_rows(const Problem& p, bool everything, bool contacts) {
    std::vector<Places> blocks;
    std::vector<std::size_t> movable;
    for (Index i = 0; i < p.rows(); ++i) {
      if (!p.is_tangent(i)) {
        if (everything || (contacts && !p.is_equality(i))) movable.push_back(blocks.size());
        blocks.emplace_back();
      }
      blocks.back().push_back(i);
    }
    std::vector<std::size_t> order(blocks.size()), moved = movable;
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(moved.begin(), moved.end(), random_);
    for (std::size_t k = 0; k < moved.size(); ++k) order[movable[k]] = moved[k];
    for (const std::size_t k : order) rows_.insert(rows_.end(), blocks[k].begin(), blocks[k].end());
  }

  void order_unknowns(const Problem& p, bool shuffled) {
    const Index width = p.size() % body == 0 ? body : 1;
    Places groups;
    groups.resize(static_cast<std::size_t>(p.size() / width));
    std::iota(groups.begin(), groups.end(), Index(0));
    if (shuffled) std::shuffle(groups.begin(), groups.end(), random_);
    to_.resize(static_cast<std::size_t>(p.size()));
    for (const Index group : groups)
      for (Index k = 0; k < width; ++k) {
        to_[static_cast<std::size_t>(width * group + k)] = std::ssize(from_);
        from_.push_back(width * group + k);
      }
  }

  std::mt19937_64 random_;
  Places rows_, from_, to_;  // new -> old row, new -> old unknown, and back
  Vector unknown_, row_;     // new over old unknown, new over old force
};

void run(const Pack& pack, const std::string& solver, double tolerance, const std::string& change,
         const std::string& which, const std::string& file) {
  const bool copy = change == "mutant";
  if (copy) {
    const auto found = std::ranges::find(names, which);
    if (found == names.end()) throw std::invalid_argument("no mutant " + which);
    mutant = static_cast<Mutant>(found - names.begin());
  }
  AnySolver method = solver_of(solver, copy);
  std::ofstream out(file, std::ios::binary);
  out << answers_header({.solver = solver, .tolerance = tolerance});
  for (const PackedProblem& packed : pack.problems()) {
    Instance instance = read_problems(pack.directory() / packed.file).at(0);
    Solution s;
    if (copy) {
      spoil_problem(instance.problem);
      method.solve(instance.problem, {.tolerance = tolerance}, s);
      spoil_answer(instance, s);
    } else {
      const Restated other(instance.problem, change, std::stoul(which));
      method.solve(other.problem, {.tolerance = tolerance}, s);
      other.restore(s);
    }
    out << answers_line(packed.sha256, {.solution = s});
  }
  if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace
}  // namespace zwang

int main(int count, char** words) {
  if (count != 7) {
    std::fputs("mutants PACK SOLVER TOLERANCE mutant|rows|ties|bodies|units|all NAME|SEED FILE\n", stderr);
    return 2;
  }
  try {
    zwang::run(zwang::Pack(words[1]), words[2], std::stod(words[3]), words[4], words[5], words[6]);
  } catch (const std::exception& wrong) {
    std::fprintf(stderr, "%s\n", wrong.what());
    return 3;
  }
}

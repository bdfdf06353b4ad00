#include <boost/multiprecision/mpfr.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>

#include <Eigen/SparseCholesky>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/packs/proofs.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/referee/exact_rank.h>
#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/referee_active_set.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

namespace mp = boost::multiprecision;
using Json = nlohmann::ordered_json;
using Hundred = mp::number<mp::mpfr_float_backend<100, mp::allocate_stack>, mp::et_off>;
using Numbers = VectorX<Hundred>;
using Sparse = Eigen::SparseMatrix<Hundred>;
using Rows = std::vector<Index>;

constexpr double zero = 1e-60;  // of a row's or a motion's size: 100 digits leave 1e-68 where doubles are dependent
constexpr int digits = 20;
constexpr int rounds = 100;  // of rows that are exchanged

struct NoProof : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Rounded up at the 20th digit, as check.py does.
std::string rounded_up(const Hundred& x) {
  if (x == 0) return "0";
  auto exponent = static_cast<int>(floor(Hundred(log10(x))));
  const Hundred ten(10), most = pow(ten, digits);
  for (;; ++exponent) {
    const Hundred scaled = ceil(Hundred(x * pow(ten, digits - 1 - exponent) * (1 - Hundred(zero))));
    if (scaled >= most) continue;
    const std::string text = scaled.str(0, std::ios::fixed);
    return text.substr(0, 1) + "." + text.substr(1, digits - 1) + "e" + std::to_string(exponent);
  }
}

// A problem in 100 digits.
class ProofSearch {
 public:
  explicit ProofSearch(const Problem& problem)
      : p_(problem), M_(problem.M.cast<Hundred>()), J_(problem.J.cast<Hundred>()), z_u_(problem.z_u.cast<Hundred>()) {
    factor_.compute(M_);
    const Sparse transposed = J_.transpose(), moves = p_.rows() > 0 ? Sparse(factor_.solve(transposed)) : transposed;
    W_ = J_ * moves;
    unit_ = Numbers(W_.diagonal()).cwiseSqrt();
    free_slack_ = J_ * z_u_;
    for (Index i = 0; i < p_.rows(); ++i) free_slack_[i] -= counts(i) ? p_.c[i] : 0;
  }

  // What proves the answer, or says that there is none.
  void prove(const Vector& z, const Vector& lambda, Json& proof) {
    const ScaledProblem scaled(p_);
    RefereeActiveSet active(scaled);
    ExtendedVector guess;
    if (lambda.size() > 0) guess = scaled.multipliers(lambda);
    const Vector& near = z.size() > 0 ? z : p_.z_u;
    switch (active.solve(scaled.motion(near), lambda.size() > 0 ? &guess : nullptr)) {
      case RefereeActiveSet::Outcome::gave_up:
        throw NoProof("the rows that hold were not found");
      case RefereeActiveSet::Outcome::infeasible:
        return contradict(active.farkas, proof);
      case RefereeActiveSet::Outcome::optimal:
        hold(active.basis);
        return measure(z, lambda, proof);
    }
  }

 private:
  bool counts(Index i) const { return std::isfinite(p_.c[i]); }
  Hundred norm(const Numbers& v) const { return sqrt(std::max(Hundred(0), Hundred(v.dot(M_ * v)))); }

  // W_BB x = right.
  Numbers solve(const Rows& basis, const Numbers& right) const {
    Sparse B(std::ssize(basis), p_.rows());
    for (std::size_t k = 0; k < basis.size(); ++k) B.insert(static_cast<Index>(k), basis[k]) = 1;
    const Sparse own = B * W_ * B.transpose();
    const Eigen::SimplicialLLT<Sparse> factor(own);
    if (factor.info() != Eigen::Success) throw NoProof("the rows that hold are too close to dependent");
    return factor.solve(right);
  }
  static Numbers picked(const Rows& rows, const Numbers& x) {
    Numbers out(std::ssize(rows));
    for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = x[rows[k]];
    return out;
  }

  // z* from independent rows that push. The basis it starts with was found in double-double.
  void hold(Rows basis) {
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i)
      if (counts(i) && p_.is_equality(i)) rows.push_back(i);
    for (const Index i : basis)
      if (!p_.is_equality(i)) rows.push_back(i);
    for (int round = 0; round < rounds; ++round) {
      basis = exact_basis(p_.J, p_.c, rows).rows;
      const Numbers push = basis.empty() ? Numbers() : solve(basis, -picked(basis, free_slack_));
      Numbers force = Numbers::Zero(p_.rows());
      Hundred largest(0);
      for (std::size_t k = 0; k < basis.size(); ++k) {
        force[basis[k]] = push[static_cast<Index>(k)];
        largest = std::max(largest, Hundred(abs(force[basis[k]]) * unit_[basis[k]]));
      }
      const auto pulls = std::ranges::find_if(
          basis, [&](Index i) { return !p_.is_equality(i) && force[i] * unit_[i] < -zero * largest; });
      if (pulls != basis.end()) {
        rows = basis;
        std::erase(rows, *pulls);
        continue;
      }
      basis_ = basis;
      true_ = z_u_ + Numbers(factor_.solve(Numbers(J_.transpose() * force)));
      const Numbers slack = free_slack_ + W_ * force;
      const Hundred motion = norm(true_) + norm(z_u_);
      Index worst = -1;
      Hundred most = motion * zero;
      for (Index i = 0; i < p_.rows(); ++i) {
        const Hundred violation = p_.is_equality(i) ? Hundred(abs(slack[i])) : -slack[i];
        if (counts(i) && violation > unit_[i] * most) worst = i, most = unit_[i] > 0 ? violation / unit_[i] : violation;
      }
      if (worst < 0) return;
      rows = basis;
      rows.push_back(worst);
      if (exact_basis(p_.J, p_.c, rows).rows.size() == basis.size()) break;
    }
    throw NoProof("rows that depend on each other disagree in their last digits");
  }

  void measure(const Vector& z, const Vector& lambda, Json& proof) {
    proof["verdict"] = to_string(Verdict::wrong);
    proof["basis"] = basis_;
    if (z.size() == 0) return;
    const Hundred motion = std::max(norm(true_), norm(z_u_));
    const auto relative = [&](const Hundred& length) {
      if (motion == 0 && length > 0) throw NoProof("there is no motion to measure by");
      return length <= zero * motion ? Hundred(0) : Hundred(length / motion);
    };
    const Hundred distance = relative(norm(z.cast<Hundred>() - true_));
    const auto error = static_cast<double>(distance);
    proof["verdict"] = to_string(by_error(error, error, proof["tolerance"].get<double>()));
    proof["distance"] = rounded_up(distance);
    if (lambda.size() == 0) return;
    Numbers force = lambda.cast<Hundred>();
    std::size_t pulling = 0;
    for (Index i = 0; i < p_.rows(); ++i) {
      if (!counts(i)) force[i] = 0;
      pulling += force[i] < 0 && !p_.is_equality(i);
    }
    const Numbers moved = factor_.solve(Numbers(J_.transpose() * force));
    proof["imbalance"] = rounded_up(relative(norm(z.cast<Hundred>() - z_u_ - moved)));
    proof["pulling"] = pulling;
  }

  // u with u_I >= 0 and J'u = 0 on independent rows and one more.
  void contradict(const Vector& farkas, Json& proof) const {
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i)
      if (counts(i) && farkas[i] != 0) rows.push_back(i);
    const auto size = [&](Index i) { return Hundred(abs(farkas[i]) * (unit_[i] > 0 ? unit_[i] : Hundred(1))); };
    const Index more = *std::ranges::max_element(rows, {}, size);
    const Hundred least = size(more) * referee::no_part;
    std::erase_if(rows, [&](Index i) { return i == more || size(i) <= least; });
    if (exact_basis(p_.J, p_.c, rows).rows.size() != rows.size())
      throw NoProof("its conflicting rows depend on each other");
    Numbers u = Numbers::Zero(p_.rows());
    const Numbers weights = rows.empty() ? Numbers() : solve(rows, -picked(rows, Numbers(W_.col(more))));
    for (std::size_t k = 0; k < rows.size(); ++k) u[rows[k]] = weights[static_cast<Index>(k)];
    u[more] = 1;
    const Numbers left = J_.transpose() * u;
    Hundred gain = -u.dot(free_slack_), motion = norm(z_u_),
            distance = sqrt(std::max(Hundred(0), Hundred(u.dot(W_ * u))));
    if (p_.is_equality(more) && gain < 0) u = -u, gain = -gain;
    for (Index i = 0; i < p_.rows(); ++i) {
      if (u[i] != 0 && unit_[i] > 0) motion = std::max(motion, Hundred(abs(free_slack_[i]) / unit_[i]));
      if (u[i] < 0 && !p_.is_equality(i)) throw NoProof("its conflicting rows were not found");
    }
    if (distance <= zero * unit_[more]) distance = 0;
    if (!(gain > 0 && distance * motion * referee::farkas_margin <= gain))
      throw NoProof("rows contradict each other by rounding, and a z beyond 1e8 motions may meet them");
    proof["verdict"] = to_string(proof["status"] == "infeasible" ? Verdict::infeasible_proven : Verdict::wrong);
    proof["basis"] = rows;
    proof["more"] = Rows{more};
    proof["contradiction"] = rounded_up(distance * motion / gain);
  }

  const Problem& p_;
  Sparse M_, J_, W_;
  Numbers z_u_, unit_, free_slack_, true_;
  Eigen::SimplicialLLT<Sparse> factor_;
  Rows basis_;
};

template <int Options>
Json entries(const Eigen::SparseMatrix<double, Options>& A) {
  Json all = Json::array();
  for (Index k = 0; k < A.outerSize(); ++k)
    for (typename Eigen::SparseMatrix<double, Options>::InnerIterator it(A, k); it; ++it)
      all.push_back({it.row(), it.col(), it.value()});
  return all;
}
std::vector<double> numbers(const Vector& v) { return {v.begin(), v.end()}; }

// The problem as check.py reads it; JSON has no infinity: null.
Json to_json(const Problem& p) {
  return {{"zwang_problem", 1}, {"name", p.name},    {"law", to_string(p.law)}, {"n", p.size()},
          {"m", p.rows()},      {"M", entries(p.M)}, {"z_u", numbers(p.z_u)},   {"J", entries(p.J)},
          {"c", numbers(p.c)},  {"kind", p.kind},    {"mu", numbers(p.mu)}};
}

// The name of an answer: SHA-256 of its status, a line break, the doubles of z and those of lambda.
std::string answer_sha256(const Solution& s) {
  std::string bytes = std::string(to_string(s.status)) + "\n";
  for (const Vector* v : {&s.z, &s.lambda})
    for (const double x : *v)
      for (int k = 0; k < 64; k += 8) bytes += static_cast<char>(std::bit_cast<std::uint64_t>(x) >> k);
  return sha256(bytes);
}

}  // namespace

ProofTally write_proofs(const Pack& pack, std::span<const Answers> contestants, const std::filesystem::path& directory,
                        const std::function<void(std::size_t, const std::string& name)>& progress,
                        const std::atomic<bool>& interrupted) {
  ProofTally tally;
  const std::vector<std::string> names = names_of(contestants);
  for (const char* folder : {"problems"}) std::filesystem::create_directories(directory / folder);
  for (const std::string& name : names) std::filesystem::create_directories(directory / name);
  std::size_t done = 0;
  for (const PackedProblem& packed : pack.problems()) {
    if (interrupted) break;
    progress(done++, packed.name);
    const Problem problem = read_problems(pack.directory() / packed.file).at(0).problem;
    const std::string file = std::filesystem::path(packed.file).stem().string() + ".json";
    ProofSearch search(problem);
    bool proven = false;
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      const auto found = contestants[k].of.find(packed.sha256);
      if (found == contestants[k].of.end()) continue;
      const Solution& s = found->second.solution;
      Json proof = {{"zwang_proof", 1},
                    {"problem", "../problems/" + file},
                    {"sha256", packed.sha256},
                    {"name", packed.name},
                    {"solver", names[k]},
                    {"tolerance", contestants[k].tolerance},
                    {"status", to_string(s.status)},
                    {"z", numbers(s.z)},
                    {"lambda", numbers(s.lambda)},
                    {"answer_sha256", answer_sha256(s)}};
      try {
        if (s.z.size() == 0 && s.status != Status::infeasible) throw NoProof("it gives no answer");
        if (problem.has_tangents()) throw NoProof("there are no proof files yet under this law: " + packed.law);
        search.prove(s.z, s.lambda, proof);
        replace_file(directory / names[k] / file, proof.dump() + "\n");
        ++tally.written;
        proven = true;
      } catch (const NoProof& why) {
        ++tally.without[why.what()];
      }
    }
    if (proven) replace_file(directory / "problems" / file, to_json(problem).dump() + "\n");
  }
  return tally;
}

}  // namespace zwang

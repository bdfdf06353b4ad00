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
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/friction/self_bound.h>
#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/referee_active_set.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::slip_lifts;
namespace mp = boost::multiprecision;
using Json = nlohmann::ordered_json;
using Hundred = mp::number<mp::mpfr_float_backend<100, mp::allocate_stack>, mp::et_off>;
using Numbers = VectorX<Hundred>;
using Sparse = Eigen::SparseMatrix<Hundred>;
using Rows = std::vector<Index>;

constexpr double zero = 1e-60;  // of a row's or a motion's size: 100 digits leave 1e-68 where doubles are dependent
constexpr int digits = 20;

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
    W_ = p_.rows() > 0 ? Sparse(J_ * Sparse(factor_.solve(Sparse(J_.transpose())))) : Sparse(0, 0);
    unit_ = Numbers(W_.diagonal()).cwiseSqrt();
    free_slack_ = J_ * z_u_;
    for (Index i = 0, head = 0; i < p_.rows(); ++i) {
      if (!p_.is_tangent(i)) head = i;
      counts_.push_back(std::isfinite(p_.c[head]));
      if (counts(i)) free_slack_[i] -= p_.c[i];
    }
  }

  // What proves the answer, or says that there is none.
  void prove(const Vector& z, const Vector& lambda, Json& proof) const {
    for (Index i = 0; i < p_.rows(); ++i)
      if (counts(i) && !p_.is_tangent(i) && unit_[i] == 0 &&
          (p_.is_equality(i) ? free_slack_[i] != 0 : free_slack_[i] < 0))
        return contradict(Vector::Unit(p_.rows(), i), proof);
    Problem normal = p_;  // tangent rows say nothing
    normal.mu.resize(0);
    for (Index i = 0; i < p_.rows(); ++i)
      if (p_.is_tangent(i)) normal.kind[static_cast<std::size_t>(i)] = RowKind::inequality, normal.c[i] = -infinity;
    const ScaledProblem scaled(normal);
    RefereeActiveSet active(scaled);
    ExtendedVector guess;
    if (lambda.size() > 0) guess = scaled.multipliers(lambda);
    const RefereeActiveSet::Outcome outcome =
        active.solve(scaled.motion(z.size() > 0 ? z : p_.z_u), lambda.size() > 0 ? &guess : nullptr);
    if (outcome == RefereeActiveSet::Outcome::infeasible) return contradict(active.farkas, proof);
    if (p_.has_tangents()) return slip_lifts(p_.law) ? stick(z, lambda, proof) : enclose(z, lambda, proof);
    if (outcome != RefereeActiveSet::Outcome::optimal) throw NoProof("the rows that hold were not found");
    hold(active.basis, Numbers::Zero(p_.rows()), z, lambda, proof);
  }

 private:
  bool counts(Index i) const { return counts_[static_cast<std::size_t>(i)]; }
  Hundred squared(const Numbers& v) const { return v.dot(M_ * v); }
  Numbers moved(const Numbers& force) const { return factor_.solve(Numbers(J_.transpose() * force)); }

  NoProof not_held() const {
    return NoProof(p_.has_tangents() && slip_lifts(p_.law)
                       ? "there are no proof files yet where contacts slide under Coulomb's law"
                       : "rows that depend on each other disagree in their last digits");
  }

  // Independent rows, the equality rows first.
  Rows independent(const Rows& others) const {
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i)
      if (p_.is_equality(i)) rows.push_back(i);
    std::ranges::copy_if(others, std::back_inserter(rows), [&](Index i) { return !p_.is_equality(i); });
    const ExactBasis found = exact_basis(p_.J, p_.c, rows);
    if (!found.contradictory.empty()) throw not_held();
    return found.rows;
  }

  // Forces on independent rows that bring their slack to 0.
  Numbers balance(const Rows& rows, const Numbers& slack) const {
    Numbers force = Numbers::Zero(p_.rows());
    if (rows.empty()) return force;
    Sparse pick(std::ssize(rows), p_.rows());
    for (std::size_t k = 0; k < rows.size(); ++k) pick.insert(static_cast<Index>(k), rows[k]) = 1;
    const Eigen::SimplicialLLT<Sparse> own(Sparse(pick * W_ * pick.transpose()));
    if (own.info() != Eigen::Success) throw NoProof("the rows that hold are too close to dependent");
    force -= pick.transpose() * Numbers(own.solve(Numbers(pick * slack)));
    return force;
  }

  // forces'slack, where all rows hold and forces push within their cones; under Coulomb's law, fit the slip.
  Hundred complementarity(const Numbers& slack, const Numbers& force, const Hundred& motion) const {
    Hundred total(0);
    const bool coulomb = slip_lifts(p_.law);
    const Hundred push = force.cwiseProduct(unit_).norm();
    for (Index i = 0; i < p_.rows(); ++i) {
      if (!counts(i) || p_.is_tangent(i)) continue;
      const Hundred room = unit_[i] > 0 ? Hundred(unit_[i] * motion * zero) : Hundred(0);
      const Hundred none = unit_[i] > 0 ? Hundred(push / unit_[i] * zero) : Hundred(0);
      const Index t = p_.is_equality(i) ? 0 : p_.tangents(i);
      const Hundred mu = t > 0 ? p_.mu[i] : 0., slip = slack.segment(i + 1, t).norm();
      const Hundred along = force.segment(i + 1, t).norm(), work = slack.segment(i + 1, t).dot(force.segment(i + 1, t));
      if (p_.is_equality(i) ? abs(slack[i]) > room : slack[i] - (coulomb ? Hundred(0) : mu * slip) < -room)
        throw not_held();
      if (p_.is_equality(i)) continue;
      if (force[i] < -none || along > mu * force[i] + none) throw not_held();
      if (coulomb &&
          (force[i] * slack[i] > none * motion || abs(work + mu * force[i] * slip) > none * motion * (1 + mu)))
        throw not_held();
      total += force[i] * slack[i] + work;
    }
    return total;
  }

  // The solution at which these rows hold, with the forces that are given on those that depend on others.
  void hold(const Rows& rows, Numbers force, const Vector& z, const Vector& lambda, Json& proof) const {
    const Rows basis = independent(rows);
    Json frozen = Json::array();
    for (const Index i : basis) force[i] = 0;
    for (const Index i : rows)
      if (force[i] != 0) frozen.push_back({i, static_cast<double>(force[i])});
    force += balance(basis, free_slack_ + W_ * force);
    const Numbers point = z_u_ + moved(force);
    complementarity(free_slack_ + W_ * force, force, sqrt(squared(point)) + sqrt(squared(z_u_)));
    proof["basis"] = basis;
    if (!frozen.empty()) proof["frozen"] = frozen;
    state(point, 0, z, lambda, proof);
  }

  // Coulomb's law: contacts stick or are open, as the answer's forces say.
  void stick(const Vector& z, const Vector& lambda, Json& proof) const {
    if (lambda.size() == 0) throw NoProof("there are no proof files yet under Coulomb's law without multipliers");
    Numbers force = Numbers::Zero(p_.rows());
    const Numbers size = lambda.cast<Hundred>().cwiseProduct(unit_).cwiseAbs();
    const Hundred least = size.maxCoeff() * referee::mode_cut;
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i) {
      if (p_.is_tangent(i) || !counts(i) || (!p_.is_equality(i) && (lambda[i] < 0 || size[i] <= least))) continue;
      const Index end = i + (p_.is_equality(i) || p_.mu[i] == 0 ? 0 : p_.tangents(i));
      for (Index k = i; k <= end; ++k) rows.push_back(k), force[k] = lambda[k];
    }
    hold(rows, force, z, lambda, proof);
  }

  // The convex law: what the referee's duality ends at.
  void enclose(const Vector& z, const Vector& lambda, Json& proof) const {
    const ScaledProblem scaled(p_);
    const double motion = std::max(scaled.norm_of_free_motion(), scaled.least_scale());
    const ContactProblem contacts(p_, scaled, motion);
    const auto count = contacts.contacts.size();
    const ConvexBound bound =
        bound_convex(contacts, scaled, ExtendedVector(count), Vector::Zero(static_cast<Index>(count)), nullptr);
    if (bound.x.empty()) throw NoProof("no point inside the cones was found");
    ExtendedVector x = contacts.to_motion(bound.x), l = contacts.to_multipliers(bound.lambda);
    Numbers near(p_.size()), force(p_.rows());
    Json points = Json::array(), forces = Json::array();
    const auto take = [](const DoubleDouble& number, Hundred& to, Json& list) {
      to = Hundred(number.hi) + Hundred(number.lo);
      list.push_back({number.hi, number.lo});
    };
    for (std::size_t j = 0; j < x.size(); ++j) {
      const auto k = static_cast<Index>(j);
      take(x[j].scaled(scaled.motion_exponent) + DoubleDouble(p_.z_u[k]), near[k], points);
    }
    for (std::size_t i = 0; i < l.size(); ++i)
      take(l[i].scaled(scaled.motion_exponent + scaled.mass_exponent - scaled.row_exponent[i]),
           force[static_cast<Index>(i)], forces);
    const Rows basis = independent({});
    const Numbers apart = near - z_u_;
    const Numbers onto = balance(basis, free_slack_ + J_ * apart);
    const Numbers point = near + moved(onto);
    const Numbers slack = free_slack_ + J_ * Numbers(point - z_u_);
    const Hundred gap = complementarity(slack, force, Hundred(0));
    proof["near"] = points;
    proof["forces"] = forces;
    proof["basis"] = basis;
    state(point, Hundred(squared(apart - moved(force)) + 2 * gap), z, lambda, proof);
  }

  // What follows from a solution within sqrt(square) of the point.
  void state(const Numbers& point, const Hundred& square, const Vector& z, const Vector& lambda, Json& proof) const {
    proof["verdict"] = to_string(Verdict::wrong);
    if (z.size() == 0) return;
    const Hundred motion = sqrt(std::max(squared(point), squared(z_u_)));
    const auto relative = [&](const Hundred& squares) {
      const Hundred length = sqrt(std::max(Hundred(0), squares));
      if (motion == 0 && length > 0) throw NoProof("there is no motion to measure by");
      return length <= zero * motion ? Hundred(0) : Hundred(length / motion);
    };
    const Hundred away = relative(squared(z.cast<Hundred>() - point)), radius = relative(square);
    const Hundred far = (away + radius) / (1 - radius), least = (away - radius) / (1 + radius);
    const Verdict verdict =
        by_error(static_cast<double>(far), static_cast<double>(least), proof["tolerance"].get<double>());
    if (!(radius < 1) || verdict == Verdict::undecided) throw NoProof("duality leaves the distance open");
    if (verdict == Verdict::wrong && p_.has_tangents() && slip_lifts(p_.law))
      throw NoProof("under Coulomb's law another solution may be near");
    proof["verdict"] = to_string(verdict);
    proof["distance"] = rounded_up(far);
    if (lambda.size() == 0) return;
    Numbers force = lambda.cast<Hundred>();
    std::size_t pulling = 0;
    for (Index i = 0; i < p_.rows(); ++i) {
      if (!counts(i)) force[i] = 0;
      pulling += force[i] < 0 && p_.kind[static_cast<std::size_t>(i)] == RowKind::inequality;
    }
    proof["imbalance"] = rounded_up(relative(squared(z.cast<Hundred>() - z_u_ - moved(force))));
    proof["pulling"] = pulling;
  }

  // u with u_I >= 0 and J'u = 0 on independent rows and one more.
  void contradict(const Vector& farkas, Json& proof) const {
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i)
      if (farkas[i] != 0) rows.push_back(i);
    const auto size = [&](Index i) { return Hundred(abs(farkas[i]) * (unit_[i] > 0 ? unit_[i] : Hundred(1))); };
    const Index more = *std::ranges::max_element(rows, {}, size);
    const Hundred least = size(more) * referee::no_part;
    std::erase_if(rows, [&](Index i) { return i == more || size(i) <= least; });
    if (exact_basis(p_.J, p_.c, rows).rows.size() != rows.size())
      throw NoProof("its conflicting rows depend on each other");
    Numbers u = balance(rows, W_.col(more));
    u[more] = 1;
    Hundred gain = -u.dot(free_slack_), motion = sqrt(squared(z_u_)),
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
    proof["more"] = more;
    proof["contradiction"] = rounded_up(distance * motion / gain);
  }

  const Problem& p_;
  Sparse M_, J_, W_;
  Numbers z_u_, unit_, free_slack_;
  Eigen::SimplicialLLT<Sparse> factor_;
  std::vector<char> counts_;  // silent contacts and their tangents do not
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
  std::filesystem::create_directories(directory / "problems");
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

#include <boost/multiprecision/mpfr.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/packs/proofs.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/referee/exact_rank.h>
#include <zwang/core/referee/friction/interval_newton.h>
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
using Dense = Eigen::Matrix<Hundred, Eigen::Dynamic, Eigen::Dynamic>;
using Rows = std::vector<Index>;

constexpr double straight = 1e-20;  // less of a slip is across it by rounding of what the referee found
constexpr double zero = 1e-60;      // of a row's or a motion's size: 100 digits leave 1e-68 where doubles are dependent
constexpr int digits = 20, newton_steps = 12, second_order_rounds = 20;

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

// A contact that slides along d: a tangent row, where nothing is of second order, or between two. Near its solution the
// force l and k = slip / friction. `most`: how large what is of second order may become (docs/checker/check.py).
struct Slide {
  Index row = 0, tangents = 0;
  double l = 0, k = 0, most = 0;
  std::array<double, 2> d = {};

  bool operator==(const Slide&) const = default;
  bool curved() const { return d[0] != 0 && d[1] != 0; }
  void start(const Hundred& mu, const Numbers& slack, const Numbers& force) {
    const Numbers slip = slack.segment(row + 1, tangents);
    const Hundred length = slip.norm();
    for (Index t = 0; t < tangents; ++t)
      d[at(t)] = abs(slip[t]) < straight * length ? 0 : static_cast<double>(slip[t] / length);
    l = static_cast<double>(force[row]);
    k = static_cast<double>(length / (mu * force[row]));
  }
};

// What terms of second order may change: slacks, forces, and z.
struct Spread {
  Numbers slack, force;
  Hundred motion = 0;
};

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
      if (p_.is_tangent(i)) normal.kind[at(i)] = RowKind::inequality, normal.c[i] = -infinity;
    const ScaledProblem scaled(normal);
    RefereeActiveSet active(scaled);
    ExtendedVector guess;
    if (lambda.size() > 0) guess = scaled.multipliers(lambda);
    const RefereeActiveSet::Outcome outcome =
        active.solve(scaled.motion(z.size() > 0 ? z : p_.z_u), lambda.size() > 0 ? &guess : nullptr);
    if (outcome == RefereeActiveSet::Outcome::infeasible) return contradict(active.farkas, proof);
    if (p_.has_tangents()) return follow(z, lambda, proof);
    if (outcome != RefereeActiveSet::Outcome::optimal) throw NoProof("the rows that hold were not found");
    hold(active.basis, Numbers::Zero(p_.rows()), {}, z, lambda, proof);
  }

 private:
  bool counts(Index i) const { return counts_[at(i)]; }
  Hundred squared(const Numbers& v) const { return v.dot(M_ * v); }
  Numbers moved(const Numbers& force) const { return factor_.solve(Numbers(J_.transpose() * force)); }

  // Independent rows, the equality rows first; those of slides that lift as they will be.
  Rows independent(const Rows& others, const std::vector<Slide>& slides) const {
    RowMatrix lift(p_.rows(), p_.rows());
    lift.setIdentity();
    for (const Slide& it : slides)
      for (Index t = 0; t < it.tangents && !slip_lifts(p_.law); ++t)
        lift.coeffRef(it.row, it.row + 1 + t) = -p_.mu[it.row] * it.d[at(t)];
    Rows rows;
    for (Index i = 0; i < p_.rows(); ++i)
      if (p_.is_equality(i)) rows.push_back(i);
    std::ranges::copy_if(others, std::back_inserter(rows), [&](Index i) { return !p_.is_equality(i); });
    const ExactBasis found = exact_basis(lift * p_.J, lift * p_.c, rows);
    if (!found.contradictory.empty()) throw NoProof("rows that depend on each other disagree in their last digits");
    return found.rows;
  }

  // Forces that bring the slack of the first `held` rows to 0; those of the others stay. Where contacts slide, by
  // Newton's method from these forces: its last step starts from doubles, which the slides keep.
  Numbers balance(const Rows& rows, std::size_t held, const Numbers& free_slack, Numbers force,
                  std::vector<Slide>& slides, Spread& spread) const {
    if (rows.empty()) return force;
    Sparse pick(std::ssize(rows), p_.rows());
    for (std::size_t k = 0; k < rows.size(); ++k) pick.insert(static_cast<Index>(k), rows[k]) = 1;
    const Dense W = pick * W_ * pick.transpose();
    const Numbers free = pick * free_slack;
    const Index size = std::ssize(rows), terms = 3 * std::ssize(slides);
    const auto place = [&](Index row) { return std::ranges::find(rows, row) - rows.begin(); };
    const Hundred lift = slip_lifts(p_.law) ? 0 : 1;
    Dense bends;
    std::vector<Slide> before(1);
    for (int step = 0; step < newton_steps; ++step) {
      const Numbers slack = free_slack + W_ * force;
      for (Slide& it : slides) it.start(p_.mu[it.row], slack, force);
      if (slides == before) break;
      before = slides;
      Dense A = W, units = Dense::Zero(size, terms);
      Numbers right = -free;
      for (std::size_t k = held; k < rows.size(); ++k) {
        const auto i = static_cast<Index>(k);
        A.row(i) = Numbers::Unit(size, i), right[i] = force[rows[k]];
      }
      Index term = 0;
      for (const Slide& it : slides) {
        const Index n = place(it.row), a = place(it.row + 1), b = a + it.tangents - 1;
        const Hundred mu = p_.mu[it.row], d0 = it.d[0], d1 = it.d[1], k = it.k;
        const Hundred bent = mu * it.l * (1 - d0 * d0 - d1 * d1) / 2;
        if (lift > 0 && n < static_cast<Index>(held)) {
          A.row(n) = W.row(n) - mu * (d0 * W.row(a) + d1 * W.row(b));
          right[n] = mu * (d0 * free[a] + d1 * free[b] + k * bent) - free[n];
        }
        A.row(b) = d0 * W.row(b) - d1 * W.row(a);
        A(b, a) -= k * d1, A(b, b) += k * d0;
        right[b] = d1 * free[a] - d0 * free[b];
        A.row(a).setZero();
        A(a, n) = mu, A(a, b) = d1, A(a, a) = d0;
        right[a] = bent;
        if (it.curved()) units(a, term) = 1, units(b, term + 1) = k, units(n, term + 2) = lift * k * mu;
        term += 3;
      }
      const Eigen::SparseLU<Sparse> own(A.sparseView());
      if (own.info() != Eigen::Success) throw NoProof("the rows that hold are too close to dependent");
      force = pick.transpose() * Numbers(own.solve(right));
      if (terms > 0) bends = pick.transpose() * Dense(own.solve(units));
    }
    if (terms == 0) return force;
    const Dense turned = W_ * bends;
    const Numbers slack = free_slack + W_ * force;
    Numbers most = Numbers::Zero(terms);
    const NoProof too_little("contacts slide too little for a proof");
    bool inside = false;
    for (int round = 0; round < second_order_rounds && !inside; ++round) {
      inside = true;
      spread = {turned.cwiseAbs() * most, bends.cwiseAbs() * most};
      for (Index c = 0; 3 * c < terms; ++c) {
        Slide& it = slides[at(c)];
        const Hundred mu = p_.mu[it.row], k = it.k, friction = mu * it.l;
        const auto off = [&](const Numbers& value, const Numbers& by, Index row, const Hundred& near) {
          return Hundred(abs(value[row] - near) + by[row]);
        };
        Hundred sum = mu * off(force, spread.force, it.row, it.l);
        sum += lift * off(slack, spread.slack, it.row, k * mu * friction) / (k * mu);
        for (Index t = 0; t < it.tangents; ++t) {
          const Hundred along = friction * it.d[at(t)];
          sum += off(force, spread.force, it.row + 1 + t, -along);
          sum += off(slack, spread.slack, it.row + 1 + t, k * along) / k;
        }
        if (!it.curved() || sum * sum <= friction * it.most) continue;
        if (!(sum < friction)) throw too_little;
        it.most = static_cast<double>(2 * sum * sum / friction);
        most.segment(3 * c, 3).setConstant(it.most);
        inside = false;
      }
    }
    if (!inside) throw too_little;
    for (Index k = 0; k < terms; ++k)
      if (const Hundred square = bends.col(k).dot(turned.col(k)); square > 0)
        spread.motion += most[k] * Hundred(rounded_up(sqrt(square)));
    return force;
  }

  // Throws where a row does not hold, a force pulls or leaves its cone, or does not fit the slip.
  void require_law(const Numbers& slack, const Numbers& force, const Hundred& motion, const Spread& spread,
                   const std::vector<Slide>& slides) const {
    const Hundred push = force.cwiseProduct(unit_).norm(), lift = slip_lifts(p_.law) ? 0 : 1;
    const auto require = [](bool holds) {
      if (!holds) throw NoProof("rows disagree in their last digits, or contacts are at the edge of what they do");
    };
    for (Index i = 0; i < p_.rows(); ++i) {
      if (!counts(i) || p_.is_tangent(i)) continue;
      const Hundred room = unit_[i] > 0 ? Hundred(unit_[i] * motion * zero) : Hundred(0);
      const Hundred none = unit_[i] > 0 ? Hundred(push / unit_[i] * zero) : Hundred(0);
      const Index t = p_.is_equality(i) ? 0 : p_.tangents(i);
      const Hundred mu = t > 0 ? p_.mu[i] : 0., closed = abs(slack[i]) + spread.slack[i];
      if (p_.is_equality(i)) {
        require(closed <= room);
        continue;
      }
      const Numbers slip = slack.segment(i + 1, t).cwiseAbs() + spread.slack.segment(i + 1, t);
      const Numbers along = force.segment(i + 1, t).cwiseAbs() + spread.force.segment(i + 1, t);
      const Hundred least = force[i] - spread.force[i], open = slack[i] - spread.slack[i];
      require(least >= -none && open >= -room);
      if (const auto it = std::ranges::find(slides, i, &Slide::row); it != slides.end()) {
        const Numbers s = slack.segment(i + 1, t), f = force.segment(i + 1, t);
        require(s.dot(f) + along.dot(slip) - f.cwiseAbs().dot(s.cwiseAbs()) <= 0 && (lift > 0 || closed <= room));
        for (Index k = 0; k < t && !it->curved(); ++k)
          require(it->d[at(k)] != 0 || (slip[k] <= room && along[k] <= none));
        require(it->curved() || lift == 0 || abs(slack[i] - mu * slip.norm()) <= room);
      } else {
        require(force[i] * closed <= none * motion && mu * force[i] * slip.norm() <= none * motion * (1 + mu));
        require(along.norm() <= mu * least + none && open >= lift * mu * slip.norm() - room);
      }
    }
  }

  // The solution at which these rows hold and these contacts slide. Rows that depend on others keep their forces.
  void hold(const Rows& held, Numbers force, std::vector<Slide> slides, const Vector& z, const Vector& lambda,
            Json& proof) const {
    const Numbers slack = free_slack_ + W_ * force;
    for (Slide& it : slides) it.start(p_.mu[it.row], slack, force);
    Rows rows = independent(held, slides);
    for (const Slide& it : slides)
      for (Index k = 1; k <= it.tangents; ++k) rows.push_back(it.row + k);
    const Rows basis = rows;
    for (const Index i : held) {
      if (force[i] == 0 || std::ranges::find(basis, i) != basis.end()) continue;
      const auto it = std::ranges::find(slides, i, &Slide::row);
      if (!slip_lifts(p_.law) && it != slides.end() && it->curved())
        throw NoProof("contacts that slide depend on each other");
      force[i] = static_cast<double>(force[i]);
      proof["frozen"].push_back({i, static_cast<double>(force[i])});
      rows.push_back(i);
    }
    Spread spread{Numbers::Zero(p_.rows()), Numbers::Zero(p_.rows())};
    force = balance(rows, basis.size(), free_slack_, force, slides, spread);
    const Numbers point = z_u_ + moved(force);
    require_law(free_slack_ + W_ * force, force, sqrt(squared(point)) + sqrt(squared(z_u_)), spread, slides);
    proof["basis"] = basis;
    for (const Slide& it : slides) {
      proof["slides"].push_back({it.row, it.l, it.k, it.most});
      for (Index t = 0; t < it.tangents; ++t) proof["slides"].back().push_back(it.d[at(t)]);
    }
    state(point, spread.motion * spread.motion, z, lambda, proof);
  }

  // What the contacts do near the answer, as the referee finds it; under the convex law, at the solution.
  void follow(const Vector& z, const Vector& lambda, Json& proof) const {
    const ScaledProblem scaled(p_);
    const Vector& from = z.size() > 0 ? z : p_.z_u;
    const ContactProblem contacts(p_, scaled, scaled.scale_of(scaled.norm_of(from)));
    if (!referee::may_prove(p_.size(), p_.rows()))
      throw NoProof("there are no proofs of so large problems with friction");
    const bool coulomb = slip_lifts(p_.law);
    const ExtendedVector x = contacts.motion(from);
    ModeProof found;
    if (coulomb && lambda.size() > 0) {
      const ExtendedVector l = contacts.multipliers(lambda);
      found = prove_near(contacts, {x, l, modes_by_size(contacts, x, l, referee::mode_cut)});
    }
    if (!found.proven) {
      Slips slips(std::ssize(contacts.contacts));
      for (Index c = 0; c < slips.sigma.size() && coulomb; ++c)
        slips.sigma[c] = contacts.slip(contacts.contacts[at(c)], x);
      const ConvexBound bound = bound_convex(contacts, slips, nullptr);
      found.point = bound;
      if (coulomb && bound.x.size() > 0) found = prove_near(contacts, found.point);
      if (bound.x.size() == 0 || (coulomb && !found.proven)) throw NoProof("no solution was found near it");
    }
    const ModePoint& point = found.point;
    const ExtendedVector l = contacts.to_multipliers(point.lambda);
    Numbers force = Numbers::Zero(p_.rows());
    Rows held;
    std::vector<Slide> slides;
    const auto push = [&](Index i, Index end, bool holds) {
      for (; i < end; ++i) {
        force[i] = Hundred(l[i].hi) + Hundred(l[i].lo);
        if (holds) held.push_back(i);
      }
    };
    for (const Index i : contacts.equalities) push(i, i + 1, true);
    for (std::size_t c = 0; c < contacts.contacts.size(); ++c) {
      const ContactRows& contact = contacts.contacts[c];
      const bool slide = point.modes[c] == ContactMode::slide;
      if (point.modes[c] == ContactMode::open) continue;
      push(contact.row, contact.row + 1, true);
      push(contact.row + 1, contact.row + contact.rows(), !slide);
      if (slide) slides.push_back({.row = contact.row, .tangents = contact.tangents});
    }
    hold(held, force, slides, z, lambda, proof);
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
      pulling += force[i] < 0 && p_.kind[at(i)] == RowKind::inequality;
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
    std::vector<Slide> none;
    Spread spread;
    Numbers u = balance(rows, rows.size(), Numbers(W_.col(more)), Numbers::Zero(p_.rows()), none, spread);
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

// The problem as check.py reads it; JSON has no infinity: null.
Json to_json(const Problem& p) {
  return {{"zwang_problem", 1}, {"name", p.name}, {"law", to_string(p.law)}, {"n", p.size()}, {"m", p.rows()},
          {"M", entries(p.M)},  {"z_u", p.z_u},   {"J", entries(p.J)},       {"c", p.c},      {"kind", p.kind},
          {"mu", p.mu}};
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
                        const PackProgress& progress, const std::atomic<bool>& interrupted) {
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
      Json proof = {{"zwang_proof", 2},
                    {"problem", "../problems/" + file},
                    {"sha256", packed.sha256},
                    {"name", packed.name},
                    {"solver", names[k]},
                    {"tolerance", contestants[k].tolerance},
                    {"status", to_string(s.status)},
                    {"z", s.z},
                    {"lambda", s.lambda},
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

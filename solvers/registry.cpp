#include <zwang/solvers/registry.h>

#include <charconv>
#include <sstream>
#include <stdexcept>

#include <zwang/core/problem/did_you_mean.h>
#include <zwang/solvers/active_set/cholesky.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/active_set/nnls.h>
#include <zwang/solvers/active_set/nnls_paper.h>
#include <zwang/solvers/first_order/apgd.h>
#include <zwang/solvers/first_order/pgs.h>
#include <zwang/solvers/first_order/projected_gradient.h>
#include <zwang/solvers/newton/newton.h>
#include <zwang/solvers/rivals/bullet.h>
#include <zwang/solvers/rivals/ipopt.h>
#include <zwang/solvers/rivals/mujoco.h>
#include <zwang/solvers/rivals/nlopt.h>

namespace zwang {
namespace {

template <class S>
std::string default_value(const Setting<S>& setting) {
  std::ostringstream text;
  std::visit([&](auto member) { text << std::boolalpha << S{}.*member; }, setting.member);
  return text.str();
}

[[maybe_unused]] void parse(const std::string& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) throw std::invalid_argument("a number");
}
[[maybe_unused]] void parse(const std::string& text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) throw std::invalid_argument("an integer");
}
[[maybe_unused]] void parse(const std::string& text, bool& value) {
  if (text == "on" || text == "true" || text == "1")
    value = true;
  else if (text == "off" || text == "false" || text == "0")
    value = false;
  else
    throw std::invalid_argument("on or off");
}

template <class S>
std::vector<Setting<S>> settings_of() {
  if constexpr (requires { S::settings(); }) return S::settings();
  return {};
}

template <class S>
AnySolver make(std::string_view text) {
  S solver;
  const auto settings = settings_of<S>();
  std::vector<std::string> names;
  for (const auto& s : settings) names.emplace_back(s.name);
  std::stringstream parts{std::string(text)};
  for (std::string part; std::getline(parts, part, ',');) {
    const auto equal = part.find('=');
    const std::string key = part.substr(0, equal), value = equal == std::string::npos ? "on" : part.substr(equal + 1);
    const Setting<S>* found = nullptr;
    for (const auto& s : settings)
      if (s.name == key) found = &s;
    if (!found)
      throw std::invalid_argument("solver '" + std::string(S::name) + "' has no setting '" + key + "'" +
                                  did_you_mean(key, names));
    try {
      std::visit([&](auto member) { parse(value, solver.*member); }, found->member);
    } catch (const std::invalid_argument& expected) {
      throw std::invalid_argument("solver '" + std::string(S::name) + "': setting " + key + "=" + value +
                                  " should be " + expected.what());
    }
  }
  return solver;
}

struct Traits {
  bool foreign = false, exact = false;
};

template <class S>
SolverEntry entry(std::string method, std::string limits, Traits traits = {}) {
  SolverEntry e;
  e.name = S::name;
  e.method = std::move(method);
  e.limits = std::move(limits);
  e.foreign = traits.foreign;
  e.exact = traits.exact;
  for (const auto& s : settings_of<S>())
    e.settings.push_back({std::string(s.name), std::string(s.help), default_value(s)});
  e.make = make<S>;
  return e;
}

}  // namespace

std::span<const SolverEntry> solvers() {
  static const std::vector<SolverEntry> all = {
      // One line a solver: entry<Type>(method, limits, {.foreign, .exact}).
      entry<DualActiveSet>("Goldfarb-Idnani by orthogonal updates, refined", "dense: slow beyond 1000 unknowns",
                           {.exact = true}),
      entry<Ipopt>("Ipopt 3.11.9: interior point with MUMPS, KKT-checked", "weakly active rows; near-dependent rows",
                   {.foreign = true}),
      entry<Nnls>("Lawson-Hanson NNLS on the scaled least-distance form",
                  "dense: time grows with rows x unknowns x active rows; meant for up to a few thousand rows",
                  {.exact = true}),
      entry<Cholesky>("dual active set on the Delassus form, CHOLMOD factor with row updates",
                      "squares the condition number: near-dependent rows go to orthogonal factors (fallback)",
                      {.exact = true}),
      entry<Newton>("augmented-Lagrangian semismooth Newton, sparse Cholesky by 6x6 blocks, polished",
                    "near-dependent rows go to the dense dual active set (fallback), or are reported as such",
                    {.exact = true}),
      entry<NnlsPaper>("the paper's Eq. 6-11: k with J k = c, then NNLS",
                       "wrong where c is outside range(J), and blind to infeasibility; the message gives the range gap",
                       {.exact = true}),
      entry<NloptSlsqp>("NLopt 2.7.1 SLSQP (contains Lawson-Hanson)", "dense; no multipliers; 1000 unknowns",
                        {.foreign = true}),
      entry<NloptMma>("NLopt 2.7.1 MMA, equality rows eliminated", "no multipliers; 1000 unknowns", {.foreign = true}),
      entry<NloptCcsaq>("NLopt 2.7.1 CCSAQ, equality rows eliminated", "no multipliers; 1000 unknowns",
                        {.foreign = true}),
      entry<NloptCobyla>("NLopt 2.7.1 COBYLA, derivative-free, equality rows eliminated",
                         "no multipliers; slow beyond a few unknowns; 30 unknowns", {.foreign = true}),
      entry<ProjectedGradient>("projected gradient on the dual: the example of docs/add-a-solver.md",
                               "slow; no infeasibility certificates; stops at 20000 steps"),
      entry<Pgs>("projected Gauss-Seidel on the dual", "slow on mass ratios and tall stacks; stops at its sweep limit"),
      entry<Apgd>("accelerated projected gradient on the dual, restarted",
                  "slow on mass ratios; stops at its step limit"),
      entry<BulletDantzig>("Bullet 3.24's Dantzig MLCP solver on the Delassus form",
                           "redundant rows; claims what it did not reach; 2000 rows", {.foreign = true}),
      entry<BulletPgs>("Bullet 3.24's projected Gauss-Seidel on the Delassus form",
                       "as pgs, with step length as its only test; 2000 rows", {.foreign = true}),
#ifdef ZWANG_HAS_MUJOCO
      entry<MujocoNewton>("MuJoCo 2.2.2's Newton solver on soft rows: a yardstick of speed",
                          "rows give way by their force / stiffness; no certificates; 1000 unknowns, 2000 rows",
                          {.foreign = true}),
#endif
  };
  return all;
}

const SolverEntry* find_solver(std::string_view name, std::span<const SolverEntry> among) {
  for (const SolverEntry& e : among)
    if (e.name == name) return &e;
  return nullptr;
}

AnySolver make_solver(std::string_view text, std::span<const SolverEntry> among) {
  const auto colon = text.find(':');
  const std::string name(text.substr(0, colon));
  if (const SolverEntry* e = find_solver(name, among))
    return e->make(colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1));
  std::vector<std::string> names;
  for (const SolverEntry& e : among) names.push_back(e.name);
  throw std::invalid_argument("no solver '" + name + "'" + did_you_mean(name, names) + " (./zwang solvers lists all)");
}

}  // namespace zwang

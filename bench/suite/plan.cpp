#include <zwang/bench/suite/plan.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>

#include <zwang/bench/results/measured_files.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/runs_apart.h>

namespace zwang {
namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files, tables;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    const std::filesystem::path kind = entry.path().extension();
    if (kind == ".h5" || kind == ".hdf5") files.push_back(entry.path());
    if (kind == ".dat") tables.push_back(entry.path());
  }
  // Siconos' own; beside HDF5 files a .dat may be anything.
  if (files.empty())
    files = std::move(tables);
  else if (!tables.empty())
    std::fprintf(stderr, "%s: %zu .dat files beside HDF5 files are left out; name them to have them read\n",
                 path.c_str(), tables.size());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw BadFile(path.string() + ": no *.h5, *.hdf5 or *.dat file in this folder");
  return files;
}

// "": all. Throws std::invalid_argument where a family has no problem here.
void keep_families(const std::string& families, std::vector<Instance>& instances, std::size_t& given) {
  std::vector<std::string> present, kept;
  for (const Instance& i : instances) present.push_back(i.family);
  std::stringstream parts(families);
  for (std::string family; std::getline(parts, family, ',');) {
    if (std::ranges::find(present, family) == present.end())
      throw std::invalid_argument("no problem of family '" + family + "'" + did_you_mean(family, present));
    kept.push_back(family);
  }
  if (kept.empty()) return;
  const auto is_kept = [&](const Instance& i) { return std::ranges::find(kept, i.family) != kept.end(); };
  given = static_cast<std::size_t>(std::ranges::count_if(std::span(instances).first(given), is_kept));
  std::erase_if(instances, [&](const Instance& i) { return !is_kept(i); });
}

// Under several laws a problem and its family get the word of each law that is not their own.
void state_under(const std::vector<Law>& laws, Plan& plan) {
  if (laws.empty()) return;
  std::vector<Instance> stated;
  for (const Instance& own : plan.instances)
    for (const Law law : laws) {
      if (!own.problem.has_tangents() && law != laws.front()) break;
      Instance instance = under(law, own);
      if (own.problem.has_tangents() && laws.size() > 1 && law != own.problem.law)
        for (std::string* name : {&instance.problem.name, &instance.family})
          name->append(" (").append(to_string(law)).append(")");
      if (own.problem.has_tangents() && laws.size() > 1 && law != Law::coulomb)
        plan.coulomb.emplace(stated.size(), under(Law::coulomb, own));
      stated.push_back(std::move(instance));
    }
  plan.instances = std::move(stated);
}

}  // namespace

static const std::vector<Law> three_laws{Law::pyramid, Law::convex, Law::coulomb};

// Everyday scenes (towers, hands), and the families in which methods are known to fail.
std::span<const Suite> suites() {
  static const std::vector<Suite> all = {
      {"quick",
       "tower(boxes=5),stack(boxes=5),wall(boxes=10),pile(spheres=14),arch(stones=7),chain(links=8),four_bar,"
       "hand(contacts=4,16,64),MR(k=8,40),NPE(k=8,32),LOOP(k=8,60),GAP(k=8,44),INC(k=8,44),WEAK(k=8,44),random,"
       "incline(mu=0.5),hand(contacts=4,mu=0.5),ROD,HELD,PUCK",
       {1e-2, 1e-6, 1e-10, 1e-14},
       45,
       0.5,
       true,
       "",
       false,
       false,
       three_laws,
       true},
      {"standard",
       "tower(boxes=5,10,20,40),stack(boxes=10,30),wall(boxes=25,60),pile(spheres=30,91),arch(stones=9,31),"
       "chain(links=8,16,32),four_bar,leash,hand(contacts=0,4,16,64,200),hands(hands=2,4),"
       "MR(k=0,12,24,36,48),MR1(k=24,48),MRC(k=24,48),NPE(k=4,14,24,34,44),LOOP(k=4,14,24,34,44,60),"
       "GAP(k=4,14,24,34,44,60),INC(k=4,14,24,34,44,60),WEAK(k=4,14,24,34,44,60),random(n=60,200),"
       "incline(mu=0.5),crate(push=0.75),ladder(slope=0.5),belt,peg,cards,stack(boxes=3,mu=0.5),wall(boxes=10,mu=0.5),"
       "hand(contacts=4,16,mu=0.5),planted(k=1,seed=1..3),MRF(k=0,16,32),STKF(boxes=2,4),JAM(k=4,24,44),"
       "ROD(k=4,24,44),HELD,PINCH,PUCK",
       {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14},
       480,
       2,
       true,
       "",
       false,
       false,
       three_laws,
       true},
      {"full",
       "tower(boxes=5,10,20,50,100,200),stack(boxes=5,10,20,50,100,seed=1..3),wall(boxes=25,100,200,seed=1..3),"
       "pile(spheres=14,30,91,204,seed=1..3),arch(stones=5,9,17,33,65),chain(links=4,8,16,32,64,128,seed=1..3),"
       "four_bar(lean=-2,-1,0,1,2),leash(dogs=4,16,64),hand(contacts=0,4,16,64,200,seed=1..10),"
       "hand(contacts=16,64,feasible=0,seed=1..10),hands(hands=2,4,8),MR(k=0..48),MR1(k=0..48),MRC(k=0..48),"
       "NPE(k=1..45),LOOP(k=0..48),LOOP(k=60),GAP(k=1..48),GAP(k=1..48,feasible=1),GAP(k=60),INC(k=0..48),INC(k=60),"
       "WEAK(k=0..48),WEAK(k=60),random(n=20,60,200,600,seed=1..3)",
       {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14},
       0,
       20},
      // The families of docs/stability.md, from benign to impossible.
      {"atlas",
       "MR(k=0,4,8,12,16,20,24,28,32,36,40,44,48),"
       "MR1(k=0,4,8,12,16,20,24,28,32,36,40,44,48),"
       "MRC(k=0,4,8,12,16,20,24,28,32,36,40,44,48),"
       "NPE(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45),"
       "NPI(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45),"
       "WED(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48),"
       "LOOP(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48,60),"
       "MANYF(contacts=6,12,30,60,120,300),"
       "MANYR(contacts=6,12,30,60,120,300),"
       "GAP(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48,60),"
       "GAP(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48,feasible=1),"
       "INC(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48,60),"
       "UNIT(k=0,-4,4,-8,8,-12,12,-16,16,-20,20),"
       "ROW(k=0,-50,50,-100,100,-150,150,-200,200,-250,250,-300,300,-350,350,-400,400,-450,450,-500,500),"
       "ROW(zero=1,2,3),"
       "HUGE(k=0,50,100,150,200,250,300,350,400,450,500,550,600,650,700,750,800,850,900,950,1000),"
       "ANI(k=0,4,8,12,16,20,24,28,32,36,40,44),"
       "WEAK(k=0,4,8,12,16,20,24,28,32,36,40,44,48,60),"
       "CHAIN(links=2,4,8,16,32,64,128,256,512,1024,2048,4096),"
       "STK(boxes=2,4,8,16,32,64,128,256,512,1024,2048,4096),"
       "PIVOT(n=2,4,6,8,10,12,14,16),"
       "PIVOT(n=2,4,6,8,10,12,14,16,reversed=1),"
       "CYCLE(n=5,6,7,8),"
       "FLIP(k=3,6,9,12,15,18,21,24,27,30,33,36,39,42,45,48,frame=17),"
       "HAND(seed=1..100),"
       "HAND(hands=2,4),"
       "MU0(k=0,5,10,15,20,25,30,35,40),"
       "MUL(k=0,1,2,3,4,6,8,12,16,20),"
       "APEX(k=0,5,10,15,20,25,30,35,40),"
       "SLIP(k=0,5,10,15,20,25,30,35,40),"
       "MRF(k=0,4,8,12,16,20,24,28,32,36,40),"
       "STKF(boxes=1,2,3,4,6,8),"
       "RANK(k=1,2,4,8),"
       "JAM(k=2,5,8,11,14,17,20,23,26,29,32,35,38,41,44),"
       "JAM(k=2,11,20,29,38,beyond=1),"
       "HELD(k=2,11,20,29,38),"
       "HELD(k=2,11,20,29,38,above=0),"
       "ROD(k=3,9,15,21,27,33,39,45),"
       "ROD(k=3,9,15,21,27,33,39,45,above=0),"
       "PINCH,"
       "PUCK",
       {1e-12},
       840,
       1,
       false},
      // docs/performance.md. Large problems last: what the small ones leave of the time is theirs.
      {"speed",
       "hand(contacts=0,4,16,64,200,seed=1..3),hands(hands=1,2,4,8,16,32,64,contacts=16),"
       "tower(boxes=10,30,100,300),wall(boxes=25,50,100,200),tower(boxes=1000),wall(boxes=400,1000),"
       "wall(boxes=100,200,400,1000,push=0),random(n=300,m=180,equalities=.83),"
       "random(n=600,m=360,equalities=.83),random(n=1200,m=720,equalities=.83),"
       "hand(contacts=4,16,64,mu=0.5),stack(boxes=3,10,30,mu=0.5)",
       {1e-10},
       400,
       20,
       true,
       "dual_active_set,nnls:reduce=on,cholesky:reduce=on,newton,ipopt,nlopt_slsqp,bullet_dantzig,bullet_pgs,"
       "mujoco_newton,mujoco_newton:stiffness=1e12,cone,nsgs,siconos_nsgs,siconos_nsn_fb,siconos_global_admm",
       false,
       true},
      // docs/campaigns.md: a million runs of native solvers on at most 100 unknowns, for accuracy alone.
      {"big",
       "stack(boxes=2,5,10,16,seed=1..250),wall(boxes=4,8,12,seed=1..250),pile(spheres=5,14,seed=1..400),"
       "chain(links=4,8,16,seed=1..250),hand(contacts=0,4,16,64,seed=1..250),HAND(seed=1..500),"
       "MR(k=0..48),MR1(k=0..48),MRC(k=0..48,seed=1..20),NPE(k=1..45,seed=1..30),NPI(k=1..45,seed=1..30),"
       "WED(k=1..48),LOOP(k=0..48),GAP(k=1..48),GAP(k=1..48,feasible=1),INC(k=0..48),WEAK(k=0..48,seed=1..30),"
       "UNIT(k=-20,-18,-16,-14,-12,-10,-8,-6,-4,-2,0,2,4,6,8,10,12,14,16,18,20,seed=1..60),"
       "ANI(k=0..44,seed=1..30),HUGE(k=0,100,200,300,400,500,600,700,800,900,1000,seed=1..40),"
       "ROW(k=-500,-400,-300,-200,-100,0,100,200,300,400,500,seed=1..40),MANYF(contacts=6,12,30,60,seed=1..50),"
       "MANYR(contacts=6,12,30,60,seed=1..50),FLIP(k=3..48,seed=1..10),CYCLE(n=5,6,7,8),PIVOT(n=1..16),"
       "leash(dogs=1..10,seed=1..20),random(n=10,20,40,60,80,100,m=60,seed=1..520)",
       {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14},
       0,
       0.1,
       false,
       "dual_active_set,nnls,cholesky,newton,nnls_paper,projected_gradient,pgs,apgd",
       true},
      // docs/campaigns.md: twenty thousand runs of native and foreign solvers on hundreds of unknowns.
      {"large",
       "tower(boxes=20,40,80),stack(boxes=20,40,seed=1..10),wall(boxes=25,60,seed=1..10),"
       "pile(spheres=30,91,seed=1..10),chain(links=32,64,seed=1..10),hand(contacts=64,200,seed=1..25),"
       "hands(hands=2,4,seed=1..5),arch(stones=17,33),random(n=150,200,300,seed=1..12),MANYF(contacts=120,300),"
       "MANYR(contacts=120,300)",
       {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14},
       0,
       2,
       false,
       "dual_active_set,nnls,cholesky,newton,nnls_paper,projected_gradient,pgs,apgd,ipopt,nlopt_slsqp,nlopt_mma,"
       "nlopt_ccsaq,nlopt_cobyla,bullet_dantzig,bullet_pgs,mujoco_newton,daqp,piqp,osqp,proxqp,qpoases",
       true},
  };
  return all;
}

const Suite& find_suite(const std::string& name) {
  std::vector<std::string> names;
  for (const Suite& s : suites()) {
    if (s.name == name) return s;
    names.emplace_back(s.name);
  }
  names.emplace_back("collision");  // a suite without solvers, run by bench_collision
  throw std::invalid_argument("no suite '" + name + "'" + did_you_mean(name, names) +
                              " (quick, standard, full, atlas, speed, big, large, collision)");
}

std::vector<std::string> split_solvers(const std::string& text) {
  std::vector<std::string> all;
  std::stringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const bool setting = part.find('=') != std::string::npos && part.find(':') == std::string::npos;
    if (setting && !all.empty())
      all.back() += "," + part;
    else
      all.push_back(part);
  }
  return all;
}

std::vector<Law> parse_laws(const std::string& text) {
  std::vector<Law> laws;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const Law law = parse_law(word);
    if (std::ranges::find(laws, law) != laws.end()) throw std::invalid_argument("--law " + text + " names a law twice");
    laws.push_back(law);
  }
  if (laws.empty()) throw std::invalid_argument("--law names no law");
  return laws;
}

static std::string expected_laws(const SolverEntry& entry) {
  static const std::vector<Law> without = {Law::frictionless, Law::pyramid};
  std::string text;
  for (const Law law : entry.laws.empty() ? without : entry.laws)
    text.append(text.empty() ? "" : " or ").append(to_string(law));
  return text;
}

std::string laws_not_read(const Plan& plan, std::span<const SolverEntry> among) {
  std::map<std::string, std::string> solvers;  // by what is said of them
  for (const std::string& text : split_solvers(plan.options.solvers)) {
    const SolverEntry& entry = *find_solver(text, among);
    std::map<Law, std::size_t> unread;
    for (const Instance& i : plan.instances)
      if (!entry.reads(i.problem)) ++unread[i.problem.law];
    std::string problems;
    for (const auto& [law, count] : unread)
      problems += (problems.empty() ? "" : " and ") + std::to_string(count) +
                  (count == 1 ? " problem under the law " : " problems under the law ") + std::string(to_string(law));
    if (problems.empty()) continue;
    std::string& names = solvers[" on " + problems + " (expected " + expected_laws(entry) + ")"];
    names += (names.empty() ? "" : ", ") + text;
  }
  std::string line;
  for (const auto& [said, names] : solvers) line += (line.empty() ? "Unsupported: " : "; ") + names + said;
  return line;
}

Shard read_shard(const std::string& text) {
  if (text.empty()) return {};
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.part);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, shard.of) : first;
  if (!slash || second.ec != std::errc{} || second.ptr != end || shard.part >= shard.of)
    throw std::invalid_argument("--shard " + text + " should be K/N with K from 0 to N-1, as in 0/64");
  return shard;
}

std::string why_bad(const Problem& problem) {
  if (std::string reason = bad_input(problem); !reason.empty()) return reason;
  return is_positive_definite(problem.M) ? "" : "M is not positive definite";
}

std::string Plan::title() const {
  const bool own = options.given > 0 || !options.problems.empty() || options.scenes != find_suite(options.suite).scenes;
  return own ? "your problems" : options.suite + " suite";
}

Plan make_plan(SuiteOptions options, std::span<const SolverEntry> among) {
  const Suite& suite = find_suite(options.suite);
  Plan plan;
  plan.time_limit = options.time_limit > 0 ? options.time_limit : suite.time_limit;
  plan.second_witness = suite.name == "full";
  if (options.scenes.empty() && options.problems.empty() && options.instances.empty()) options.scenes = suite.scenes;
  plan.whole_suite =
      suite.fills_time && options.scenes == suite.scenes && options.problems.empty() && options.families.empty();
  plan.limit_s = suite.limit_s;
  const bool own_scenes = options.scenes == suite.scenes && options.problems.empty() && options.instances.empty();
  plan.conformance = suite.conformance && own_scenes && options.shard.empty();
  if (own_scenes && options.laws.empty()) options.laws = suite.laws;
  options.accuracy |= suite.accuracy;
  plan.shard = read_shard(options.shard);
  if (!options.shard.empty()) {
    if (suite.speed)
      throw std::invalid_argument("the suite " + options.suite + " times sequences on one machine and has no parts");
    plan.whole_suite = false;
    plan.limit_s = 0;
  }
  if (options.tolerances.empty()) options.tolerances = suite.tolerances;
  if (options.solvers.empty())
    for (const std::string& text : split_solvers(suite.solvers))
      if (find_solver(text, among)) options.solvers += (options.solvers.empty() ? "" : ",") + text;
  if (options.solvers.empty())
    for (const SolverEntry& e : among) options.solvers += (options.solvers.empty() ? "" : ",") + e.name;

  std::sort(options.tolerances.rbegin(), options.tolerances.rend());
  options.tolerances.erase(std::unique(options.tolerances.begin(), options.tolerances.end()), options.tolerances.end());
  for (const double t : options.tolerances)
    if (!(t > 0 && t < 1)) throw std::invalid_argument("a tolerance should be between 0 and 1, as in 1e-6");
  plan.speed = suite.speed && plan.whole_suite;
  for (const std::string& text : split_solvers(options.solvers)) {
    make_solver(text, among);
    const SolverEntry& entry = *find_solver(text, among);
    Run run{.solver = text, .foreign = runs_apart(text, among)};
    // Of a yardstick a shortened limit would leave only a bound.
    if (suite.speed && entry.yardstick) run.least_time_limit = plan.time_limit;
    if (plan.speed) run.largest_island = entry.largest_island;
    for (const double t : options.tolerances) {
      run.tolerance = t;
      plan.runs.push_back(run);
    }
  }
  if (plan.runs.empty()) throw std::invalid_argument("no solver chosen");

  options.given = options.instances.size();
  plan.instances = std::move(options.instances);
  if (!options.scenes.empty())
    std::ranges::move(make_scenes(options.scenes, options.seed), std::back_inserter(plan.instances));
  if (plan.speed) {
    std::vector<Instance> measured = measured_problems();
    plan.instances.insert(plan.instances.begin(), measured.begin(), measured.end());
    std::sort(plan.instances.begin(), plan.instances.end(), [](const Instance& a, const Instance& b) {
      const Index left = a.problem.size() + a.problem.rows(), right = b.problem.size() + b.problem.rows();
      return left != right ? left < right : a.problem.name < b.problem.name;
    });
  }
  // A reader that knows the law leaves out what it does not need.
  const auto one_law = options.laws.size() == 1 ? std::optional(options.laws[0]) : std::nullopt;
  if (options.laws.size() > 1 && options.given > 0)
    throw std::invalid_argument("problems of a program's own are stated under one law at a time");
  for (std::filesystem::path& path : options.problems) {
    for (const std::filesystem::path& file : files_of(path))
      for (Instance& instance : read_problems(file, one_law)) {
        if (const std::string reason = why_bad(instance.problem); !reason.empty())
          throw BadFile(file.string() + ", problem " + instance.problem.name + ": " + reason);
        plan.instances.push_back(std::move(instance));
      }
    path = std::filesystem::absolute(path);
  }
  keep_families(options.families, plan.instances, options.given);
  state_under(options.laws, plan);
  if (plan.instances.empty()) throw std::invalid_argument("no problem chosen");
  plan.options = std::move(options);
  return plan;
}

}  // namespace zwang

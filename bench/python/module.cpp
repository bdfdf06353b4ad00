// _zwang: what the Python package `zwang` is made of. Its modules check types and indices before they call.
#include <pthread.h>
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <numeric>

#include <zwang/bench/packs/judge_pack.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/references/judge.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/scene_change.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/cpu_clock.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/referee/exact_rank.h>
#include <zwang/solvers/friction/solution_derivative.h>
#include <zwang/solvers/registry.h>

namespace py = pybind11;
using namespace py::literals;

namespace zwang {
namespace {

// pybind11's __new__ makes an object whose value only __init__ sets: reading it before crashes. Python refuses the
// __new__ of a base to a type that has one of its own, so that only a call of the class makes objects.
template <class T>
py::class_<T> made_by_calls(py::class_<T> type) {
  reinterpret_cast<PyTypeObject*>(type.ptr())->tp_new = [](PyTypeObject* made, PyObject* args, PyObject* words) {
    return py::detail::pybind11_object_new(made, args, words);
  };
  return type;
}

Instance make_problem(const SparseMatrix& M, const Vector& z_u, const RowMatrix& J, const Vector& c,
                      const py::array_t<bool>& equality, const py::array_t<bool>& tangent, const Vector& mu,
                      const std::string& law, std::string name) {
  Instance out;
  Problem& p = out.problem;
  p.name = std::move(name);
  p.M = M;
  p.z_u = z_u;
  p.J = J;
  p.c = c;
  for (Index i = 0; i < equality.size(); ++i) {
    p.kind.push_back(equality.at(i) ? RowKind::equality : tangent.at(i) ? RowKind::tangent : RowKind::inequality);
    p.key.push_back({0, static_cast<std::uint32_t>(i)});
  }
  p.mu = mu;
  p.law = parse_law(law);
  // What bench, judge and solve say of numbers that nobody can work with.
  require_matching_sizes(p);
  if (const std::string bad = why_bad(p); !bad.empty()) throw std::invalid_argument(bad);
  return out;
}

py::array_t<bool> rows_of(const Instance& i, RowKind kind) {
  py::array_t<bool> out(i.problem.rows());
  std::ranges::transform(i.problem.kind, out.mutable_data(), [kind](RowKind own) { return own == kind; });
  return out;
}

// Of the first unknown of each body, -1 without; empty where no scene made the problem.
std::vector<int> bodies(const Instance& instance) {
  std::vector<int> column;
  if (instance.step) first_columns(instance.step->scene.bodies, column);
  return column;
}

// body: -1 for none.
py::tuple change_of_scene(const Instance& instance, int body, const Vector& pose, const Vector& velocity, double mass,
                          double mu) {
  SceneChange change{.bodies = std::vector<SceneChange::OfBody>(bodies(instance).size()), .friction = mu};
  if (body >= 0) change.bodies.at(at(body)) = {pose, velocity, mass};
  const Problem d = scene_change(instance, change);
  return py::make_tuple(d.M, d.z_u, d.J, d.c, d.has_tangents() ? d.mu : Vector::Zero(d.rows()));
}

// CPU seconds of this process's other threads, and of its children that have ended: a function's time, whoever it lets
// do the work.
double cpu_seconds_beside() {
  timespec all{};
  rusage ended{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &all);
  getrusage(RUSAGE_CHILDREN, &ended);
  const double own = thread_cpu_seconds() - seconds_elsewhere;
  const auto seconds = [](auto whole, auto part, double unit) {
    return static_cast<double>(whole) + unit * static_cast<double>(part);
  };
  return seconds(all.tv_sec, all.tv_nsec, 1e-9) - own +
         seconds(ended.ru_utime.tv_sec + ended.ru_stime.tv_sec, ended.ru_utime.tv_usec + ended.ru_stime.tv_usec, 1e-6);
}

// A Python callable as a solver: called as f(problem, tolerance), it returns z, (z, lambda) or None. It runs in a child
// process with a deadline, like every foreign solver.
struct PythonSolver {
  static constexpr auto name = "python";
  std::shared_ptr<py::function> call = {};

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    const py::gil_scoped_acquire python;
    const double beside = cpu_seconds_beside();
    try {
      Instance instance;
      instance.problem = problem;
      const py::object answer = (*call)(instance, options.tolerance);
      if (answer.is_none()) {
        solution.status = Status::numerical_failure;
        solution.message = "no answer";
        return solution.empty_z();
      }
      std::tie(solution.z, solution.lambda) = py::cast<std::pair<Vector, Vector>>(answer);
      if (solution.z.size() != problem.size() ||
          (solution.lambda.size() != 0 && solution.lambda.size() != problem.rows()))
        throw std::invalid_argument("z or lambda has the wrong size");
      solution.status = Status::solved;
    } catch (const std::exception& bad) {
      solution.status = Status::numerical_failure;
      solution.message = std::string(bad.what()).substr(0, std::string(bad.what()).find('\n'));
      solution.empty_answer();
    }
    seconds_elsewhere += std::max(0.0, cpu_seconds_beside() - beside);
  }
};

void add_python_solver(const std::string& name, py::function call, const std::string& method) {
  if (name.empty() || name.find_first_of(",:") != std::string::npos)
    throw std::invalid_argument("a solver's name has no comma and no colon: '" + name + "'");
  // The interpreter is told in the child that it is a copy, once.
  static const int hook = pthread_atfork(nullptr, nullptr, [] {
    if (Py_IsInitialized() && PyGILState_Check()) PyOS_AfterFork_Child();
  });
  if (hook != 0) throw std::runtime_error("pthread_atfork failed");
  // Never destroyed: the interpreter may be gone when the registry is.
  auto* kept = new std::shared_ptr<py::function>(new py::function(std::move(call)), [](py::function*) {});
  add_solver({.name = name,
              .method = method,
              .limits = "a Python function",
              .foreign = true,
              .sees_infeasibility = false,
              .make = [kept](std::string_view) -> AnySolver { return PythonSolver{*kept}; }});
}

// Under which it reads tangent rows.
std::vector<std::string> laws_of(const SolverEntry& entry) {
  std::vector<std::string> words;
  for (const Law law : entry.laws) words.emplace_back(to_string(law));
  return words;
}

// Of each its default and what it does.
py::dict settings_of(const SolverEntry& entry) {
  py::dict all;
  for (const SettingInfo& s : entry.settings) all[py::str(s.name)] = py::dict("default"_a = s.value, "help"_a = s.help);
  return all;
}

using Values = SolutionDerivative::Values;

// Where it stays: to move it would copy M and J.
std::unique_ptr<SolutionDerivative> derivative_of(const Problem& problem, const Values& z, const Values& lambda) {
  auto made = std::make_unique<SolutionDerivative>(problem, z, lambda);
  if (made->off <= tolerances::derivative_tie * made->motion) return made;
  throw std::invalid_argument(printed("the answer is off by %.1e of the motion, and modes are read to %.0e",
                                      made->off / (made->motion > 0 ? made->motion : 1), tolerances::derivative_tie));
}

auto parts_of(SolutionDerivative::Change change) {
  return std::tuple(std::move(change.z), std::move(change.lambda), change.is_unique, change.is_settled,
                    change.is_small);
}

struct Solved {
  Solution solution;
  double seconds = 0;
};

Solved solve(const Instance& instance, const std::string& asked, double tolerance, const std::string& accuracy,
             int max_iterations, double time_limit, const std::optional<Vector>& warm, bool keep_python) {
  std::string text = asked;
  if (text.substr(0, text.find(':')) == "auto") text.replace(0, 4, usual_solver(instance.problem));
  thread_local std::string known;
  if (text != known) make_solver(text);  // a wrong name or setting is said before anything runs
  known = text;
  if (!(tolerance > 0 && tolerance < 1)) throw std::invalid_argument("tolerance should lie between 0 and 1");
  SolveOptions().read_accuracy(accuracy);
  SolveRequest request{.solver = text,
                       .tolerance = tolerance,
                       .accuracy = accuracy,
                       .time_limit = time_limit,
                       .max_iterations = max_iterations,
                       .fresh = true,
                       .form = &SolutionDerivative::form()};
  if (warm) {
    request.warm = {.key = instance.problem.key, .lambda = *warm};
    if (request.warm.lambda.size() != instance.problem.rows())
      throw std::invalid_argument("warm_start should have " + std::to_string(instance.problem.rows()) +
                                  " entries, and has " + std::to_string(request.warm.lambda.size()));
  }
  const Run run{.solver = text, .foreign = runs_apart(text), .tolerance = tolerance, .accuracy = accuracy};
  std::optional<py::gil_scoped_release> free;
  if (!keep_python) free.emplace();
  Dispatcher dispatcher;
  if (run.foreign) dispatcher.child.load(instance.problem);
  SolveReply reply = dispatcher.run(instance.problem, run, request, nullptr);
  return {std::move(reply.solution), reply.seconds};
}

// Ctrl-C stops a suite, and then does what it does in Python. Threads beside the main one are never interrupted.
struct Interruptible {
  static inline std::atomic<bool> interrupted = false;
  const bool main = gettid() == getpid();
  const PyOS_sighandler_t before = main ? PyOS_setsig(SIGINT, [](int) { interrupted = true; }) : nullptr;
  ~Interruptible() {
    if (main) PyOS_setsig(SIGINT, before);
    if (main && interrupted.exchange(false)) PyErr_SetInterrupt();
  }
};

void judge_answers(const std::filesystem::path& directory, const std::vector<std::filesystem::path>& files,
                   const std::filesystem::path& out) {
  const Pack pack(directory);
  std::vector<Answers> contestants;
  for (const std::filesystem::path& file : files) contestants.push_back(read_answers(file, pack));
  judge_pack(pack, std::move(contestants),
             {.directory = new_directory(out.string(), ""),
              .cache = reference_cache(),
              .command = "zwang.judge_pack",
              .quiet = true},
             Interruptible::interrupted);
}

}  // namespace

PYBIND11_MODULE(_zwang, m) {
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"}) setenv(name, "1", 0);
  m.attr("__version__") = conditions().version;
  py::register_exception<BadFile>(m, "BadFile", PyExc_ValueError);
  py::register_exception<NotDefinite>(m, "NotDefinite", PyExc_ValueError);

  made_by_calls(py::class_<Instance>(m, "Problem"))
      .def(py::init(&make_problem))
      .def_property_readonly(
          "M", [](const Instance& i) { return i.problem.M; }, "n x n, scipy.sparse.csc_matrix")
      .def_property_readonly(
          "J", [](const Instance& i) { return i.problem.J; }, "m x n, scipy.sparse.csr_matrix")
      .def_property_readonly("z_u", [](const Instance& i) { return i.problem.z_u; })
      .def_property_readonly("c", [](const Instance& i) { return i.problem.c; })
      .def_property_readonly("equality", [](const Instance& i) { return rows_of(i, RowKind::equality); })
      .def_property_readonly("tangent", [](const Instance& i) { return rows_of(i, RowKind::tangent); })
      .def_property_readonly("mu",
                             [](const Instance& i) -> Vector {
                               return i.problem.has_tangents() ? i.problem.mu : Vector::Zero(i.problem.rows());
                             })
      .def_property_readonly("law", [](const Instance& i) { return std::string(to_string(i.problem.law)); })
      .def("_under", [](const Instance& i, const std::string& law) { return under(parse_law(law), i); })
      .def_property_readonly("size", [](const Instance& i) { return i.problem.size(); })
      .def_property_readonly("rows", [](const Instance& i) { return i.problem.rows(); })
      .def_property_readonly("name", [](const Instance& i) { return i.problem.name; })
      .def_readonly("family", &Instance::family)
      .def("_name_it",
           [](Instance& i, const std::string& a, const std::string& b) { i.problem.name = a, i.family = b; })
      .def_readonly("notes", &Instance::notes)
      .def_property_readonly("bodies", &bodies)
      .def("_scene_change", &change_of_scene)
      .def_property_readonly("row_names",
                             [](const Instance& i) {
                               std::vector<std::string> names;
                               for (Index r = 0; r < i.problem.rows(); ++r) names.push_back(row_name(i, r));
                               return names;
                             })
      .def_property_readonly("sha256", [](const Instance& i) { return problem_sha256(i.problem); })
      .def_property_readonly("_reference", [](const Instance& i) -> py::object {
        if (!i.reference) return py::none();
        return py::dict("feasible"_a = i.reference->feasible, "z"_a = i.reference->z, "lambda_"_a = i.reference->lambda,
                        "bound"_a = i.reference->bound, "method"_a = i.reference->method);
      });

  made_by_calls(py::class_<Solved>(m, "Solution"))
      .def_property_readonly("status", [](const Solved& s) { return std::string(to_string(s.solution.status)); })
      .def_property_readonly("z", [](const Solved& s) { return s.solution.z; })
      .def_property_readonly("lambda_", [](const Solved& s) { return s.solution.lambda; })
      .def_property_readonly("certificate", [](const Solved& s) { return s.solution.certificate; })
      .def_property_readonly("iterations", [](const Solved& s) { return s.solution.iterations; })
      .def_property_readonly("error_bound", [](const Solved& s) { return s.solution.error_bound; })
      .def_property_readonly("message", [](const Solved& s) { return s.solution.message; })
      .def_property_readonly("handed_to", [](const Solved& s) { return s.solution.handed_to; })
      .def_property_readonly("redundant", [](const Solved& s) { return s.solution.redundant; })
      .def_readonly("seconds", &Solved::seconds);

  made_by_calls(py::class_<SolutionDerivative>(m, "SolutionDerivative"))
      .def(py::init([](const Instance& instance, const Solved& solved) {
        return derivative_of(instance.problem, solved.solution.z, solved.solution.lambda);
      }))
      .def(py::init([](const Instance& instance, const Values& z, const Values& lambda) {
        return derivative_of(instance.problem, z, lambda);
      }))
      .def_readonly("rows", &SolutionDerivative::rows)
      .def_readonly("ties", &SolutionDerivative::ties)
      .def_readonly("by_mu", &SolutionDerivative::by_mu)
      .def_property_readonly("slides", &SolutionDerivative::slides)
      .def_readonly("ties_rub", &SolutionDerivative::ties_rub)
      .def("along", [](SolutionDerivative& own, const Values& dz_u) { return parts_of(own.along(dz_u)); })
      .def("along", [](SolutionDerivative& own, const Values& dz_u, const Values& force, const Values& moved,
                       const Values& dmu) { return parts_of(own.along(dz_u, force, moved, dmu)); })
      .def("back", [](SolutionDerivative& own, const Values& z_bar, const Values& lambda_bar, const py::tuple& names) {
        if (names.empty()) throw std::invalid_argument("no names");
        SolutionDerivative::Bars bars = own.back(z_bar, lambda_bar);
        const bool unique = bars.change.is_unique;
        py::dict out;
        for (const py::handle& name : names) {
          const std::string word = py::str(name);
          py::object bar = py::none();
          if (word == "z_u")
            bar = py::cast(bars.z_u);
          else if (word == "mu")
            bar = py::cast(bars.mu);
          else if (word == "M")
            bar = py::cast(own.by_M(bars.change));
          else if (word != "J" && word != "c")
            throw std::invalid_argument("a name of another kind");
          else if (unique)
            bar = word == "J" ? py::cast(own.by_J(bars.change)) : py::cast(Vector(-bars.change.lambda));
          out[name] = bar;
        }
        return std::pair(out, unique);
      });

  made_by_calls(py::class_<Judgement>(m, "Judgement"))
      .def_property_readonly("verdict", [](const Judgement& j) { return std::string(to_string(j.verdict)); })
      .def_readonly("at_least", &Judgement::at_least)
      .def_readonly("at_most", &Judgement::at_most)
      .def_readonly("proof", &Judgement::proof)
      .def_readonly("worst_row", &Judgement::worst_row)
      .def_readonly("scale_over_answer", &Judgement::scale_over_answer)
      .def_property_readonly("primal", [](const Judgement& j) { return j.metrics.primal; })
      .def_property_readonly("dual", [](const Judgement& j) { return j.metrics.dual; })
      .def_property_readonly("stationarity", [](const Judgement& j) { return j.metrics.stationarity; })
      .def_property_readonly("complementarity", [](const Judgement& j) { return j.metrics.complementarity; })
      .def_property_readonly("natural", [](const Judgement& j) { return j.metrics.natural; })
      .def_property_readonly("scale", [](const Judgement& j) { return j.metrics.scale; })
      .def("__str__", [](const Judgement& j) { return j.text; })
      .def("__repr__", [](const Judgement& j) { return "<" + j.text + ">"; });

  m.def("solvers", [] {
    std::vector<py::dict> all;
    for (const SolverEntry& e : solvers())
      all.push_back(py::dict("name"_a = e.name, "method"_a = e.method, "limits"_a = e.limits, "foreign"_a = e.foreign,
                             "exact"_a = e.exact, "laws"_a = laws_of(e), "settings"_a = settings_of(e)));
    return all;
  });
  m.def("scenes", [] {
    std::vector<py::dict> all;
    for (const SceneEntry& e : scenes()) {
      std::vector<py::dict> knobs;
      for (const Knob& k : e.knobs)
        knobs.push_back(py::dict("name"_a = k.name, "value"_a = k.value, "low"_a = k.low, "high"_a = k.high,
                                 "integer"_a = k.integer, "help"_a = k.help));
      all.push_back(py::dict("name"_a = e.name, "family"_a = e.family, "line"_a = e.line, "knobs"_a = knobs));
    }
    return all;
  });
  const auto free = py::call_guard<py::gil_scoped_release>();
  m.def("make_scenes", &make_scenes, "text"_a, "seed"_a, "mu"_a = py::none(), free);
  m.def("load", [](const std::filesystem::path& file) { return read_problems(file); }, free);
  m.def(
      "save",
      [](const std::filesystem::path& file, const std::vector<Instance>& problems) {
        problems.size() == 1 ? write_problem(file, problems[0]) : write_problems(file, problems);
      },
      free);
  m.def("solve", &solve);
  m.def(
      "judge",
      [](const Instance& instance, const Vector& z, const Vector& lambda, double tolerance) {
        return judge(instance, z, lambda, tolerance, reference_cache());
      },
      free);
  m.def(
      "judge_infeasible",
      [](const Instance& instance, const Vector& certificate) {
        return judge_infeasible(instance, certificate, reference_cache());
      },
      free);
  made_by_calls(py::class_<QuadraticProgram>(m, "Program"))
      .def(py::init<SparseMatrix, Vector, RowMatrix, Vector, RowMatrix, Vector, Vector, Vector>());
  m.def("from_qp", [](const QuadraticProgram& program) {
    AsLeastConstraint form = as_least_constraint(program);
    // Printed upwards: a bound.
    form.instance.notes.push_back(printed("z_u = -P^-1 q is rounded: |z_u + P^-1 q|_P <= %.3g", 1.01 * form.rounding));
    return form.instance;
  });
  m.def(
      "judge_qp",
      [](const QuadraticProgram& program, const Vector& x, const Vector& y, const Vector& z, const Vector& z_box,
         double tolerance) { return judge(program, x, y, z, z_box, tolerance); },
      free);
  m.def("by_error", [](double upper, double lower, double tolerance) {
    return std::string(to_string(by_error(upper, lower, tolerance)));
  });
  // Of the rows, in their order: which are independent of those before them, and which contradict those before them.
  m.def("exact_basis", [](const RowMatrix& J, const Vector& c) {
    if (c.size() != J.rows()) throw std::invalid_argument("right should have one entry a row");
    const py::gil_scoped_release working;
    std::vector<Index> all(at(J.rows()));
    std::iota(all.begin(), all.end(), Index{0});
    const ExactBasis found = exact_basis(J, c, all);
    return std::pair(found.rows, found.contradictory);
  });
  m.def("judge_pack", &judge_answers, py::call_guard<Interruptible, py::gil_scoped_release>());
  m.def("add_solver", &add_python_solver);
  // Runs a suite into `directory` and leaves results.jsonl there.
  m.def("bench", [](const std::string& suite, const std::string& scenes, const std::vector<Instance>& problems,
                    const std::vector<std::filesystem::path>& files, const std::string& chosen,
                    const std::vector<double>& tolerances, int repetitions, std::uint64_t seed,
                    const std::optional<std::string>& law, bool keep_python, const std::filesystem::path& directory,
                    bool progress) {
    SuiteOptions options{.suite = suite,
                         .scenes = scenes,
                         .problems = files,
                         .instances = problems,
                         .laws = law ? parse_laws(*law) : std::vector<Law>(),
                         .solvers = chosen,
                         .tolerances = tolerances,
                         .repetitions = repetitions,
                         .seed = seed};
    const Interruptible stoppable;
    std::optional<py::gil_scoped_release> working;
    if (!keep_python) working.emplace();
    run_suite(make_plan(std::move(options)),
              {.directory = new_directory(directory.string(), ""),
               .cache = reference_cache(),
               .command = "zwang.bench",
               .quiet = !progress},
              Interruptible::interrupted);
  });
}

}  // namespace zwang

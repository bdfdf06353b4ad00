#include <zwang/bench/fuzz/worker.h>

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <numeric>
#include <sstream>
#include <system_error>
#include <tuple>

#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

constexpr std::size_t most_solvers = 32, most_files = 20;
constexpr double hang = 60;  // s

// What a worker and its parent both see.
struct Shared {
  std::atomic<std::uint64_t> next;  // the problem at hand, or the first one not yet looked at
  std::atomic<std::uint64_t> done;
  std::atomic<std::size_t> solver;
  FuzzTally tally[most_solvers];
};

struct Unmap {
  void operator()(Shared* shared) const { munmap(shared, sizeof(Shared)); }
};
using SharedMemory = std::unique_ptr<Shared, Unmap>;

SharedMemory shared_memory() {
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "no shared memory");
  return SharedMemory(new (memory) Shared{});
}

struct Worker {
  SharedMemory shared = shared_memory();
  pid_t pid = -1;
  int from = -1;
  std::string text = {};  // what came and is not yet a whole line
  std::uint64_t seen = 0;
  double moved = 0;  // when it last went on
};

std::string name_of(const Fault& fault) {
  return std::to_string(fault.number) + "-" + fault.solver.substr(0, fault.solver.find(':'));
}

std::filesystem::path write(const std::filesystem::path& directory, const std::string& name, const Fault& fault) {
  try {
    std::filesystem::create_directories(directory);
    const auto file = directory / (name + ".h5");
    write_problem(file, fault.instance);
    return file;
  } catch (const std::runtime_error&) {
    return {};  // the finding itself is kept
  }
}

}  // namespace

FuzzOutcome run_fuzz(const FuzzOptions& options, int jobs, const std::filesystem::path& directory,
                     std::span<const SolverEntry> among, const std::function<void(std::uint64_t)>& progress,
                     const std::atomic<bool>& interrupted) {
  FuzzOutcome outcome{.solvers = fuzzed_solvers(options, among)};
  if (outcome.solvers.size() > most_solvers) throw std::invalid_argument("at most 32 solvers are fuzzed at once");
  std::vector<FuzzTally> unused(outcome.solvers.size());
  // Throws here, before any process starts, where a name is mistyped.
  Fuzzer(options, among, unused, [](std::size_t) {}, [](const Fault&) {});
  const std::uint64_t end = options.first + options.count, step = static_cast<std::uint64_t>(jobs);
  const double start = wall_seconds();
  const pid_t parent = getpid();
  std::map<std::string, std::size_t> files, same_name;  // by solver; of further faults of one solver on one problem

  const auto work = [&](Shared& shared, int to) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0);
    std::signal(SIGINT, SIG_IGN);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const auto report = [&](const Fault& fault) {
      std::filesystem::path file;
      if (files[fault.solver]++ < most_files) {
        std::string name = name_of(fault);
        if (const std::size_t number = ++same_name[name]; number > 1) name.append("-").append(std::to_string(number));
        file = write(directory, name, fault);
      }
      std::ostringstream line;
      line << fault.number << '\t' << fault.solver << '\t' << file.string() << '\t' << fault.what << '\n';
      const std::string text = line.str();
      for (std::size_t at = 0; at < text.size();) {
        const ssize_t written = ::write(to, text.data() + at, text.size() - at);
        if (written <= 0) _exit(1);
        at += static_cast<std::size_t>(written);
      }
    };
    Fuzzer fuzzer(options, among, shared.tally, [&](std::size_t i) { shared.solver = i; }, report);
    while (shared.next < end) {
      fuzzer.look(shared.next);
      ++shared.done;
      shared.next += step;
    }
    _exit(0);
  };
  const auto launch = [&](Worker& worker) {
    int ends[2];
    if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "no pipe");
    worker.pid = fork();
    if (worker.pid < 0) throw std::system_error(errno, std::generic_category(), "no child process");
    if (worker.pid == 0) {
      close(ends[0]);
      work(*worker.shared, ends[1]);
    }
    close(ends[1]);
    worker.from = ends[0];
    worker.moved = wall_seconds();
  };
  const auto take_lines = [&](Worker& worker) {
    for (std::size_t at; (at = worker.text.find('\n')) != std::string::npos; worker.text.erase(0, at + 1)) {
      std::stringstream line(worker.text.substr(0, at));
      std::string number, solver, file, what;
      std::getline(std::getline(std::getline(line, number, '\t'), solver, '\t'), file, '\t');
      std::getline(line, what);
      outcome.findings.push_back({std::stoull(number), solver, what, file});
    }
  };
  // The worker died or hung: a fault of the solver that was running.
  const auto bury = [&](Worker& worker, const std::string& how) {
    Shared& shared = *worker.shared;
    const std::string solver = outcome.solvers[shared.solver];
    ++shared.tally[shared.solver].faults;
    Fault fault{.number = shared.next, .solver = solver, .what = how};
    fault.instance.problem = fuzzed_problem(options, shared.next);
    fault.instance.reference = fuzzed_truth(options, fault.instance.problem);
    outcome.findings.push_back({fault.number, solver, how, write(directory, name_of(fault) + "-died", fault)});
    shared.next += step;
    ++shared.done;
  };

  std::vector<Worker> workers(static_cast<std::size_t>(jobs));
  for (std::size_t j = 0; j < workers.size(); ++j) {
    workers[j].shared->next = options.first + j;
    launch(workers[j]);
  }
  const auto done = [&] {
    return std::accumulate(workers.begin(), workers.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Worker& w) { return sum + w.shared->done; });
  };
  const auto running = [&] { return std::ranges::any_of(workers, [](const Worker& w) { return w.pid >= 0; }); };
  while (running()) {
    std::vector<pollfd> waiting;
    for (const Worker& w : workers) waiting.push_back({w.from, POLLIN, 0});
    poll(waiting.data(), waiting.size(), 200);
    for (std::size_t j = 0; j < workers.size(); ++j) {
      Worker& w = workers[j];
      if (w.pid < 0) continue;
      char bytes[4096];
      ssize_t got = 1;
      if (waiting[j].revents != 0 && (got = read(w.from, bytes, sizeof bytes)) > 0)
        w.text.append(bytes, static_cast<std::size_t>(got));
      take_lines(w);
      if (w.seen != w.shared->next) {
        w.seen = w.shared->next;
        w.moved = wall_seconds();
      }
      const bool hangs = wall_seconds() - w.moved > hang;
      if (interrupted || hangs) kill(w.pid, SIGKILL);
      if (got > 0 && !interrupted && !hangs) continue;
      int status = 0;
      waitpid(w.pid, &status, 0);
      close(w.from);
      w.pid = w.from = -1;
      if (interrupted || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) continue;
      bury(w, hangs ? "hangs" : WIFSIGNALED(status) ? std::string("dies: ") + strsignal(WTERMSIG(status)) : "dies");
      if (w.shared->next < end) launch(w);
    }
    progress(done());
  }
  outcome.done = done();
  outcome.tally.assign(outcome.solvers.size(), {});
  for (const Worker& w : workers)
    for (std::size_t i = 0; i < outcome.solvers.size(); ++i) outcome.tally[i] += w.shared->tally[i];
  std::ranges::sort(outcome.findings, {},
                    [](const Finding& f) { return std::tie(f.number, f.solver, f.what, f.file); });
  outcome.seconds = wall_seconds() - start;
  outcome.interrupted = interrupted;
  return outcome;
}

}  // namespace zwang

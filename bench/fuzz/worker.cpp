#include <zwang/bench/fuzz/worker.h>

#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <system_error>
#include <tuple>

#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/process/child_process.h>
#include <zwang/core/process/wire.h>

namespace zwang {

void fields(auto visit, same_but_const<Finding> auto& x) { visit(x.number, x.solver, x.what, x.file); }

namespace {

constexpr std::size_t most_solvers = 32, most_files = 20;
constexpr double hang = 60, patience_when_interrupted = 1;  // s

// What a worker and its parent both see.
struct Shared {
  std::atomic<std::uint64_t> next;  // the problem at hand, or the first one not yet looked at
  std::atomic<std::uint64_t> done;
  std::atomic<std::size_t> solver;
  std::atomic<bool> enough;
  FuzzTally tally[most_solvers];
};

std::shared_ptr<Shared> shared_memory() {
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "no shared memory");
  return {new (memory) Shared{}, [](Shared* shared) { munmap(shared, sizeof(Shared)); }};
}

struct Worker {
  std::shared_ptr<Shared> shared = shared_memory();
  Peer peer = {};  // which sends its findings
  std::uint64_t seen = 0;
  double moved = 0;  // when it last went on
};

std::string name_of(const Fault& fault) {
  return std::to_string(fault.number) + "-" + fault.solver.substr(0, fault.solver.find(':'));
}

Finding write(const std::filesystem::path& directory, const std::string& name, const Fault& fault) {
  Finding finding{fault.number, fault.solver, fault.what, directory / (name + ".h5")};
  try {
    std::filesystem::create_directories(directory);
    write_problem(finding.file, fault.instance);
  } catch (const std::runtime_error& bad) {
    finding.file.clear();
    finding.what.append("; no file: ").append(bad.what());
  }
  return finding;
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
  std::map<std::string, std::size_t> files, same_name;  // by solver; of further faults of one solver on one problem

  const auto work = [&](Shared& shared, int socket) {
    const auto report = [&](const Fault& fault) {
      Finding finding{fault.number, fault.solver, fault.what};
      if (files[fault.solver]++ < most_files) {
        std::string name = name_of(fault);
        if (const std::size_t number = ++same_name[name]; number > 1) name.append("-").append(std::to_string(number));
        finding = write(directory, name, fault);
      }
      send_message(socket, pack(finding));
    };
    Fuzzer fuzzer(options, among, shared.tally, [&](std::size_t i) { shared.solver = i; }, report);
    while (shared.next < end && !shared.enough) {
      fuzzer.look(shared.next);
      ++shared.done;
      shared.next += step;
    }
  };
  const auto launch = [&](Worker& worker) {
    worker.peer.start([&](int socket) { work(*worker.shared, socket); });
    worker.moved = wall_seconds();
  };
  // The worker died or hung: a fault of the solver that was running.
  const auto bury = [&](Worker& worker, const std::string& how) {
    Shared& shared = *worker.shared;
    const std::string solver = outcome.solvers[shared.solver];
    ++shared.tally[shared.solver].faults;
    const Fault fault{shared.next, solver, how, fuzzed(options, shared.next)};
    outcome.findings.push_back(write(directory, name_of(fault) + "-died", fault));
    shared.next += step;
    ++shared.done;
  };

  std::vector<Worker> workers(at(jobs));
  for (std::size_t j = 0; j < workers.size(); ++j) {
    workers[j].shared->next = options.first + j;
    launch(workers[j]);
  }
  const auto done = [&] {
    return std::accumulate(workers.begin(), workers.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Worker& w) { return sum + w.shared->done; });
  };
  while (std::ranges::any_of(workers, [](const Worker& w) { return w.peer.runs(); })) {
    std::vector<pollfd> waiting;
    for (const Worker& w : workers) waiting.push_back({w.peer.socket(), POLLIN, 0});
    poll(waiting.data(), waiting.size(), 200);
    for (std::size_t j = 0; j < workers.size(); ++j) {
      Worker& w = workers[j];
      if (!w.peer.runs()) continue;
      std::string message;
      const bool lives = waiting[j].revents == 0 || receive_message(w.peer.socket(), message);
      if (!message.empty() && lives) outcome.findings.push_back(unpack<Finding>(message));
      if (w.seen != w.shared->next) {
        w.seen = w.shared->next;
        w.moved = wall_seconds();
      }
      w.shared->enough = interrupted.load();
      const bool hangs = message.empty() && wall_seconds() - w.moved > (interrupted ? patience_when_interrupted : hang);
      if (lives && !hangs) continue;
      const int status = w.peer.stop();
      if ((hangs && interrupted) || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) continue;
      bury(w, hangs ? "hangs" : WIFSIGNALED(status) ? std::string("dies: ") + strsignal(WTERMSIG(status)) : "dies");
      if (w.shared->next < end && !interrupted) launch(w);
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

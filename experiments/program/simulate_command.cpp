#include <unistd.h>
#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/report.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/experiments/god_hand/run/run.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

using god::Asked;
using god::Options;
namespace fs = std::filesystem;

struct Typed {
  Asked asked = {};
  double rate = 1000, seconds = 0;
  std::string out = {}, resume = {};
};

// An option that takes one of two words.
void add_choice(CLI::App& options, const std::string& name, const std::string& no, const std::string& yes,
                const std::string& line, const std::function<void(bool)>& choose) {
  options
      .add_option_function<std::string>(
          "--" + name,
          [=](const std::string& word) {
            if (word != no && word != yes)
              throw std::invalid_argument("--" + name + " " + word + " should be " + no + " or " + yes +
                                          did_you_mean(word, {no, yes}));
            choose(word == yes);
          },
          line)
      ->type_name(no + "|" + yes)
      ->group("What is compared");
}

void add_options(CLI::App& options, Typed& typed) {
  Asked& a = typed.asked;
  Options& o = a.options;
  options.add_option("SCENE", a.scene, "a name (below), or mesh files as fixed parts: a.stl@mm,b.obj")->type_name("");
  options.add_option("--motion", a.motion, "a name (below), or a file: Leap recording (.json, .gz), angles (.csv)")
      ->group("What is simulated")
      ->type_name("FILE|NAME");
  options.add_option("--parts", a.parts, "folder of real parts for the scenes simple and engine")
      ->group("What is simulated")
      ->type_name("FOLDER");
  options
      .add_option("--place", a.share,
                  "a recording is placed so that its target is inside an object in this share of its frames; 0: as "
                  "recorded; default: 0.45")
      ->group("What is simulated")
      ->check(from_to(0.0, 1.0))
      ->type_name("SHARE");
  options.add_option("--frames", a.frames, "stop after so many")->group("What is simulated")->check(above(0));
  options.add_option("--seconds", typed.seconds, "stop after so much simulated time")
      ->group("What is simulated")
      ->check(above(0));
  options.add_option("--solver", o.solver, "NAME:key=value,...; default: dual_active_set (./zwang solvers)")
      ->group("How");
  options.add_option("--rate", typed.rate, "simulated steps a second; default: 1000")
      ->group("How")
      ->check(from_to(1.0, 1e5))
      ->type_name("HZ");
  options.add_option("--tolerance", o.tolerance, "that the solver is asked for; default: 1e-10")
      ->group("How")
      ->check(from_to(1e-16, 1));
  options.add_option("--k-f", o.force_stiffness, "stiffness of the coupling to the engine [1/s^2]; default: 1000")
      ->group("How")
      ->check(from_to(0));
  options.add_option("--cap", o.force_cap, "largest push on one object [N]; default: 60")
      ->group("How")
      ->check(from_to(0));
  options.add_option("--gap", o.gap, "that contact rows keep [m]; default: 2e-4")->group("How")->check(above(0));
  options.add_option("--activation", o.activation, "distance from which contacts are rows [m]; default: 2e-3")
      ->group("How")
      ->check(above(0));
  options.add_option("--sub-steps", o.sub_steps, "of a frame, at most; default: 3")
      ->group("How")
      ->check(from_to(1, 100));
  options.add_flag("--audit", a.audit, "FCL looks at every committed frame at the end")->group("How");
  add_choice(options, "limits", "predictive", "violated", "rows of joint limits before they are met, or once violated",
             [&o](bool yes) { o.limits = yes ? Options::Limits::violated : Options::Limits::predictive; });
  add_choice(options, "commit", "cycle", "printed", "close the joints after each step, or the linear step alone",
             [&o](bool yes) { o.commit = yes ? Options::Commit::printed : Options::Commit::cycle; });
  add_choice(options, "toc", "once", "twice", "time of contact applied once, or as Eq. 29-30 are printed",
             [&o](bool yes) { o.toc_twice = yes; });
  add_choice(options, "toc-of", "cluster", "all", "whose time of contact ends a sub-step (all: Algorithm 1)",
             [&o](bool yes) { o.toc_of_all = yes; });
  add_choice(options, "clusters", "off", "on", "each hand solved apart", [&o](bool yes) { o.clusters = yes; });
  add_choice(options, "thinning", "off", "on", "contacts reduced to those that carry",
             [&o](bool yes) { o.reduce_contacts = yes; });
  add_choice(options, "lazy", "off", "on",
             "what thinning took is given back where the solve needs it; off: all of it, at once",
             [&o](bool yes) { o.lazy_contacts = yes; });
  add_choice(options, "model", "reduced", "maximal", "26 unknowns a hand, or 96 with 70 joint rows",
             [&o](bool yes) { o.maximal = yes; });
  options
      .add_option("--verify", o.verify,
                  "the referee looks at the solves of every N-th frame (default 10; 0: of none); it takes its time,\n"
                  "which is not in the figures")
      ->check(from_to(0));
  options.add_option("--out", typed.out, "folder for the run; default: results/<date>-<time>")
      ->group("Where it goes")
      ->type_name("DIR");
  options.add_option("--resume", typed.resume, "go on with a run that was stopped, or write its page anew")
      ->group("Where it goes")
      ->type_name("DIR");
}

std::string names() {
  std::string text = "\nScenes:\n";
  const auto add = [&text](const std::string& name, const std::string& line) {
    text += "  " + name + std::string(std::max<std::size_t>(1, 12 - name.size()), ' ') + line + "\n";
  };
  for (const god::SceneEntry& scene : god::scenes()) add(scene.name, scene.line);
  text += "\nMotions:\n";
  for (const auto& [name, line] : god::synthetic_motions()) add(name, line);
  return text;
}

// The options of the run in this folder; `--audit` alone may be asked for anew.
god::Record record_to_resume(const CLI::App& options, const Typed& typed) {
  for (const CLI::Option* option : options.get_options())
    if (option->count() > 0 && option->get_name() != "--resume" && option->get_name() != "--audit")
      throw std::invalid_argument("--resume " + typed.resume + " goes on with the options of that run: " +
                                  option->get_name() + " has no part in it");
  god::Record record = god::read_record(typed.resume);
  god::require_same_program(typed.resume);
  record.asked.audit = record.asked.audit || typed.asked.audit;
  return record;
}

// Files by their absolute paths: a run may be resumed from another folder.
void make_absolute(Asked& asked) {
  for (std::string* path : {&asked.parts, &asked.motion})
    if (!path->empty() && fs::exists(*path)) *path = fs::absolute(*path).lexically_normal().string();
}

std::string head_line(const god::Record& record, const god::Setup& setup) {
  const god::SceneSize size = god::size_of(setup.surroundings);
  const Asked& a = record.asked;
  std::string line = record.title + " in " + a.scene + ": " + std::to_string(record.hands) +
                     (record.hands == 1 ? " hand, " : " hands, ") + std::to_string(size.fixed) + " fixed and " +
                     std::to_string(size.loose) + " loose objects, " + grouped(size.triangles) + " triangles; " +
                     a.options.solver + " at " + grouped(static_cast<std::size_t>(std::lround(1 / a.options.dt))) +
                     " Hz";
  if (record.placement.depth > 0) {
    char placed[120];
    std::snprintf(placed, sizeof placed,
                  "\nPlaced so that the target is inside in %.0f %% of its frames, %.1f mm deep at most",
                  100 * record.placement.inside, 1e3 * record.placement.depth);
    line += placed;
  }
  return line;
}

}  // namespace

int simulate_command(std::vector<std::string> words) {
  CLI::App options("Lets a tracked hand work among objects: the god hand follows it and stays out of them.");
  introduce(options, "simulate",
            "  ./zwang simulate simple --motion grasp\n"
            "  ./zwang simulate engine --motion recording.json --solver nnls --rate 500 --audit\n"
            "  ./zwang simulate gear.stl@mm --motion press --seconds 2 --out gear\n"
            "  ./zwang simulate box --motion slide --commit printed --solver nnls_paper\n"
            "  ./zwang simulate --resume gear\n" +
                names());
  Typed typed;
  add_options(options, typed);
  const std::string command = command_line("simulate", words);
  if (!read(options, std::move(words))) return done;

  const bool resume = !typed.resume.empty();
  god::Record record;
  fs::path directory;
  if (resume) {
    record = record_to_resume(options, typed);
    directory = typed.resume;
  } else {
    record = {.command = command, .started = now_iso8601(), .finished = {}, .asked = typed.asked};
    record.asked.options.dt = 1 / typed.rate;
    if (typed.seconds > 0) {
      const long most = std::max(1l, std::lround(typed.seconds * typed.rate));
      record.asked.frames = record.asked.frames > 0 ? std::min(record.asked.frames, most) : most;
    }
    make_absolute(record.asked);
    directory = new_directory(typed.out, "./zwang simulate --resume");
  }
  const god::Record stored = record;
  const god::Setup setup =
      resume ? from_record(directory, [&record] { return god::set_up(record); }) : god::set_up(record);
  if (resume && (stored.motion != record.motion || stored.surroundings != record.surroundings))
    throw BadFile(directory.string() + " cannot go on: its " + (stored.motion != record.motion ? "motion" : "scene") +
                  " is no longer what it was");
  std::printf("%s\n", head_line(record, setup).c_str());
  std::fflush(stdout);

  fs::create_directories(directory);
  god::write_record(directory, record);
  Progress bar(isatty(STDERR_FILENO) == 1);
  auto start = std::chrono::steady_clock::now();
  double begun = -1;
  const auto progress = [&](double fraction, const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    if (begun < 0 || fraction < begun) begun = fraction, start = now;
    const double passed = std::chrono::duration<double>(now - start).count();
    bar.show(fraction, what, fraction > begun ? passed * (1 - fraction) / (fraction - begun) : -1);
  };
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  long frames = record.asked.frames;
  if (record.finished.empty()) frames = god::simulate(directory, record, setup, resume, progress, interrupted);
  const bool whole = frames == record.asked.frames;
  if (whole && record.finished.empty()) {
    record.finished = now_iso8601();
    god::write_record(directory, record);
  }
  begun = -1;
  if (!whole) record.asked.audit = false;
  const god::Finished finished = god::finish(directory, record, setup, progress);
  bar.clear();
  const std::string go_on = "./zwang simulate --resume " + report::shell_word(directory.string());
  if (!whole)
    std::printf("Stopped after %s of %s frames; nothing lost. Go on with: %s\n",
                grouped(static_cast<std::size_t>(frames)).c_str(),
                grouped(static_cast<std::size_t>(record.asked.frames)).c_str(), go_on.c_str());
  for (const std::string& line : finished.lines) std::printf("%s\n", line.c_str());
  std::printf("Summary: %s\n", (directory / "summary.json").c_str());
  if (!finished.replay.empty()) std::printf("Replay: %s\n", finished.replay.c_str());
  return whole ? done : stopped;
}

}  // namespace zwang

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
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/run/run.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>
#include <zwang/experiments/program/commands.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

using god::Asked;
namespace fs = std::filesystem;

struct Typed {
  Asked asked = {};
  double rate = 1000, seconds = 0;
  std::string out = {}, resume = {};
};

// An option of the simulation: a number or a name, or one of two words.
struct AddOption {
  CLI::App& app;

  template <class T>
  void operator()(const god::OptionText& text, T& value) const {
    if (text.name == nullptr) return;
    CLI::Option* option = app.add_option("--" + std::string(text.name), value, text.line)->group("How");
    if constexpr (std::is_arithmetic_v<T>) option->check(text.open ? above(text.low) : from_to(text.low, text.high));
  }
  template <class T>
  void operator()(const god::OptionText& text, T& value, const god::Words& words) const {
    const auto choose = [name = "--" + std::string(text.name), &value, words](const std::string& word) {
      if (word != words[0] && word != words[1])
        throw std::invalid_argument(name + " " + word + " should be " + words[0] + " or " + words[1] +
                                    did_you_mean(word, {words[0], words[1]}));
      value = static_cast<T>(word == words[1]);
    };
    app.add_option_function<std::string>("--" + std::string(text.name), choose, text.line)
        ->type_name(std::string(words[0]) + "|" + words[1])
        ->group("What is compared");
  }
};

void add_options(CLI::App& options, Typed& typed) {
  Asked& a = typed.asked;
  const auto add = [&options](const char* group, const char* name, auto& value, const char* line) {
    return options.add_option(name, value, line)->group(group);
  };
  options.add_option("SCENE", a.scene, "a name (below), or mesh files as fixed parts: a.stl@mm,b.obj")->type_name("");
  add("What is simulated", "--motion", a.motion,
      "a name (below), or a file: Leap recording (.json, .gz), angles or the path of a tool (.csv)")
      ->type_name("FILE|NAME");
  add("What is simulated", "--god", a.god,
      "what is tracked: hand, a tool by name (below), mesh files as its convex pieces: a.stl@mm,b.obj, or a jointed "
      "mechanism: a scene file (.json), an MJCF or URDF model (.xml, .urdf; hand.xml@x-z: its x axis along the "
      "fingers, its -z out of the back of the hand); default: hand")
      ->type_name("FILE|NAME");
  add("What is simulated", "--parts", a.parts, "folder of real parts for the scenes simple and engine")
      ->type_name("FOLDER");
  add("What is simulated", "--place", a.share,
      "a recording is placed so that its target is inside an object in this share of its frames; 0: as recorded; "
      "default: 0.45")
      ->check(from_to(0.0, 1.0))
      ->type_name("SHARE");
  add("What is simulated", "--frames", a.frames, "stop after so many")->check(above(0));
  add("What is simulated", "--seconds", typed.seconds, "stop after so much simulated time")->check(above(0));
  add("How", "--rate", typed.rate, "simulated steps a second; default: 1000")
      ->check(from_to(1.0, 1e5))
      ->type_name("HZ");
  // Before the single choices, which have the last word.
  const auto choose = [&a](const std::string& method) {
    if (method != "zwang" && method != "paper")
      throw std::invalid_argument("--method " + method + " should be zwang or paper" +
                                  did_you_mean(method, {"zwang", "paper"}));
    a.options = method == "paper" ? god::paper_method() : god::Options{};
  };
  options
      .add_option_function<std::string>("--method", choose,
                                        "zwang's own, or as the paper prints it; each choice below may be taken back")
      ->type_name("zwang|paper")
      ->group("What is compared");
  each_option(a.options, AddOption{options});
  options.add_flag("--audit", a.audit, "FCL looks at every committed frame at the end")->group("How");
  add("Where it goes", "--out", typed.out, "folder for the run; default: results/<date>-<time>")->type_name("DIR");
  add("Where it goes", "--resume", typed.resume, "go on with a run that was stopped, or write its page anew")
      ->type_name("DIR");
}

std::string names() {
  std::string text = "\nScenes:\n";
  const auto add = [&text](const std::string& name, const std::string& line) {
    text += "  " + name + std::string(std::max<std::size_t>(1, 12 - name.size()), ' ') + line + "\n";
  };
  for (const god::SceneEntry& scene : god::scenes()) add(scene.name, scene.line);
  text += "\nGod objects (--god):\n";
  add("hand", "16 bodies; two where the motion has two");
  for (const auto& [name, line] : god::tools()) add(name, line);
  add("FILE", "meshes, or a mechanism (docs/god-hand.md)");
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
  const auto absolute = [](std::string& path, bool is_file) {
    if (is_file && fs::exists(path)) path = fs::absolute(path).lexically_normal().string();
  };
  absolute(asked.parts, !asked.parts.empty());
  absolute(asked.motion, god::names_file(asked.motion));
  if (god::is_mechanism(asked.god)) {
    auto [file, axes] = god::parts_of_name(asked.god);
    absolute(file, true);
    asked.god = file + axes;
  } else {
    absolute(asked.god, asked.god.find_first_of("./") != std::string::npos);
  }
}

std::string head_line(const god::Record& record, const god::Setup& setup) {
  const god::SceneSize size = god::size_of(setup.surroundings);
  const Asked& a = record.asked;
  const std::string gods = setup.tool ? setup.tool->name : record.hands == 1 ? "hand" : "hands";
  std::string line = record.title + " in " + a.scene + ": " + std::to_string(record.hands) + " " + gods + ", " +
                     std::to_string(size.fixed) + " fixed and " + std::to_string(size.loose) + " loose objects, " +
                     grouped(size.triangles) + " triangles; " + a.options.solver +
                     (a.options.mu > 0 ? " at " : ", no friction, at ") + grouped(std::lround(1 / a.options.dt)) +
                     " Hz";
  if (record.placement.depth > 0)
    line += printed("\nPlaced so that the target is inside in %.0f %% of its frames, %.1f mm deep at most",
                    100 * record.placement.inside, 1e3 * record.placement.depth);
  return line;
}

}  // namespace

int simulate_command(std::vector<std::string> words) {
  CLI::App options("Lets a tracked hand work among objects: the god hand follows it and stays out of them.");
  introduce(options, "simulate",
            "  ./zwang simulate simple --motion grasp\n"
            "  ./zwang simulate engine --motion recording.json --solver nnls --rate 500 --audit\n"
            "  ./zwang simulate gear.stl@mm --motion press --seconds 2 --out gear\n"
            "  ./zwang simulate box --motion slide --method paper\n"
            "  ./zwang simulate box --god fingers.json --motion grasp\n"
            "  ./zwang simulate box --motion slide --method paper --solver dual_active_set\n"
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
    const SolverEntry* solver = find_solver(typed.asked.options.solver);
    if (options.get_option("--mu")->count() == 0 && solver && solver->laws.empty()) record.asked.options.mu = 0;
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
  const char* changed = stored.motion != record.motion               ? "motion"
                        : stored.surroundings != record.surroundings ? "scene"
                        : stored.god != record.god                   ? "god object"
                                                                     : nullptr;
  if (resume && changed)
    throw BadFile(directory.string() + " cannot go on: its " + changed + " is no longer what it was");
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
    std::printf("Stopped after %s of %s frames; nothing lost. Go on with: %s\n", grouped(frames).c_str(),
                grouped(record.asked.frames).c_str(), go_on.c_str());
  for (const std::string& line : finished.lines) std::printf("%s\n", line.c_str());
  std::printf("Summary: %s\n", (directory / "summary.json").c_str());
  if (!finished.replay.empty()) std::printf("Replay: %s\n", finished.replay.c_str());
  return whole ? done : stopped;
}

}  // namespace zwang

#include <zwang/experiments/program/choices.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <stdexcept>

#include <zwang/bench/program/options.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

using god::Asked;
namespace fs = std::filesystem;

void add_words(CLI::App& app, const std::string& name, const god::Words& words, const char* line, const char* group,
               const std::function<void(bool second)>& choose) {
  const auto take = [name, words, choose](const std::string& word) {
    if (word != words[0] && word != words[1])
      throw std::invalid_argument(name + " " + word + " should be " + words[0] + " or " + words[1]);
    choose(word == words[1]);
  };
  app.add_option_function<std::string>(name, take, line)
      ->type_name(std::string(words[0]) + "|" + words[1])
      ->group(group);
}

constexpr auto compared = "What is compared";

// An option of the simulation: a number or a name, or one of two words.
struct AddOption {
  CLI::App& app;

  template <class T>
  void operator()(const god::OptionText& text, T& value) const {
    if (text.name == nullptr) return;
    CLI::Option* option = app.add_option("--" + std::string(text.name), value, text.line)->group("How");
    if constexpr (std::is_arithmetic_v<T>) within(text.range, option);
  }
  template <class T>
  void operator()(const god::OptionText& text, T& value, const god::Words& words) const {
    add_words(app, "--" + std::string(text.name), words, text.line, compared,
              [&value](bool second) { value = static_cast<T>(second); });
  }
};

std::string names() {
  std::string text = "\nScenes:\n";
  const auto add = [&text](const std::string& name, const std::string& line) {
    text += "  " + name + std::string(std::max<std::size_t>(1, 12 - name.size()), ' ') + line + "\n";
  };
  for (const auto& [name, line] : god::scenes()) add(name, line);
  text += "\nGod objects (--god):\n";
  add("hand", "16 bodies; two where the motion has two");
  for (const auto& [name, line] : god::tools()) add(name, line);
  add("FILE", "meshes, or a mechanism (docs/god-hand/scenes.md)");
  text += "\nMotions:\n";
  for (const auto& [name, line] : god::synthetic_motions()) add(name, line);
  return text;
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

}  // namespace

void add_choices(CLI::App& app, const std::string& command, const std::string& examples, Choices& choices) {
  introduce(app, command, examples + names());
  Asked& a = choices.asked;
  const auto add = [&app](const char* name, auto& value, const char* line) {
    return app.add_option(name, value, line)->group("What is simulated");
  };
  app.add_option("SCENE", a.scene, "a name (below), or mesh files as fixed parts: a.stl@mm,b.obj; default: " + a.scene)
      ->type_name("");
  add("--motion", a.motion,
      "a name (below), or a file: Leap recording (.json, .gz), angles or the path of a tool (.csv); default: grasp")
      ->type_name("FILE|NAME");
  add("--god", a.god,
      "what is tracked: hand, a tool by name (below), mesh files as its convex pieces: a.stl@mm,b.obj, or a jointed "
      "mechanism: a scene file (.json), an MJCF or URDF model (.xml, .urdf; hand.xml@x-z: its x axis along the "
      "fingers, its -z out of the back of the hand); default: hand")
      ->type_name("FILE|NAME");
  add("--parts", a.parts, "folder of real parts for the scenes simple and engine")->type_name("FOLDER");
  within(from_to(0, 1), add("--place", a.share,
                            "a recording is placed so that its target is inside an object in this share of its "
                            "frames; 0: as recorded; default: 0.45"))
      ->type_name("SHARE");
  within(above(0, "s"), add("--seconds", choices.seconds, "stop after so much simulated time"))->type_name("S");
  within(from_to(1, 1e5, "Hz"), app.add_option("--rate", choices.rate, "simulated steps a second; default: 1000"))
      ->group("How")
      ->type_name("HZ");
  // Before the single choices, which have the last word.
  add_words(app, "--method", {"zwang", "paper"},
            "zwang's own, or as the paper prints it; each choice below may be taken back", compared,
            [&a](bool paper) { a.options = paper ? god::paper_method() : god::Options{}; });
  each_option(a.options, AddOption{app});
}

long frames_of(const Choices& choices) {
  return std::max(1l, std::lround(std::min(choices.seconds * choices.rate, 1e15)));  // within a long
}

god::Record record_of(const CLI::App& app, const Choices& choices, const std::string& command_line) {
  god::Record record = {.command = command_line, .started = now_iso8601(), .finished = {}, .asked = choices.asked};
  Asked& asked = record.asked;
  asked.options.dt = 1 / choices.rate;
  const SolverEntry* solver = find_solver(asked.options.solver);
  if (app.get_option("--mu")->count() == 0 && solver && solver->laws.empty()) asked.options.mu = 0;
  SolveOptions().read_accuracy(asked.options.accuracy);
  if (asked.options.pads > 0 && !(asked.options.mu > 0))
    throw std::invalid_argument("--pads: what is held is held by friction; --mu should be above 0");
  if (asked.options.gap > asked.options.activation)
    throw std::invalid_argument(printed("--gap %g is above --activation %g: what is farther away than that has no rows",
                                        asked.options.gap, asked.options.activation));
  if (choices.seconds > 0) {
    const long most = frames_of(choices);
    asked.frames = asked.frames > 0 ? std::min(asked.frames, most) : most;
  }
  make_absolute(asked);
  return record;
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
  if (const int every = a.options.verify; every > 0)
    line += every == 1 ? ", every frame refereed" : "; the referee looks at one frame in " + std::to_string(every);
  if (record.placement.depth > 0)
    line += printed("\nPlaced so that the target is inside in %.0f %% of its frames, %.1f mm deep at most",
                    100 * record.placement.inside, 1e3 * record.placement.depth);
  return line;
}

}  // namespace zwang
